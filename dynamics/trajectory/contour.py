"""Errors of a measured motion: across the commanded path, and behind the set point.

The contour error is the distance from the measured position to the nearest place of the path; the
tracking error is the distance to where the axis should be at that time (Altintas 2012,
Manufacturing Automation, chapter 5).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.motion import TrajectoryError
from dynamics.trajectory.path import Path, foot

#: of two distances that count as the same
_SAME = 1e-9


class ContourError(NamedTuple):
    """Against a path, at each measured position, (n,)."""

    error: NDArray[np.float64]  # m; > 0: left of the path, seen in the direction of travel
    length: NDArray[np.float64]  # where on the path the nearest place is, m


def contour_error(path: Path, position: ArrayLike) -> ContourError:
    """Return the signed distance of positions (n, 2), m, to a path.

    Raises
    ------
    TrajectoryError
        If the positions are no finite (n, 2).

    Notes
    -----
    The nearest place of the whole path counts, so that an error must be small against the
    distance of branches that cross or touch. Outside of a sharp corner both its sides are as
    near; the side is decided by the one that the point lies further across of.
    """
    points = np.asarray(position, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise TrajectoryError(f"contour error: positions of shape {points.shape}; finite (n, 2)")
    distance, left = np.full(len(points), np.inf), np.zeros(len(points))
    length = np.zeros(len(points))
    for begin, element in zip(path.breaks[:-1], path.elements, strict=True):
        there = foot(element, points)
        nearer = there.distance < distance * (1.0 - _SAME)
        same = ~nearer & (there.distance <= distance * (1.0 + _SAME))
        taken = nearer | (same & (np.abs(there.left) > np.abs(left)))
        distance = np.where(taken, there.distance, distance)
        left = np.where(taken, there.left, left)
        length = np.where(taken, begin + there.length, length)
    return ContourError(np.copysign(distance, left), length)


def tracking_error(set_position: ArrayLike, position: ArrayLike) -> NDArray[np.float64]:
    """Return set minus measured position of each axis, m; both (n, axes) at the same times.

    Raises
    ------
    TrajectoryError
        If the shapes differ.
    """
    wanted, measured = np.asarray(set_position), np.asarray(position)
    if wanted.shape != measured.shape:
        raise TrajectoryError(
            f"tracking error: set positions of shape {wanted.shape}, measured {measured.shape}"
        )
    return wanted.astype(np.float64) - measured
