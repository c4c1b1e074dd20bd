"""Limits by collocation with finer elements until they are good to a tolerance.

Some of the limits are re-evaluated with far finer elements. The growth rate there, over its slope,
is the error.
"""

from chatter.description.arrays import Array
from chatter.description.progress import Progress, no_progress
from chatter.stability.limit_curve import LimitCurve, limits_at
from chatter.stability.methods.collocation.element_cut import RESOLUTION, CutAt, ElementCut
from chatter.stability.methods.collocation.finer_limits import checked_limits, moved_limits
from chatter.stability.methods.collocation.multipliers import (
    FINER,
    evaluated_points,
    growth_rate_at,
    limit_curve,
    points_of_periods,
)
from chatter.stability.methods.collocation.varying_limits import limits_of_varying_speed
from chatter.stability.methods.collocation.varying_speed import varies
from chatter.stability.model import LIMIT_ERROR

#: of `FINER` for no more than the usual tolerance: a serrated edge, with kinks everywhere, would
#: take minutes
_USUAL = 2
#: limits that are re-evaluated with finer elements
_CHECKED = 16
#: Gauss points of the elements that they are re-evaluated with, and their length over that they
#: had: so fine that where the chip has kinks, and errors fall but as the square, a tenth is left
_CHECK = (12, 0.3)
#: finer elements move a limit by no more than some of its errors, relative to its depth
_REACH, _LARGEST_REACH = 4.0, 0.1
#: limits are searched to this share of the largest error
_SEARCHED = 0.1


def converged_limit_curve(
    cut_at: CutAt,
    speeds: Array,
    depths: Array,
    progress: Progress = no_progress,
    tolerance: float = LIMIT_ERROR,
) -> LimitCurve:
    """Limits at every spindle speed, with finer elements until they are good to a tolerance.

    `speeds`, `depths` and `progress` are as for `multipliers.limit_curve`; the tolerance is on the
    critical depths, relative. The curve has the estimated error.
    """
    search = _SEARCHED * tolerance
    finer_ones = FINER if tolerance < LIMIT_ERROR else FINER[:_USUAL]
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
    limits: LimitCurve, cut: ElementCut, depths: Array, tolerance: float
) -> LimitCurve:
    speeds = limits.spindle_speed
    evaluated = evaluated_points(cut, speeds)
    reach = min(_LARGEST_REACH, _REACH * limits.error)
    crossings = moved_limits(
        list(limits.crossings), cut, speeds, depths, evaluated.growth_rate, tolerance, (reach,)
    )
    steps = points_of_periods(cut, speeds, depths)
    return limits_at(evaluated.at_limits, speeds, crossings, steps)


def _limit_error(
    limits: LimitCurve, cut: ElementCut, cut_at: CutAt, resolution: tuple[int, float]
) -> float:
    """Largest error of the critical depth, relative, of some limits, by a far finer resolution."""
    checked = checked_limits(cut, limits.spindle_speed, limits.critical_depth, _CHECKED)
    finer = cut_at(_CHECK[0], _CHECK[1] * resolution[1])
    # at the limit of the finer cut the growth rate is zero: what the search leaves counts too
    return checked.largest_error(growth_rate_at(finer, checked.speed, checked.depth))
