"""A machine, or modes, compiled for the time loop: ports in order, structure, law groups."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.control.drive_table import control_table
from dynamics.drive.backlash import BacklashTable, backlash_table
from dynamics.friction.law import FrictionLaw
from dynamics.friction.laws import friction_groups
from dynamics.machine.description import Machine
from dynamics.machine.energy import (
    SOURCES,
    EnergyAccount,
    account_of_moving,
    account_of_structure,
    energy_of,
)
from dynamics.machine.groups import ConstantForces, ControlledDrives, Loads, frictions_on_ports
from dynamics.machine.modal_structure import ModalSteps, modal_energy, modal_structure
from dynamics.machine.moving_structure import MachinesAlong, MovingStructure, moving_structure
from dynamics.machine.steps import StructureSteps, structure_steps
from dynamics.modal.modes import Mode
from dynamics.structure.linear_structure import StructureError
from dynamics.trajectory.set_points import SetPoints


class StructureTables(NamedTuple):
    """What the time loop needs of a structure: its ports, and what acts on them."""

    bus: StructureSteps | ModalSteps
    explicit: tuple  # laws whose forces are known at the beginning of a step
    implicit: tuple  # laws that are solved together with the motion
    port: dict[str, int]  # of drives, frictions, loads and outputs by name


def resting_set_points(axes: int) -> SetPoints:
    """Set points of axes that stay where they are."""
    position, velocity, acceleration = np.zeros((3, 1, max(axes, 1)))
    return SetPoints(position, velocity, acceleration, 1)


def machine_tables(
    machine: Machine,
    step: float,
    points: SetPoints | None = None,
    loads: Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]] | None = None,
    outputs: Mapping[str, NDArray[np.float64]] | None = None,
    velocity: NDArray[np.float64] | None = None,
    along: MachinesAlong | None = None,
) -> StructureTables:
    """Compile a machine, unstrained.

    At a step, s. Set points have one column an axis, in the order of `machine.axes`; loads are rows
    (n,) of the structure and forces (steps + 1,) on them at the ends of steps, N, linear in
    between; outputs are rows (n,) that will be read. The freedoms start with a velocity (n,). Rest
    by default. StructureError if a name is used twice or the set points have another number of
    axes, ControlError if a sample time is not a multiple of the step.

    The structure follows its axes where it is given at positions along them, of which the machine
    is that at the start; the outputs there are rows of loads and outputs.
    """
    points = resting_set_points(len(machine.axes)) if points is None else points
    if points.position.shape[1] != max(len(machine.axes), 1):
        raise StructureError(
            f"set points of {points.position.shape[1]} axes; the machine has {len(machine.axes)}"
        )
    loads = loads or {}
    rows: dict[str, NDArray[np.float64]] = {}
    for name, row in _rows(machine, {name: row for name, (row, _) in loads.items()}, outputs or {}):
        if name in rows:
            raise StructureError(f'"{name}" names two places of the machine')
        rows[name] = row
    port = {name: index for index, name in enumerate(rows)}
    matrix = np.array(list(rows.values())).reshape(-1, machine.structure.size)
    explicit: tuple = ()
    accounts: tuple = ()
    bus: StructureSteps
    if along is None:
        bus = structure_steps(machine.structure, matrix, step, velocity)
    else:
        bus, moving = _following(along, rows, port, step, velocity)
        explicit += (moving,)
        accounts += (account_of_moving(moving, bus, _sources(machine, port)),)
    if machine.drives:
        explicit += (_controlled(machine, step, points, port),)
    if machine.preloads:
        indices = np.array([port[one.name] for one in machine.preloads], dtype=np.int64)
        explicit += (ConstantForces(indices, np.array([one.value for one in machine.preloads])),)
    if loads:
        indices = np.array([port[name] for name in loads], dtype=np.int64)
        force = np.stack([force for _, force in loads.values()], axis=1, dtype=np.float64)
        explicit += (Loads(indices, force),)
    frictions = friction_groups(
        [one.law for one in machine.frictions], [port[_friction(one)] for one in machine.frictions]
    )
    backlashes = (_backlash_table(machine, port, along),) if machine.backlashes else ()
    implicit: tuple = ()
    if frictions or backlashes:
        implicit = (frictions_on_ports(frictions, bus.step_compliance, backlashes),)
    return StructureTables(bus, explicit, (*implicit, *accounts), port)


def with_energy_account(tables: StructureTables, machine: Machine) -> StructureTables:
    """Same tables with an account of the energy, as those of a structure along its axes have."""
    if any(isinstance(group, EnergyAccount) for group in tables.implicit):
        return tables
    sources = _sources(machine, tables.port)
    account = account_of_structure(machine.structure, tables.bus, sources)
    return tables._replace(implicit=(*tables.implicit, account))


def _sources(machine: Machine, port: Mapping[str, int]) -> list[int]:
    """What puts the force on each port, as a number in `SOURCES`; loads act at outputs too."""
    names = {
        **{f"drive {one.name}": "drives" for one in machine.drives},
        **{_friction(one): "friction" for one in machine.frictions},
        **{one.name: "preloads" for one in machine.preloads},
        **{f"backlash {one.name}": "backlash" for one in machine.backlashes},
    }
    numbers = {name: number for number, name in enumerate(SOURCES)}
    return [numbers[names.get(name, "loads")] for name in port]


def energy_of_structure(tables: StructureTables) -> dict[str, float]:
    """Energy where it is accounted for, J, as `energy_of`; empty elsewhere."""
    for group in tables.implicit:
        if isinstance(group, EnergyAccount):
            return energy_of(group, tables.bus)
    return {}


def _following(
    along: MachinesAlong,
    rows: Mapping[str, NDArray[np.float64]],
    port: Mapping[str, int],
    step: float,
    velocity: NDArray[np.float64] | None,
) -> tuple[StructureSteps, MovingStructure]:
    """Structure that follows its axes, and the group that makes it."""
    matrices = []
    for machine, outputs in zip(along.machines, along.outputs, strict=True):
        there = dict(_rows(machine, {}, outputs))
        matrices.append(np.array([there[name] for name in rows]))
    drives = {drive.axis: drive.name for drive in reversed(along.machines[0].drives)}
    travel = np.array([port[f"scale {drives[axis]}"] for axis in along.axes], dtype=np.int64)
    return moving_structure(along, matrices, travel, step, velocity)


def modal_tables(
    modes: Sequence[Mode],
    step: float,
    laws: Sequence[FrictionLaw] = (),
    rubbing: Sequence[int] = (),
) -> StructureTables:
    """Compile modes at rest, with frictions on some of them.

    At a step, s; `rubbing` is the mode that each law acts on.
    """
    bus = modal_structure(modes, step, rubbing)
    port = {f"tool {axis}": index for index, axis in enumerate("xyz")}
    indices = range(len(port), len(port) + len(rubbing))
    frictions = friction_groups(list(laws), list(indices))
    implicit: tuple = (modal_energy(modes),)
    if frictions:
        implicit += (frictions_on_ports(frictions, bus.step_compliance),)
    return StructureTables(bus, (), implicit, port)


def _rows(machine: Machine, loads: Mapping, outputs: Mapping):
    for drive in machine.drives:
        yield f"drive {drive.name}", drive.row
    for one in machine.frictions:
        yield _friction(one), one.row
    for one in machine.preloads:
        yield one.name, one.row
    for one in machine.backlashes:
        yield f"backlash {one.name}", one.row
    yield from loads.items()
    for drive in machine.drives:
        yield f"scale {drive.name}", drive.scale
    for name, row in outputs.items():
        if name not in loads:
            yield name, row


def _friction(one) -> str:
    return f"friction {one.name}"


def _backlash_table(
    machine: Machine, port: Mapping[str, int], along: MachinesAlong | None
) -> BacklashTable:
    """Backlashes of a machine, their springs as stiff as where their axes are."""
    laws, positions, travel = [], [], []
    drives = {drive.axis: drive.name for drive in reversed(machine.drives)}
    for index, one in enumerate(machine.backlashes):
        if along is None or one.axis not in along.axes:
            laws.append([one.law])
            positions.append(np.zeros(1))
            travel.append(-1)
        else:
            axis = along.axes.index(one.axis)
            laws.append([there.backlashes[index].law for there in along.machines_along(axis)])
            positions.append(along.positions[axis])
            travel.append(port[f"scale {drives[one.axis]}"])
    ports = [port[f"backlash {one.name}"] for one in machine.backlashes]
    return backlash_table(laws, ports, travel, positions)


def _controlled(
    machine: Machine, step: float, points: SetPoints, port: Mapping[str, int]
) -> ControlledDrives:
    count = len(machine.drives)
    return ControlledDrives(
        control_table([drive.controller for drive in machine.drives], step),
        np.array([port[f"drive {drive.name}"] for drive in machine.drives], dtype=np.int64),
        np.array([port[f"scale {drive.name}"] for drive in machine.drives], dtype=np.int64),
        np.array([machine.axes.index(drive.axis) for drive in machine.drives], dtype=np.int64),
        points,
        np.zeros((1, count)),
        np.zeros(count),
    )
