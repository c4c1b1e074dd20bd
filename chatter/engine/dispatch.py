"""Law groups on the ports of a structure, dispatched by the type of their table.

Every group answers two calls with the bus and the clock: `forces` puts its forces on the bus,
`commit` takes the motion of the step into its memory. A law joins by its table and two kernels in
`cutting` or `dynamics` and one line in a list: here, or in `cut` where it acts at the tool point. A
law that is absent from a case costs nothing.
"""

from chatter.engine.cut import CutOnPorts, cut_commit, cut_forces
from chatter.engine.record import CutRecord, PortRecord, cut_record_commit, port_record_commit
from cutting.compiled import by_table, for_each
from dynamics.machine.energy import EnergyAccount, energy_commit
from dynamics.machine.groups import (
    ConstantForces,
    ControlledDrives,
    FrictionsOnPorts,
    Loads,
    constant_forces,
    drive_forces,
    friction_commit,
    friction_forces,
    load_forces,
    nothing,
)
from dynamics.machine.modal_structure import ModalEnergy, modal_energy_forces
from dynamics.machine.moving_structure import MovingStructure, moving_forces
from dynamics.machine.travel_limit import TravelLimit, travel_limit_commit

#: table -> kernels of its forces and its commit
LAWS = {
    MovingStructure: (moving_forces, nothing),
    ControlledDrives: (drive_forces, nothing),
    ConstantForces: (constant_forces, nothing),
    Loads: (load_forces, nothing),
    CutOnPorts: (cut_forces, cut_commit),
    FrictionsOnPorts: (friction_forces, friction_commit),
    ModalEnergy: (modal_energy_forces, nothing),
    EnergyAccount: (nothing, energy_commit),
    TravelLimit: (nothing, travel_limit_commit),
    CutRecord: (nothing, cut_record_commit),
    PortRecord: (nothing, port_record_commit),
}
all_forces = for_each(by_table({table: forces for table, (forces, _) in LAWS.items()}))
all_commit = for_each(by_table({table: commit for table, (_, commit) in LAWS.items()}))
