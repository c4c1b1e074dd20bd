"""Noise floor of signals, from the residual of them beside a model."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

#: white noise has a periodogram of an exponential distribution, whose median is this share of it
_MEDIAN = math.log(2.0)


def white_level(residual: NDArray[np.float64]) -> float:
    """Standard deviation of the white noise in a residual, whatever stands out of it in lines.

    The median over the lines of the periodogram forgets lines and resonances that fill less than
    half of the band.
    """
    lines = np.abs(np.fft.rfft(residual - residual.mean())[1:-1]) ** 2
    if lines.size < 4:
        return float(np.std(residual))
    return math.sqrt(float(np.median(lines)) / _MEDIAN / residual.size)
