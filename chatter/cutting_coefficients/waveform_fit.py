"""Least squares of the waveforms of all cuts together, and how well each number is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

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
_MOST_EVALUATIONS = 40


@dataclass(frozen=True, eq=False)
class WaveformFit:
    """A model and what is fitted to the averages."""

    model: WaveformModel
    averages: tuple[RevolutionAverage, ...]
    parameters: Array  # (p,)
    values: Array  # (n,) coefficients (SI), then offsets of every cut and channel, N
    residual: tuple[Complex, ...]  # (channels, k) of each cut, N
    covariance: Array  # (p + n, p + n)
    power: float  # mean square of the residual summed over channels and cuts, N^2
    effective: float  # independent readings, by the autocorrelation of the residual

    @property
    def coefficients(self) -> Array:
        """Coefficients in the order of the keys of the law, SI."""
        return self.values[: len(self.model.law.keys)]

    @property
    def deviations(self) -> Array:
        """Standard deviations of the coefficients, SI."""
        first = self.parameters.size
        return self._deviations[first : first + self.coefficients.size]

    @property
    def parameter_deviations(self) -> Array:
        """Standard deviations of the other parameters."""
        return self._deviations[: self.parameters.size]

    @property
    def _deviations(self) -> Array:
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    def criterion(self, effective: float) -> float:
        """Bayesian criterion for a number of independent readings; less is better."""
        count = self.parameters.size + self.values.size
        return effective * math.log(max(self.power, 1e-12)) + count * math.log(effective)


class Problem:
    """Averages of cuts and a model for them, with what is the same between evaluations kept."""

    def __init__(self, model: WaveformModel, averages: Sequence[RevolutionAverage]) -> None:
        self.model, self.averages = model, tuple(averages)
        self.measured = np.concatenate([stacked(one.amplitude[..., None]) for one in averages])[
            :, 0
        ]
        self._kept: dict[tuple[int, bytes], Complex] = {}

    def rows(self, parameters: Array) -> Array:
        """Readings (m, n) for each linear parameter of 1."""
        parts = self.model.split(parameters, len(self.averages))
        blocks = [
            stacked(self._columns(number, one, parts)) for number, one in enumerate(self.averages)
        ]
        coefficients = np.concatenate(blocks)
        if not self.model.offsets:
            return coefficients
        offsets = [self._offset_rows(one) for one in self.averages]
        return np.hstack([coefficients, scipy.linalg.block_diag(*offsets)])

    def solved(self, parameters: Array) -> tuple[Array, Array]:
        """Linear parameters, and what they leave."""
        rows = self.rows(parameters)
        scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
        values = np.linalg.lstsq(rows / scale, self.measured, rcond=1e-9)[0] / scale
        return values, rows @ values - self.measured

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
        return stacked(unit)

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


def fitted(
    model: WaveformModel, averages: Sequence[RevolutionAverage], first: NDArray[np.float64]
) -> WaveformFit:
    """Fit a model from first parameters; the linear ones are solved at every step."""
    problem = Problem(model, averages)
    low, high = problem.bounds(first)
    margin = 1e-6
    found = scipy.optimize.least_squares(
        lambda p: problem.solved(p)[1], np.clip(first, low + margin, high - margin),
        bounds=(low, high), x_scale=0.1, diff_step=_STEP, max_nfev=_MOST_EVALUATIONS,
    ).x  # fmt: skip
    return _with_covariance(problem, found)


def _with_covariance(problem: Problem, parameters: Array) -> WaveformFit:
    values, left = problem.solved(parameters)
    residual = unstacked(left, problem.averages)
    jacobian = np.hstack([_slopes(problem, parameters, values), problem.rows(parameters)])
    covariance = _sandwich(jacobian, residual, left.size)
    powers = np.concatenate([(np.abs(one) ** 2).ravel() for one in residual])
    effective = 4.0 * powers.sum() ** 2 / max(float(np.sum(powers**2)), 1e-300)
    return WaveformFit(
        problem.model, problem.averages, parameters, values, residual, covariance,
        float(left @ left), min(effective, float(left.size)),
    )  # fmt: skip


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
    scale = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
    inverse = np.linalg.pinv(jacobian / scale, rcond=1e-9)
    freedom = max(count - jacobian.shape[1], 1)
    return (inverse * power) @ inverse.T * (count / freedom) / np.outer(scale, scale)
