"""Motion along blocks of a path, each with its own feed: jerk-limited, arcs exact.

The speed changes by three pieces of constant jerk and is reached without acceleration at the end of
a block; blocks ahead are looked at, so that every one can be braked for (forward and backward
pass). Two blocks that go on in one direction are passed without a stop, a corner is a stop. On an
element with the derivatives p'' and p''' over its length the acceleration is T a + p'' v^2 and the
jerk T j + 3 p'' v a + p''' v^3 (Altintas 2012, Manufacturing Automation, chapter 5): speed,
tangential acceleration and tangential jerk of an arc get such shares of the limits that the vectors
stay within them. Where the curvature jumps, between a line and an arc, the acceleration jumps by
v^2 / r whatever the speed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.jerk_limited import reachable_speed, speed_change, speed_change_length
from dynamics.trajectory.motion import Motion, TrajectoryError, require_positive
from dynamics.trajectory.path_motion import Pieces
from dynamics.trajectory.spatial_path import (
    PathElement,
    SpatialArc,
    SpatialLine,
    SpatialPath,
    angle_between,
    rounding_arc,
)
from dynamics.trajectory.transition import Clothoid, eased_arc

#: change of direction that counts as none, rad
_STRAIGHT = 1e-6


@dataclass(frozen=True)
class Block:
    """An element of a path, and how it is run through."""

    element: PathElement
    feed: float  # m/s; infinite for as fast as the limits let it
    stops: bool = False  # at its end
    dwell: float = 0.0  # at rest behind its end, s
    source: int = 0  # number of what it was made of, which a rounding keeps


@dataclass(frozen=True)
class PathLimits:
    """Limits of the vectors along a path."""

    velocity: float  # m/s
    acceleration: float  # m/s^2
    jerk: float  # m/s^3

    def __post_init__(self) -> None:
        for key in ("velocity", "acceleration", "jerk"):
            require_positive("motion of blocks", key, getattr(self, key))

    def on(self, block: Block) -> PathLimits:
        """Limits of speed, tangential acceleration and tangential jerk on a block."""
        element = block.element
        speed = min(self.velocity, block.feed)
        if element.bend == 0.0:
            return PathLimits(speed, self.acceleration, self.jerk)
        if isinstance(element, Clothoid):
            return self._on_transition(element, speed)
        across = self.acceleration / math.sqrt(2.0)
        speed = min(
            speed,
            math.sqrt(across / element.bend),
            (0.25 * self.jerk / element.twist) ** (1.0 / 3.0),
        )
        # (j/4 + j/4)^2 + (3 p'' v a)^2 <= j^2
        along = min(across, math.sqrt(3.0) * self.jerk / (6.0 * element.bend * speed))
        return PathLimits(speed, along, 0.25 * self.jerk)

    def _on_transition(self, element: Clothoid, speed: float) -> PathLimits:
        """Limits on a transition, which is so short that nearly all of the jerk may turn it.

        (0.8 j + 0.1 j)^2 + (3 p'' v a)^2 <= j^2
        """
        speed = min(
            speed,
            math.sqrt(0.9 * self.acceleration / element.bend),
            (0.8 * self.jerk / element.twist) ** (1.0 / 3.0),
        )
        left = math.sqrt(1.0 - 0.9**2)
        along = min(left * self.acceleration, left * self.jerk / (3.0 * element.bend * speed))
        return PathLimits(speed, along, 0.1 * self.jerk)


def eased(blocks: Sequence[Block], tolerance: float) -> list[Block]:
    """Blocks with transitions between lines and their tangent arcs within a tolerance, m.

    The acceleration then does not jump there. Arcs without two tangent lines, of more than 160
    degrees, helices, and arcs too short for transitions stay as they are.
    """
    require_positive("motion of blocks", "tolerance", tolerance)
    found = list(blocks)
    for number in range(len(found) - 2, 0, -1):
        before, block, after = found[number - 1 : number + 2]
        arc = block.element
        if not isinstance(arc, SpatialArc) or not passed(before, block) or not passed(block, after):
            continue
        one, two = before.element, after.element
        if not (isinstance(one, SpatialLine) and isinstance(two, SpatialLine)):
            continue
        made = eased_arc(one, arc, two, tolerance)
        if made is None:
            continue
        ends = _start(made.into), _end(made.out)
        found[number - 1 : number + 2] = [
            replace(before, element=SpatialLine(one.start, ends[0])),
            replace(block, element=made.into),
            replace(block, element=made.arc),
            replace(block, element=made.out),
            replace(after, element=SpatialLine(ends[1], two.end)),
        ]
    return found


def passed(one: Block, two: Block) -> bool:
    """Whether two blocks go on in one direction without a stop."""
    stop = one.stops or one.dwell > 0.0
    return not stop and angle_between(one.element, two.element) <= _STRAIGHT


def rounded(blocks: Sequence[Block], tolerance: float, limits: PathLimits) -> list[Block]:
    """Blocks with the corners of lines rounded by arcs within a tolerance, m, where that is faster.

    A corner stays where a block stops, and where the arc would be so narrow that a stop is quicker.
    """
    require_positive("motion of blocks", "tolerance", tolerance)
    arcs = [_worth_rounding(one, two, tolerance, limits) for one, two in pairwise(blocks)]
    found = []
    for number, block in enumerate(blocks):
        element = block.element
        if isinstance(element, SpatialLine):
            before = arcs[number - 1] if number else None
            after = arcs[number] if number < len(arcs) else None
            start = element.start if before is None else _end(before)
            end = element.end if after is None else _start(after)
            if math.dist(start, end) > 1e-9 * element.length:
                element = SpatialLine(start, end)
                found.append(replace(block, element=element))
        else:
            found.append(block)
        if number < len(arcs) and arcs[number] is not None:
            following = blocks[number + 1]
            feed = min(block.feed, following.feed)
            found.append(Block(arcs[number], feed, source=following.source))
    return found


def _worth_rounding(
    before: Block, after: Block, tolerance: float, limits: PathLimits
) -> SpatialArc | None:
    """Arc over the corner between two blocks, where it is faster than a stop."""
    one, two = before.element, after.element
    lines = isinstance(one, SpatialLine) and isinstance(two, SpatialLine)
    if before.stops or before.dwell > 0.0 or not lines:
        return None
    arc = rounding_arc(one, two, tolerance)
    if arc is None:
        return None
    feed = min(before.feed, after.feed, limits.velocity)
    slow = limits.on(Block(arc, feed)).velocity
    a, j = limits.acceleration, limits.jerk

    def braking(last: float) -> tuple[float, float]:
        ramp, constant = speed_change(feed - last, a, j)
        return 2.0 * ramp + constant, speed_change_length(feed, last, a, j)

    (stop_time, stop_way), (slow_time, slow_way) = braking(0.0), braking(slow)
    saved_way = 2.0 * (stop_way - slow_way) - arc.length
    return arc if 2.0 * slow_time + arc.length / slow + saved_way / feed < 2.0 * stop_time else None


def _start(element: PathElement) -> tuple[float, float, float]:
    return tuple(element.at(np.array(0.0)).position.tolist())


def _end(element: PathElement) -> tuple[float, float, float]:
    return tuple(element.at(np.array(element.length)).position.tolist())


@dataclass(frozen=True)
class BlockMotion:
    """Motion from rest to rest along blocks, in three coordinates.

    TrajectoryError if there is no block or blocks do not join.
    """

    blocks: tuple[Block, ...]
    limits: PathLimits
    path: SpatialPath = field(init=False, repr=False)
    pieces: Pieces = field(init=False, repr=False)
    duration: float = field(init=False)  # s
    begins: tuple[float, ...] = field(init=False, repr=False)  # time of every block, s

    def __post_init__(self) -> None:
        object.__setattr__(self, "blocks", tuple(self.blocks))
        if not self.blocks:
            raise TrajectoryError("motion of blocks: nothing moves")
        object.__setattr__(self, "path", SpatialPath(tuple(one.element for one in self.blocks)))
        pieces, begins, duration = self._planned()
        object.__setattr__(self, "pieces", pieces)
        object.__setattr__(self, "begins", begins)
        object.__setattr__(self, "duration", duration)

    def along(self, time: ArrayLike) -> tuple[NDArray, NDArray, NDArray]:
        """Return length covered, m, speed, m/s, and tangential acceleration at times, s."""
        t = np.asarray(time, dtype=np.float64)
        p = self.pieces
        i = np.clip(np.searchsorted(p.time, t, "right") - 1, 0, len(p.time) - 1)
        d = np.clip(t, 0.0, self.duration) - p.time[i]
        gain = p.acceleration[i] + p.jerk[i] * d
        speed = p.speed[i] + d * (p.acceleration[i] + d * p.jerk[i] / 2.0)
        travel = d * (p.speed[i] + d * (p.acceleration[i] / 2.0 + d * p.jerk[i] / 6.0))
        moving = (t > 0.0) & (t < self.duration)
        covered = np.where(t >= self.duration, self.path.length, p.length[i] + travel)
        return covered, np.where(moving, speed, 0.0), np.where(moving, gain, 0.0)

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of the coordinates at times, s."""
        covered, speed, gain = self.along(time)
        place = self.path.at(covered)
        return Motion(
            place.position,
            speed[..., None] * place.tangent,
            gain[..., None] * place.tangent + (speed**2)[..., None] * place.bend,
        )

    def _planned(self) -> tuple[Pieces, tuple[float, ...], float]:
        limits = [self.limits.on(block) for block in self.blocks]
        speeds = self._speeds_between(limits)
        rows: list[tuple[float, ...]] = []
        begins, t = [], 0.0
        for number, block in enumerate(self.blocks):
            begins.append(t)
            begin = float(self.path.breaks[number])
            ends = (speeds[number], speeds[number + 1])
            t = _pieces(rows, t, begin, block.element.length, ends, limits[number])
            if block.dwell > 0.0:
                rows.append((t, begin + block.element.length, 0.0, 0.0, 0.0))
                t += block.dwell
        return Pieces(*np.array(rows).T), tuple(begins), t

    def _speeds_between(self, limits: Sequence[PathLimits]) -> list[float]:
        """Speeds at the start, between blocks, and at the end."""
        speeds = [0.0]
        for number, (one, two) in enumerate(pairwise(self.blocks)):
            both = (limits[number].velocity, limits[number + 1].velocity)
            speeds.append(min(both) if passed(one, two) else 0.0)
        speeds.append(0.0)
        lengths = [block.element.length for block in self.blocks]
        for n, (length, limit) in enumerate(zip(lengths, limits, strict=True)):
            reached = reachable_speed(speeds[n], length, limit.acceleration, limit.jerk)
            speeds[n + 1] = min(speeds[n + 1], reached)
        for n in range(len(lengths) - 1, -1, -1):
            limit = limits[n]
            reached = reachable_speed(speeds[n + 1], lengths[n], limit.acceleration, limit.jerk)
            speeds[n] = min(speeds[n], reached)
        return speeds


