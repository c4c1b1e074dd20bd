"""Peaks of FRFs: those of a smooth curve, and those that stand out from the noise of a test."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.signal import find_peaks

from chatter.io.result_files import finite_or_none
from dynamics.frf.container import Frf

#: a peak stands out by this factor, at the least, from the higher of the valleys that part it
#: from higher peaks: a mode of 40 % damping alone does
_STANDS_OUT = 1.05
#: lines around a peak that tell how noisy a test is
_NEIGHBOURS = 41
#: standard deviations by which a peak stands out: noise itself goes up and down by 7 in 2000 lines
_SURE = 10.0
#: the same from the scatter that the coherence tells, which counts single averages
_SURE_OF_COHERENCE = 3.0
#: of the third difference of white noise, over that of the noise itself
_THIRD_DIFFERENCE = np.sqrt(20.0)
#: median of |x| of a normal distribution, over its standard deviation
_MEDIAN = 0.6745


def peaks(frf: Frf) -> list[dict]:
    """Peaks of the magnitude of a smooth curve: frequency, height and damping by half power.

    The damping is None where a neighbour hides the flanks.
    """
    return _peaks(frf, np.full(len(frf.values), np.log(_STANDS_OUT)))


def peaks_of_test(frf: Frf) -> list[dict]:
    """Peaks that stand out from the noise of a test, as `peaks`.

    Noise is told from the roughness of the logarithm around each line, which also shows what is
    the same in every average (friction, motion), and from the coherence.
    """
    wanted = np.maximum(np.log(_STANDS_OUT), _SURE * _roughness(frf))
    if frf.coherence is not None:
        coherence = np.clip(frf.coherence, 1e-12, 1.0)
        # Bendat and Piersol 2010, Random Data, table 9.6, for one average
        scatter = np.sqrt((1.0 - coherence) / (2.0 * coherence))
        wanted = np.maximum(wanted, _SURE_OF_COHERENCE * scatter)
    return _peaks(frf, wanted)


def _peaks(frf: Frf, wanted: NDArray[np.float64]) -> list[dict]:
    """Peaks whose logarithm stands out by what is wanted at their line."""
    height = np.abs(frf.values)
    level = np.log(np.maximum(height, np.finfo(np.float64).tiny))
    places, told = find_peaks(level, prominence=0.0)
    found = []
    for place in places[told["prominences"] >= wanted[places]]:
        top, at = _vertex(frf.frequency, height, place)
        damping = _half_power(frf.frequency, height, place, top, at)
        found.append({"frequency_Hz": at, "magnitude": top, "damping": finite_or_none(damping)})
    return found


def _roughness(frf: Frf) -> NDArray[np.float64]:
    """Standard deviation of the logarithm of the magnitude about a smooth curve, by line."""
    height = np.abs(frf.values)
    level = np.log(np.maximum(height, np.finfo(np.float64).tiny))
    if len(level) < 5:
        return np.zeros(len(level))
    # cubic trends, such as the flanks of a peak, leave no third difference
    third = np.abs(np.diff(level, 3))
    size = min(_NEIGHBOURS, 2 * (len(third) // 2) - 1)
    around = median_filter(third, size=max(size, 1), mode="nearest")
    return np.pad(around, (1, 2), mode="edge") / (_MEDIAN * _THIRD_DIFFERENCE)


def _vertex(frequency: NDArray, height: NDArray, place: int) -> tuple[float, float]:
    """Height and frequency of the parabola through a peak and its neighbours."""
    f, y = frequency[place - 1 : place + 2], height[place - 1 : place + 2]
    bend, slope, _ = np.polyfit(f - f[1], y, 2)
    if bend >= 0.0:
        return float(y[1]), float(f[1])
    off = -0.5 * slope / bend
    return float(y[1] + 0.5 * slope * off), float(f[1] + off)


def _half_power(frequency: NDArray, height: NDArray, place: int, top: float, at: float) -> float:
    level = top / np.sqrt(2.0)
    sides = []
    for way in (-1, 1):
        line = place
        while 0 < line < len(height) - 1 and height[line] > level:
            if (height[line + way] - height[line]) > 0.0 and line != place:
                return float("nan")
            line += way
        if height[line] > level:
            return float("nan")
        inner = line - way
        share = (height[inner] - level) / (height[inner] - height[line])
        sides.append(frequency[inner] + share * (frequency[line] - frequency[inner]))
    return float((sides[1] - sides[0]) / (2.0 * at))
