"""What every trajectory answers: how long it lasts, and where its axes are at any time."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


class TrajectoryError(ValueError):
    """A trajectory that makes no sense; the message names what and the value given."""


class Motion(NamedTuple):
    """Axes at some times; each (..., axes), times first."""

    position: NDArray[np.float64]  # m (rad)
    velocity: NDArray[np.float64]  # m/s
    acceleration: NDArray[np.float64]  # m/s^2


class Trajectory(Protocol):
    """A commanded motion; before its start and behind its end it stands still."""

    @property
    def duration(self) -> float:
        """From start to end, s."""

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of all axes at times, s."""


def require_positive(part: str, key: str, value: float) -> None:
    """Raise TrajectoryError unless value is a finite number above zero."""
    if not (math.isfinite(value) and value > 0.0):
        raise TrajectoryError(f"{part}: {key} is {value}; a finite number above 0 is needed")


def axes_vector(
    part: str,
    key: str,
    value: float | Sequence[float] | NDArray[np.float64],
    axes: int | None = None,
) -> NDArray[np.float64]:
    """Return a finite vector over axes as an array, or raise TrajectoryError."""
    vector = np.atleast_1d(np.asarray(value, dtype=np.float64))
    if vector.ndim != 1 or vector.size == 0 or not np.isfinite(vector).all():
        raise TrajectoryError(f"{part}: {key} is {value}; one finite number for each axis")
    if axes is not None and vector.size != axes:
        raise TrajectoryError(f"{part}: {key} has {vector.size} axes; {axes} are needed")
    return vector


def along(
    start: NDArray[np.float64],
    direction: NDArray[np.float64],
    covered: NDArray[np.float64],
    speed: NDArray[np.float64],
    gain: NDArray[np.float64],
) -> Motion:
    """Return the motion on a straight line by the length covered, m, and its derivatives."""
    return Motion(
        start + covered[..., None] * direction,
        speed[..., None] * direction,
        gain[..., None] * direction,
    )


@dataclass(frozen=True)
class SomeCoordinates:
    """Some coordinates of a trajectory, in another order."""

    trajectory: Trajectory
    coordinates: tuple[int, ...]

    @property
    def duration(self) -> float:
        """From start to end, s."""
        return self.trajectory.duration

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of the coordinates at times, s."""
        return Motion(*(part[..., list(self.coordinates)] for part in self.trajectory.at(time)))
