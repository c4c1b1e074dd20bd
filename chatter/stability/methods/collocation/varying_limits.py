"""Limits under a varying spindle speed, with finer elements until they are good to a tolerance.

They are found with coarse elements and periods that many speeds have in common, and followed from
there with finer elements and periods that fit better, between two of those. The error is what far
finer elements and a far closer fit of the period change at some of the limits.
"""

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.progress import Progress
from chatter.engine.parallel import kept_threads
from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.brackets import GrowthRate
from chatter.stability.limit_curve import LimitCurve, first_crossings, limits_at
from chatter.stability.methods.collocation.element_cut import RESOLUTION, CutAt
from chatter.stability.methods.collocation.finer_limits import (
    CheckedLimits,
    checked_limits,
    moved_limits,
)
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
_SEARCHED = 0.2
#: limits that are re-evaluated: with elements of so many points, and their length over that they
#: had, and with periods of so many tool periods at the least
_CHECKED, _CHECK, _CHECK_PERIODS = 8, (8, 0.5), 100
#: tool periods in a period at the least, one after the other until limits are good
_LEAST_PERIODS = (20, 40)

_Crossings = list[Array]


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
    periods = list(_LEAST_PERIODS)
    while True:
        cut = cut_at(*resolutions[0])
        pair = beside(cut, periods[0])
        crossings = _between(crossings, slopes, pair, speeds, depths, _SEARCHED * tolerance)
        # where others were found, there are no slopes of them
        slopes = [
            slope if slope.size == found.size else np.full(found.size, np.nan)
            for slope, found in zip(slopes, crossings, strict=True)
        ]
        checked = checked_limits(pair[0], speeds, first_crossings(crossings), _CHECKED)
        finer = cut_at(_CHECK[0], _CHECK[1] * resolutions[0][1]).with_fit(pair[0].arrays.fit)
        # the true ratio lies between two: each has a growth rate there
        of_elements = checked.largest_error(
            *(growth_rate_at(one, checked.speed, checked.depth) for one in (finer, pair[0]))
        )
        of_periods = checked.largest_error(_rates_between(beside(cut, _CHECK_PERIODS), checked))
        if of_elements + of_periods <= tolerance:
            break
        if of_periods > of_elements and len(periods) > 1:
            periods.pop(0)
        elif of_elements >= of_periods and len(resolutions) > 1:
            resolutions.pop(0)
        else:
            break
    steps = points_of_periods(pair[0], speeds, depths)
    curve = limits_at(evaluated_points(pair[0], speeds).at_limits, speeds, crossings, steps)
    return curve._replace(error=of_elements + of_periods)


def _between(
    crossings: _Crossings,
    slopes: list[Array],
    pair: Pair,
    speeds: Array,
    depths: Array,
    tolerance: float,
) -> _Crossings:
    """Limits at the true ratio, next to those that are known about, with slopes of theirs."""
    count = [found.size for found in crossings]
    points, depth = np.repeat(np.arange(len(speeds)), count), np.concatenate(crossings)
    moved = limits_by_secants(
        points, depth, np.concatenate(slopes), _growth_at_true_ratio(pair, speeds), tolerance
    )
    found = np.split(moved, np.cumsum(count)[:-1])
    # nan is in no order
    lost = np.array(
        [i for i, at in enumerate(found)
         if at.size and not (np.all(np.diff(at) > 0.0) and at[0] > 0.0 and at[-1] <= depths[-1])],
        dtype=np.int64,
    )  # fmt: skip
    if lost.size:
        anew = _between_searched(
            [crossings[i] for i in lost], pair, speeds[lost], depths, tolerance
        )
        for i, there in zip(lost.tolist(), anew, strict=True):
            found[i] = there
    return found


def _growth_at_true_ratio(pair: Pair, speeds: Array) -> GrowthRate:
    """Growth rate between those of the two beside the true ratio."""
    share = share_between(pair, speeds)
    of_fewer, of_more = (growth_rate_of(cut, speeds) for cut in pair)

    def growth_rate(points: IntegerArray, depth: Array) -> Array:
        value = of_fewer(points, depth)
        apart = np.flatnonzero(share[points] > 0.0)
        of_other = of_more(points[apart], depth[apart])
        value[apart] += share[points[apart]] * (of_other - value[apart])
        return value

    return growth_rate


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


def _rates_between(pair: Pair, checked: CheckedLimits) -> Array:
    """Growth rate at limits, at the true ratio."""
    fewer, more = (growth_rate_at(cut, checked.speed, checked.depth) for cut in pair)
    return fewer + share_between(pair, checked.speed) * (more - fewer)
