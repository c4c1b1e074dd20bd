"""Limits by collocation with finer elements until they are good to a tolerance.

Some of the limits are looked at again with far finer elements. What growth is left there, over its
slope, is the error.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress, no_progress
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import limits_at
from chatter.stability.methods.collocation.cut_arrays import RESOLUTION, CutArrays
from chatter.stability.methods.collocation.error_estimate import checked_limits
from chatter.stability.methods.collocation.multipliers import (
    FINER,
    CutAt,
    limit_curve,
    near_limits,
    points_of_periods,
    rates,
)
from chatter.stability.methods.collocation.nearby_limits import moved_limits
from chatter.stability.methods.collocation.varying_limits import limits_of_varying_speed
from chatter.stability.methods.collocation.varying_speed import varies

#: largest estimated error of limits, relative to their depth
LIMIT_ERROR = 1e-3
#: of `FINER` for no more than that: a serrated edge, with kinks everywhere, would take minutes
_DAILY = 2
#: limits that are looked at again with finer elements
_CHECKED = 16
#: Gauss points of the elements that they are looked at with, and their length over that they had:
#: so fine that where the chip has kinks, and errors fall but as the square, a tenth is left
_CHECK = (12, 0.3)
#: finer elements move a limit by no more than some of its errors, relative to its depth
_REACH, _LARGEST_REACH = 4.0, 0.1
#: limits are searched to this share of the largest error
_SEARCHED = 0.1


def converged_limit_curve(
    cut_at: CutAt,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
    tolerance: float = LIMIT_ERROR,
) -> LimitCurve:
    """Limits at every spindle speed, with finer elements until they are good to a tolerance.

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
    search = _SEARCHED * tolerance
    finer_ones = FINER if tolerance < LIMIT_ERROR else FINER[:_DAILY]
    cut = cut_at(*RESOLUTION)
    if varies(cut):
        return limits_of_varying_speed(cut_at, speeds, depths, progress, tolerance)
    limits = limit_curve(cut, speeds, depths, progress, search)
    limits = limits._replace(error=_limit_error(limits, cut, cut_at, RESOLUTION))
    for finer in finer_ones:
        if limits.error <= tolerance:
            break
        cut = cut_at(*finer)
        limits = _limits_of_finer(limits, cut, depths, search)
        limits = limits._replace(error=_limit_error(limits, cut, cut_at, finer))
    return limits


def _limits_of_finer(
    limits: LimitCurve, cut: CutArrays, depths: NDArray[np.float64], tolerance: float
) -> LimitCurve:
    speeds = limits.spindle_speed
    heard = near_limits(cut, speeds)
    reach = min(_LARGEST_REACH, _REACH * limits.error)
    crossings = moved_limits(
        list(limits.crossings), cut, speeds, depths, heard.growth, tolerance, (reach,)
    )
    return limits_at(heard.nearest, speeds, crossings, points_of_periods(cut, speeds, depths))


def _limit_error(
    limits: LimitCurve, cut: CutArrays, cut_at: CutAt, resolution: tuple[int, float]
) -> float:
    """Largest error of the limit depth, relative, of some limits, by a far finer resolution."""
    checked = checked_limits(cut, limits.spindle_speed, limits.critical_depth, _CHECKED)
    finer = cut_at(_CHECK[0], _CHECK[1] * resolution[1])
    # at the limit of the finer cut there would be no growth: what the search leaves counts as well
    return checked.largest_error(rates(finer, checked.speed, checked.depth))