def _pieces(
    rows: list[tuple[float, ...]],
    t: float,
    begin: float,
    length: float,
    ends: tuple[float, float],
    limit: PathLimits,
) -> float:
    """Append the pieces of a block from one speed to another; return the time at its end."""
    first, last = ends
    a, j = limit.acceleration, limit.jerk

    def needed(peak: float) -> float:
        return speed_change_length(first, peak, a, j) + speed_change_length(peak, last, a, j)

    peak, low = limit.velocity, max(first, last)
    if needed(peak) > length:
        peak = low
        if needed(low) < length:
            peak = scipy.optimize.brentq(
                lambda v: needed(v) - length, low, limit.velocity, xtol=1e-15, rtol=1e-14
            )
    cruise = max(length - needed(peak), 0.0) / peak
    speed, s = first, begin
    for target, before in ((peak, 0.0), (last, cruise)):
        if before > 0.0:
            rows.append((t, s, speed, 0.0, 0.0))
            t, s = t + before, s + before * speed
        ramp, constant = speed_change(target - speed, a, j)
        sign, gain = math.copysign(1.0, target - speed), 0.0
        for duration, jerk in ((ramp, sign * j), (constant, 0.0), (ramp, -sign * j)):
            if duration > 0.0:
                rows.append((t, s, speed, gain, jerk))
                s += duration * (speed + duration * (gain / 2.0 + duration * jerk / 6.0))
                speed += duration * (gain + duration * jerk / 2.0)
                gain += duration * jerk
                t += duration
        speed = target
    return t
