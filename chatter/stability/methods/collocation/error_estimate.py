"""Error of limits, estimated at some of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.stability.methods.collocation.element_cut import ElementCut
from chatter.stability.methods.collocation.multipliers import growth_rate_at

_ALLOWANCE = 1.1


class CheckedLimits(NamedTuple):
    """Limits at which the error is estimated."""

    speed: NDArray[np.float64]  # rad/s (n,)
    depth: NDArray[np.float64]  # m (n,)
    slope: NDArray[np.float64]  # of the growth rate per tool period over depth, 1/m (n,)

    def largest_error(
        self, growth_rate: NDArray[np.float64], at_limits: NDArray[np.float64] | float = 0.0
    ) -> float:
        """Error relative to the depth, from growth rates (n,) and what they should be."""
        if self.depth.size == 0:
            return 0.0
        return float(
            _ALLOWANCE * np.max(np.abs(growth_rate - at_limits) / (self.slope * self.depth))
        )


def checked_limits(
    cut: ElementCut, speeds: NDArray[np.float64], limits: NDArray[np.float64], most: int
) -> CheckedLimits:
    """Take some of the limits, and how fast the growth rate changes with depth there.

    Parameters
    ----------
    cut : ElementCut
    speeds, limits : (n,) array of float
        rad/s; m, inf where there is none.
    most : int
        That are taken.
    """
    picked = np.flatnonzero(np.isfinite(limits))
    if picked.size > most:
        # the slowest speeds have the most wavelengths in a cut: none of them is left out
        ranks = np.geomspace(1, picked.size, most).round().astype(int) - 1
        picked = picked[np.unique(ranks)]
    speed, depth = speeds[picked], limits[picked]
    step = 1e-3 * depth
    below, above = (growth_rate_at(cut, speed, depth + s) for s in (-step, step))
    return CheckedLimits(speed, depth, np.maximum(np.abs(above - below) / (2.0 * step), 1e-300))
