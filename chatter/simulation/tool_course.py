"""Path of the tool along an NC program or recorded set points, with its feeds and spindle speeds.

Coordinates are those of the cut: the tool against the workpiece, as NC programs state it (ISO 841).
The engagement that [cut] states turns with the direction of the feed. Where a block does not cut,
the tool is in the air: in rapid traverse under the delayed chip, which knows no stock to leave,
and in all blocks that are above the lowest height of the program.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.sections.program import Program
from chatter.io.nc_program.program import ProgramBlock, read_program
from chatter.io.set_points import recorded_positions
from chatter.simulation.spindle import ProgrammedSpindle, Spindle
from chatter.simulation.virtual_tests.courses import program_motion
from dynamics.trajectory.block_motion import BlockMotion, PathLimits
from dynamics.trajectory.motion import Trajectory, TrajectoryError
from dynamics.trajectory.recorded import RecordedMotion

_REVOLUTION = 2.0 * math.pi
#: height above the lowest one from which on the tool is in the air, m
_LIFTED = 1e-6
#: speed in the plane, as a share of the largest, below which a feed has no direction of its own
_AT_REST = 1e-6
#: instants at which the direction of the feed is sampled, over all and for a revolution
_SAMPLES, _SAMPLES_A_REVOLUTION = 2000, 72
_MOST_SAMPLES = 400_000


@dataclass(frozen=True, eq=False)
class ToolCourse:
    """What the tool does over time; before its start and behind its end it stands still."""

    trajectory: Trajectory  # of x, y, z, m
    spindle: Spindle | ProgrammedSpindle
    slowest: float  # spindle speed, rad/s
    fastest: float  # spindle speed, rad/s
    feed_per_tooth: float  # largest of all that cuts, m; 0 where nothing does
    in_air: NDArray[np.float64]  # from and to, s, in their order, (n, 2)
    _sampled: tuple[NDArray[np.float64], NDArray[np.float64]]  # times, s, and directions, rad

    @property
    def duration(self) -> float:
        """Time from start to end, s."""
        return self.trajectory.duration

    @property
    def start(self) -> NDArray[np.float64]:
        """Where the tool axis is at time zero, m, (2,)."""
        return self.trajectory.at(np.zeros(1)).position[0, :2]

    def position_at(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Place (2, ...) of the tool axis, m."""
        return np.moveaxis(self.trajectory.at(time).position[..., :2], -1, 0)

    def heading_at(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Direction of the feed from +x towards +y, rad; at rest that of the motion before."""
        times, headings = self._sampled
        sampled = headings[np.clip(np.searchsorted(times, time, "right") - 1, 0, len(times) - 1)]
        velocity = self.trajectory.at(time).velocity[..., :2]
        moving = np.hypot(velocity[..., 0], velocity[..., 1]) > _AT_REST * self._largest
        own = np.arctan2(velocity[..., 1], velocity[..., 0])
        return np.where(moving, own, sampled)

    @property
    def _largest(self) -> float:
        velocity = self.trajectory.at(self._sampled[0]).velocity[:, :2]
        return float(np.hypot(*velocity.T).max())

    def cuts_at(self, time: float) -> bool:
        """Whether the tool is not in the air at a time, s, and just behind it."""
        return not any(begin <= time < end for begin, end in self.in_air)

    def next_change(self, time: float) -> float:
        """Time behind a time at which the tool next enters or leaves the air, s; inf if never."""
        later = self.in_air[self.in_air > time]
        return float(later.min()) if later.size else math.inf

    def fitted(self, case: Case) -> Case:
        """Case whose [cut] has the slowest speed and the largest feed, and its run this length."""
        cut, section = case.cut, case.simulation
        changed = {"spindle_speed": self.slowest}
        if self.feed_per_tooth > 0.0:
            changed["feed_per_tooth"] = self.feed_per_tooth
        if section.duration is None and section.revolutions is None:
            section = section.model_copy(update={"duration": self.duration})
        return case.model_copy(
            update={"cut": cut.model_copy(update=changed), "simulation": section}
        )


def tool_course(case: Case) -> ToolCourse | None:
    """Course of the tool of a case; None where it has no program.

    InputError if the file cannot be read, or the case does not fit a program.
    """
    section = case.simulation.program if case.simulation else None
    if section is None:
        return None
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: a program sets the speed of the spindle"
        )
    if case.simulation.chip != "delay" and case.stock is None:
        raise InputError(
            f"{case.name}: simulation.program: a path of its own needs a [stock] to lead through, "
            'or chip = "delay"'
        )
    try:
        return (_of_program if section.kind == "nc program" else _of_record)(case, section)
    except TrajectoryError as error:
        raise InputError(f"{case.name}: simulation.program: {error}") from error


def _of_program(case: Case, section: Program) -> ToolCourse:
    start = (*section.start, 0.0)[:3]
    program = read_program(section.file, start)
    limits = PathLimits(section.velocity, section.acceleration, section.jerk)
    motion = program_motion(program, limits, section.tolerance)
    blocks = [program.blocks[one.source] for one in motion.blocks]
    speeds = [_spindle_speed(case, section, one) for one in blocks]
    ends = (*motion.begins[1:], motion.duration)
    in_air = _air_of_blocks(case, motion, blocks)
    feeds = [
        min(one.feed, section.velocity) * _REVOLUTION / (case.tool.teeth * speed)
        for one, speed, air in zip(motion.blocks, speeds, in_air, strict=True)
        if not air
    ]
    return ToolCourse(
        motion,
        _spindle(motion.begins, speeds),
        min(speeds),
        max(speeds),
        max(feeds, default=0.0),
        _intervals(motion.begins, ends, in_air),
        _headings(motion, min(speeds)),
    )


def _spindle_speed(case: Case, section: Program, block: ProgramBlock) -> float:
    if block.spindle_speed is None:
        return case.cut.spindle_speed
    if block.spindle_speed == 0.0:
        raise InputError(f"{section.file}: line {block.line}: the tool moves at S0; it has to turn")
    return block.spindle_speed


def _spindle(begins: Sequence[float], speeds: Sequence[float]) -> Spindle | ProgrammedSpindle:
    """Spindle with the speeds of blocks; one that turns evenly where they are all the same."""
    if len(set(speeds)) == 1:
        return Spindle(speeds[0])
    return ProgrammedSpindle(min(speeds), np.array(begins), np.array(speeds))


def _air_of_blocks(case: Case, motion: BlockMotion, blocks: Sequence[ProgramBlock]) -> list[bool]:
    """Whether each block is in the air."""
    heights = [
        one.element.at(np.linspace(0.0, one.element.length, 5)).position[:, 2]
        for one in motion.blocks
    ]
    lowest = min(float(height.min()) for height in heights)
    no_stock = case.simulation.chip == "delay"
    return [
        (no_stock and block.rapid) or float(height.max()) > lowest + _LIFTED
        for block, height in zip(blocks, heights, strict=True)
    ]


def _intervals(
    begins: Sequence[float], ends: Sequence[float], chosen: Sequence[bool]
) -> NDArray[np.float64]:
    """Times (n, 2) from and to of what is chosen, those that follow each other as one."""
    found = []
    for air, group in groupby(zip(begins, ends, chosen, strict=True), key=lambda one: one[2]):
        if air:
            parts = list(group)
            found.append((parts[0][0], parts[-1][1]))
    return np.array(found, dtype=np.float64).reshape(-1, 2)


def _of_record(case: Case, section: Program) -> ToolCourse:
    time, plane = recorded_positions(section.file, ("X", "Y"))
    height = np.zeros((len(time), 1))
    if _has_height(section):
        height = recorded_positions(section.file, ("Z",))[1]
    motion = RecordedMotion(time, np.hstack([plane, height]))
    speed = case.cut.spindle_speed
    lifted = height[:, 0] > height.min() + _LIFTED
    velocity = motion.at(time - time[0]).velocity[~lifted, :2]
    feed = float(np.hypot(*velocity.T).max(initial=0.0))
    times = time - time[0]
    return ToolCourse(
        motion,
        Spindle(speed),
        speed,
        speed,
        feed * _REVOLUTION / (case.tool.teeth * speed),
        _intervals(times[:-1], times[1:], lifted[:-1] | lifted[1:]),
        _headings(motion, speed),
    )


def _has_height(section: Program) -> bool:
    try:
        recorded_positions(section.file, ("Z",))
    except InputError:
        return False
    return True


def _headings(motion: Trajectory, speed: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Instants, s, and the directions of the feed at them, rad; at rest that of the one before."""
    revolutions = motion.duration * speed / _REVOLUTION
    count = int(np.clip(revolutions * _SAMPLES_A_REVOLUTION, _SAMPLES, _MOST_SAMPLES))
    time = np.linspace(0.0, motion.duration, count)
    velocity = motion.at(time).velocity[:, :2]
    size = np.hypot(*velocity.T)
    if not size.max() > 0.0:
        return time, np.zeros(count)
    heading = np.arctan2(velocity[:, 1], velocity[:, 0])
    moving = size > _AT_REST * size.max()
    # the first motion gives the direction before it
    last = np.maximum.accumulate(np.where(moving, np.arange(count), 0))
    last[: int(np.argmax(moving))] = int(np.argmax(moving))
    return time, heading[last]
