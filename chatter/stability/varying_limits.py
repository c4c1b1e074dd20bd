"""Limits under a varying spindle speed, with finer elements until they are good to a tolerance.

They are looked for with coarse elements and periods that many speeds have in common, and taken up
from there by everyday elements and periods that fit better, between two of those. The error is what
far finer elements and a far closer fit of the period leave at some of the limits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.stability.checked_limits import CheckedLimits, checked_limits
from chatter.stability.collocation import (
    FINER,
    CutAt,
    near_limits,
    points_of_periods,
    rates,
    rates_at,
)
from chatter.stability.cut_arrays import RESOLUTION, CutArrays
from chatter.stability.following import followed_crossings
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import limits_at
from chatter.stability.moved_limits import moved_limits
from chatter.stability.sweep import Progress
from chatter.stability.varying_speed import (
    LOOSE_TUNING,
    beyond,
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
#: had, and with the frequency moved by no more than this
_CHECKED, _CHECK, _CHECK_TUNING = 8, (10, 0.3), 5e-4
#: too large an error of the tuning asks for that much less of it
_TIGHTER = 0.4

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
    resolutions, tuning = list(_RESOLUTIONS), LOOSE_TUNING
    while True:
        cut = tuned(cut_at(*resolutions[0]), tuning)
        crossings = _truly_varying(crossings, cut, speeds, depths, _SEARCHED * tolerance)
        limits = np.array([found[0] if found.size else np.inf for found in crossings])
        checked = checked_limits(cut, speeds, limits, _CHECKED)
        of_elements = _error_of_elements(checked, cut, cut_at, resolutions[0])
        of_tuning = checked.largest_error(
            rates(tuned(cut, _CHECK_TUNING), checked.speed, checked.depth)
        )
        if of_elements + of_tuning <= tolerance:
            break
        if of_tuning > of_elements and tuning > _CHECK_TUNING:
            tuning *= _TIGHTER
        elif len(resolutions) > 1:
            resolutions.pop(0)
        else:
            break
    heard = near_limits(cut, speeds)
    steps = points_of_periods(cut, speeds, depths)
    curve = limits_at(heard.nearest, speeds, crossings, steps)
    return curve._replace(error=of_elements + of_tuning)


def _truly_varying(
    crossings: _Crossings,
    cut: CutArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    tolerance: float,
) -> _Crossings:
    """Limits at the true frequency, between the two that fit into a period."""
    taken, other = (
        moved_limits(
            crossings, fitted, speeds, depths, rates_at(fitted, speeds), tolerance, _REACHES
        )
        for fitted in (cut, beyond(cut))
    )
    return interpolated(taken, other, place_between(cut, speeds))


def _error_of_elements(
    checked: CheckedLimits, cut: CutArrays, cut_at: CutAt, resolution: tuple[int, float]
) -> float:
    """Error that the elements leave, by far finer ones."""
    finer = tuned(cut_at(_CHECK[0], _CHECK[1] * resolution[1]), cut.variation.tuning)
    # limits lie between two tunings: each has growth there
    there = checked.speed, checked.depth
    return checked.largest_error(rates(finer, *there) - rates(cut, *there))
