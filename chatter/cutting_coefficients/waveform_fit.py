"""Least squares of the waveforms of all cuts together, and how well each number is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.cutting_coefficients.mean_forces import GAIN
from chatter.cutting_coefficients.revolution_average import RevolutionAverage
from chatter.cutting_coefficients.waveform_model import Complex, WaveformModel
from chatter.description.arrays import Array

#: change of a parameter for a difference
_STEP = 1e-5
#: harmonics over which the power of the residual is smoothed
_SMOOTH = 5
#: bounds: runout (10 um), exponent, helix (rad), ln of damping
_RUNOUT, _EXPONENT, _HELIX = 20.0, (0.05, 1.0), math.radians(60.0)
_DAMPING = (math.log(0.005), math.log(1.0))
#: of ln of the cut-off of a low-pass, from where it was found
_LOW_PASS = 0.7
_MOST_EVALUATIONS = 40
#: weight of an offset over that of the readings: of what they do not tell, offsets are the least
_LEAST_OFFSET = 1e-4
#: singular value, over the largest, of what the readings do not tell, and share of a coefficient
_UNTOLD, _SHARE = 1e-6, 0.01
#: residual of a harmonic, over the largest of its channel, below which its weight grows no more
_LEAST_RESIDUAL = 0.05


@dataclass(frozen=True, eq=False)
class WaveformFit:
    """A model and what is fitted to the averages."""

    model: WaveformModel
    averages: tuple[RevolutionAverage, ...]
    parameters: Array  # (p,)
    values: Array  # (n,) coefficients (SI), then offsets of every cut and channel, N
    residual: tuple[Complex, ...]  # (channels, k) of each cut, N
    covariance: Array  # (p + n, p + n)
    weights: Array  # (channels, k) of the readings, 1/N
    power: Array  # (channels,) mean square of the weighted residual, summed over cuts
    #: (channels,) independent readings, by the autocorrelation of the weighted residual
    effective: Array
    #: coefficients that offsets hide: their force does not vary over the revolution
    hidden: tuple[str, ...] = ()

    @property
    def coefficients(self) -> Array:
        """Coefficients in the order of the keys of the law, SI."""
        return self.values[: len(self.model.law.keys)]

    @property
    def coefficient_covariance(self) -> Array:
        """Covariance of the coefficients, SI: none is known better than a dynamometer's gain."""
        first = self.parameters.size
        own = slice(first, first + self.coefficients.size)
        return self.covariance[own, own] + np.diag((GAIN * self.coefficients) ** 2)

    @property
    def deviations(self) -> Array:
        """Standard deviations of the coefficients, SI."""
        return np.sqrt(np.maximum(np.diag(self.coefficient_covariance), 0.0))

    @property
    def parameter_deviations(self) -> Array:
        """Standard deviations of the other parameters."""
        return self._deviations[: self.parameters.size]

    @property
    def _deviations(self) -> Array:
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def rms_left(self) -> float:
        """Root of the mean square of the residual, summed over channels and cuts, N."""
        squares = [np.abs(one[:, :1]) ** 2 for one in self.residual]
        squares += [2.0 * np.abs(one[:, 1:]) ** 2 for one in self.residual]
        return math.sqrt(sum(float(one.sum()) for one in squares))

    def criterion(self, effective: Array) -> float:
        """Bayesian criterion for independent readings of each channel; less is better.

        Every channel has a noise of its own size.
        """
        count = self.parameters.size + self.values.size
        fit = float(effective @ np.log(np.maximum(self.power, 1e-24)))
        return fit + count * math.log(float(effective.sum()))


