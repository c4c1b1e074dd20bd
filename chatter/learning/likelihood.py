"""How likely the verdicts, chatter frequencies and powers of cutting tests are by a particle."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError, RunError
from chatter.explain.fitting import WORKERS
from chatter.explain.kinds.stability import likely_stable, limited
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem
from chatter.learning.cuts import TEST
from chatter.learning.idle_power import IDLE_POWER, POWER
from chatter.learning.prior import SCATTER_OF_LIMITS, Prior
from chatter.learning.records_of_cuts import ANGLE, DEVIATION, MAGNITUDE

Array = NDArray[np.float64]

#: scatter of multipliers beyond that of their records: the model is no better
_LEAST_OF_MULTIPLIERS = 0.03
#: logarithm of the likelihood of a test that cannot be predicted
_IMPOSSIBLE = -1e6


class Likelihood:
    """Logarithm of the likelihood of the readings of tests, particle by particle.

    Parameters
    ----------
    problem : Problem
        With the tests as runs, a run a reading.
    prior : Prior
        Of its parameters and the scatter of limits.

    Attributes
    ----------
    test : (r,) array of int
        Number of the test of every reading.
    """

    def __init__(self, problem: Problem, prior: Prior) -> None:
        self.problem, self.prior = problem, prior
        self.runs = problem.measurement.runs
        self.test = np.concatenate([run.signals[TEST] for run in self.runs]).astype(np.intp)
        self._scatter = prior.names.index(SCATTER_OF_LIMITS)

    def predictions(self, counted: Array) -> Array:
        """Margins, frequencies and powers (n, r) by particles (n, p); NaN where there is none."""
        if not len(counted):
            return np.empty((0, self.test.size))
        with ThreadPoolExecutor(WORKERS) as pool:
            return np.stack(list(pool.map(self._predicted, counted)))

    def _predicted(self, counted: Array) -> Array:
        values = self.prior.values(counted)
        values.pop(SCATTER_OF_LIMITS)
        idle = values.pop(IDLE_POWER, 0.0)
        try:
            case = self.problem.case(values)
            return np.concatenate([self._of_run(case, idle, run) for run in self.runs])
        except (InputError, RunError):
            return np.full(self.test.size, np.nan)

    def _of_run(self, case, idle: float, run: Run) -> Array:
        predicted = self.problem.predictions.of(case, run)
        if run.record == POWER:
            return predicted[POWER] + idle
        return predicted["margin" if run.record == "stable" else str(run.record)]

    def scatter(self, counted: Array) -> Array:
        """Scatter (n,) of limits by particles (n, p)."""
        return self.prior.parameters[self._scatter].value(counted[:, self._scatter])

    def of(self, predictions: Array, counted: Array) -> Array:
        """Logarithms (n, r) of the likelihood of readings by predictions (n, r) of particles."""
        scatter, found, begin = self.scatter(counted)[:, None], [], 0
        for run in self.runs:
            end = begin + run.signals[TEST].size
            found.append(self._of_readings(run, predictions[:, begin:end], scatter))
            begin = end
        return np.where(np.isfinite(predictions), np.concatenate(found, axis=1), _IMPOSSIBLE)

    def _of_readings(self, run: Run, predicted: Array, scatter: Array) -> Array:
        channel = str(run.record)
        measured = run.signals[channel]
        if channel == "stable":
            stable = likely_stable(predicted, scatter)
            return np.log(np.where(measured > 0.5, stable, 1.0 - stable))
        if channel in (MAGNITUDE, ANGLE):
            return -0.5 * limited((predicted - measured) / _scatter_of(run)) ** 2
        level = self.problem.kind.first_noise(run)[channel]
        scale = measured * level if channel == "spindle_power" else level
        return -0.5 * limited((predicted - measured) / scale) ** 2


def _scatter_of(run: Run) -> Array:
    """Standard deviations (r,) of the multipliers that records show, of angles in rad."""
    deviation = run.signals[DEVIATION]
    if run.record == ANGLE:
        deviation = deviation / np.maximum(run.signals[MAGNITUDE], 0.1)
    return np.hypot(deviation, _LEAST_OF_MULTIPLIERS)
