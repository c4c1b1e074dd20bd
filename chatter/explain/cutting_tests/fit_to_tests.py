"""Fit of a model to cutting tests: damped least squares beside priors with heavy tails.

Levenberg (1944, Q. Appl. Math. 2:164) and Marquardt (1963, J. SIAM 11:431). The likelihood of
verdicts is flat far from the limit and priors are no squares: `chatter.explain.fitting` is for
residuals that are nearly linear, and takes many more predictions here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from chatter.explain.cutting_tests.priors import Priors, pulls
from chatter.explain.fitting import WORKERS, Fit
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem

Array = NDArray[np.float64]

#: of a finite difference, in units of a parameter's size
_DIFFERENCE = 2e-3
#: fall of the cost that ends a fit, steps at the most, and steps tried from one point
_SMALLEST_GAIN, MOST_STEPS, _MOST_TRIED = 0.2, 10, 4
#: damping: at first, its factors, and least stiffness of a parameter without a prior
_DAMPING, _LESS, _MORE, _LEAST_STIFFNESS = 0.1, 0.2, 6.0, 1e-6


def fit_tests(
    problem: Problem, runs: Sequence[Run], start: Mapping[str, float], most: int = MOST_STEPS
) -> Fit:
    """Fit everything to runs, from values by name, those declared where they are not named."""
    search = _Search(problem, runs)
    x = search.clipped(
        pulls(search.parameters, {one.name: one.start for one in search.parameters} | dict(start))
    )
    residuals, damping = search.residuals(x), _DAMPING
    jacobian = search.differences(x, residuals)
    for _ in range(most):
        cost = search.cost(residuals, x)
        for _ in range(_MOST_TRIED):
            trial = search.step(x, residuals, jacobian, damping)
            found = search.residuals(trial)
            gained = cost - search.cost(found, trial)
            if gained > 0.0:
                break
            damping *= _MORE
        if gained <= 0.0:
            break
        x, residuals, damping = trial, found, damping * _LESS
        if gained < _SMALLEST_GAIN:
            break
        jacobian = search.differences(x, residuals)
    return search.result(x, residuals, jacobian)


class _Search:
    """Residuals of runs over parameters that are counted in their sizes from where they start."""

    def __init__(self, problem: Problem, runs: Sequence[Run]) -> None:
        self.problem, self.runs = problem, runs
        self.parameters = problem.parameters()
        self.priors = Priors(problem, self.parameters)
        self.size = np.array([one.size for one in self.parameters])
        self.origin = np.array([one.start for one in self.parameters])
        self.lower = (np.array([one.lower for one in self.parameters]) - self.origin) / self.size
        self.upper = (np.array([one.upper for one in self.parameters]) - self.origin) / self.size

    def clipped(self, x: Array) -> Array:
        """Parameters within their bounds."""
        return np.clip(x, self.lower, self.upper)

    def residuals(self, x: Array) -> Array:
        """Residuals (n,) of the runs."""
        values = self.origin + x * self.size
        names = [one.name for one in self.parameters]
        return self.problem.residuals(dict(zip(names, values.tolist(), strict=True)), self.runs)

    def cost(self, residuals: Array, x: Array) -> float:
        """Twice the lost logarithm of likelihood and prior."""
        return float(residuals @ residuals) + self.priors.cost(x)

    def differences(self, x: Array, residuals: Array) -> Array:
        """Jacobian (n, p) by forward differences, in threads."""

        def column(index: int) -> Array:
            moved = x.copy()
            step = _DIFFERENCE if x[index] + _DIFFERENCE <= self.upper[index] else -_DIFFERENCE
            moved[index] += step
            return (self.residuals(moved) - residuals) / step

        with ThreadPoolExecutor(WORKERS) as pool:
            columns = list(pool.map(column, range(x.size)))
        return np.array(columns).T.reshape(residuals.size, x.size)

    def step(self, x: Array, residuals: Array, jacobian: Array, damping: float) -> Array:
        """Point that a damped step leads to; parameters that press on a bound stay there."""
        weight = self.priors.weight(x)
        slope = jacobian.T @ residuals + weight * x
        held = ((x <= self.lower) & (slope > 0.0)) | ((x >= self.upper) & (slope < 0.0))
        free = np.flatnonzero(~held)
        normal = (jacobian.T @ jacobian)[np.ix_(free, free)] + np.diag(weight[free])
        stiffness = np.maximum(np.diag(normal), _LEAST_STIFFNESS)
        moved = x.copy()
        moved[free] -= np.linalg.solve(normal + damping * np.diag(stiffness), slope[free])
        return self.clipped(moved)

    def result(self, x: Array, residuals: Array, jacobian: Array) -> Fit:
        """Fit at a point; its covariance is that of the normal distribution there."""
        normal = jacobian.T @ jacobian + np.diag(self.priors.weight(x))
        covariance = np.linalg.pinv(normal, hermitian=True) * np.outer(self.size, self.size)
        values = self.origin + x * self.size
        return Fit(tuple(self.parameters), values, covariance, jacobian, residuals)