class Problem:
    """Averages of cuts and a model for them, with what is the same between evaluations kept."""

    def __init__(
        self,
        model: WaveformModel,
        averages: Sequence[RevolutionAverage],
        weights: Array | None = None,
    ) -> None:
        self.model, self.averages = model, tuple(averages)
        self.weights = channel_weights(averages) if weights is None else weights
        weighted = [self._weighted(one.amplitude[..., None]) for one in averages]
        self.measured = np.concatenate([stacked(one) for one in weighted])[:, 0]
        self._kept: dict[tuple[int, bytes], Complex] = {}

    def rows(self, parameters: Array) -> Array:
        """Readings (m, n) for each linear parameter of 1."""
        parts = self.model.split(parameters, len(self.averages))
        blocks = [
            stacked(self._weighted(self._columns(number, one, parts)))
            for number, one in enumerate(self.averages)
        ]
        coefficients = np.concatenate(blocks)
        if not self.model.offsets:
            return coefficients
        offsets = [self._offset_rows(one) for one in self.averages]
        return np.hstack([coefficients, scipy.linalg.block_diag(*offsets)])

    def solved(self, parameters: Array) -> tuple[Array, Array]:
        """Linear parameters, and what they leave, weighted."""
        rows = self.rows(parameters)
        scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
        # without it half of a force that does not vary were an offset
        few = _LEAST_OFFSET * np.eye(scale.size)[len(self.model.law.keys) :]
        given = np.concatenate([self.measured, np.zeros(len(few))])
        values = np.linalg.lstsq(np.vstack([rows / scale, few]), given, rcond=1e-9)[0] / scale
        return values, rows @ values - self.measured

    def hidden(self, parameters: Array) -> tuple[str, ...]:
        """Coefficients whose force offsets of the channels may be as well."""
        keys = self.model.law.keys
        rows = self.rows(parameters)
        scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
        sizes, directions = np.linalg.svd(rows / scale, full_matrices=False)[1:]
        untold = np.abs(directions[sizes < _UNTOLD * sizes[0], : len(keys)])
        return tuple(
            key for key, share in zip(keys, untold.max(axis=0, initial=0.0), strict=True)
            if share > _SHARE
        )  # fmt: skip

    def _columns(self, number: int, one: RevolutionAverage, parts: dict[str, Array]) -> Complex:
        shape = np.concatenate([parts["runout"], parts["exponent"], parts["helix"]])
        key = (number, shape.tobytes())
        if key not in self._kept:
            if len(self._kept) > 40 * len(self.averages):
                self._kept.clear()
            self._kept[key] = self.model.forces(one, parts)
        return self.model.seen(one, parts, self._kept[key], float(parts["start"][number]))

    def _offset_rows(self, one: RevolutionAverage) -> Array:
        unit = np.zeros((*one.amplitude.shape, len(one.channels)), dtype=np.complex128)
        unit[:, 0, :] = np.eye(len(one.channels))
        return stacked(self._weighted(unit))

    def _weighted(self, amplitude: Complex) -> Complex:
        return amplitude * self.weights[:, : amplitude.shape[1], None]

    def bounds(self, first: Array) -> tuple[Array, Array]:
        """Bounds of the parameters."""
        parts = self.model.split(np.arange(first.size), len(self.averages))
        low, high = np.full(first.size, -np.inf), np.full(first.size, np.inf)
        low[parts["runout"]], high[parts["runout"]] = -_RUNOUT, _RUNOUT
        low[parts["exponent"]], high[parts["exponent"]] = _EXPONENT
        low[parts["helix"]], high[parts["helix"]] = 0.0, _HELIX
        frequency, damping = parts["resonance"][::2], parts["resonance"][1::2]
        low[frequency], high[frequency] = first[frequency] - 0.4, first[frequency] + 0.4
        low[damping], high[damping] = _DAMPING
        cut_off = parts["low_pass"]
        low[cut_off], high[cut_off] = first[cut_off] - _LOW_PASS, first[cut_off] + _LOW_PASS
        return low, high


def stacked(amplitude: Complex) -> Array:
    """Complex coefficients (channels, k, n) as real ones (m, n) of the same mean square."""
    rest = math.sqrt(2.0) * amplitude[:, 1:]
    parts = np.concatenate([amplitude[:, :1].real, rest.real, rest.imag], axis=1)
    return parts.reshape(-1, amplitude.shape[2])


def unstacked(values: Array, averages: Sequence[RevolutionAverage]) -> tuple[Complex, ...]:
    """Complex coefficients (channels, k) of every cut from a real vector."""
    found, place = [], 0
    for one in averages:
        channels, count = one.amplitude.shape
        size = channels * (2 * count - 1)
        block = values[place : place + size].reshape(channels, -1)
        rest = (block[:, 1:count] + 1j * block[:, count:]) / math.sqrt(2.0)
        found.append(np.concatenate([block[:, :1].astype(np.complex128), rest], axis=1))
        place += size
    return tuple(found)


