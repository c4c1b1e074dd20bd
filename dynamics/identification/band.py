"""Which lines of the measured FRFs can be used."""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

#: median signal over noise, and median coherence, of lines in which modes are looked for
SEARCHED_SIGNAL_TO_NOISE = 2.0
SEARCHED_COHERENCE = 0.3

#: the same for lines that belong to the band without a mode in them
CLEAN_SIGNAL_TO_NOISE = 5.0
CLEAN_COHERENCE = 0.7

#: signal over noise of a resonance that stands alone in a noisy part
RESONANCE_TO_NOISE = 8.0

#: noise, relative to the peak of the FRF as measured, of lines without a mode in them
MOST_NOISE_OF_PEAK = 0.015

#: level at the low end, relative to the largest resonance, below which it is no rigid line
RISE_TO_RESONANCE = 0.7

#: lines in a row, most of which must be good where the band begins or ends: at most, and a part
#: of all lines
RUN, RUN_SHARE = 10, 0.05

#: lines over which signal and coherence are smoothed by their median: at most, and a part
SMOOTHING, SMOOTHING_SHARE = 15, 0.02

#: a band with fewer lines is not used
LEAST_LINES = 16

#: half-power bandwidths on either side of a mode that belong to the band with it
BANDWIDTHS_OF_A_MODE = 1.5


@dataclass(frozen=True)
class Band:
    """Part of the frequency axis that is fitted."""

    lowest: float  # Hz
    highest: float  # Hz
    reason: str  # why it begins and ends there, for people


def usable_bands(
    frequency: NDArray[np.float64],
    receptance: NDArray[np.complex128],
    noise: NDArray[np.float64],
    derivative: int,
    coherence: NDArray[np.float64] | None = None,
) -> tuple[Band, Band]:
    """Find the lines on which the FRFs stand out of the noise.

    From either end lines are dropped until signal, noise and (where known) coherence are good in
    nearly all of the following lines: antiresonances inside the band do not end it. At the low
    end lines are dropped, too, while the receptance there stands above every resonance: drift, a
    mass line or noise divided by the square of a small frequency.

    Frequencies (n,), Hz, above zero; receptance (n, k), m/N, the standard deviation of its noise,
    and coherence where it is known; derivative 0, 1 or 2 of the quantity measured, receptance,
    mobility or accelerance. The band in which modes are looked for, and the part of it with little
    noise.
    """
    signal = np.stack([_running_median(np.abs(h)) for h in receptance.T], axis=1)
    ratio = np.max(signal / noise, axis=1)
    agreement = np.ones(frequency.size)
    if coherence is not None:
        agreement = np.max([_running_median(c) for c in coherence.T], axis=0)
    good = (ratio >= SEARCHED_SIGNAL_TO_NOISE) & (agreement >= SEARCHED_COHERENCE)
    first, last = _with_resonances(np.max(np.abs(receptance) / noise, axis=1), *_trim(good))
    start = _above_rigid_line(frequency, np.max(signal, axis=1), first, last)
    low = "noise" if first else "first line"
    low = "receptance above every resonance" if start > first else low
    high = "noise" if last < frequency.size - 1 else "last line"
    if last - start + 1 < LEAST_LINES:
        whole = Band(float(frequency[0]), float(frequency[-1]), "no part is free of noise")
        return whole, whole
    searched = Band(float(frequency[start]), float(frequency[last]), _reason(low, high))
    scale = (2.0 * np.pi * frequency[:, None]) ** derivative
    peak = np.max((np.abs(receptance) * scale)[start : last + 1], axis=0)
    good = np.min(noise * scale / peak, axis=1) <= MOST_NOISE_OF_PEAK
    good &= (ratio >= CLEAN_SIGNAL_TO_NOISE) & (agreement >= CLEAN_COHERENCE)
    inner_first, inner_last = _trim(good)
    low = "noise" if inner_first > start else low
    high = "noise" if inner_last < last else high
    start, last = max(start, inner_first), min(last, inner_last)
    if last - start + 1 < LEAST_LINES:
        return searched, searched
    return searched, Band(float(frequency[start]), float(frequency[last]), _reason(low, high))


def _reason(low: str, high: str) -> str:
    return f"below: {low}; above: {high}"


def widened(
    clean: Band,
    searched: Band,
    frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    spacing: float,
) -> Band:
    """Widen a band to hold the modes that were found in its noisy surroundings.

    Modes by frequency, Hz, and damping (m,); spacing of the lines, Hz.
    """
    inside = (frequency >= searched.lowest) & (frequency <= searched.highest)
    reach = BANDWIDTHS_OF_A_MODE * 2.0 * (damping * frequency)[inside]
    reach = np.maximum(reach, RUN * spacing)
    lowest = min([clean.lowest, *(float(f) for f in frequency[inside] - reach)])
    highest = max([clean.highest, *(float(f) for f in frequency[inside] + reach)])
    return Band(max(lowest, searched.lowest), min(highest, searched.highest), clean.reason)


def _running_median(values: NDArray[np.float64]) -> NDArray[np.float64]:
    half = int(min(SMOOTHING, SMOOTHING_SHARE * values.size)) // 2
    return scipy.ndimage.median_filter(values, size=2 * half + 1, mode="nearest")


def _run(lines: int) -> int:
    return max(2, min(RUN, int(RUN_SHARE * lines)))


def _trim(good: NDArray[np.bool_]) -> tuple[int, int]:
    """First and last good line with a run of good lines beside it; everything where none is."""
    run = _run(good.size)
    share = np.convolve(good, np.ones(run), mode="valid") / run
    starts = np.flatnonzero((share >= 0.8) & good[: share.size])
    ends = np.flatnonzero((share >= 0.8) & good[run - 1 :])
    if starts.size == 0 or ends.size == 0:
        return 0, good.size - 1
    return int(starts[0]), int(ends[-1] + run - 1)


def _with_resonances(ratio: NDArray[np.float64], first: int, last: int) -> tuple[int, int]:
    """Widen a band by resonances beyond its ends: three lines in a row well above the noise."""
    high = ratio >= RESONANCE_TO_NOISE
    row = np.flatnonzero(high[:-2] & high[1:-1] & high[2:])
    if row.size == 0:
        return first, last
    run = _run(ratio.size)
    return max(min(first, int(row[0]) - run), 0), min(max(last, int(row[-1]) + run), high.size - 1)


def _above_rigid_line(
    frequency: NDArray[np.float64], level: NDArray[np.float64], first: int, last: int
) -> int:
    """First line from which the largest receptance is a resonance and not the low end."""
    start = first
    while start < last:
        peak = start + int(np.argmax(level[start : last + 1]))
        rises = level[start] < RISE_TO_RESONANCE * level[peak]
        if peak - start > _run(level.size) // 2 or rises:
            return start
        start = peak + 1
        if frequency[start] > frequency[first] + 0.3 * (frequency[last] - frequency[first]):
            break
    return first
