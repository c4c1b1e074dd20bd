"""Limits of finer elements, next to those that are known, and the error that these have."""

from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.brackets import GrowthRate
from chatter.stability.crossings import moved_crossings
from chatter.stability.methods.collocation.element_cut import ElementCut
from chatter.stability.methods.collocation.multipliers import growth_rate_at, growth_rate_of

_ALLOWANCE = 1.1


class CheckedLimits(NamedTuple):
    """Limits at which the error is estimated."""

    speed: Array  # rad/s (n,)
    depth: Array  # m (n,)
    slope: Array  # of the growth rate per tool period over depth, 1/m (n,)

    def largest_error(self, growth_rate: Array, at_limits: Array | float = 0.0) -> float:
        """Error relative to the depth, from growth rates (n,) and what they should be."""
        if self.depth.size == 0:
            return 0.0
        return float(
            _ALLOWANCE * np.max(np.abs(growth_rate - at_limits) / (self.slope * self.depth))
        )


def checked_limits(cut: ElementCut, speeds: Array, limits: Array, most: int) -> CheckedLimits:
    """Take some of the limits, and how fast the growth rate changes with depth there.

    Speeds (n,) in rad/s, limits (n,) in m, inf where there is none; `most` of them are taken.
    """
    picked = np.flatnonzero(np.isfinite(limits))
    if picked.size > most:
        # the slowest speeds have the most wavelengths in a cut: none of them is left out
        ranks = np.geomspace(1, picked.size, most).round().astype(int) - 1
        picked = picked[np.unique(ranks)]
    speed, depth = speeds[picked], limits[picked]
    step = 1e-3 * depth
    # at once, so that they share what they can
    both = growth_rate_at(cut, np.tile(speed, 2), np.concatenate([depth - step, depth + step]))
    below, above = np.split(both, 2)
    return CheckedLimits(speed, depth, np.maximum(np.abs(above - below) / (2.0 * step), 1e-300))


def moved_limits(
    crossings: list[Array],
    cut: ElementCut,
    speeds: Array,
    depths: Array,
    growth_rate: GrowthRate,
    tolerance: float,
    reaches: tuple[float, ...],
) -> list[Array]:
    """Changes of stability of a cut that hardly differs from another, m.

    `crossings` are those of the other cut at every speed (rad/s), m; those that come or go are
    searched on the grid of depths (m). `growth_rate` is that of the cut next to a known limit. The
    tolerance of a limit is relative to its depth, and so is how far it may have moved: `reaches`
    are tried one after the other.
    """
    speed = np.repeat(np.arange(len(speeds)), [found.size for found in crossings])
    depth = np.concatenate([np.empty(0), *crossings])
    moved = np.full(depth.size, np.nan)
    for reach in reaches:
        left = np.flatnonzero(np.isnan(moved))
        if left.size:
            moved[left] = moved_crossings(speed[left], depth[left], reach, growth_rate, tolerance)
    gone = np.unique(speed[np.isnan(moved) | (moved > depths[-1])])
    found = [moved[speed == i] for i in range(len(speeds))]
    if gone.size:
        anew = continued_crossings(
            gone.size, depths, growth_rate_of(cut, speeds[gone]), tolerance, stride=1
        )
        for i, there in zip(gone.tolist(), anew, strict=True):
            found[i] = there
    return found
