"""Frequency of the spindle's revolution by the spacing of lines, or by a tacho."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.detection.spectral.chatter_lines import (
    MOST_TEETH,
    Comb,
    harmonics_significance,
    strongest_line,
)
from chatter.detection.spectral.spectra import Frames, mean_of
from chatter.detection.spectral.tacho_pulses import MOST_PULSES

Array = NDArray[np.float64]

#: logarithm above the floor from which a bin counts, and at most
_COUNTS, _AT_MOST = 1.5, 5.0
#: multiples of the spacing that are added up, at the least and per tooth
_MULTIPLES, _PER_TOOTH = 20, 4
#: share of the range of frequencies up to which spacings are taken
_RANGE = 0.5


class Spacing(NamedTuple):
    """The spacing of lines, and how sure it is."""

    frequency: float  # Hz
    score: float  # mean autocorrelation at its multiples
    significance: float  # standard deviations above the scores of other spacings


def line_autocorrelations(frames: Frames) -> Array:
    """Autocorrelation over frequency of what stands above the floor, of each frame, (m, b).

    Lines at c + k f, whatever c is, put peaks at the multiples of f: harmonics of the spindle do,
    and so does a chatter frequency with its sidebands.
    """
    count = frames.frequency.size
    size = scipy.fft.next_fast_len(2 * count, real=True)
    found = np.empty_like(frames.above)
    for row, above in enumerate(frames.above):
        lines = np.clip(above - _COUNTS, 0.0, _AT_MOST)
        spectrum = np.abs(scipy.fft.rfft(lines - lines.mean(), size)) ** 2
        found[row] = scipy.fft.irfft(spectrum, size)[:count]
    return found / np.maximum(found[:, :1], 1e-300)


def spacing_scores(autocorrelation: Array, step: float, spacings: Array, teeth: int) -> Array:
    """Mean autocorrelation at the multiples of each spacing, Hz."""
    highest = _RANGE * autocorrelation.size * step
    most = max(_MULTIPLES, _PER_TOOTH * teeth)
    at = spacings[:, None] * np.arange(1, most + 1)
    inside = at < highest
    inside[:, 0] = True
    values = np.interp(at / step, np.arange(autocorrelation.size), autocorrelation)
    norm = autocorrelation[0] if autocorrelation[0] > 0.0 else 1.0
    return np.sum(values * inside, axis=1) / inside.sum(axis=1) / norm


def best_spacing(
    autocorrelation: Array, step: float, low: float, high: float, teeth: int = 1
) -> Spacing:
    """Spacing between two frequencies, Hz, with the largest score."""
    finest = step / (4.0 * max(_MULTIPLES, _PER_TOOTH * teeth))
    count = max(int((high - low) / finest), 8) + 1
    spacings = np.linspace(low, high, count)
    scores = spacing_scores(autocorrelation, step, spacings, teeth)
    best = int(np.argmax(scores))
    others = scores[np.abs(spacings - spacings[best]) > 2.0 * step]
    if others.size < 8:
        return Spacing(float(spacings[best]), float(scores[best]), math.nan)
    centre = float(np.median(others))
    spread = 1.4826 * float(np.median(np.abs(others - centre))) or 1e-12
    return Spacing(
        float(spacings[best]), float(scores[best]), (float(scores[best]) - centre) / spread
    )


class Revolution(NamedTuple):
    """Frequency of the spindle over the frames, and where it is from."""

    frequency: Array  # (m,) Hz, of each frame
    uncertainty: float  # relative
    source: str  # "tacho", "given", "given, refined by the spectrum" or "spectrum"
    mean: float  # Hz, over the recording
    #: of the spectrum alone: the spacing of lines may be that of several teeth
    may_be_multiple: bool = False
    #: of a tacho: pulses a revolution, and whether it may have more, of which no lines tell
    pulses: int = 1
    may_have_more_pulses: bool = False

    def with_pulses(self, pulses: int) -> Revolution:
        """The same pulses of a tacho, so many of them a revolution."""
        factor = self.pulses / pulses
        return self._replace(
            frequency=self.frequency * factor, mean=self.mean * factor, pulses=pulses
        )


#: source of a stated speed that the lines correct
REFINED = "given, refined by the spectrum"
#: standard deviations from which a spacing is believed, alone and beside a given speed
CERTAIN, PLAUSIBLE = 10.0, 8.0
#: range about a given speed in which the true one is searched; the near part of it is preferred
#: unless the rest scores better by a factor
ABOUT_GIVEN, _NEAR_GIVEN, BETTER = 0.12, 0.015, 1.4
#: relative uncertainty of a frequency given, read off a spectrum, and by a tacho
_GIVEN, _READ, _BY_TACHO = 5e-3, 1e-3, 5e-4
#: relative variation of the speed from frame to frame that is followed, and frames taken together
VARIATION, _TOGETHER = 0.015, 1
#: share of the power of a line that a fraction of the spacing has to hold; what its frequency is
#: known to, of a line width and relative by that of the spacing
_LARGE, _LINE, _SPACING = 0.1, 0.2, 1.5e-4
#: pulses that tell what is usual near one, relative difference of a period that misses one, and of
#: neighbours of a spindle that turns; share of the periods that are as they should be
_NEARBY, _MISSING, _STEADY, _MOST = 9, 0.25, 0.05, 0.6
#: difference of a number of pulses a revolution from a whole one
_WHOLE = 0.25
#: lowest and highest frequency of a spindle, Hz
_SLOWEST, FASTEST = 3.0, 700.0


def about_given(long: Frames, frames: Frames, given: float, teeth: int) -> Revolution:
    """Frequency over the frames, where one is given, Hz: the lines near it decide."""
    mean = mean_about_given(long, given, teeth)
    return stated_alone(frames, given) if mean is None else over_frames(frames, mean, teeth)


def mean_about_given(long: Frames, given: float, teeth: int) -> float | None:
    """Mean frequency where one is given, Hz; None where no lines near it show it.

    What is set on the machine, and what a note says, may be some percent off. The mean is read off
    longer frames, in which lines lie further apart for their width.
    """
    everywhere = line_autocorrelations(long).sum(axis=0)
    bounds = given * (1.0 - ABOUT_GIVEN), given * (1.0 + ABOUT_GIVEN)
    found = best_spacing(everywhere, long.step, *bounds, teeth)
    near = best_spacing(
        everywhere, long.step, given * (1.0 - _NEAR_GIVEN), given * (1.0 + _NEAR_GIVEN), teeth
    )
    if not found.significance > PLAUSIBLE:
        return None
    if found.score > BETTER * near.score and explains_more(long, found, near, teeth):
        return found.frequency
    return near.frequency


def stated_alone(frames: Frames, given: float) -> Revolution:
    """Frequency as it was stated, Hz, which no lines confirm."""
    return Revolution(np.full(frames.time.size, given), _GIVEN, "given", given)


def explains_more(frames: Frames, one: Spacing, other: Spacing, teeth: int) -> bool:
    """Whether harmonics of one spacing stand out more: chatter lines lie as far from each other."""
    _, above = mean_of(frames, slice(None))
    first, second = (
        harmonics_significance(
            above,
            frames.frequency,
            Comb(found.frequency, teeth * found.frequency, 0.0, frames.half_width),
        )
        for found in (one, other)
    )
    return first > second


def slowest_of(frames: Frames) -> float:
    """Smallest spacing, Hz, at which the lines of the frames are told from each other."""
    return max(_SLOWEST, 3.0 * frames.half_width)


def from_spectrum(frames: Frames, teeth: int | None) -> float | None:
    """Frequency, Hz, by the spacing of lines alone; None where no spacing stands out.

    The spacing may be that of the teeth or of a part of them: its whole fractions are tried for
    lines of their own, which runout and unequal inserts bring.
    """
    everywhere = line_autocorrelations(frames).sum(axis=0)
    slowest = slowest_of(frames)
    found = best_spacing(everywhere, frames.step, slowest, FASTEST, 1)
    if not found.significance > CERTAIN:
        return None
    most = MOST_TEETH if teeth is None else max(teeth, 1)
    fractions = [
        parts
        for parts in range(2, most + 1)
        if found.frequency / parts > slowest
        and _has_own_lines(everywhere, frames.step, found.frequency, parts)
        and _holds_the_line(frames, found.frequency, parts)
    ]
    return found.frequency / max(fractions, default=1)


def _holds_the_line(frames: Frames, spacing: float, parts: int) -> bool:
    """Whether the strongest line off a spacing is, as exactly as it is read, on a fraction of it.

    A chatter line and its sidebands lie a spacing apart too, off the harmonics by any share of it.
    """
    power, above = mean_of(frames, slice(None))
    comb = Comb(spacing, spacing, _READ, frames.half_width)
    line = strongest_line(power, above, frames.frequency, comb)
    if not line.alone > _LARGE:
        return True
    fraction = spacing / parts
    apart = abs(line.frequency - round(line.frequency / fraction) * fraction)
    return apart < _LINE / frames.length + _SPACING * line.frequency


def _has_own_lines(autocorrelation: Array, step: float, spacing: float, parts: int) -> bool:
    """Whether lines lie a fraction of a spacing apart that no coarser spacing explains."""
    orders = np.arange(1, parts * max(_MULTIPLES // parts, 4) + 1)
    orders = orders[np.gcd(orders, parts) == 1]
    at = orders * spacing / parts
    at = at[at < _RANGE * autocorrelation.size * step]
    if at.size < 2:
        return False
    bins = np.arange(autocorrelation.size)
    own = np.interp(at / step, bins, autocorrelation).mean()
    shifts = np.linspace(0.2, 0.8, 40) * spacing / parts
    others = np.array([np.interp((at + s) / step, bins, autocorrelation).mean() for s in shifts])
    return bool(own > others.mean() + PLAUSIBLE * max(float(others.std()), 1e-12))


def over_frames(frames: Frames, mean: float, teeth: int) -> Revolution:
    """Follow the spacing from frame to frame where another than the mean is certain."""
    count, source = frames.time.size, REFINED
    found = np.full(count, np.nan)
    each = line_autocorrelations(frames)
    for row in range(count):
        together = each[max(row - _TOGETHER, 0) : row + _TOGETHER + 1].sum(axis=0)
        found[row] = speed_of_frames(together, frames.step, mean, teeth)
    certain = np.isfinite(found)
    if not certain.any():
        return Revolution(np.full(count, mean), _READ, source, mean)
    followed = np.interp(np.arange(count), np.flatnonzero(certain), found[certain])
    return Revolution(followed, _READ, source, mean)


def speed_of_frames(autocorrelation: Array, step: float, mean: float, teeth: int) -> float:
    """Spacing near the mean, Hz: the mean where none is much better, nan where none is certain."""
    bounds = mean * (1.0 - ABOUT_GIVEN), mean * (1.0 + ABOUT_GIVEN)
    found = best_spacing(autocorrelation, step, *bounds, teeth)
    if not found.significance > PLAUSIBLE or abs(found.frequency / mean - 1.0) > VARIATION:
        return math.nan
    own = best_spacing(autocorrelation, step, mean * (1.0 - _READ), mean * (1.0 + _READ), teeth)
    return own.frequency if found.score < BETTER * own.score else found.frequency


def from_tacho(
    tacho: Array, time_step: float, start: float, frames: Frames, given: float | None = None
) -> Revolution | None:
    """Frequency over the frames by the rising edges of a signal with pulses at even angles.

    One a revolution; several where the frequency that is given, Hz, says so. None of a signal that
    has no such pulses, or so many that the speed does not tell how many.
    """
    found = rates_of_pulses(tacho, time_step, start)
    if found is None:
        return None
    middle, frequency = found
    pulses = pulses_of_revolution(float(frequency.mean()), given)
    frequency = frequency / pulses
    mean = 1.0 / float(np.mean(1.0 / frequency))
    if pulses > MOST_PULSES or mean > (FASTEST if given is not None else MOST_PULSES * FASTEST):
        return None
    over = [
        1.0 / np.mean(1.0 / frequency[near]) if near.any() else mean
        for near in (np.abs(middle - t) <= 0.5 * frames.length for t in frames.time)
    ]
    return Revolution(np.array(over), _BY_TACHO, "tacho", mean, pulses=pulses)


def rates_of_pulses(
    tacho: Array, time_step: float, start: float = 0.0
) -> tuple[Array, Array] | None:
    """Times, s, and frequencies, Hz, between the pulses of a tacho; None of no such signal."""
    times = _rising_edges(tacho, time_step, start)
    if times.size < 3:
        return None
    middle, frequency = 0.5 * (times[1:] + times[:-1]), 1.0 / np.diff(times)
    usual = scipy.ndimage.median_filter(frequency, min(_NEARBY, frequency.size | 1), mode="nearest")
    is_usual = np.abs(frequency / usual - 1.0) < _MISSING
    steady = np.abs(usual[1:] / usual[:-1] - 1.0) < _STEADY
    if is_usual.mean() < _MOST or (steady.size and steady.mean() < _MOST):
        return None
    return middle[is_usual], frequency[is_usual]


def _rising_edges(tacho: Array, time_step: float, start: float) -> Array:
    """Times at which a signal rises through the middle of its range, s."""
    low, high = np.quantile(tacho, [0.02, 0.98])
    if not high > low:
        low, high = float(tacho.min()), float(tacho.max())
    level = 0.5 * (low + high)
    above = tacho > level
    edges = np.flatnonzero(above[1:] & ~above[:-1]) + 1
    before, after = tacho[edges - 1], tacho[edges]
    return start + (edges - 1 + (level - before) / (after - before)) * time_step


def pulses_of_revolution(frequency: float, given: float | None) -> int:
    """Pulses a revolution: those that a frequency that is given, Hz, has."""
    if given is None:
        return 1
    ratio = frequency / given
    return round(ratio) if ratio > 1.5 and abs(ratio - round(ratio)) < _WHOLE else 1
