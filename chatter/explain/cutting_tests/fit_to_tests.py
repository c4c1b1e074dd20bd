"""Fit of a model to cutting tests: steps over predictions that are linear in the parameters.

What costs is the prediction: the stability of every test. What bends is the likelihood of verdicts,
flat far from the limit, and priors with heavy tails. Margins, frequencies and powers are nearly
linear in the parameters, so that each step goes to the least of likelihood and priors over linear
predictions within a trust region (Conn, Gould and Toint 2000, Trust-Region Methods, chapter 6);
one prediction a step tells how far that holds, and brings the slopes up to date (Broyden 1965).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError, RunError
from chatter.explain.cutting_tests.priors import Priors
from chatter.explain.fitting import WORKERS, Fit
from chatter.explain.kinds.kind import Noise
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem

Array = NDArray[np.float64]

#: of a finite difference, in units of a parameter's size
_DIFFERENCE = 2e-3
#: fall of the cost, as the linear predictions promise it, that ends a fit
_SMALLEST_GAIN = 1e-3
#: predictions at the most, without those of finite differences
MOST_STEPS = 24
#: trust region in sizes: at first, least, its factors, and shares of the promised fall for them
_REGION, _SMALLEST_REGION, _NARROWER, _WIDER, _POOR, _GOOD = 1.5, 0.02, 0.35, 2.0, 0.25, 0.7
#: of the least over linear predictions: iterations, damping and its factors, fall that ends it
_ITERATIONS, _DAMPING, _LESS, _MORE, _LEAST_STIFFNESS = 40, 0.1, 0.2, 6.0, 1e-6
_LEAST_FALL = 1e-3
#: of a prediction, by which the slope of the likelihood is taken, in its scatter
_SLOPE = 1e-4


def fit_tests(
    problem: Problem, runs: Sequence[Run], start: Mapping[str, float], most: int = MOST_STEPS
) -> Fit:
    """Fit everything to runs, from values by name, those declared where they are not named."""
    search = SearchOverTests(problem, runs, start)
    search.descend(problem.noise, most)
    return search.result()


def fit_tests_widely(
    problem: Problem, runs: Sequence[Run], start: Mapping[str, float], scatters: Sequence[float]
) -> Fit:
    """Fit everything to runs whose limits are taken as scattered widely at first.

    Verdicts far from the limit still pull then, and a fit does not end beside the first lobe that
    it meets. Scatters are those of the limits that are gone through before that of the problem.
    """
    search = SearchOverTests(problem, runs, start)
    for scatter in scatters:
        search.descend(scattered(problem.noise, scatter), MOST_STEPS // 3)
    search.descend(problem.noise, MOST_STEPS)
    return search.result()


def scattered(noise: Noise, scatter: float) -> dict[str, Mapping[str, float]]:
    """Noise with another scatter of the limits."""
    return {name: {"stable": scatter} if "stable" in own else own for name, own in noise.items()}


class SearchOverTests:
    """Predictions of runs over parameters that are counted in their sizes from where they start."""

    def __init__(self, problem: Problem, runs: Sequence[Run], start: Mapping[str, float]) -> None:
        self.problem, self.runs = problem, runs
        self.parameters = problem.parameters()
        self.priors = Priors(problem, self.parameters)
        self.lower = np.array([one.counted(one.lower) for one in self.parameters])
        self.upper = np.array([one.counted(one.upper) for one in self.parameters])
        begin = [one.counted(start.get(one.name, one.start)) for one in self.parameters]
        self.x = np.clip(np.array(begin), self.lower, self.upper)
        self.noise = problem.noise
        self.predicted = self.predictions(self.x)
        self.slopes: Array | None = None
        self.steps_since = 0  # steps since the slopes were taken by differences
        self.region = _REGION

    def values(self, x: Array) -> dict[str, float]:
        """Parameters by name, SI."""
        return {one.name: one.value(float(v)) for one, v in zip(self.parameters, x, strict=True)}

    def predictions(self, x: Array) -> Array | None:
        """Margins, frequencies and powers (n,) of the runs; None where there are none."""
        try:
            case = self.problem.case(self.values(x))
            found = [self.problem.predictions.of(case, run)[_told_by(run)] for run in self.runs]
        except (InputError, RunError):
            return None
        return np.concatenate(found)

    def residuals(self, predicted: Array) -> Array:
        """Residuals (n,) of predictions, each by its own prediction alone."""
        parts, begin = [], 0
        for run in self.runs:
            end = begin + run.signals[str(run.record)].size
            own = {_told_by(run): predicted[begin:end]}
            parts.append(self.problem.kind.residuals(run, own, self.noise[run.name]))
            begin = end
        return np.concatenate(parts)

    def cost(self, predicted: Array | None, x: Array) -> float:
        """Twice the lost logarithm of likelihood and prior."""
        if predicted is None:
            return np.inf
        residuals = self.residuals(predicted)
        return float(residuals @ residuals) + self.priors.cost(x)

    def descend(self, noise: Noise, most: int) -> None:
        """Go to the least cost with a noise, by some predictions at the most."""
        self.noise = noise
        if self.predicted is None:
            return
        self.region = max(self.region, _REGION)
        cost = self.cost(self.predicted, self.x)
        for _ in range(most):
            if self.slopes is None:
                self.slopes, self.steps_since = self.differences(), 0
            trial, promised = self.least(cost)
            if promised < _SMALLEST_GAIN or self.region < _SMALLEST_REGION:
                if self.steps_since == 0:
                    break
                # what no longer gains by slopes brought up to date may by differences
                self.slopes = None
                continue
            cost = self.tried(trial, cost, promised)

    def tried(self, trial: Array, cost: float, promised: float) -> float:
        """Go to a point if it is better, and learn from it; the cost where the search is then."""
        found = self.predictions(trial)
        gained = cost - self.cost(found, trial)
        step = trial - self.x
        if gained < _POOR * promised:
            self.region = _NARROWER * float(np.max(np.abs(step)))
        elif gained > _GOOD * promised:
            self.region *= _WIDER
        if found is not None:
            apart = found - (self.predicted + self.slopes @ step)
            self.slopes = self.slopes + np.outer(apart, step) / float(step @ step)
            self.steps_since += 1
        if gained <= 0.0:
            return cost
        self.x, self.predicted = trial, found
        return cost - gained

    def differences(self) -> Array:
        """Slopes (n, p) of the predictions by forward differences, in threads."""

        def column(index: int) -> Array:
            moved = self.x.copy()
            step = _DIFFERENCE if moved[index] + _DIFFERENCE <= self.upper[index] else -_DIFFERENCE
            moved[index] += step
            found = self.predictions(moved)
            return (
                np.zeros_like(self.predicted)
                if found is None
                else ((found - self.predicted) / step)
            )

        with ThreadPoolExecutor(WORKERS) as pool:
            columns = list(pool.map(column, range(self.x.size)))
        return np.array(columns).T.reshape(self.predicted.size, self.x.size)

    def least(self, cost: float) -> tuple[Array, float]:
        """Point of the least cost over linear predictions in the trust region, and its gain."""
        lower = np.maximum(self.lower, self.x - self.region)
        upper = np.minimum(self.upper, self.x + self.region)

        def linear(x: Array) -> Array:
            return self.predicted + self.slopes @ (x - self.x)

        x, now, damping = self.x, cost, _DAMPING
        for _ in range(_ITERATIONS):
            residuals, jacobian = self.linearised(linear(x))
            trial = self.damped(x, residuals, jacobian, damping, lower, upper)
            after = self.cost(linear(trial), trial)
            if after >= now:
                damping *= _MORE
                if damping > 1e6:
                    break
                continue
            fell, x, now, damping = now - after, trial, after, damping * _LESS
            if fell < _LEAST_FALL:
                break
        return x, cost - now

    def linearised(self, predicted: Array) -> tuple[Array, Array]:
        """Residuals (n,) and their Jacobian (n, p), from predictions."""
        residuals = self.residuals(predicted)
        step = _SLOPE * np.maximum(np.abs(predicted), 1.0)
        slope = (self.residuals(predicted + step) - residuals) / step
        return residuals, slope[:, None] * self.slopes

    def damped(
        self, x: Array, residuals: Array, jacobian: Array, damping: float, lower: Array,
        upper: Array,
    ) -> Array:  # fmt: skip
        """Point that a damped step leads to; parameters that press on a bound stay there.

        Levenberg (1944, Q. Appl. Math. 2:164) and Marquardt (1963, J. SIAM 11:431).
        """
        weight = self.priors.weight(x)
        slope = jacobian.T @ residuals + weight * x
        held = ((x <= lower) & (slope > 0.0)) | ((x >= upper) & (slope < 0.0))
        free = np.flatnonzero(~held)
        normal = (jacobian.T @ jacobian)[np.ix_(free, free)] + np.diag(weight[free])
        stiffness = np.maximum(np.diag(normal), _LEAST_STIFFNESS)
        moved = x.copy()
        moved[free] -= np.linalg.solve(normal + damping * np.diag(stiffness), slope[free])
        return np.clip(moved, lower, upper)

    def result(self) -> Fit:
        """Fit where the search is; its covariance is that of the normal distribution there."""
        count = sum(run.signals[str(run.record)].size for run in self.runs)
        if self.predicted is None:
            residuals = self.problem.residuals(self.values(self.x), self.runs)
            jacobian = np.zeros((count, self.x.size))
        else:
            if self.slopes is None:
                self.slopes = self.differences()
            residuals, jacobian = self.linearised(self.predicted)
        normal = jacobian.T @ jacobian + np.diag(self.priors.weight(self.x))
        per_size = np.array(
            [one.per_size(float(v)) for one, v in zip(self.parameters, self.x, strict=True)]
        )
        covariance = np.linalg.pinv(normal, hermitian=True) * np.outer(per_size, per_size)
        values = np.array(list(self.values(self.x).values()))
        return Fit(tuple(self.parameters), values, covariance, jacobian, residuals)


def _told_by(run: Run) -> str:
    """Signal of a prediction that the residuals of a run follow from."""
    return "margin" if run.record == "stable" else str(run.record)
