"""Limits under a varying spindle speed, with finer elements until they are good to a tolerance.

They are found with coarse elements and periods that many speeds have in common, and re-evaluated
with regular elements and periods that fit better, between two of those. The error is what far finer
elements and a far closer fit of the period change at some of the limits.
"""

from chatter.description.arrays import Array
from chatter.description.progress import Progress
from chatter.stability.boundary_continuation import continued_crossings
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
from chatter.stability.methods.collocation.varying_speed import (
    Pair,
    beside,
    interpolated,
    share_between,
)
from chatter.stability.spindle_rotation import PeriodFit

#: Gauss points of an element and wavelengths that it holds, one after the other until limits are
#: good
_RESOLUTIONS = ((6, 1.0), RESOLUTION, *FINER[:2])
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
_CHECKED, _CHECK, _CHECK_PERIODS = 8, (10, 0.3), 150
#: tool periods in a period at the least, one after the other until limits are good
_LEAST_PERIODS = (20, 40)

_Crossings = list[Array]


def limits_of_varying_speed(
    cut_at: CutAt, speeds: Array, depths: Array, progress: Progress, tolerance: float
) -> LimitCurve:
    """Limits at every mean spindle speed, good to a tolerance; see `converged_limit_curve`."""
    first = cut_at(*_RESOLUTIONS[0]).with_fit(_FIRST_FIT)
    crossings = continued_crossings(
        len(speeds), depths, growth_rate_of(first, speeds), _FIRST_TOLERANCE, _STRIDE, progress
    )
    resolutions, periods = list(_RESOLUTIONS), list(_LEAST_PERIODS)
    while True:
        cut = cut_at(*resolutions[0])
        pair = beside(cut, periods[0])
        crossings = _between(crossings, pair, speeds, depths, _SEARCHED * tolerance)
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
    crossings: _Crossings, pair: Pair, speeds: Array, depths: Array, tolerance: float
) -> _Crossings:
    """Limits at the true ratio, between those of the two beside it."""
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
