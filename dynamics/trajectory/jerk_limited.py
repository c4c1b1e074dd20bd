"""Time-optimal motion under constant limits of velocity, acceleration and jerk.

A change of speed has three pieces (jerk, none, -jerk); a move from rest to rest is a speed-up,
cruising, and the speed-up backwards in time: seven pieces, some of which vanish for short moves
(Biagiotti and Melchiorri 2008, Trajectory Planning for Automatic Machines and Robots, section
3.4; Lambrechts, Boerlage and Steinbuch 2005, Control Engineering Practice 13:145).
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.motion import Motion, along, axes_vector, require_positive


def speed_change(change: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """Return the duration of each jerk piece and that of constant acceleration, s.

    Change of speed, m/s, of any sign; limits in m/s^2 and m/s^3.
    """
    change = abs(change)
    if change * jerk <= acceleration**2:
        return math.sqrt(change / jerk), 0.0
    return acceleration / jerk, change / acceleration - acceleration / jerk


def speed_change_length(first: float, last: float, acceleration: float, jerk: float) -> float:
    """Return the length covered by a change of speed, m; its mean speed is the arithmetic mean."""
    ramp, constant = speed_change(last - first, acceleration, jerk)
    return 0.5 * (first + last) * (2.0 * ramp + constant)


def reachable_speed(first: float, length: float, acceleration: float, jerk: float) -> float:
    """Return the greatest speed, m/s, that can be reached from a speed within a length, m.

    Notes
    -----
    Without constant acceleration the change q^2 solves q^3 + 2 v q = L sqrt(j), which has one
    real root (hyperbolic form of Cardano's); else (2v + d)(d/a + a/j) = 2L is quadratic in d.
    """
    ramped = acceleration**2 / jerk
    if speed_change_length(first, first + ramped, acceleration, jerk) >= length:
        right = length * math.sqrt(jerk)
        size = math.sqrt(2.0 * first / 3.0)
        if size**3 <= 1e-30 * right:  # from rest, as far as rounding goes
            return first + right ** (2.0 / 3.0)
        root = 2.0 * size * math.sinh(math.asinh(0.5 * right / size**3) / 3.0)
        return first + root**2
    # d^2 + (2v + a^2/j) d + 2 v a^2/j - 2 a L = 0
    half = first + 0.5 * ramped
    return first - half + math.sqrt(half**2 + 2.0 * acceleration * length - 2.0 * first * ramped)


@dataclass(frozen=True)
class JerkLimitedMove:
    """Straight move from rest to rest in the least time under limits along the line.

    Parameters
    ----------
    start, end : (axes,) array_like of float
        m (rad).
    velocity, acceleration, jerk : float
        Limits, m/s, m/s^2, m/s^3.

    Raises
    ------
    TrajectoryError
        If a limit is not above 0, or start and end differ in their number of axes.
    """

    start: ArrayLike
    end: ArrayLike
    velocity: float
    acceleration: float
    jerk: float
    durations: tuple[float, ...] = field(init=False)  # of the seven pieces, s

    def __post_init__(self):
        for key in ("velocity", "acceleration", "jerk"):
            require_positive("jerk-limited move", key, getattr(self, key))
        first = axes_vector("jerk-limited move", "start", self.start)
        axes_vector("jerk-limited move", "end", self.end, first.size)
        length, a, j = self.length, self.acceleration, self.jerk
        if length == 0.0:
            ramp = constant = cruise = 0.0
        else:
            full = 2.0 * speed_change_length(0.0, self.velocity, a, j)
            ramp, constant = speed_change(self.velocity, a, j)
            cruise = (length - full) / self.velocity
            if cruise < 0.0:
                ramp, constant = _half_way(length, a, j)
                cruise = 0.0
        pieces = (ramp, constant, ramp, cruise, ramp, constant, ramp)
        object.__setattr__(self, "durations", pieces)

    @property
    def length(self) -> float:
        """Of the line, m."""
        return float(np.linalg.norm(np.subtract(np.atleast_1d(self.end), self.start)))

    @property
    def duration(self) -> float:
        """Of the move, s."""
        ramp, constant, _, cruise = self.durations[:4]
        return 4.0 * ramp + 2.0 * constant + cruise

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of all axes at times, s."""
        first = np.atleast_1d(np.asarray(self.start, dtype=np.float64))
        last = np.atleast_1d(np.asarray(self.end, dtype=np.float64))
        direction = (last - first) / self.length if self.length else np.zeros_like(first)
        t = np.clip(np.asarray(time, dtype=np.float64), 0.0, self.duration)
        backwards = t > 0.5 * self.duration
        covered, speed, gain = self._speed_up(np.where(backwards, self.duration - t, t))
        ahead = along(first, direction, covered, speed, gain)
        back = along(last, -direction, covered, -speed, gain)
        # the second half is the first one backwards, so that the end is met exactly
        later = backwards[..., None]
        return Motion(*(np.where(later, b, a) for a, b in zip(ahead, back, strict=True)))

    def _speed_up(self, t: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Length, speed and acceleration in the first half."""
        ramp, constant = self.durations[:2]
        jerk, a = self.jerk, self.jerk * ramp
        rising = np.minimum(t, ramp)
        steady = np.clip(t - ramp, 0.0, constant)
        falling = np.clip(t - ramp - constant, 0.0, ramp)
        cruising = np.maximum(t - 2.0 * ramp - constant, 0.0)
        v1 = jerk * rising**2 / 2.0
        v2 = v1 + a * steady
        v3 = v2 + a * falling - jerk * falling**2 / 2.0
        covered = (
            jerk * rising**3 / 6.0
            + v1 * steady
            + a * steady**2 / 2.0
            + v2 * falling
            + a * falling**2 / 2.0
            - jerk * falling**3 / 6.0
            + v3 * cruising
        )
        return covered, v3, jerk * (rising - falling)


def _half_way(length: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """Jerk and constant-acceleration durations of a move that does not reach its velocity, s."""
    ramp = (0.5 * length / jerk) ** (1.0 / 3.0)
    longest = acceleration / jerk
    if ramp <= longest:
        return ramp, 0.0
    # L = a (ramp + constant)(2 ramp + constant) with ramp = a/j
    constant = -1.5 * longest + math.sqrt(0.25 * longest**2 + length / acceleration)
    return longest, max(constant, 0.0)