def channel_weights(averages: Sequence[RevolutionAverage]) -> Array:
    """Weights (channels, k) that make the varying force of every channel as large."""
    most = max(one.amplitude.shape[1] for one in averages)
    squares = sum(np.sum(np.abs(one.amplitude[:, 1:]) ** 2, axis=1) for one in averages)
    size = np.sqrt(np.maximum(squares, 1e-24))
    return np.tile(1.0 / size[:, None], (1, most))


def residual_weights(fit: WaveformFit) -> Array:
    """Weights (channels, k) by what a fit leaves at each harmonic: a model is wrong at some."""
    most = max(one.shape[1] for one in fit.residual)
    power = np.zeros((fit.residual[0].shape[0], most))
    count = np.zeros(most)
    for one in fit.residual:
        power[:, : one.shape[1]] += np.abs(one) ** 2
        count[: one.shape[1]] += 1.0
    smooth = scipy.ndimage.uniform_filter1d(power / count, _SMOOTH, axis=1, mode="nearest")
    least = _LEAST_RESIDUAL**2 * smooth.max(axis=1, keepdims=True)
    return 1.0 / np.sqrt(np.maximum(smooth, np.maximum(least, 1e-24)))


def fitted(
    model: WaveformModel,
    averages: Sequence[RevolutionAverage],
    first: NDArray[np.float64],
    weights: Array | None = None,
) -> WaveformFit:
    """Fit a model from first parameters; the linear ones are solved at every step."""
    problem = Problem(model, averages, weights)
    low, high = problem.bounds(first)
    margin = 1e-6
    found = scipy.optimize.least_squares(
        lambda p: problem.solved(p)[1], np.clip(first, low + margin, high - margin),
        bounds=(low, high), x_scale=0.1, diff_step=_STEP, max_nfev=_MOST_EVALUATIONS,
    ).x  # fmt: skip
    return _with_covariance(problem, found)


def _with_covariance(problem: Problem, parameters: Array) -> WaveformFit:
    values, left = problem.solved(parameters)
    weighted = unstacked(left, problem.averages)
    jacobian = np.hstack([_slopes(problem, parameters, values), problem.rows(parameters)])
    covariance = _sandwich(jacobian, weighted, left.size)
    residual = tuple(one / problem.weights[:, : one.shape[1]] for one in weighted)
    power, effective = _powers(weighted)
    return WaveformFit(
        problem.model, problem.averages, parameters, values, residual, covariance,
        problem.weights, power, effective, problem.hidden(parameters),
    )  # fmt: skip


def _powers(weighted: Sequence[Complex]) -> tuple[Array, Array]:
    """Mean square of every channel, and how many independent readings it has."""
    squares = np.concatenate([np.abs(one) ** 2 for one in weighted], axis=1)
    total, fourth = squares.sum(axis=1), np.sum(squares**2, axis=1)
    # a complex coefficient is two readings; of Gaussian ones the mean of |c|^4 is twice |c|^2 ^2
    effective = 4.0 * total**2 / np.maximum(fourth, 1e-300)
    return total, np.minimum(effective, 2.0 * squares.shape[1])


def _slopes(problem: Problem, parameters: Array, values: Array) -> Array:
    """Derivative (m, p) of the readings by the parameters that are not linear."""
    columns = [
        (problem.rows(parameters + step) - problem.rows(parameters - step)) @ values / 2e-4
        for step in 1e-4 * np.eye(parameters.size)
    ]
    return np.column_stack(columns)


def _sandwich(jacobian: Array, residual: Sequence[Complex], count: int) -> Array:
    """Covariance of least squares whose residual is not white.

    The residual over a revolution is taken as stationary: its autocorrelation is its power over the
    harmonics, smoothed, and its covariance is diagonal there.
    """
    spectrum = [
        scipy.ndimage.uniform_filter1d(np.abs(one) ** 2, _SMOOTH, axis=1, mode="nearest")
        for one in residual
    ]
    # of each real number: a complex coefficient has two, stretched by the square root of two
    power = np.concatenate(
        [np.concatenate([one[:, :1], one[:, 1:], one[:, 1:]], axis=1).ravel() for one in spectrum]
    )
    scale = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-100)
    inverse = np.linalg.pinv(jacobian / scale, rcond=1e-9)
    freedom = max(count - jacobian.shape[1], 1)
    return (inverse * power) @ inverse.T * (count / freedom) / np.outer(scale, scale)
