"""Kind of a sustained motion: quasi-periodic, of double period, of a period of n."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from chatter.judgement.lines import ChatterLine

#: periods of an orbit that are looked for
_LONGEST = 12
#: share of the variance from period to period that an orbit of n periods may leave unexplained
_UNEXPLAINED = 0.01
#: angle by which a doubled period may seem to drift over the window, rad
_DRIFT = 0.5
#: steady enough for an orbit to close, growth over the window
_STEADY = 0.3


def kind_of_orbit(
    values: NDArray[np.float64], line: ChatterLine, growth: float, noise: float
) -> tuple[str, int]:
    """Name the bifurcation of a motion that does not repeat from period to period.

    Parameters
    ----------
    values : (periods, points, k) array of float
        The later part of the record.
    line : ChatterLine
        Of the same values.
    growth : float
        Logarithm of the growth a period.
    noise : float
        Rms of the noise of one sample.

    Returns
    -------
    str, int
        "flip" and 2; "period-n" and n; "hopf" and 0.
    """
    count = len(values)
    if abs(math.pi - line.rotation) * count < _DRIFT:
        return "flip", 2
    if abs(growth) * count > _STEADY:
        return "hopf", 0
    for period in range(2, min(_LONGEST, count // 3) + 1):
        if _unexplained(values, period, noise) < _UNEXPLAINED:
            return ("flip", 2) if period == 2 else ("period-n", period)
    return "hopf", 0


def _unexplained(values: NDArray[np.float64], period: int, noise: float) -> float:
    """Share of the variance from period to period that an orbit of this length leaves."""
    count, points, channels = values.shape
    total = np.sum((values - values.mean(axis=0)) ** 2)
    left = sum(
        np.sum((values[first::period] - values[first::period].mean(axis=0)) ** 2)
        for first in range(period)
    )
    by_noise = noise**2 * points * channels
    left = max(left - by_noise * (count - period), 0.0)
    return float(left / max(total - by_noise * (count - 1), 1e-300))
