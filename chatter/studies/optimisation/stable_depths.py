"""All stable intervals of depth at every speed, and what margins in speed and depth leave of them.

Nothing assumes that stability ends once: a speed has as many intervals as the grid finds.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chatter.description.arrays import Array, BooleanArray
from chatter.description.progress import Progress, no_progress
from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.crossings import find_crossings
from chatter.stability.limit_curve import first_crossings
from chatter.stability.methods.collocation.element_cut import ElementCut
from chatter.stability.methods.collocation.multipliers import growth_rate_of

#: of a limit, relative to its depth
_TOLERANCE = 1e-3
#: depths of a grid that are evaluated together
_ROWS_AT_ONCE = 6
_ROUNDING = 1e-9
#: speeds from one to the next of those at which all depths are evaluated, at the most, and the
#: part of a lobe between them
_WIDEST_STRIDE, _PART_OF_A_LOBE = 4, 0.3
#: decay from tooth to tooth, e-folds, beyond which a mode keeps no phase and has no lobes
_FORGOTTEN = 1.5


@dataclass(frozen=True)
class StableDepths:
    """Stable intervals of depth at the speeds that were evaluated."""

    speeds: Array  # rad/s, ascending (n,)
    crossings: Sequence[Array]  # m; stability is lost at even indices and regained at odd ones
    max_depth: float  # depth to which was searched, m

    def intervals(self, index: int) -> Array:
        """Stable intervals (k, 2) at a speed, m."""
        ends = np.concatenate([[0.0], self.crossings[index]])
        if ends.size % 2:
            ends = np.append(ends, self.max_depth)
        return ends.reshape(-1, 2)

    def within(self, speed: float, depth_margin: float, speed_margin: float) -> Array:
        """Stretches (k, 2), m, that keep the margins at a speed, rad/s.

        A depth keeps them if all depths within the share `depth_margin` of a limit are stable at
        all speeds evaluated within the share `speed_margin` of this one. Where the search ends is
        no limit.
        """
        near = np.flatnonzero(np.abs(self.speeds / speed - 1.0) <= speed_margin + _ROUNDING)
        found = np.array([[0.0, self.max_depth]])
        for index in near:
            found = _common(found, self._shrunk(self.intervals(index), depth_margin))
        return found

    def _shrunk(self, intervals: Array, margin: float) -> Array:
        low, high = intervals[:, 0] / (1.0 - margin), intervals[:, 1].copy()
        limited = high < self.max_depth
        high[limited] *= 1.0 - margin
        kept = low < high
        return np.stack([low[kept], high[kept]], axis=1)


def _common(first: Array, second: Array) -> Array:
    """Intersection of two sets of intervals."""
    found = [
        (max(a[0], b[0]), min(a[1], b[1]))
        for a in first
        for b in second
        if max(a[0], b[0]) < min(a[1], b[1])
    ]
    return np.array(found).reshape(-1, 2)


def is_inside(intervals: Array, depths: Array) -> BooleanArray:
    """Whether each depth (m,) lies in one of the intervals (k, 2)."""
    low, high = intervals[:, 0], intervals[:, 1] * (1.0 + _ROUNDING)
    return ((depths[:, None] >= low) & (depths[:, None] <= high)).any(axis=1)


def stable_depths(
    cut: ElementCut, speeds: Array, depths: Array, progress: Progress = no_progress
) -> StableDepths:
    """Stable intervals of depth, by collocation, following the boundary from speed to speed.

    The cut is laid out down to the deepest depth at least; speeds (n,), rad/s, ascend. On the
    depths (m,), m, ascending, > 0, changes of stability are looked for: an interval that fits
    between two of them is not seen, nor one between two speeds at which all of them are evaluated.
    Progress counts speeds.
    """
    stride = widest_stride(cut, speeds)
    growth_rate = growth_rate_of(cut, speeds)
    crossings = continued_crossings(speeds.size, depths, growth_rate, _TOLERANCE, stride, progress)
    return StableDepths(speeds, crossings, float(depths[-1]))


def widest_stride(cut: ElementCut, speeds: Array) -> int:
    """Speeds (a power of two) that may be stepped over where all depths are evaluated.

    Where a mode does f/(N n) cycles from one tooth to the next, a lobe is as wide as the speed over
    that number. A mode that has died out by then has none.
    """
    if speeds.size < 2:
        return 1
    arrays = cut.arrays
    passing = speeds[0] / float(np.max(arrays.segments.distinct_delay))
    lasting = arrays.damping * arrays.natural_frequency < _FORGOTTEN * passing
    highest = float(arrays.natural_frequency[lasting].max(initial=0.0))
    lobes = max(highest / (2.0 * math.pi * passing), 1.0)
    step = float(np.max(np.diff(speeds) / speeds[:-1]))
    stride = 1
    while 2 * stride <= _WIDEST_STRIDE and 2 * stride * step * lobes <= _PART_OF_A_LOBE:
        stride *= 2
    return stride


def first_limits(cut: ElementCut, speeds: Array, depths: Array) -> Array:
    """First limit (n,) of stability, m; inf where none was found; see `stable_depths`."""
    growth_rate = growth_rate_of(cut, speeds)
    # a speed that has lost its stability needs no deeper look
    grid = np.ones((speeds.size, depths.size))
    open_speeds = np.arange(speeds.size)
    for start in range(0, depths.size, _ROWS_AT_ONCE):
        rows = np.arange(start, min(start + _ROWS_AT_ONCE, depths.size))
        index, row = (part.ravel() for part in np.meshgrid(open_speeds, rows, indexing="ij"))
        grid[index, row] = growth_rate(index, depths[row])
        lost = (grid[open_speeds][:, rows] > 0.0).any(axis=1)
        open_speeds = open_speeds[~lost]
        if open_speeds.size == 0:
            break
    crossings = find_crossings(grid, depths, growth_rate, _TOLERANCE)
    return first_crossings(crossings)
