"""A residual split into harmonics of the spindle and what lies between them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.variables import spindle_angle

Array = NDArray[np.float64]

#: samples of a run that are examined, and the fewest a harmonic
_MOST_SAMPLES, _SAMPLES_A_HARMONIC = 6000, 6
#: of a harmonic the fewest samples a cycle
_SAMPLES_A_CYCLE = 2.2
#: lines on each side over which the level beside a line is read
_BESIDE = 12


class Split(NamedTuple):
    """One channel of one run, in the frequency domain; squares are over those of the noise.

    Parameters
    ----------
    orders : (k,) array of int
        Of the spindle.
    at_orders : (k,) array
        Sum of squares at each; 2 for noise.
    frequency : (m,) array
        Hz.
    density, whole : (m,) array
        Of what lies between the harmonics, and of everything; 1 for noise.
    beside : (m,) array
        Level beside lines.
    samples : int
    """

    orders: NDArray[np.intp]
    at_orders: Array
    frequency: Array
    density: Array
    whole: Array
    beside: Array
    samples: int


class Harmonics:
    """Harmonics of the spindle in one run, shared by its channels."""

    def __init__(self, residual: ChannelResidual) -> None:
        angle = spindle_angle(residual)[:_MOST_SAMPLES]
        self.samples = angle.size
        self.step = residual.step
        a_sample = float(np.median(np.diff(angle)))
        highest = int(2.0 * math.pi / (a_sample * _SAMPLES_A_CYCLE))
        count = max(1, min(highest, self.samples // (2 * _SAMPLES_A_HARMONIC)))
        self.orders = np.arange(1, count + 1)
        columns = [np.ones((self.samples, 1))]
        phase = np.outer(angle, self.orders)
        pairs = np.stack((np.cos(phase), np.sin(phase)), axis=2).reshape(self.samples, -1)
        self.basis = np.linalg.qr(np.hstack([*columns, pairs]))[0]
        self.window = np.hanning(self.samples)
        self.frequency = np.fft.rfftfreq(self.samples, self.step)

    def split(self, residual: ChannelResidual) -> Split:
        """Split one channel of the run."""
        values = residual.normalised[: self.samples]
        parts = self.basis.T @ values
        between = values - self.basis @ parts
        density = self._density(between)
        return Split(
            self.orders,
            np.sum(parts[1:].reshape(-1, 2) ** 2, axis=1),
            self.frequency,
            density,
            self._density(values),
            _level_beside(density),
            self.samples,
        )

    def _density(self, values: Array) -> Array:
        lines = np.abs(np.fft.rfft(values * self.window)) ** 2
        return lines / np.sum(self.window**2)


def _level_beside(density: Array) -> Array:
    """Running median of a periodogram, as the mean of one without lines."""
    padded = np.pad(density, _BESIDE, mode="reflect" if density.size > _BESIDE else "edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * _BESIDE + 1)
    return np.median(windows, axis=1) / math.log(2.0)
