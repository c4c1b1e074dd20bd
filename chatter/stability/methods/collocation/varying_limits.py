"""Limits under a varying spindle speed, with finer elements until they are good to a tolerance.

They are found with coarse elements and periods that many speeds have in common, and followed from
there with finer elements and periods that fit better, between two of those. In windows of the
ratio of tool periods to variations, some half a tool period wide, chatter locks to the variation,
and limits are up to some per cent lower: where limits on both sides of the true ratio differ,
closer ratios follow. The error is what far finer elements change at some of the limits, and a share
of the difference that is left between both sides.
"""

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.progress import Progress
from chatter.engine.parallel import kept_threads
from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.limit_curve import LimitCurve, first_crossings, limits_at
from chatter.stability.methods.collocation.element_cut import RESOLUTION, CutAt, ElementCut
from chatter.stability.methods.collocation.finer_limits import checked_limits, moved_limits
from chatter.stability.methods.collocation.multipliers import (
    FINER,
    evaluated_points,
    growth_rate_at,
    growth_rate_of,
    points_of_periods,
)
from chatter.stability.methods.collocation.secant_limits import (
    RecordedGrowthRate,
    limits_by_secants,
)
from chatter.stability.methods.collocation.varying_speed import (
    Pair,
    beside,
    interpolated,
    share_between,
)
from chatter.stability.model import LIMIT_ERROR
from chatter.stability.spindle_rotation import PeriodFit

#: Gauss points of an element and wavelengths that it holds: of the limits that are found first, and
#: then, one after the other until limits are good
_FIRST, _RESOLUTIONS = (4, 1.0), ((5, 1.0), (6, 1.0), RESOLUTION, *FINER[:2])
#: of those, the first for a tolerance below the usual one
_FIRST_OF_CLOSE = 1
#: fit of the period, and tolerance, relative, of the limits that are found first
_FIRST_FIT, _FIRST_TOLERANCE = PeriodFit(tuning=5e-2), 0.01
#: from columns of the grid to the next
_STRIDE = 4
#: how far those may be off, relative to their depth
_REACHES = (0.015, 0.06)
#: limits are searched to this share of the largest error
_SEARCHED = 0.05
#: limits that are re-evaluated: with elements of so many points, and their length over that they
#: had
_CHECKED, _CHECK = 8, (8, 0.5)
#: tool periods in a period at the least, and numbers of variations in it that are tried: at all
#: speeds, and then where the growth rates on both sides of the true ratio differ
_LEAST_PERIODS, _TRIED = 20, (1, 3, 6)
#: share of the largest error that elements may have
_ERROR_OF_ELEMENTS = 0.5
#: limits on both sides of the true ratio may differ by so many tolerances; this share of that is
#: the error of a limit between them
_APART, _SHARE_OF_DIFFERENCE = 1.0, 0.5

_Crossings = list[Array]


class RateBetween:
    """Growth rate at the true ratio, between those of the two cuts beside it."""

    def __init__(self, pair: Pair, speeds: Array) -> None:
        self.pair = pair
        self._share = share_between(pair, speeds)
        self._of_fewer, self._of_more = (growth_rate_of(cut, speeds) for cut in pair)
        #: by how much the two differed where they were evaluated last
        self._apart = np.zeros(len(speeds))

    def __call__(self, points: IntegerArray, depth: Array) -> Array:
        """Growth rate at points."""
        share = self._share[points]
        value = self._of_fewer(points, depth)
        apart = np.flatnonzero(share > 0.0)
        of_other = self._of_more(points[apart], depth[apart]) - value[apart]
        self._apart[points[apart]] = np.abs(of_other)
        value[apart] += share[apart] * of_other
        return value

    def difference_at(self, crossings: _Crossings, slopes: list[Array]) -> Array:
        """By how much limits of the two differ at every speed, relative; nan where not known."""
        # where no limit is known there is nothing to change it by
        change = [
            np.min(np.abs(slope * found), initial=np.inf)
            for slope, found in zip(slopes, crossings, strict=True)
        ]
        return self._apart / np.array(change)


def limits_of_varying_speed(
    cut_at: CutAt, speeds: Array, depths: Array, progress: Progress, tolerance: float
) -> LimitCurve:
    """Limits at every mean spindle speed, good to a tolerance; see `converged_limit_curve`."""
    with kept_threads():
        return _limits(cut_at, speeds, depths, progress, tolerance)


