"""Limits of a cut that hardly differs from another, next to those of the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.brackets import GrowthRate
from chatter.stability.crossings import moved_crossings
from chatter.stability.methods.collocation.element_cut import ElementCut
from chatter.stability.methods.collocation.multipliers import growth_rate_of


def moved_limits(
    crossings: list[NDArray[np.float64]],
    cut: ElementCut,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    growth_rate: GrowthRate,
    tolerance: float,
    reaches: tuple[float, ...],
) -> list[NDArray[np.float64]]:
    """Changes of stability of a cut.

    Parameters
    ----------
    crossings : list of n arrays
        Those of the other cut, m.
    cut : ElementCut
    speeds : (n,) array of float
        rad/s.
    depths : (m,) array of float
        Grid on which those are searched that come or go, m.
    growth_rate : callable
        Of the cut, where a limit is searched next to the known one.
    tolerance : float
        Of a limit, relative to its depth.
    reaches : tuple of float
        How far a limit may have moved, relative to its depth; one after the other is tried.
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
