"""Least squares of a table of real modes against a receptance.

A row of the table, (n, 5), is a mode: logarithms of natural frequency and damping ratio, and the
mass-normalised direction. All slopes are a function of the line times a pattern of the matrix, so
that the normal equations follow from products of these (63 of 21 modes) and not from the whole
Jacobian. Levenberg-Marquardt with the damping of Nielsen, "Damping parameter in Marquardt's
method", IMM-REP-1999-05; bounds by projection.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

#: elements of a symmetric matrix, and their weights in its norm
_FIRST, _SECOND = np.triu_indices(3)
_WEIGHT = np.where(_FIRST == _SECOND, 1.0, math.sqrt(2.0))
#: slopes of a mode: by frequency and damping ratio one pattern, by direction three
_LINE_OF_SLOPE = np.array([0, 1, 2, 2, 2])
#: Marquardt's factor at first and at least; beyond the most no step helps
_FIRST_FACTOR, _LEAST_FACTOR, _MOST_FACTOR = 1e-3, 1e-10, 1e12
#: iterations in succession that have to gain next to nothing
_CALM = 2


@dataclass(frozen=True)
class WantedReceptance:
    """Receptance that modes are to make up.

    Parameters
    ----------
    omega : (m,) array of float
        Lines, rad/s.
    values : (m, 3, 3) array of complex
        Symmetric, m/N.
    weight : (m,) array of float
        Weight of a line, N/m.
    """

    omega: NDArray[np.float64]
    values: NDArray[np.complex128]
    weight: NDArray[np.float64]

    def residual(self, table: NDArray[np.float64]) -> NDArray[np.complex128]:
        """What is missing, (m, 3, 3), m/N."""
        shape = table[:, 2:]
        response = np.einsum("mn,ni,nj->mij", oscillators(table, self.omega), shape, shape)
        return self.values - response

    def missing(self, table: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Independent elements (m, 6) of what is missing, weighted."""
        shape = table[:, 2:]
        made = oscillators(table, self.omega) @ (shape[:, _FIRST] * shape[:, _SECOND] * _WEIGHT)
        return self._wanted - made * self.weight[:, None]

    @cached_property
    def _wanted(self) -> NDArray[np.complex128]:
        return self.elements(self.values)

    def elements(self, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Independent elements (m, 6) of symmetric matrices, weighted."""
        return values[:, _FIRST, _SECOND] * (self.weight[:, None] * _WEIGHT)


class ModeBounds(NamedTuple):
    """Least and largest of each entry of a table, both (n, 5)."""

    least: NDArray[np.float64]
    most: NDArray[np.float64]

    @classmethod
    def of(
        cls, number: int, frequencies: tuple[float, float], dampings: tuple[float, float]
    ) -> ModeBounds:
        """Bounds of a number of modes: natural frequencies, rad/s, and damping ratios."""
        least, most = np.full((number, 5), -np.inf), np.full((number, 5), np.inf)
        least[:, 0], most[:, 0] = np.log(frequencies)
        least[:, 1], most[:, 1] = np.log(dampings)
        return cls(least, most)

    def with_further(self, others: ModeBounds) -> ModeBounds:
        """Bounds of these modes and of others behind them."""
        return ModeBounds(
            np.vstack([self.least, others.least]), np.vstack([self.most, others.most])
        )


class _Step(NamedTuple):
    table: NDArray[np.float64]
    missing: NDArray[np.complex128]
    cost: float


def refined(
    table: NDArray[np.float64],
    bounds: ModeBounds,
    wanted: WantedReceptance,
    iterations: int,
    least_gain: float,
) -> tuple[NDArray[np.float64], float]:
    """Table of the least weighted squares near a first one, and that sum.

    It ends when two iterations in succession take less than a share `least_gain` off the sum.
    """
    now = _at(np.clip(table, *bounds), wanted)
    factor, growth, calm = _FIRST_FACTOR, 2.0, 0
    normal, slope = _normal_equations(now, wanted)
    for _ in range(iterations):
        step = _step(now.table, normal, slope, bounds, factor)
        then = _at(np.clip(now.table + step, *bounds), wanted)
        if then.cost >= now.cost:
            factor, growth = factor * growth, 2.0 * growth
            if factor > _MOST_FACTOR:
                break
            continue
        # Nielsen: by what the step gained over what the slopes promised
        taken = (then.table - now.table).ravel()
        promised = taken @ (2.0 * slope - normal @ taken)
        share = (now.cost - then.cost) / promised if promised > 0.0 else 0.0
        factor = max(factor * max(0.2, 1.0 - (2.0 * share - 1.0) ** 3), _LEAST_FACTOR)
        growth = 2.0
        calm = calm + 1 if now.cost - then.cost < least_gain * now.cost else 0
        now = then
        if calm >= _CALM:
            break
        normal, slope = _normal_equations(now, wanted)
    return now.table, now.cost


def oscillators(table: NDArray[np.float64], omega: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Response (m, n) of each oscillator of unit mass at lines in rad/s."""
    natural, damping = np.exp(table[:, 0]), np.exp(table[:, 1])
    line = omega[:, None]
    return 1.0 / (natural**2 - line**2 + 2j * damping * natural * line)


def best_further(
    wanted: WantedReceptance, residual: NDArray[np.complex128], candidates: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Row, of candidates (k, 2), that takes most off a residual with its best direction.

    Candidates are natural frequencies, rad/s, and damping ratios.
    """
    response = oscillators(np.log(candidates), wanted.omega) * wanted.weight[:, None]
    size = np.sum(np.abs(response) ** 2, axis=0)
    elements = (response.conj().T @ wanted.elements(residual)).real / (size[:, None] * _WEIGHT)
    matrices = np.empty((len(candidates), 3, 3))
    matrices[:, _FIRST, _SECOND] = matrices[:, _SECOND, _FIRST] = elements
    values, vectors = np.linalg.eigh(matrices)
    # a mode of positive mass
    largest = np.maximum(values[:, -1], 0.0)
    best = int(np.argmax(largest**2 * size))
    return np.array([*np.log(candidates[best]), *(math.sqrt(largest[best]) * vectors[best, :, -1])])


def _at(table: NDArray[np.float64], wanted: WantedReceptance) -> _Step:
    missing = wanted.missing(table)
    return _Step(table, missing, float(np.vdot(missing, missing).real))


def _normal_equations(
    now: _Step, wanted: WantedReceptance
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Matrix (5 n, 5 n) and right-hand side (5 n,) of the normal equations."""
    lines, patterns = _slopes(now.table, wanted)
    lines = np.vstack([lines.real, lines.imag])
    missing = np.vstack([now.missing.real, now.missing.imag])
    index = (3 * np.arange(len(now.table))[:, None] + _LINE_OF_SLOPE).ravel()
    normal = (lines.T @ lines)[np.ix_(index, index)] * (patterns @ patterns.T)
    slope = np.sum((lines.T @ missing)[index] * patterns, axis=1)
    return normal, slope


def _slopes(
    table: NDArray[np.float64], wanted: WantedReceptance
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Functions of the line (m, 3 n), weighted, and patterns (5 n, 6) of the slopes."""
    response = oscillators(table, wanted.omega)
    natural, damping = np.exp(table[:, 0]), np.exp(table[:, 1])
    # by the logarithms of natural frequency and damping ratio
    loss = 2j * damping * natural * wanted.omega[:, None]
    by_frequency = -(response**2) * (2.0 * natural**2 + loss)
    by_damping = -(response**2) * loss
    lines = np.stack([by_frequency, by_damping, response], axis=-1)
    lines = (lines * wanted.weight[:, None, None]).reshape(len(wanted.omega), -1)
    shape, patterns = table[:, 2:], np.empty((len(table), 5, _WEIGHT.size))
    patterns[:, :2] = (shape[:, _FIRST] * shape[:, _SECOND])[:, None]
    for axis, unit in enumerate(np.eye(3)):
        patterns[:, 2 + axis] = unit[_FIRST] * shape[:, _SECOND] + shape[:, _FIRST] * unit[_SECOND]
    return lines, (patterns * _WEIGHT).reshape(-1, _WEIGHT.size)


def _step(
    table: NDArray[np.float64],
    normal: NDArray[np.float64],
    slope: NDArray[np.float64],
    bounds: ModeBounds,
    factor: float,
) -> NDArray[np.float64]:
    """Step of the table; what stands at a bound and would leave stays."""
    x, least, most = table.ravel(), bounds.least.ravel(), bounds.most.ravel()
    free = ~((x <= least) & (slope < 0.0) | (x >= most) & (slope > 0.0))
    diagonal = np.diag(normal)
    size = np.sqrt(np.maximum(diagonal, 1e-12 * diagonal.max()))[free]
    matrix = normal[np.ix_(free, free)] / np.outer(size, size) + factor * np.eye(size.size)
    step = np.zeros_like(x)
    solved = scipy.linalg.cho_solve(scipy.linalg.cho_factor(matrix), slope[free] / size)
    step[free] = solved / size
    return step.reshape(table.shape)
