"""What every structure on ports answers, whatever its table: predict, correct, one force more."""

from dynamics.compiled import by_table
from dynamics.machine.modal_structure import (
    ModalSteps,
    add_force_on_mode,
    correct_modes,
    predict_modes,
)
from dynamics.machine.steps import (
    StructureSteps,
    add_force_on_structure,
    correct_structure,
    predict_structure,
)

#: motion over the step with all forces constant
predict = by_table({StructureSteps: predict_structure, ModalSteps: predict_modes})
#: lets the forces vary linearly over the step by their changes
correct = by_table({StructureSteps: correct_structure, ModalSteps: correct_modes})
#: adds a force that is constant over the step, after the prediction
add_constant_force = by_table(
    {StructureSteps: add_force_on_structure, ModalSteps: add_force_on_mode}
)
