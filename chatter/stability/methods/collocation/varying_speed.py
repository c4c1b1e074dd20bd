"""Periods of a varying spindle speed, and limits between two that nearly fit.

A period holds a whole number of variations and of tool periods, so that the frequency of the
variation is taken a little higher or lower than it is. The growth rate per tool period changes
smoothly with the ratio of the two: limits are interpolated between the whole numbers on both sides
of the true ratio, with an error of second order in what the frequency has been moved by.
"""

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.stability.methods.collocation.element_cut import ElementCut
from chatter.stability.spindle_rotation import PeriodFit, fitted_periods

#: by this share the frequency may be moved where speed matters more than accuracy
LOOSE_FIT = PeriodFit(tuning=2e-2)

Pair = tuple[ElementCut, ElementCut]


def varies(cut: ElementCut) -> bool:
    """Whether the spindle speed varies."""
    return cut.arrays.variation.amplitude > 0.0


def beside(cut: ElementCut, least_periods: int, tried: int) -> Pair:
    """The cut with fewer and with more tool periods in a variation than the true ratio.

    A period has `least_periods` tool periods at the least; so many numbers of variations are tried.
    """
    fit = cut.arrays.fit._replace(least_periods=least_periods, tried=tried)
    return cut.with_fit(fit._replace(beyond=0)), cut.with_fit(fit._replace(beyond=1))


def periods(cut: ElementCut, speeds: Array) -> tuple[IntegerArray, IntegerArray]:
    """Tool periods and variations in a period at every speed (rad/s), both (n,)."""
    arrays = cut.arrays
    return fitted_periods(arrays.variation, arrays.fit, speeds, arrays.period_angle)


def tool_periods(cut: ElementCut, speeds: Array) -> Array:
    """Tool periods in a period (n,) at n speeds (rad/s)."""
    if not varies(cut):
        return np.ones(len(speeds))
    return periods(cut, speeds)[0].astype(np.float64)


def share_between(pair: Pair, speeds: Array) -> Array:
    """Where the true ratio (n,) lies: 0 is what the first of the two takes, 1 the second."""
    (of_fewer, by_fewer), (of_more, by_more) = (periods(cut, speeds) for cut in pair)
    fewer, more = of_fewer / by_fewer, of_more / by_more
    arrays = pair[0].arrays
    true = speeds / (arrays.variation.frequency * arrays.period_angle)
    return np.where(more > fewer, (true - fewer) / np.where(more > fewer, more - fewer, 1.0), 0.0)


def interpolated(taken: list[Array], other: list[Array], share: Array) -> list[Array]:
    """Crossings of every speed between two lists of them (shares 0 and 1).

    Where their numbers differ, those of the first.
    """
    return [
        a + part * (b - a) if a.size == b.size else a
        for a, b, part in zip(taken, other, share.tolist(), strict=True)
    ]
