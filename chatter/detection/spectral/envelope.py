"""The envelope of a line: a limit cycle keeps its amplitude, a mode that noise shakes does not."""

from __future__ import annotations

import numpy as np
import scipy

from chatter.detection.spectral.recording import Recording

#: share of the distance to the next harmonic within which a line is taken alone
_WITHIN = 0.8
#: lines of the spectrum that an envelope takes, and share of it that the window spoils at each end
_FEWEST, _ENDS = 6, 0.05


def envelope_kurtosis(
    recording: Recording, begin: float, end: float, line: float, revolution: float
) -> float:
    """Mean fourth power of the envelope of a line over the square of its mean square.

    1 for a constant amplitude, 2 for a mode shaken by Gaussian noise, whose envelope is Rayleigh's
    (Rice 1944, Bell System Technical Journal 23, 282). The kurtosis of the signal is 1.5 times as
    much, by which harmonic and structural modes differ (Brincker, Andersen and Moller 2000,
    IMAC XVIII, 924). nan where the frames are too short for it.

    Parameters
    ----------
    recording : Recording
        The channel with most power in the line is taken.
    begin, end : float
        s.
    line, revolution : float
        Hz.
    """
    first = max(round((begin - recording.start) / recording.time_step), 0)
    last = round((end - recording.start) / recording.time_step)
    values = recording.values[first:last]
    # the transform of a length with a large prime factor takes twenty times as long
    padded = scipy.fft.next_fast_len(len(values), real=True)
    frequency = scipy.fft.rfftfreq(padded, recording.time_step)
    order = line / revolution
    to_harmonic = abs(order - round(order)) * revolution
    band = np.abs(frequency - line) < _WITHIN * to_harmonic
    if band.sum() < _FEWEST:
        return float("nan")
    spectra = scipy.fft.rfft(values - values.mean(axis=0), padded, axis=0)[band]
    strongest = int(np.argmax(np.sum(np.abs(spectra) ** 2, axis=0)))
    window = np.hanning(int(band.sum()) + 2)[1:-1]
    envelope = np.abs(scipy.fft.ifft(spectra[:, strongest] * window))
    inside = envelope[: round(envelope.size * len(values) / padded)]
    ends = max(round(_ENDS * inside.size), 1)
    square = inside[ends:-ends] ** 2
    return float(np.mean(square**2) / np.mean(square) ** 2)
