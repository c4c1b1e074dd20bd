"""Power spectra of short frames of a recording, and what stands above their noise floor."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.detection.spectral.recording import Recording

Array = NDArray[np.float64]

#: highest frequency of milling chatter that is searched, Hz, and the lowest of any line
_HIGHEST, _LOWEST = 5000.0, 15.0
#: share of the sampling frequency up to which converters are trusted
_BELOW_NYQUIST = 0.45
#: zero padding: bins per line width
_PADDING = 2
#: half width of a line of a Hann window, in bins of the unpadded frame (its first zero)
HALF_WIDTH = 2.0
#: width of the noise floor's median, in line half widths
_FLOOR_WIDTH = 24.0
#: least ratio of a line to what is there at rest
RATIO_AT_REST = 10.0
#: power over that of the largest bin under which a spectrum is that of the window, or rounding
_ROUNDING = 1e-7


class Frames(NamedTuple):
    """Power spectra of frames that overlap."""

    time: Array  # (m,) s, middle of each frame
    frequency: Array  # (b,) Hz
    power: Array  # (m, b), channels of unit power added up
    above: Array  # (m, b), logarithm of the power above the noise floor
    length: float  # s, of a frame

    @property
    def step(self) -> float:
        """Distance of the bins, Hz."""
        return float(self.frequency[1] - self.frequency[0])

    @property
    def half_width(self) -> float:
        """Half the width of a line, Hz."""
        return HALF_WIDTH / self.length


def frames_of(recording: Recording, length: float, hop: float) -> Frames:
    """Spectra of frames of a length, s, one every hop, s; the last ends with the recording."""
    samples = min(round(length / recording.time_step), len(recording.values))
    length = samples * recording.time_step
    last = len(recording.values) - samples
    count = max(math.ceil(last * recording.time_step / hop), 1) if last else 0
    starts = np.unique(np.linspace(0, last, count + 1).round().astype(np.intp))
    frequency, spectra = _channel_spectra(recording, starts, samples)
    power = added_up(spectra)
    middle = recording.start + (starts + 0.5 * samples) * recording.time_step
    return Frames(middle, frequency, power, above_floor(power, frequency, length), length)


def spectrum_of(recording: Recording) -> tuple[Array, Array]:
    """Frequency (b,), Hz, and power of each channel (k, b) over a whole recording."""
    first = np.zeros(1, dtype=np.intp)
    frequency, spectra = _channel_spectra(recording, first, len(recording.values))
    return frequency, spectra[:, 0]


def _channel_spectra(
    recording: Recording, starts: NDArray[np.intp], samples: int
) -> tuple[Array, Array]:
    """Frequency (b,), Hz, and power of each channel and frame (k, m, b), weighted."""
    size = scipy.fft.next_fast_len(_PADDING * samples, real=True)
    frequency = scipy.fft.rfftfreq(size, recording.time_step)
    highest = min(_HIGHEST, _BELOW_NYQUIST / recording.time_step)
    frequency = frequency[frequency <= highest]
    window = np.hanning(samples)
    spectra = np.empty((recording.values.shape[1], starts.size, frequency.size))
    for row, start in enumerate(starts):
        values = recording.values[start : start + samples]
        values = (values - values.mean(axis=0)) * window[:, None]
        spectra[:, row] = np.abs(scipy.fft.rfft(values.T, size)[:, : frequency.size]) ** 2
    for channel, slope in zip(spectra, recording.slopes, strict=True):
        channel *= np.where(frequency < _LOWEST, 0.0, frequency ** (2.0 * slope))
    return frequency, spectra


def added_up(spectra: Array) -> Array:
    """Power of frames (m, b): channels (k, m, b), each over its mean power, added up."""
    total = spectra.sum(axis=2).mean(axis=1)
    return np.sum(spectra / np.where(total > 0.0, total, 1.0)[:, None, None], axis=0)


def above_floor(power: Array, frequency: Array, length: float) -> Array:
    """Logarithm of spectra (..., b) above their noise floor, a median over neighbouring bins."""
    least = _ROUNDING * power.max(axis=-1, keepdims=True) + 1e-300
    logarithm = np.log(power + least)
    step = float(frequency[1] - frequency[0])
    width = round(_FLOOR_WIDTH * HALF_WIDTH / (length * step)) | 1
    flat = logarithm.reshape(-1, logarithm.shape[-1])
    floor = np.array([scipy.ndimage.median_filter(one, width) for one in flat])
    return logarithm - floor.reshape(logarithm.shape)


def mean_of(frames: Frames, rows: slice | NDArray[np.bool_]) -> tuple[Array, Array]:
    """Mean spectrum (b,) of some frames, and its logarithm above the floor."""
    power = frames.power[rows].mean(axis=0)
    return power, above_floor(power, frames.frequency, frames.length)
