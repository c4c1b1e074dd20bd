"""Sine, circle and constant speed: the motions of drive tests."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.motion import Motion, TrajectoryError, along, axes_vector, require_positive


def _standing_outside(motion: Motion, t: NDArray[np.float64], duration: float) -> Motion:
    """Without velocity and acceleration before the start and behind the end."""
    inside = ((t >= 0.0) & (t <= duration))[..., None]
    return Motion(
        motion.position,
        np.where(inside, motion.velocity, 0.0),
        np.where(inside, motion.acceleration, 0.0),
    )


@dataclass(frozen=True)
class ConstantSpeedMove:
    """Straight move at constant speed; velocity jumps at both ends.

    Raises
    ------
    TrajectoryError
        If the speed is not above 0 or start and end do not make a line.
    """

    start: ArrayLike  # (axes,), m (rad); they differ
    end: ArrayLike  # (axes,), m (rad); they differ
    speed: float  # m/s

    def __post_init__(self):
        require_positive("constant-speed move", "speed", self.speed)
        first = axes_vector("constant-speed move", "start", self.start)
        last = axes_vector("constant-speed move", "end", self.end, first.size)
        require_positive("constant-speed move", "length", float(np.linalg.norm(last - first)))

    @property
    def duration(self) -> float:
        """From start to end, s."""
        return float(np.linalg.norm(np.subtract(self.end, self.start))) / self.speed

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of all axes at times, s."""
        first, last = np.atleast_1d(self.start), np.atleast_1d(self.end)
        length = np.linalg.norm(last - first)
        time = np.asarray(time, dtype=np.float64)
        covered = np.clip(time, 0.0, self.duration) / self.duration * length
        speed = np.full_like(covered, self.speed)
        moved = along(first, (last - first) / length, covered, speed, np.zeros_like(covered))
        return _standing_outside(moved, time, self.duration)


@dataclass(frozen=True)
class SineMotion:
    """x = centre + amplitude sin(2 pi f t + phase) in each axis.

    Raises
    ------
    TrajectoryError
        If frequency or periods are not above 0, or the axes differ in number.
    """

    centre: ArrayLike  # (axes,), m (rad)
    amplitude: ArrayLike  # (axes,), m (rad)
    frequency: float  # Hz
    periods: float  # how many
    phase: float = 0.0  # rad; pi/2 starts at the amplitude, without velocity

    def __post_init__(self):
        require_positive("sine", "frequency", self.frequency)
        require_positive("sine", "periods", self.periods)
        axes = axes_vector("sine", "centre", self.centre).size
        axes_vector("sine", "amplitude", self.amplitude, axes)
        if not math.isfinite(self.phase):
            raise TrajectoryError(f"sine: phase is {self.phase}; a finite angle, rad, is needed")

    @property
    def duration(self) -> float:
        """From start to end, s."""
        return self.periods / self.frequency

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of all axes at times, s."""
        w = 2.0 * np.pi * self.frequency
        time = np.asarray(time, dtype=np.float64)
        angle = w * np.clip(time, 0.0, self.duration)[..., None] + self.phase
        amplitude = np.atleast_1d(np.asarray(self.amplitude, dtype=np.float64))
        sine = amplitude * np.sin(angle)
        moved = Motion(
            np.atleast_1d(self.centre) + sine, w * amplitude * np.cos(angle), -(w**2) * sine
        )
        return _standing_outside(moved, time, self.duration)


@dataclass(frozen=True)
class CircleMotion:
    """Circle at constant feed, as in a circular test (ISO 230-4).

    Raises
    ------
    TrajectoryError
        If radius or feed are not above 0, or revolutions is 0.
    """

    centre: ArrayLike  # (2,), m
    radius: float  # m
    feed: float  # along the circle, m/s
    revolutions: float = 1.0  # how many; negative: clockwise
    start_angle: float = 0.0  # rad from the first axis

    def __post_init__(self):
        axes_vector("circle", "centre", self.centre, 2)
        require_positive("circle", "radius", self.radius)
        require_positive("circle", "feed", self.feed)
        require_positive("circle", "number of revolutions", abs(self.revolutions))
        if not math.isfinite(self.start_angle):
            raise TrajectoryError(f"circle: start angle is {self.start_angle}; a finite angle, rad")

    @property
    def duration(self) -> float:
        """From start to end, s."""
        return 2.0 * math.pi * abs(self.revolutions) * self.radius / self.feed

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of both axes at times, s."""
        w = math.copysign(self.feed / self.radius, self.revolutions)
        time = np.asarray(time, dtype=np.float64)
        angle = self.start_angle + w * np.clip(time, 0.0, self.duration)
        outward = self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        around = self.radius * np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
        moved = Motion(np.asarray(self.centre) + outward, w * around, -(w**2) * outward)
        return _standing_outside(moved, time, self.duration)
