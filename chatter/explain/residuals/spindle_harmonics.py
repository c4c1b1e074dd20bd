"""Harmonics of the spindle in a run of milling, and what lies between them."""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.variables import spindle_angle

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: samples of a run that are examined, and the fewest a harmonic
_MOST_SAMPLES, _SAMPLES_A_HARMONIC = 6000, 6
#: of a harmonic the fewest samples a cycle
_SAMPLES_A_CYCLE = 2.2
#: share of the diagonal that keeps the harmonics of a short record apart
_RIDGE = 1e-9
#: lines on each side over which the level beside a line is read
_BESIDE = 12
#: rad of the highest harmonic by which a spindle that turns evenly is off, as digits are written
_EVEN = 1e-2


class Split(NamedTuple):
    """One channel of one run, in the frequency domain; squares are over those of the noise."""

    orders: NDArray[np.intp]  # (k,), of the spindle
    at_orders: Array  # (k,), sum of squares at each; 2 for noise
    frequency: Array  # (m,), Hz
    density: Array  # (m,), of what lies between the harmonics; 1 for noise
    whole: Array  # (m,), of everything
    beside: Array  # (m,), level beside lines
    samples: int


class SpindleHarmonics:
    """Harmonics of the spindle in one run, shared by its channels."""

    def __init__(self, residual: ChannelResidual) -> None:
        angle = spindle_angle(residual)[:_MOST_SAMPLES]
        self.samples = angle.size
        self.step = residual.step
        a_sample = float(np.median(np.diff(angle)))
        highest = int(2.0 * math.pi / (a_sample * _SAMPLES_A_CYCLE))
        count = max(1, min(highest, self.samples // (2 * _SAMPLES_A_HARMONIC)))
        self.orders = np.arange(1, count + 1)
        self.turns = phases_of(angle, count)
        gram = _gram(self.turns.powers_summed(), count)
        # of less than a revolution harmonics are collinear
        gram[np.diag_indices_from(gram)] += _RIDGE * self.samples
        self.factor = np.linalg.cholesky(gram)
        self.window = np.hanning(self.samples)
        self.frequency = np.fft.rfftfreq(self.samples, self.step)

    def split(self, residual: ChannelResidual) -> Split:
        """Split one channel of the run."""
        values = residual.normalised[: self.samples]
        sums = self.turns.products(values)
        right = np.concatenate([[values.sum()], np.column_stack([sums.real, sums.imag]).ravel()])
        parts = scipy.linalg.solve_triangular(self.factor, right, lower=True)
        amplitudes = scipy.linalg.solve_triangular(self.factor, parts, lower=True, trans="T")
        between = values - amplitudes[0]
        between -= self.turns.combined(amplitudes[1::2] - 1j * amplitudes[2::2]).real
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


class Phases:
    """Powers 1 to m of turns exp(i angle) (n,)."""

    def __init__(self, angle: Array, count: int) -> None:
        turn = np.exp(1j * angle)
        self._powers = np.empty((count, angle.size), dtype=np.complex128)
        self._powers[0] = turn
        for before, power in itertools.pairwise(self._powers):
            np.multiply(before, turn, out=power)

    def powers_summed(self) -> Complex:
        """Sums over the samples of the powers 0 to 2 m."""
        powers = self._powers
        return np.concatenate([[powers.shape[1]], powers.sum(axis=1), powers @ powers[-1]])

    def products(self, values: Array) -> Complex:
        """Sums (m,) of values (n,) times the powers."""
        return self._powers @ values

    def combined(self, amplitudes: Complex) -> Complex:
        """Sum (n,) of the powers, with an amplitude (m,) each."""
        return amplitudes @ self._powers


class EvenPhases:
    """The same where the spindle turns by one angle from sample to sample.

    Sums of powers are geometric series, products with values chirp z-transforms (Rabiner, Schafer
    and Rader 1969).
    """

    def __init__(self, start: float, step: float, samples: int, count: int) -> None:
        self._start, self._step, self._samples = start, step, samples
        self._shift = np.exp(1j * start * np.arange(count + 1))
        self._to_orders = scipy.signal.CZT(samples, count + 1, np.exp(-1j * step))
        self._to_samples = scipy.signal.CZT(count + 1, samples, np.exp(1j * step))

    def powers_summed(self) -> Complex:
        """Sums over the samples of the powers 0 to 2 m."""
        orders = np.arange(2 * self._shift.size - 1)
        half = 0.5 * self._step * orders
        # exp(i n x / 2) / exp(i x / 2) times sin(n x / 2) / sin(x / 2)
        ratio = np.full(orders.size, float(self._samples))
        np.divide(np.sin(self._samples * half), np.sin(half), out=ratio, where=np.sin(half) != 0.0)
        middle = self._start + 0.5 * self._step * (self._samples - 1)
        return ratio * np.exp(1j * middle * orders)

    def products(self, values: Array) -> Complex:
        """Sums (m,) of values (n,) times the powers."""
        return (self._shift * np.conj(self._to_orders(values)))[1:]

    def combined(self, amplitudes: Complex) -> Complex:
        """Sum (n,) of the powers, with an amplitude (m,) each."""
        return self._to_samples(self._shift * np.concatenate([[0.0], amplitudes]))


def phases_of(angle: Array, count: int) -> Phases | EvenPhases:
    """Phases at angles (n,), rad, of a spindle that turns evenly or not."""
    step, start = np.polynomial.polynomial.polyfit(np.arange(angle.size), angle, 1)[::-1]
    even = start + step * np.arange(angle.size)
    if count * np.max(np.abs(angle - even)) < _EVEN:
        return EvenPhases(start, step, angle.size, count)
    return Phases(angle, count)


def _gram(sums: Complex, count: int) -> Array:
    """Products (2 m + 1, 2 m + 1) of 1, cos, sin, cos, ... of m multiples of an angle, summed.

    Of the sums (2 m + 1,) of exp(i k angle): products are sums over sums and differences of the
    orders, so that these make all of them.
    """
    orders = np.arange(1, count + 1)
    above = sums[orders[:, None] + orders]
    apart = orders[:, None] - orders
    below = np.where(apart < 0, sums[np.abs(apart)].conj(), sums[np.abs(apart)])
    gram = np.empty((2 * count + 1, 2 * count + 1))
    gram[0, 0] = sums[0].real
    gram[0, 1::2] = gram[1::2, 0] = sums[1 : count + 1].real
    gram[0, 2::2] = gram[2::2, 0] = sums[1 : count + 1].imag
    gram[1::2, 1::2] = 0.5 * (below + above).real
    gram[2::2, 2::2] = 0.5 * (below - above).real
    gram[1::2, 2::2] = 0.5 * (above - below).imag
    gram[2::2, 1::2] = gram[1::2, 2::2].T
    return gram


def _level_beside(density: Array) -> Array:
    """Running median of a periodogram, as the mean of one without lines."""
    padded = np.pad(density, _BESIDE, mode="reflect" if density.size > _BESIDE else "edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * _BESIDE + 1)
    return np.median(windows, axis=1) / math.log(2.0)
