"""A path at a feed: slowed down for its corners, jerk-limited in between.

On an arc of radius r the speed is constant and no more than the feed, sqrt(a r) and
cbrt(j r^2): centripetal acceleration v^2/r and its turning v^3/r^2 stay within the limits
(Erkorkmaz and Altintas 2001, Int. J. Mach. Tools Manuf. 41:1323). Where curvature jumps between
a line and an arc, the acceleration jumps by v^2/r whatever the speed. On the lines speed changes
by three pieces of constant jerk, and acceleration is zero at their ends. A sharp corner is
reached at rest.
"""

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.jerk_limited import reachable_speed, speed_change, speed_change_length
from dynamics.trajectory.motion import Motion, TrajectoryError, require_positive
from dynamics.trajectory.path import Arc, Line, Path

#: of a turn that counts as none, rad
_STRAIGHT = 1e-7


class Pieces(NamedTuple):
    """Constant jerk along the path: state at the beginning of each piece, (n,)."""

    time: NDArray[np.float64]  # s
    length: NDArray[np.float64]  # m
    speed: NDArray[np.float64]  # m/s
    acceleration: NDArray[np.float64]  # m/s^2
    jerk: NDArray[np.float64]  # m/s^3


@dataclass(frozen=True)
class PathMotion:
    """Motion from rest to rest along a plane path.

    Raises
    ------
    TrajectoryError
        If a limit is not above 0, or the path starts or ends with an arc, or has a sharp corner
        at an arc.
    """

    path: Path  # its first and last element are lines
    feed: float  # m/s
    acceleration: float  # limit of the speed along the path and in the corners, m/s^2
    jerk: float  # limit of the same, m/s^3
    pieces: Pieces = field(init=False, repr=False)
    duration: float = field(init=False)  # s

    def __post_init__(self):
        for key in ("feed", "acceleration", "jerk"):
            require_positive("path motion", key, getattr(self, key))
        if any(isinstance(self.path.elements[i], Arc) for i in (0, -1)):
            raise TrajectoryError(
                "path motion: the path starts or ends with an arc; it needs a line to speed up on"
            )
        pieces, duration = self._planned()
        object.__setattr__(self, "pieces", pieces)
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
        covered = np.where(t >= self.duration, self.path.breaks[-1], p.length[i] + travel)
        return covered, np.where(moving, speed, 0.0), np.where(moving, gain, 0.0)

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of both axes at times, s."""
        covered, speed, gain = self.along(time)
        position, tangent, curvature = self.path.at(covered)
        across = np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)
        turning = (curvature * speed**2)[..., None] * across
        return Motion(position, speed[..., None] * tangent, gain[..., None] * tangent + turning)

    def corner_speed(self, radius: float) -> float:
        """Return the greatest speed on an arc of a radius, m; m/s."""
        return min(
            self.feed, math.sqrt(self.acceleration * radius), (self.jerk * radius**2) ** (1.0 / 3.0)
        )

    def _planned(self) -> tuple[Pieces, float]:
        elements = self.path.elements
        lines = [i for i, element in enumerate(elements) if isinstance(element, Line)]
        speeds = self._speeds_between(lines)
        rows: list[tuple[float, ...]] = []
        t = 0.0
        breaks = self.path.breaks
        for n, i in enumerate(lines):
            t = self._line(rows, t, breaks[i], elements[i].length, speeds[n], speeds[n + 1])
            if n + 1 < len(lines) and lines[n + 1] > i + 1:
                rows.append((t, breaks[i + 1], speeds[n + 1], 0.0, 0.0))
                t += (breaks[lines[n + 1]] - breaks[i + 1]) / speeds[n + 1]
        return Pieces(*np.array(rows).T), t

    def _speeds_between(self, lines: list[int]) -> list[float]:
        """Speeds at the start, between one line and the next, and at the end."""
        elements, a, j = self.path.elements, self.acceleration, self.jerk
        speeds = [0.0, *(self._limit(b, e) for b, e in pairwise(lines)), 0.0]
        lengths = [elements[i].length for i in lines]
        for n, length in enumerate(lengths):
            speeds[n + 1] = min(speeds[n + 1], reachable_speed(speeds[n], length, a, j))
        for n in range(len(lengths) - 1, -1, -1):
            speeds[n] = min(speeds[n], reachable_speed(speeds[n + 1], lengths[n], a, j))
        return speeds

    def _limit(self, line: int, following: int) -> float:
        """Greatest speed between a line and the following one."""
        elements = self.path.elements[line : following + 1]
        sharp = any(_turn(*pair) > _STRAIGHT for pair in pairwise(elements))
        arcs = [element for element in elements[1:-1] if isinstance(element, Arc)]
        if sharp and arcs:
            raise TrajectoryError(f"path motion: sharp corner at an arc behind element {line}")
        if sharp:
            return 0.0
        return min([self.feed, *(self.corner_speed(arc.radius) for arc in arcs)])

    def _line(
        self, rows: list, t: float, begin: float, length: float, first: float, last: float
    ) -> float:
        """Append the pieces of a line; return the time at its end."""
        a, j = self.acceleration, self.jerk

        def needed(peak: float) -> float:
            return speed_change_length(first, peak, a, j) + speed_change_length(peak, last, a, j)

        peak = self.feed
        if needed(peak) > length:
            low = max(first, last)
            peak = (
                low
                if needed(low) >= length
                else scipy.optimize.brentq(
                    lambda v: needed(v) - length, low, peak, xtol=1e-15, rtol=1e-14
                )
            )
        cruise = max(length - needed(peak), 0.0) / peak
        speed, s = first, begin
        for target, before in ((peak, 0.0), (last, cruise)):
            if before > 0.0:
                rows.append((t, s, speed, 0.0, 0.0))
                t, s = t + before, s + before * speed
            ramp, constant = speed_change(target - speed, a, j)
            sign = math.copysign(1.0, target - speed)
            gain = 0.0
            for duration, jerk in ((ramp, sign * j), (constant, 0.0), (ramp, -sign * j)):
                if duration > 0.0:
                    rows.append((t, s, speed, gain, jerk))
                    s += duration * (speed + duration * (gain / 2.0 + duration * jerk / 6.0))
                    speed += duration * (gain + duration * jerk / 2.0)
                    gain += duration * jerk
                    t += duration
            speed = target
        return t


def _turn(one: Line | Arc, two: Line | Arc) -> float:
    """Angle between the end of an element and the start of the next, rad."""
    before, after = one.at(np.array(one.length))[1], two.at(np.array(0.0))[1]
    return math.atan2(abs(before[0] * after[1] - before[1] * after[0]), float(before @ after))