def _limits(
    cut_at: CutAt, speeds: Array, depths: Array, progress: Progress, tolerance: float
) -> LimitCurve:
    first = RecordedGrowthRate(growth_rate_of(cut_at(*_FIRST).with_fit(_FIRST_FIT), speeds))
    crossings = continued_crossings(len(speeds), depths, first, _FIRST_TOLERANCE, _STRIDE, progress)
    slopes = [first.slopes(np.full(found.size, i), found) for i, found in enumerate(crossings)]
    resolutions = list(_RESOLUTIONS[0 if tolerance >= LIMIT_ERROR else _FIRST_OF_CLOSE :])
    while True:
        cut = cut_at(*resolutions[0])
        between = RateBetween(beside(cut, _LEAST_PERIODS, _TRIED[0]), speeds)
        crossings = _between(crossings, slopes, between, speeds, depths, _SEARCHED * tolerance)
        slopes = [_slopes_of(*both) for both in zip(crossings, slopes, strict=True)]
        one = between.pair[0]
        checked = checked_limits(one, speeds, first_crossings(crossings), _CHECKED)
        finer = cut_at(_CHECK[0], _CHECK[1] * resolutions[0][1]).with_fit(one.arrays.fit)
        # the true ratio lies between two: each has a growth rate there
        error = checked.largest_error(
            *(growth_rate_at(of, checked.speed, checked.depth) for of in (finer, one))
        )
        if error <= _ERROR_OF_ELEMENTS * tolerance or len(resolutions) == 1:
            break
        resolutions.pop(0)
    crossings, difference = _at_closer_ratios(
        crossings, slopes, between, cut, speeds, depths, tolerance
    )
    # over the long periods of close ratios the frequency would cost more than the limits
    steps = points_of_periods(one, speeds, depths)
    curve = limits_at(evaluated_points(one, speeds).at_limits, speeds, crossings, steps)
    return curve._replace(error=error + _SHARE_OF_DIFFERENCE * difference)


def _at_closer_ratios(
    crossings: _Crossings,
    slopes: list[Array],
    between: RateBetween,
    cut: ElementCut,
    speeds: Array,
    depths: Array,
    tolerance: float,
) -> tuple[_Crossings, float]:
    """Limits, with closer ratios where both sides differ, and the largest difference left."""
    crossings, slopes = list(crossings), list(slopes)
    difference = between.difference_at(crossings, slopes)
    for tried in _TRIED[1:]:
        left = np.flatnonzero(~(difference <= _APART * tolerance))
        if left.size == 0:
            break
        between = RateBetween(beside(cut, _LEAST_PERIODS, tried), speeds[left])
        known, of_known = [crossings[i] for i in left], [slopes[i] for i in left]
        moved = _between(known, of_known, between, speeds[left], depths, _SEARCHED * tolerance)
        for i, there in zip(left.tolist(), moved, strict=True):
            crossings[i], slopes[i] = there, _slopes_of(there, slopes[i])
        difference[left] = between.difference_at(moved, [slopes[i] for i in left])
    return crossings, float(np.max(difference[np.isfinite(difference)], initial=0.0))


def _slopes_of(found: Array, slope: Array) -> Array:
    """Slopes at limits; where others were found, there are none of them."""
    return slope if slope.size == found.size else np.full(found.size, np.nan)


def _between(
    crossings: _Crossings,
    slopes: list[Array],
    between: RateBetween,
    speeds: Array,
    depths: Array,
    tolerance: float,
) -> _Crossings:
    """Limits at the true ratio, next to those that are known about, with slopes of theirs."""
    count = [found.size for found in crossings]
    points, depth = np.repeat(np.arange(len(speeds)), count), np.concatenate(crossings)
    moved = limits_by_secants(points, depth, np.concatenate(slopes), between, tolerance)
    found = np.split(moved, np.cumsum(count)[:-1])
    # nan is in no order
    lost = np.array(
        [i for i, at in enumerate(found)
         if at.size and not (np.all(np.diff(at) > 0.0) and at[0] > 0.0 and at[-1] <= depths[-1])],
        dtype=np.int64,
    )  # fmt: skip
    if lost.size:
        anew = _between_searched(
            [crossings[i] for i in lost], between.pair, speeds[lost], depths, tolerance
        )
        for i, there in zip(lost.tolist(), anew, strict=True):
            found[i] = there
    return found


def _between_searched(
    crossings: _Crossings, pair: Pair, speeds: Array, depths: Array, tolerance: float
) -> _Crossings:
    """Limits at the true ratio, between those of the two beside it, each in brackets."""
    fewer, more = (
        moved_limits(
            crossings, cut, speeds, depths, growth_rate_of(cut, speeds), tolerance, _REACHES
        )
        for cut in pair
    )
    return interpolated(fewer, more, share_between(pair, speeds))
