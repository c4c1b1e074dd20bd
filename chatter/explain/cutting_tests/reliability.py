"""Whether tests that a model was not fitted to are predicted as well as their scatter allows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.cutting_tests.fit_to_tests import fit_tests
from chatter.explain.fitting import Fit
from chatter.explain.kinds.stability import likely_stable
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem

Array = NDArray[np.float64]

#: parts of the tests, each predicted from the others
_FOLDS = 3
#: standard deviations by which the lost likelihood of holdout tests may exceed that of scatter
MOST_LOST_BY_SCATTER = 2.5
#: scatter of limits that repeated tests may have; beyond it something is missing
_LARGEST_SCATTER = 0.1


class Reliability(NamedTuple):
    """Holdout tests against their prediction."""

    tests: int
    right: int  # verdicts that are as predicted
    lost: float  # twice the lost logarithm of likelihood of the verdicts
    expected: float  # of it, by the predicted probabilities
    deviation: float  # standard deviation of it

    @property
    def is_as_scatter(self) -> bool:
        """Whether the verdicts are predicted as well as the scatter of limits allows."""
        return self.lost <= self.expected + MOST_LOST_BY_SCATTER * self.deviation

    def summary(self) -> dict[str, float | int | bool]:
        """Entry of explanation.json."""
        return {
            "tests": self.tests,
            "predicted_rightly": self.right,
            "lost_log_likelihood": 0.5 * self.lost,
            "expected_by_scatter": 0.5 * self.expected,
            "standard_deviation": 0.5 * self.deviation,
            "as_scatter_allows": self.is_as_scatter,
        }


class LostByScatter(NamedTuple):
    """Twice the lost logarithm of likelihood of verdicts that scatter as predicted."""

    mean: float
    variance: float


def lost_by_scatter(stable: np.ndarray) -> LostByScatter:
    """Twice the logarithm that verdicts lose by scatter, of probabilities (n,) of a stable one."""
    gain, other = np.log(stable), np.log1p(-stable)
    mean = -2.0 * float(np.sum(stable * gain + (1.0 - stable) * other))
    variance = 4.0 * float(np.sum(stable * (1.0 - stable) * (gain - other) ** 2))
    return LostByScatter(mean, variance)


def reliability_of(problem: Problem, fit: Fit) -> Reliability:
    """Predict every test by a model that was fitted to the others.

    A limit scatters from test to test, and is known no better than the others tell its parameters.
    """
    runs = problem.measurement.runs
    right, lost, expected, variance, count = 0, 0.0, 0.0, 0.0, 0
    for fold in range(_FOLDS):
        held = [run for run in runs if run.part.start % _FOLDS == fold]
        others = [run for run in runs if run.part.start % _FOLDS != fold]
        found = fit_tests(problem, others, fit.by_name)
        for run in held:
            if run.record != "stable":
                continue
            scatter = min(problem.noise[run.name]["stable"], _LARGEST_SCATTER)
            margin = _margin(problem, found.by_name, run)
            scatters = np.hypot(scatter, spread_of_margin(problem, found, run, margin))
            stable, verdict = likely_stable(margin, scatters), run.signals["stable"] > 0.5
            lost -= 2.0 * float(np.sum(np.log(np.where(verdict, stable, 1.0 - stable))))
            own = lost_by_scatter(stable)
            expected, variance = expected + own.mean, variance + own.variance
            right += int(np.sum((margin > 0.0) == verdict))
            count += verdict.size
    return Reliability(count, right, lost, expected, math.sqrt(variance))


def _margin(problem: Problem, values: Mapping[str, float], run: Run) -> Array:
    """Margins of the tests of a run, 1."""
    return problem.predictions.of(problem.case(values), run)["margin"]


def spread_of_margin(problem: Problem, found: Fit, run: Run, margin: Array) -> Array:
    """Standard deviation of margins by what a fit leaves open of its parameters, 1.

    Margins are taken as linear over a standard deviation of each parameter.
    """
    deviation = np.sqrt(np.diag(found.covariance))
    slopes = np.zeros((margin.size, deviation.size))
    for index, one in enumerate(found.parameters):
        ends = [
            float(np.clip(found.by_name[one.name] + side * deviation[index], one.lower, one.upper))
            for side in (-1.0, 1.0)
        ]
        if ends[1] > ends[0]:
            low, high = (_margin(problem, {**found.by_name, one.name: end}, run) for end in ends)
            slopes[:, index] = (high - low) / (ends[1] - ends[0])
    return np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slopes, found.covariance, slopes), 0.0))
