"""One record against what the others make of its blow: gain, timing, and what is left over."""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.frf.hammer.consensus import AlignedSet, common_function, predicted, unpredictable
from dynamics.frf.hammer.hit import NORMAL_MAD

#: lengths of the segments in which the residual is judged, samples
SEGMENT_LENGTHS = (1, 8, 32, 128, 512)
#: chance that noise alone exceeds the limit of a segment
_CHANCE = 1e-10
#: share of the largest response below which nothing left over matters
_LEAST_SHARE = 0.002
#: the noise of a prediction comes in bursts, where a blow has force the others lack
_BURSTS = 1.6
#: crest of a slow movement over its standard deviation
_CREST = 2.5
#: allowance for a noise estimate that is a little low
_NOISE_MARGIN = 1.08


@dataclass(frozen=True)
class Comparison:
    """How one record differs from the prediction of others."""

    gain: float  # response over predicted response; negative where the sign is turned
    delay: float  # samples by which the response comes late
    #: root of the share of the energy of the ringing that gain and delay do not explain, what noise
    #: and the unpredictable part may contribute taken off
    misfit: float
    response: NDArray[np.float64]  # (m,)
    #: (m,), response less prediction with that gain and delay, in its unit
    residual: NDArray[np.float64]
    envelope: NDArray[np.float64]  # (m,), largest predicted response nearby
    #: (m,), that the blow may cause beyond what the others can tell
    unpredictable: NDArray[np.float64]
    #: (m,), deviation of the residual where nothing but noise is left over
    noise: NDArray[np.float64]
    wander: float  # standard deviation of slow movements of the rest level


@dataclass(frozen=True)
class Excess:
    """Where a residual exceeds most what noise and tolerance allow."""

    ratio: float  # root mean square over its limit; above 1 it is no chance
    start: int  # segment of the aligned record, samples
    stop: int  # segment of the aligned record, samples
    size: float  # largest absolute residual in the segment


@dataclass(frozen=True)
class Limits:
    """What counts as a deviation, given how far the agreeing records scatter."""

    gain: float  # of `Comparison.gain` from 1
    delay: float  # of `Comparison.delay` from 0, samples
    misfit: float  # of `Comparison.misfit`
    tolerance: float  # share of the predicted response by which a residual may exceed its noise


@dataclass(frozen=True)
class RecordAssessment:
    """A record against the others: how far beyond the limits, and in what."""

    comparison: Comparison
    excess: Excess
    limits: Limits

    @property
    def severity(self) -> float:
        """Largest deviation over its limit; above 1 the record is at fault."""
        return max(
            abs(self.comparison.gain - 1.0) / self.limits.gain,
            abs(self.comparison.delay) / self.limits.delay,
            self.comparison.misfit / self.limits.misfit,
            self.excess.ratio,
        )


def compare(aligned: AlignedSet, row: int, members: NDArray[np.bool_]) -> Comparison:
    """Compare one record with the prediction of the members, itself left out.

    Members, (n,), are the records to judge it by.
    """
    others = members.copy()
    others[row] = False
    function = common_function(aligned, others)
    prediction, prediction_noise = predicted(aligned, function, row)
    spectrum = function.values * aligned.force_spectra[row]
    correlation = np.fft.irfft(
        aligned.response_spectra[row] * np.conj(spectrum), aligned.transform_length
    )
    energy = float(np.sum(prediction**2))
    height, delay = _peak(correlation)
    response = aligned.response[row]
    # a steady gain and delay are judged as such; what is left over is judged without them
    lines = np.arange(spectrum.size) / aligned.transform_length
    shifted = (height / energy) * spectrum * np.exp(-2j * np.pi * lines * delay)
    residual = response - np.fft.irfft(shifted, aligned.transform_length)[: response.size]
    unknown = unpredictable(aligned, function, row, int(others.sum()))
    explained = height**2 / energy + float(np.sum(unknown**2))
    return Comparison(
        gain=height / energy,
        delay=delay,
        misfit=_misfit(aligned, row, explained, prediction_noise),
        response=response,
        residual=residual,
        envelope=scipy.ndimage.maximum_filter1d(np.abs(prediction), 65, mode="nearest"),
        unpredictable=unknown,
        noise=_expected_noise(aligned, row, residual, prediction_noise),
        wander=float(np.hypot(aligned.wander[row], np.median(aligned.wander[others]))),
    )


