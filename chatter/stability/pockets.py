"""Pockets of a stability diagram: speeds at which a deep cut is stable, with a margin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: part of the critical depth that is kept in hand
DEPTH_MARGIN = 0.15
#: spindle speed and natural frequency may be off by this much
SPEED_MARGIN = 0.015


class Pocket(NamedTuple):
    """A index worth using.

    The depth is the lowest limit within the speed margin on either side, less the depth margin.
    """

    spindle_speed: float  # rad/s
    axial_depth: float  # m
    critical_depth: float  # m, at the speed itself
    removal_rate: float  # m^3/s


def find_pockets(
    speeds: NDArray[np.float64],
    limits: NDArray[np.float64],
    max_depth: float,
    removal_rate_per_depth_and_speed: float,
    most: int = 5,
) -> tuple[Pocket, ...]:
    """Find the pockets with the highest removal rate.

    Parameters
    ----------
    speeds : (n,) array of float
        rad/s, ascending.
    limits : (n,) array of float
        Critical depth, m; inf where none was found.
    max_depth : float
        Depth to which was searched, m; no pocket is deeper.
    removal_rate_per_depth_and_speed : float
        Removal rate over depth and speed, m^2 (radial depth, teeth and feed per tooth in it).
    most : int
        Pockets returned at most.

    Returns
    -------
    tuple of Pocket
        Highest removal rate first.
    """
    bounded = np.minimum(limits, max_depth)
    robust = np.array(
        [
            bounded[np.abs(speeds / speed - 1.0) <= SPEED_MARGIN * (1.0 + 1e-9)].min()
            for speed in speeds
        ]
    )
    indices = _local_maxima(robust)
    pockets = [
        Pocket(
            float(speeds[i]),
            float((1.0 - DEPTH_MARGIN) * robust[i]),
            float(limits[i]),
            float((1.0 - DEPTH_MARGIN) * robust[i] * speeds[i] * removal_rate_per_depth_and_speed),
        )
        for i in indices
    ]
    return tuple(sorted(pockets, key=lambda pocket: -pocket.removal_rate)[:most])


def _local_maxima(values: NDArray[np.float64]) -> list[int]:
    """Middle of every plateau that is higher than what surrounds it.

    At an end of the range a lone point does not count: what lies beyond is not known.
    """
    indices = []
    first = 0
    for i in range(1, len(values) + 1):
        if i < len(values) and np.isclose(values[i], values[first], rtol=1e-9, atol=0.0):
            continue
        is_plateau = i - first > 1
        rises = values[first - 1] < values[first] if first > 0 else is_plateau
        falls = values[i] < values[first] if i < len(values) else is_plateau
        if rises and falls:
            indices.append((first + i - 1) // 2)
        first = i
    return indices
