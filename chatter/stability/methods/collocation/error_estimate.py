"""Error of limits, estimated at some of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.stability.methods.collocation.cut_arrays import CutArrays
from chatter.stability.methods.collocation.multipliers import rates

_ALLOWANCE = 1.1


class CheckedLimits(NamedTuple):
    """Limits at which the error is estimated."""

    speed: NDArray[np.float64]  # rad/s (n,)
    depth: NDArray[np.float64]  # m (n,)
    slope: NDArray[np.float64]  # of growth for each tool period over depth, 1/m (n,)

    def largest_error(self, growth_left: NDArray[np.float64]) -> float:
        """Relative to the depth, of growth (n,) where there should be none."""
        if self.depth.size == 0:
            return 0.0
        return float(_ALLOWANCE * np.max(np.abs(growth_left) / (self.slope * self.depth)))


def checked_limits(
    cut: CutArrays, speeds: NDArray[np.float64], limits: NDArray[np.float64], most: int
) -> CheckedLimits:
    """Take some of the limits, and how fast growth changes with depth there.

    Parameters
    ----------
    cut : CutArrays
    speeds, limits : (n,) array of float
        rad/s; m, inf where there is none.
    most : int
        That are taken.
    """
    picked = np.flatnonzero(np.isfinite(limits))
    if picked.size > most:
        # the slowest speeds have the most waves in a cut: none of them is left out
        places = np.geomspace(1, picked.size, most).round().astype(int) - 1
        picked = picked[np.unique(places)]
    speed, depth = speeds[picked], limits[picked]
    step = 1e-3 * depth
    below, above = (rates(cut, speed, depth + s) for s in (-step, step))
    return CheckedLimits(speed, depth, np.maximum(np.abs(above - below) / (2.0 * step), 1e-300))
