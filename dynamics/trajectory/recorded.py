"""Set points as they were recorded, run through again."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.motion import Motion, TrajectoryError

_FEWEST = 4


@dataclass(frozen=True)
class RecordedMotion:
    """Positions at recorded times, with the cubic spline of no velocity at its ends between them.

    TrajectoryError if there are fewer than four, times do not rise, or a number is not finite.
    """

    time: NDArray[np.float64]  # (n,), s
    position: NDArray[np.float64]  # (n, axes), m (rad)
    duration: float = field(init=False)  # s
    _spline: scipy.interpolate.CubicSpline = field(init=False, repr=False)

    def __post_init__(self) -> None:
        time = np.asarray(self.time, dtype=np.float64)
        position = np.asarray(self.position, dtype=np.float64)
        if time.ndim != 1 or position.ndim != 2 or len(time) != len(position):
            raise TrajectoryError(
                f"recorded set points: {time.shape} times for {position.shape} positions"
            )
        if len(time) < _FEWEST:
            raise TrajectoryError(
                f"recorded set points: {len(time)} are there; {_FEWEST} at least are needed"
            )
        if not (np.isfinite(time).all() and np.isfinite(position).all()):
            raise TrajectoryError("recorded set points: a time or a position is not finite")
        falling = np.flatnonzero(np.diff(time) <= 0.0)
        if falling.size:
            raise TrajectoryError(
                f"recorded set points: time does not rise at {time[falling[0]]:g} s"
            )
        time = time - time[0]
        object.__setattr__(self, "duration", float(time[-1]))
        object.__setattr__(
            self, "_spline", scipy.interpolate.CubicSpline(time, position, bc_type="clamped")
        )

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of all axes at times, s."""
        given = np.asarray(time, dtype=np.float64)
        t = np.clip(given, 0.0, self.duration)
        inside = ((given >= 0.0) & (given <= self.duration))[..., None]
        return Motion(
            self._spline(t),
            np.where(inside, self._spline(t, 1), 0.0),
            np.where(inside, self._spline(t, 2), 0.0),
        )
