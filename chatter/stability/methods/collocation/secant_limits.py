"""Limits next to those of a like problem, by secants from slopes that are known about.

Where the search for the first limits has left the slope of the growth rate, two evaluations reach a
limit that has moved by a per cent; brackets take three and more. What does not settle is left to
them.
"""

import numpy as np

from chatter.description.arrays import Array, BooleanArray, IntegerArray
from chatter.stability.brackets import GrowthRate

#: slopes are taken between points so far off at the least, relative to the depth
_APART = 3e-3
#: a limit moves by no more than this, relative to its depth
_REACH = 0.06
#: slopes of two steps may differ by this factor: else another motion becomes the dominant one
_SLOPE_RATIO = 3.0
#: share of a step by a secant that it may be off, at most
_STEP_ERROR = 0.2
#: steps shorter than this, relative to the depth, leave the slope as it is
_SHORT_STEP = 1e-4
_MOST_STEPS = 4


class RecordedGrowthRate:
    """A growth rate that records where it was evaluated."""

    def __init__(self, growth_rate: GrowthRate) -> None:
        self._growth_rate = growth_rate
        self._point: list[IntegerArray] = []
        self._depth: list[Array] = []
        self._value: list[Array] = []

    def __call__(self, points: IntegerArray, depth: Array) -> Array:
        """Growth rate at points."""
        value = self._growth_rate(points, depth)
        self._point.append(points)
        self._depth.append(depth)
        self._value.append(value)
        return value

    def slopes(self, points: IntegerArray, depth: Array) -> Array:
        """Slope (n,), 1/m, between the nearest depths on both sides; nan where a side has none."""
        point = np.concatenate([np.empty(0, dtype=np.int64), *self._point])
        at, value = (np.concatenate([np.empty(0), *part]) for part in (self._depth, self._value))
        if at.size == 0:
            return np.full(len(points), np.nan)
        order = np.lexsort((at, point))
        point, at, value = point[order], at[order], value[order]
        # points ascend in steps of one, depths within them
        deepest = 2.0 * max(float(at.max()), float(np.max(depth, initial=0.0)))
        key = point + at / deepest
        below = np.searchsorted(key, points + (1.0 - _APART) * depth / deepest, side="right") - 1
        above = np.searchsorted(key, points + (1.0 + _APART) * depth / deepest)
        there = (below >= 0) & (above < at.size)
        below, above = np.clip(below, 0, None), np.clip(above, None, at.size - 1)
        there &= (point[below] == points) & (point[above] == points)
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = (value[above] - value[below]) / (at[above] - at[below])
        return np.where(there, slope, np.nan)


def limits_by_secants(
    points: IntegerArray, depth: Array, slope: Array, growth_rate: GrowthRate, tolerance: float
) -> Array:
    """Changes of stability (n,), m, next to those of a like problem; nan where none settles.

    Points and depths (n,), m, and the slopes of the growth rate there, 1/m, are those of the like
    problem; the tolerance is relative to the depth.
    """
    found = np.full(depth.size, np.nan)
    k = np.flatnonzero(np.isfinite(slope) & (slope != 0.0))
    now, of_now, steepness = depth[k], growth_rate(points[k], depth[k]), slope[k]
    # the slope is that of the like problem
    k, now, of_now, steepness = _settled(found, k, now, of_now, steepness, _STEP_ERROR * tolerance)
    for _ in range(_MOST_STEPS):
        following = now - of_now / steepness
        kept = np.abs(following - depth[k]) <= _REACH * depth[k]
        k, following, now, of_now, steepness = _of(kept, k, following, now, of_now, steepness)
        if k.size == 0:
            break
        value = growth_rate(points[k], following)
        step = following - now
        short = np.abs(step) <= _SHORT_STEP * now
        with np.errstate(divide="ignore", invalid="ignore"):
            secant = np.where(short, steepness, (value - of_now) / step)
        ratio = secant / steepness
        like = (ratio > 1.0 / _SLOPE_RATIO) & (ratio < _SLOPE_RATIO)
        k, now, of_now, steepness = _of(like, k, following, value, secant)
        k, now, of_now, steepness = _settled(found, k, now, of_now, steepness, tolerance)
    return found


def _settled(
    found: Array, k: IntegerArray, now: Array, of_now: Array, steepness: Array, tolerance: float
) -> tuple[Array, ...]:
    """Enter what a last step finds where it is short; returns the others."""
    left = of_now / steepness
    done = _STEP_ERROR * np.abs(left) <= tolerance * now
    found[k[done]] = (now - left)[done]
    return _of(~done, k, now, of_now, steepness)


def _of(kept: BooleanArray, index: IntegerArray, *values: Array) -> tuple[Array, ...]:
    """Return those of the index and of the values that are kept."""
    return (index[kept], *(value[kept] for value in values))