def _misfit(aligned: AlignedSet, row: int, explained: float, prediction_noise: float) -> float:
    """Root of the share of the energy of the ringing that neither is explained nor can be noise."""
    samples = aligned.ringing
    total = float(np.sum(aligned.response[row, :samples] ** 2))
    noise = (aligned.noise[row] ** 2 + prediction_noise**2) * samples
    at_most_noise = noise * (_NOISE_MARGIN**2 + 6.0 * np.sqrt(2.0 / samples))
    left = max(total - explained - at_most_noise, 0.0)
    return float(np.sqrt(left / max(total - noise, 1e-3 * total)))


def _expected_noise(
    aligned: AlignedSet, row: int, residual: NDArray[np.float64], prediction_noise: float
) -> NDArray[np.float64]:
    """Standard deviation of the residual, sample by sample, where only noise is left over."""
    quiet = float(np.median(np.abs(residual))) / NORMAL_MAD
    noise = np.full(residual.size, max(quiet, float(aligned.noise[row])))
    known = slice(0, aligned.ringing + aligned.ringing // 4)  # the gate falls off behind it
    noise[known] = np.hypot(noise[known], _BURSTS * prediction_noise)
    if aligned.ringing == residual.size:
        # the end cuts the ringing off, and with it what would predict the last of it
        noise[-max(residual.size // 20, 1) :] = float(np.max(np.abs(aligned.response[row])))
    return noise


def _peak(correlation: NDArray[np.float64]) -> tuple[float, float]:
    """Signed height and lag in samples of the largest absolute value, between samples too."""
    count = correlation.size
    top = int(np.argmax(np.abs(correlation)))
    sign = 1.0 if correlation[top] > 0.0 else -1.0
    before, here, after = (sign * correlation[(top + k) % count] for k in (-1, 0, 1))
    curvature = before - 2.0 * here + after
    offset = 0.5 * (before - after) / curvature if curvature < 0.0 else 0.0
    height = here - 0.25 * (before - after) * offset
    lag = top if top <= count // 2 else top - count
    return sign * float(height), float(lag + offset)


def _means(values: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    """Means of every segment of `length` samples, by its first sample."""
    sums = np.concatenate(([0.0], np.cumsum(values)))
    return np.maximum(sums[length:] - sums[:-length], 0.0) / length


def largest_excess(comparison: Comparison, tolerance: float) -> Excess:
    """Stretch where the residual exceeds most what is allowed, over several lengths.

    Allowed are the noise, up to what chance makes of it, and a share of the predicted response
    nearby: no two blows of a hand are quite alike.

    The tolerance is the share of the predicted response nearby.
    """
    worst = Excess(0.0, 0, 0, 0.0)
    allowed = tolerance * comparison.envelope + comparison.unpredictable
    allowed += _LEAST_SHARE * float(np.max(comparison.envelope))
    square = comparison.residual**2
    for length in SEGMENT_LENGTHS:
        if length > square.size:
            break
        by_chance = float(np.sqrt(scipy.stats.chi2.isf(_CHANCE, length) / length)) * _NOISE_MARGIN
        limit = by_chance * comparison.noise + _CREST * comparison.wander + allowed
        ratio = np.sqrt(_means(square, length) / _means(limit**2, length))
        start = int(np.argmax(ratio))
        if ratio[start] > worst.ratio:
            size = float(np.max(np.abs(comparison.residual[start : start + length])))
            worst = Excess(float(ratio[start]), start, start + length, size)
    return worst
