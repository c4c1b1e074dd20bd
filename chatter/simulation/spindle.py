"""Rotation of the spindle and path of the tool over the steps of a run."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.engine.cut import PrescribedPath, PrescribedSpindle

_REVOLUTION = 2.0 * math.pi
#: speeds whose times are kept: those of the runs of a measurement
_KEPT = 32
#: bin of the spindle, fraction of it, and bins from each to the next
Bins = tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]


@dataclass(frozen=True)
class Spindle:
    """Prescribed rotation: a mean speed, and a variation around it where there is one."""

    speed: float  # mean, rad/s
    amplitude: float = 0.0  # share of the mean by which the speed varies; 0 for none
    frequency: float = 1.0  # of the variation, Hz
    shape: str = "sine"  # ``"sine"`` or ``"triangle"``

    @property
    def has_constant_speed(self) -> bool:
        """Whether its speed is the same all along."""
        return self.amplitude == 0.0

    def speed_at(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Speed, rad/s."""
        if self.amplitude == 0.0:
            return np.full(np.shape(time), self.speed)
        cycle = np.mod(self.frequency * np.asarray(time), 1.0)
        if self.shape == "triangle":
            wave = 1.0 - np.abs(np.mod(4.0 * cycle + 1.0, 4.0) - 2.0)
        else:
            wave = np.sin(_REVOLUTION * cycle)
        return self.speed * (1.0 + self.amplitude * wave)

    def angle_at(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angle turned since time zero, rad."""
        time = np.asarray(time)
        cycle = np.mod(self.frequency * time, 1.0)
        if self.shape == "triangle":
            swing = _triangle_integral(cycle)
        else:
            swing = (1.0 - np.cos(_REVOLUTION * cycle)) / _REVOLUTION
        return self.speed * (time + self.amplitude / self.frequency * swing)


def _triangle_integral(cycle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integral over a cycle of the triangle 0, 1, 0, -1, 0 from its start."""
    rising = 2.0 * cycle**2
    falling = 0.25 - 2.0 * (cycle - 0.5) ** 2
    last = 2.0 * (1.0 - cycle) ** 2
    return np.where(cycle < 0.25, rising, np.where(cycle < 0.75, falling, last))


@dataclass(frozen=True, eq=False)
class ProgrammedSpindle:
    """Rotation whose speed changes at times of a program, at once."""

    speed: float  # that steps are counted by, rad/s
    begins: NDArray[np.float64]  # from when on a speed holds, s, the first at 0, (n,)
    speeds: NDArray[np.float64]  # rad/s, (n,)
    amplitude: float = 0.0  # it changes from block to block alone
    frequency: float = 1.0  # of no meaning then

    @property
    def has_constant_speed(self) -> bool:
        """Whether its speed is the same all along."""
        return False

    def _part(self, time: NDArray[np.float64]) -> NDArray[np.int64]:
        return np.clip(np.searchsorted(self.begins, time, side="right") - 1, 0, None)

    def speed_at(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Speed, rad/s."""
        return self.speeds[self._part(time)]

    def angle_at(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angle turned since time zero, rad."""
        time = np.asarray(time, dtype=np.float64)
        turned = np.concatenate([[0.0], np.cumsum(self.speeds[:-1] * np.diff(self.begins))])
        part = self._part(time)
        return turned[part] + self.speeds[part] * (time - self.begins[part])


@dataclass(frozen=True)
class ToolPath:
    """Straight lines from corner to corner, run through at a constant feed."""

    #: (c, 2), m; the tool starts at the first, and runs on beyond the last
    corners: NDArray[np.float64]
    feed: float  # m/s

    @property
    def start(self) -> NDArray[np.float64]:
        """Where the tool axis is at time zero, m, (2,)."""
        return self.corners[0]

    def position_at(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Place (2, ...) of the tool axis, m; before time zero it came straight to the first."""
        travel = self.feed * np.asarray(time)
        legs = np.diff(self.corners, axis=0)
        length = np.hypot(*legs.T)
        if len(legs) == 1:
            heading = legs[0] / length[0]
            return np.stack([self.corners[0, axis] + travel * heading[axis] for axis in range(2)])
        start = np.concatenate([[0.0], np.cumsum(length)[:-1]])
        leg = np.clip(np.searchsorted(start, travel, side="right") - 1, 0, len(legs) - 1)
        along = (travel - start[leg]) / length[leg]
        return (self.corners[leg] + along[..., None] * legs[leg]).T


def spindle_of(case: Case) -> Spindle:
    """Spindle that a case describes."""
    variation = case.cut.speed_variation
    if variation is None:
        return Spindle(case.cut.spindle_speed)
    return Spindle(
        case.cut.spindle_speed, variation.amplitude, variation.frequency, variation.shape
    )


def path_of(case: Case) -> ToolPath:
    """Path that a case describes: along x where it gives none."""
    cut = case.cut
    feed = cut.feed_per_tooth * case.tool.teeth * cut.spindle_speed / _REVOLUTION
    given = case.simulation.path if case.simulation else None
    corners = np.array(given if given else [(0.0, 0.0), (1.0, 0.0)], dtype=np.float64)
    return ToolPath(corners, feed)


def counted_bins(number: NDArray[np.int64], bins: int) -> Bins:
    """Bins at steps that each turn the spindle by one of them.

    They are counted, so that the last bit of an angle never moves a bin.
    """
    return number % bins, np.zeros(number.size), np.ones(number.size - 1)


def bins_at(spindle: Spindle, time: NDArray[np.float64], bins: int) -> Bins:
    """Bins at any times, s."""
    position = spindle.angle_at(time) * (bins / _REVOLUTION)
    floor = np.floor(position)
    return floor.astype(np.int64) % bins, position - floor, np.diff(position)


def prescribed_spindle(
    spindle: Spindle, time: NDArray[np.float64], at: Bins, bins: int
) -> PrescribedSpindle:
    """Rotation of the spindle at the ends of steps, with their times, s, and bins."""
    whole, part, advance = at
    angle = (whole + part) * (_REVOLUTION / bins)
    return PrescribedSpindle(
        whole, part, np.sin(angle), np.cos(angle), advance, spindle.speed_at(time)
    )


def counted_spindle(
    spindle: Spindle, time: NDArray[np.float64], number: NDArray[np.int64], bins: int
) -> PrescribedSpindle:
    """Rotation of the spindle at steps, by their numbers, that each turn it by one bin."""
    whole, part, advance = counted_bins(number, bins)
    angle = np.arange(bins) * (_REVOLUTION / bins)
    return PrescribedSpindle(
        whole, part, np.sin(angle)[whole], np.cos(angle)[whole], advance, spindle.speed_at(time)
    )


def prescribed_path(
    path: ToolPath, time: NDArray[np.float64], share: NDArray[np.float64] | None = None
) -> PrescribedPath:
    """Path of the tool at times, s, and share of the force ramp, which is 1 by default."""
    x, y = path.position_at(time)
    return PrescribedPath(
        np.ascontiguousarray(x),
        np.ascontiguousarray(y),
        np.ones(time.size) if share is None else share,
    )


def path_of_last_revolution(spindle: Spindle, path: ToolPath, bins: int) -> NDArray[np.float64]:
    """Place (2, bins + 1) of the tool axis at every bin of the revolution before the start."""
    return path.position_at(_revolution_before(float(spindle.speed_at(np.zeros(1))[0]), bins))


@lru_cache(_KEPT)
def _revolution_before(speed: float, bins: int) -> NDArray[np.float64]:
    """Times (bins + 1,), s, of the bins of the revolution before the start, at a speed in rad/s."""
    behind = np.arange(bins, -1, -1)
    return -behind * _REVOLUTION / bins / speed
