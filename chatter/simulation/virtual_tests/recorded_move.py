"""The move of an axis of a machine along set points that were recorded."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from chatter.compile.machine_along_axes import StateOfMachine, machine_along_axes, machine_at_start
from chatter.compile.machine_parts import assembled_machine
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.virtual_tests.move import MovePlan, MoveResult, axes_moved
from dynamics.machine.description import Machine
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.trajectory.motion import TrajectoryError
from dynamics.trajectory.recorded import RecordedMotion
from dynamics.trajectory.set_points import interpolation_cycle

Array = NDArray[np.float64]

#: machines kept assembled: moves of one state are asked for one by one
_KEPT_MACHINES = 4


def recorded_move(case: Case, axis: str, time: Array, command: Array) -> MoveResult:
    """Move of an axis of the machine of a case, from rest, along recorded set points.

    Parameters
    ----------
    case : Case
        On a machine, whose other axes stand where the case has them.
    axis : str
        Name of the axis, which is under control.
    time, command : (n,) array of float
        Times, s, and set points, m.

    Returns
    -------
    MoveResult
        A row a cycle of the position loop; the effort is the mean over the cycle that ends there.

    Raises
    ------
    InputError
        If there is no such axis under control, or the set points make no move.
    RunError
        If the machine runs away.
    """
    file = case.machine_file()
    try:
        motion = RecordedMotion(time, command[:, None])
    except TrajectoryError as error:
        raise InputError(f"{case.name}: axis {axis}: {error}") from error
    travel = command - command[0]
    machine, along = _machine(case, axis, float(travel.min()), float(travel.max()))
    drives = machine.drives
    cycle = interpolation_cycle(
        (one.controller.position.timing.sample_time for one in drives), file.step
    )
    plan = MovePlan(motion, (axis,), cycle, afterwards=0.0)
    return axes_moved(file.title or file.name, machine, file.step, plan, along=along)


@lru_cache(_KEPT_MACHINES)
def _machine(
    case: Case, axis: str, lowest: float, highest: float
) -> tuple[Machine, MachinesAlong | None]:
    """Machine where the move begins, and along the way where that changes it."""
    section, file = case.structure, case.machine_file()
    _refuse_without_control(case, file, axis)
    machine = assembled_machine(file, section.condition, section.position)
    if section.friction is False:
        machine = machine.without_friction()
    along = machine_along_axes(
        file,
        {axis: (lowest, highest)},
        lambda *_: {},
        section.travel_positions,
        StateOfMachine(section.condition, section.position, section.friction is not False),
        machine,
    )
    return (machine if along is None else machine_at_start(along)), along


def _refuse_without_control(case: Case, file: MachineFile, axis: str) -> None:
    section = file.axis.get(axis)
    if section is None or section.control is None:
        known = ", ".join(name for name, one in file.axis.items() if one.control is not None)
        raise InputError(
            f'{case.name}: axis "{axis}" of {file.name} is not under control; there are '
            f"{known or 'none'}"
        )
