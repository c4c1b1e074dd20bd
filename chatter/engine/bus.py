"""The bus: what a step of time offers to every law group.

Ports are those of a structure (`dynamics.machine.steps.StructureSteps`): displacement and velocity
at both ends of the step, force held over it and its change. The clock says which step it is.
"""

from typing import NamedTuple


class Clock(NamedTuple):
    """Step of time: from its beginning, `step`, to `step + 1`."""

    number: int  # of the step since the controllers began, from 0
    step: int  # since the start of the cut, or of the run; below 0 before it, with all at rest
    row: int  # in the chunk, of what is prescribed at the beginning of the step
