"""Periods of a varying spindle speed, and limits between two that nearly fit.

A period holds a whole number of variations and of tool periods, so that the frequency of the
variation is taken a little higher or lower than it is. Growth over a tool period changes smoothly
with the ratio of the two: of the whole numbers on both sides of the true ratio, limits are
interpolated, with an error of second order in what the frequency has been moved by.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.stability.methods.collocation.cut_arrays import CutArrays
from chatter.stability.spindle_rotation import SpindleTurn, spindle_turn

#: the frequency may be moved by this share where limits are looked for
LOOSE_TUNING = 2e-2


def varies(cut: CutArrays) -> bool:
    """Tell whether the spindle speed varies."""
    return cut.variation.amplitude > 0.0


def tuned(cut: CutArrays, tuning: float) -> CutArrays:
    """The cut with the frequency of a varying speed moved by no more than a share."""
    return cut._replace(variation=cut.variation._replace(tuning=tuning))


def beside(cut: CutArrays, least_periods: int) -> tuple[CutArrays, CutArrays]:
    """The cut with periods of fewer and of more tool periods than the true ratio asks for.

    Parameters
    ----------
    cut : CutArrays
    least_periods : int
        Tool periods in a period at the least.
    """
    fewer = cut.variation._replace(least_periods=least_periods, beyond=0)
    return cut._replace(variation=fewer), cut._replace(variation=fewer._replace(beyond=1))


def turns(cut: CutArrays, speeds: NDArray[np.float64]) -> list[SpindleTurn]:
    """Turn of the spindle at every speed (rad/s)."""
    return [spindle_turn(cut.variation, float(speed), cut.period_angle) for speed in speeds]


def tool_periods(cut: CutArrays, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Tool periods in a period (n,) at n speeds (rad/s)."""
    if not varies(cut):
        return np.ones(len(speeds))
    return np.array([float(turn.patterns) for turn in turns(cut, speeds)])


def place_between(
    pair: tuple[CutArrays, CutArrays], speeds: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Where the true ratio (n,) lies: 0 is what the first of the two takes, 1 the second."""
    fewer, more = (
        np.array([turn.patterns / turn.cycles for turn in turns(cut, speeds)]) for cut in pair
    )
    true = speeds / (pair[0].variation.frequency * pair[0].period_angle)
    return np.where(more > fewer, (true - fewer) / np.where(more > fewer, more - fewer, 1.0), 0.0)


def interpolated(
    taken: list[NDArray[np.float64]], other: list[NDArray[np.float64]], place: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Crossings of every speed between two lists of them (places 0 and 1).

    Where their numbers differ, those of the first.
    """
    return [
        a + share * (b - a) if a.size == b.size else a
        for a, b, share in zip(taken, other, place.tolist(), strict=True)
    ]
