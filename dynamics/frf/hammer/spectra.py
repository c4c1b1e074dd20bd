"""Averaged spectra of hammer records and the estimators of the FRF."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.frf.container import Frf, Point, Quantity
from dynamics.frf.hammer.examine import require_one_kind
from dynamics.frf.hammer.hit import Hit, locate_hit
from dynamics.frf.hammer.record import HammerRecord
from dynamics.frf.hammer.windows import (
    Windows,
    choose_windows,
    exponential_window,
    force_window,
    response_window,
    window_width,
)

#: force power below this share of its largest is no longer of use (-40 dB)
_FORCE_FLOOR = 1e-4
#: least force power over that of its noise
_FORCE_OVER_NOISE = 20.0
#: least coherence, averaged over neighbouring lines, in the usable band
_LEAST_COHERENCE = 0.9
#: lines over which coherence is averaged, and fewest of good coherence in a row that count
_SMOOTHED_LINES = 5
_FEWEST_LINES = 3
#: widest dip of the coherence at an antiresonance, as a share of its frequency
_WIDEST_DIP = 0.25


@dataclass(frozen=True)
class Spectra:
    """Spectra averaged over records, unscaled."""

    frequency: NDArray[np.float64]  # (n,), Hz, from 0 to half the sampling rate
    force_power: NDArray[np.float64]  # (n,), mean of |F|^2
    response_power: NDArray[np.float64]  # (n,), mean of |X|^2
    cross: NDArray[np.complex128]  # (n,), mean of X F*
    count: int  # records averaged
    noise_power: float  # that the noise of the response puts on each line
    force_noise_power: float  # that the noise of the force does
    quantity: Quantity  # of the FRF
    added_decay: float  # of the exponential window, 1/s
    response: Point  # where the response was measured
    reference: Point  # where the blows fell


Estimator = Callable[[Spectra], NDArray[np.complex128]]


def h1(spectra: Spectra) -> NDArray[np.complex128]:
    """FRF estimate S_xf / S_ff: free of bias from response noise, low where the force has noise.

    Source: J. S. Bendat and A. G. Piersol, 2010, Random Data, 4th ed., section 6.1.
    """
    return spectra.cross / np.maximum(spectra.force_power, np.finfo(np.float64).tiny)


def h2(spectra: Spectra) -> NDArray[np.complex128]:
    """FRF estimate S_xx / S_fx: free of bias from force noise, high where the response has noise.

    Source: L. D. Mitchell, 1982, "Improved methods for the FFT calculation of the frequency
    response function", Journal of Mechanical Design 104.
    """
    cross = np.conj(spectra.cross)
    return spectra.response_power / np.where(cross == 0.0, np.finfo(np.float64).tiny, cross)


def coherence(spectra: Spectra) -> NDArray[np.float64]:
    """Ordinary coherence |S_xf|^2 / (S_ff S_xx), which is H1 / H2, 0 to 1.

    Of one record alone it is 1 everywhere and says nothing.
    """
    product = spectra.force_power * spectra.response_power
    value = np.abs(spectra.cross) ** 2 / np.maximum(product, np.finfo(np.float64).tiny)
    return np.clip(value, 0.0, 1.0)


def averaged_spectra(
    records: Sequence[HammerRecord],
    windows: Windows | None = None,
    hits: Sequence[Hit] | None = None,
    transform_length: int | None = None,
) -> Spectra:
    """Window and transform the records and average their spectra.

    Records of one sampling rate and quantity are cut to the shortest; windows and hits are found
    where they are not given. A transform longer than what the windows keep (padded with zeros)
    gives closer lines that say no more. MeasurementError if the records are not of one kind or one
    holds no hit.
    """
    require_one_kind(records)
    hits = [locate_hit(record) for record in records] if hits is None else hits
    windows = choose_windows(records, hits) if windows is None else windows
    samples = max(windows.length, transform_length or 0)
    transforms = [
        np.fft.rfft(windowed(record, hit, windows), samples)
        for record, hit in zip(records, hits, strict=True)
    ]
    force = np.stack([transform[0] for transform in transforms])
    response = np.stack([transform[1] for transform in transforms])
    rate = records[0].sampling_rate
    weight = response_window(windows) * exponential_window(windows, rate)
    noise = np.mean([hit.response.noise**2 for hit in hits])
    force_noise = np.mean([hit.force.noise**2 * window_width(hit) for hit in hits])
    return Spectra(
        frequency=np.fft.rfftfreq(samples, 1.0 / rate),
        force_power=np.mean(np.abs(force) ** 2, axis=0),
        response_power=np.mean(np.abs(response) ** 2, axis=0),
        cross=np.mean(response * np.conj(force), axis=0),
        count=len(records),
        noise_power=float(noise * np.sum(weight**2)),
        force_noise_power=float(force_noise),
        quantity=records[0].quantity,
        added_decay=windows.added_decay,
        response=records[0].response_point,
        reference=records[0].reference_point,
    )


def windowed(record: HammerRecord, hit: Hit, windows: Windows) -> NDArray[np.float64]:
    """Force and response of one record, rest levels removed, windowed, shape (2, length)."""
    first = hit.onset - windows.lead
    kept = slice(first, first + windows.length)
    weight = exponential_window(windows, record.sampling_rate)
    force = (record.force[kept] - hit.force.level) * force_window(hit, first, windows)
    response = (record.response[kept] - hit.response.level) * response_window(windows)
    return np.stack([force * weight, response * weight])


def frf_from_records(
    records: Sequence[HammerRecord], estimator: Estimator = h1, transform_length: int | None = None
) -> Frf:
    """Estimate the FRF of hammer records averaged together, from 0 Hz to half the sampling rate.

    The blow is windowed off the noise of the force, the response is let down to zero once nothing
    but noise is left, and an exponential window is used only where the ringing outlasts the record;
    `Frf.added_decay` then tells by how much. Records are good ones
    (`dynamics.frf.hammer.examine.examine_records`), estimators `h1` and `h2`; for the transform
    length, samples, see `averaged_spectra`. The coherence is there where there are several records;
    `usable_band` tells where the FRF holds. MeasurementError if the records are not of one kind or
    one holds no hit.
    """
    spectra = averaged_spectra(records, transform_length=transform_length)
    return frf_of(spectra, estimator, ", ".join(record.name for record in records))


def frf_of(spectra: Spectra, estimator: Estimator, source: str) -> Frf:
    """FRF of averaged spectra."""
    return Frf(
        frequency=spectra.frequency,
        values=estimator(spectra),
        quantity=spectra.quantity,
        response=spectra.response,
        reference=spectra.reference,
        coherence=coherence(spectra) if spectra.count > 1 else None,
        source=source,
        added_decay=spectra.added_decay,
    )


def usable_band(spectra: Spectra) -> tuple[float, float]:
    """Band over which the blows had force enough and the response followed it.

    The force must stand within 40 dB of its strongest line and clear of its noise, and the
    coherence (for one record, the share of the response power that is not noise) must be 0.9 on
    average over neighbouring lines. From the largest response the band reaches up and down over
    all such lines; dips narrower than a quarter of their frequency, antiresonances, are passed
    over.

    Lowest and highest frequency, Hz.
    """
    frequency = spectra.frequency
    least_force = max(
        _FORCE_FLOOR * float(spectra.force_power.max()),
        _FORCE_OVER_NOISE * spectra.force_noise_power,
    )
    good = (spectra.force_power >= least_force) & (_followed(spectra) >= _LEAST_COHERENCE)
    good = scipy.ndimage.binary_opening(good, structure=np.ones(_FEWEST_LINES, dtype=bool))
    good[0] = False
    if not good.any():
        strong = spectra.force_power >= least_force
        return float(frequency[1]), float(max(frequency[strong][-1], frequency[2]))
    peak = int(np.argmax(np.where(good, spectra.response_power, 0.0)))
    lines = frequency[good]
    wide = np.flatnonzero(lines[1:] > (1.0 + _WIDEST_DIP) * lines[:-1] + 2.0 * frequency[1])
    index = int(np.searchsorted(lines, frequency[peak]))
    below, above = wide[wide < index], wide[wide >= index]
    first = int(below[-1]) + 1 if below.size else 0
    last = int(above[0]) if above.size else lines.size - 1
    return float(lines[first]), float(lines[last])


def _followed(spectra: Spectra) -> NDArray[np.float64]:
    """Share of the response power that follows the force, averaged over neighbouring lines."""
    power = scipy.ndimage.uniform_filter1d(spectra.response_power, _SMOOTHED_LINES, mode="nearest")
    share = 1.0 - spectra.noise_power / np.maximum(power, np.finfo(np.float64).tiny)
    if spectra.count == 1:
        return share
    measured = scipy.ndimage.uniform_filter1d(
        coherence(spectra) * spectra.response_power, _SMOOTHED_LINES, mode="nearest"
    )
    return np.minimum(share, measured / np.maximum(power, np.finfo(np.float64).tiny))
