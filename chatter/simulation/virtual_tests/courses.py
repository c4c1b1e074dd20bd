"""Trajectories of moves: computed, of an NC program, or of recorded set points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.description.machine.move import Course, MoveSection
from chatter.io.nc_program.program import NcProgram, read_program
from chatter.io.set_points import recorded_positions
from dynamics.trajectory.block_motion import Block, BlockMotion, PathLimits, eased, rounded
from dynamics.trajectory.motion import SomeCoordinates, TrajectoryError
from dynamics.trajectory.recorded import RecordedMotion
from dynamics.trajectory.spatial_path import PathInSpace
from dynamics.trajectory.time_optimal import TimeOptimalMotion

_LETTERS = "XYZ"
#: instants between two recorded ones at which limits are looked at
_BETWEEN = 4
#: by which a limit may be exceeded by rounding, as a share of it
_ROUNDING = 1e-3
_UNITS = {"velocity": "m/s", "acceleration": "m/s^2"}


def course_of(section: MoveSection) -> Course:
    """Trajectory and path of a move.

    TrajectoryError if they make no sense; InputError if its file cannot be read, moves an axis that
    the move has not, or exceeds a limit.
    """
    if section.kind == "nc program":
        return _of_program(section)
    if section.kind == "recorded":
        return _of_record(section)
    return section.course()


def limits_of(section: MoveSection) -> PathLimits:
    """Limits along the path of a move."""
    return PathLimits(section.velocity, section.acceleration, section.jerk)


def program_motion(
    program: NcProgram, limits: PathLimits, tolerance: float | None = None
) -> BlockMotion:
    """Motion along all blocks of a program, within a tolerance, m, if given.

    Corners are then rounded, and the curvature between lines and arcs does not jump.

    Blocks of the motion have the number of that of the program as their source.
    """
    blocks: Sequence[Block] = [
        replace(one.block, source=number) for number, one in enumerate(program.blocks)
    ]
    if tolerance is not None:
        blocks = eased(rounded(blocks, tolerance, limits), tolerance)
    return BlockMotion(tuple(blocks), limits)


def _of_program(section: MoveSection) -> Course:
    start = np.zeros(3)
    coordinates = tuple(_LETTERS.index(letter) for letter in section.letters)
    if section.start is not None:
        start[list(coordinates)] = section.start
    program = read_program(section.file, tuple(start.tolist()))
    for one in program.blocks:
        for index, letter in enumerate(_LETTERS):
            along = np.linspace(0.0, one.element.length, 5)
            moves = np.ptp(one.element.at(along).position[:, index]) > 0.0
            if moves and index not in coordinates:
                raise InputError(
                    f"{program.path}: line {one.line}: {letter} moves, but the move has "
                    f"{', '.join(section.letters)}"
                )
    limits = limits_of(section)
    motion: BlockMotion | TimeOptimalMotion = program_motion(program, limits, section.tolerance)
    if section.planner == "time-optimal":
        motion = TimeOptimalMotion(motion.blocks, limits)
    # corners that are rounded count as a contour error, as they do on a machine
    exact = BlockMotion(tuple(one.block for one in program.blocks), limits_of(section))
    return Course(SomeCoordinates(motion, coordinates), PathInSpace(exact.path, coordinates))


def _of_record(section: MoveSection) -> Course:
    time, position = recorded_positions(section.file, section.axes)
    motion = RecordedMotion(time, position)
    _refuse_faster(section, motion, time)
    return Course(motion)


def _refuse_faster(section: MoveSection, motion: RecordedMotion, time: Array) -> None:
    """Refuse set points that exceed the limits that the move states."""
    fine = np.linspace(0.0, motion.duration, _BETWEEN * len(time) + 1)
    moved = motion.at(fine)
    values = {"velocity": moved.velocity, "acceleration": moved.acceleration}
    for key, found in values.items():
        limit = getattr(section, key)
        size = np.max(np.abs(found), axis=1)
        if limit is not None and size.max() > (1.0 + _ROUNDING) * limit:
            row = int(np.argmax(size))
            axis = section.axes[int(np.argmax(np.abs(found[row])))]
            raise TrajectoryError(
                f"{section.file}: {axis} has {key} {size[row]:.4g} {_UNITS[key]} at "
                f"{fine[row]:.4g} s; {limit:.4g} are allowed"
            )
    if section.jerk is not None:
        jerk = (
            np.abs(np.diff(motion.at(time - time[0]).acceleration, axis=0)) / np.diff(time)[:, None]
        )
        if jerk.max() > (1.0 + _ROUNDING) * section.jerk:
            row = int(np.argmax(jerk.max(axis=1)))
            raise TrajectoryError(
                f"{section.file}: {section.axes[int(np.argmax(jerk[row]))]} has jerk "
                f"{jerk.max():.4g} m/s^3 at {time[row] - time[0]:.4g} s; {section.jerk:.4g} are "
                "allowed"
            )
