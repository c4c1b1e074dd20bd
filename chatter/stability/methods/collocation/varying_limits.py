"""Limits under a varying spindle speed, with finer elements until they are good to a tolerance.

They are looked for with coarse elements and periods that many speeds have in common, and taken up
from there by everyday elements and periods that fit better, between two of those. The error is what
far finer elements and a far closer fit of the period leave at some of the limits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress
from chatter.stability.boundary_continuation import followed_crossings
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import limits_at
from chatter.stability.methods.collocation.cut_arrays import RESOLUTION, CutArrays
from chatter.stability.methods.collocation.error_estimate import CheckedLimits, checked_limits
from chatter.stability.methods.collocation.multipliers import (
    FINER,
    CutAt,
    near_limits,
    points_of_periods,
    rates,
    rates_at,
)
from chatter.stability.methods.collocation.nearby_limits import moved_limits
from chatter.stability.methods.collocation.varying_speed import (
    beside,
    interpolated,
    place_between,
    tuned,
)

#: Gauss points of an element and waves that it holds, one after the other until limits are good
_RESOLUTIONS = ((6, 1.0), RESOLUTION, *FINER[:2])
#: share by which the frequency may be moved, and tolerance, relative, of the limits that are the
#: first to be found
_FIRST_TUNING, _FIRST_TOLERANCE = 5e-2, 0.01
#: from columns of the net to the next
_STRIDE = 4
#: how far those may be off, relative to their depth
_REACHES = (0.015, 0.06)
#: limits are searched to this share of the largest error
_SEARCHED = 0.2
#: limits that are looked at again: with elements of so many points, and their length over that they
#: had, and with periods of so many tool periods at the least
_CHECKED, _CHECK, _CHECK_PERIODS = 8, (10, 0.3), 150
#: tool periods in a period at the least, one after the other until limits are good
_LEAST_PERIODS = (20, 40)

_Crossings = list[NDArray[np.float64]]


def limits_of_varying_speed(
    cut_at: CutAt,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress,
    tolerance: float,
) -> LimitCurve:
    """Limits at every mean spindle speed, good to a tolerance.

    Parameters
    ----------
    cut_at : callable
        Cut at a resolution.
    speeds, depths, progress
        As for `collocation.limit_curve`.
    tolerance : float
        On the depths of the limits, relative.

    Returns
    -------
    LimitCurve
        With the estimated error.
    """
    first = tuned(cut_at(*_RESOLUTIONS[0]), _FIRST_TUNING)
    crossings = followed_crossings(
        len(speeds), depths, rates_at(first, speeds), _FIRST_TOLERANCE, _STRIDE, progress
    )
    resolutions, periods = list(_RESOLUTIONS), list(_LEAST_PERIODS)
    while True:
        cut = cut_at(*resolutions[0])
        pair = beside(cut, periods[0])
        crossings = _between(crossings, pair, speeds, depths, _SEARCHED * tolerance)
        limits = np.array([found[0] if found.size else np.inf for found in crossings])
        checked = checked_limits(pair[0], speeds, limits, _CHECKED)
        of_elements = _error_of_elements(checked, pair[0], cut_at, resolutions[0])
        of_periods = checked.largest_error(_rates_between(beside(cut, _CHECK_PERIODS), checked))
        if of_elements + of_periods <= tolerance:
            break
        if of_periods > of_elements and len(periods) > 1:
            periods.pop(0)
        elif of_elements >= of_periods and len(resolutions) > 1:
            resolutions.pop(0)
        else:
            break
    heard = near_limits(pair[0], speeds)
    steps = points_of_periods(pair[0], speeds, depths)
    curve = limits_at(heard.nearest, speeds, crossings, steps)
    return curve._replace(error=of_elements + of_periods)


def _between(
    crossings: _Crossings,
    pair: tuple[CutArrays, CutArrays],
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    tolerance: float,
) -> _Crossings:
    """Limits at the true ratio, between those of the two beside it."""
    fewer, more = (
        moved_limits(crossings, cut, speeds, depths, rates_at(cut, speeds), tolerance, _REACHES)
        for cut in pair
    )
    return interpolated(fewer, more, place_between(pair, speeds))


def _rates_between(
    pair: tuple[CutArrays, CutArrays], checked: CheckedLimits
) -> NDArray[np.float64]:
    """Growth at limits, at the true ratio."""
    fewer, more = (rates(cut, checked.speed, checked.depth) for cut in pair)
    return fewer + place_between(pair, checked.speed) * (more - fewer)


def _error_of_elements(
    checked: CheckedLimits, cut: CutArrays, cut_at: CutAt, resolution: tuple[int, float]
) -> float:
    """Error that the elements leave, by far finer ones."""
    finer = cut_at(_CHECK[0], _CHECK[1] * resolution[1])._replace(variation=cut.variation)
    # the true ratio lies between two: each has growth there
    there = checked.speed, checked.depth
    return checked.largest_error(rates(finer, *there) - rates(cut, *there))
