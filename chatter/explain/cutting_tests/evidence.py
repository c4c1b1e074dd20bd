"""How much better one model of cutting tests is than another, and the scatter of readings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from chatter.explain.cutting_tests.priors import declared, prior_cost
from chatter.explain.fitting import Fit
from chatter.explain.kinds.kind import Noise
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem

#: scatter of limits that tests may have, as shares of the depth
_SCATTERS = (0.06, 0.08, 0.1, 0.13, 0.17, 0.22)
#: factor by which the usual scatter of limits is known
_FACTOR_OF_SCATTER = 2.0
#: fall of twice the logarithm of the likelihood that a wider scatter of limits must bring
_LEAST_FOR_SCATTER = 3.0
#: least and largest scatter of frequencies and powers, as shares
_LEAST, _LARGEST = {"chatter_frequency": 0.005, "spindle_power": 0.01}, 0.05
_TO_DEVIATION = 1.4826


def penalised_cost(problem: Problem, fit: Fit) -> float:
    """Twice the lost logarithm of the evidence of a model fitted to tests, but for a constant.

    Likelihood, priors, and for each number without a prior the logarithm of the number of tests
    (Schwarz 1978, Ann. Stat. 6:461).
    """
    tests = sum(
        run.signals["stable"].size for run in problem.measurement.runs if run.record == "stable"
    )
    return fit.cost + prior_cost(problem, fit) + charged_numbers(problem) * math.log(tests)


def charged_numbers(problem: Problem) -> int:
    """How many numbers effects add that no prior holds."""
    names = {one.name for one in declared(problem)}
    return sum(1 for one in problem.parameters() if one.name not in names and not one.prior)


def cost_of_scatter(problem: Problem) -> float:
    """Twice the lost logarithm of the prior of the scatter of limits, which is known by a factor.

    A wide scatter excuses every model: it counts where models with their own scatters compare.
    """
    scatter = max(own["stable"] for own in problem.noise.values() if "stable" in own)
    return (math.log(scatter / _SCATTERS[0]) / math.log(_FACTOR_OF_SCATTER)) ** 2


def with_scatter(problem: Problem, values: Mapping[str, float]) -> Problem:
    """Same problem with the scatter of limits, frequencies and powers beside a case."""
    case, runs = problem.case(values), problem.measurement.runs
    levels: dict[str, float] = {}
    for channel in _LEAST:
        own = [run for run in runs if run.record == channel]
        if not own:
            continue
        time, ratio = [], []
        for run in own:
            measured = run.signals[channel]
            ratio.append(problem.predictions.of(case, run)[channel] / measured)
            time.append(run.signals.get("cut_time", np.zeros(measured.size)))
        levels[channel] = _scatter(np.concatenate(ratio), np.concatenate(time), channel)
    scatter = _scatter_of_limits(problem, values)
    noise = {run.name: _noise_of(run, scatter, levels) for run in runs}
    return _with_noise(problem, noise)


def _scatter(ratio: np.ndarray, time: np.ndarray, channel: str) -> float:
    """Scatter of readings from test to test: of neighbours in time, which wear leaves alike."""
    if channel == "chatter_frequency":
        apart = ratio - 1.0
    else:
        apart = np.diff(ratio[np.argsort(time, kind="stable")]) / math.sqrt(2.0)
    if apart.size < 2:
        return _LARGEST
    level = _TO_DEVIATION * float(np.median(np.abs(apart))) / float(np.median(np.abs(ratio)))
    return min(max(level, _LEAST[channel]), _LARGEST)


def _scatter_of_limits(problem: Problem, values: Mapping[str, float]) -> float:
    """Scatter at which the verdicts are likeliest; the usual one unless they ask for more."""
    runs = [run for run in problem.measurement.runs if run.record == "stable"]
    costs = []
    for scatter in _SCATTERS:
        noise = {run.name: {"stable": scatter} for run in runs}
        costs.append(_with_noise(problem, noise).cost(values, runs))
    best = int(np.argmin(costs))
    return _SCATTERS[best] if costs[0] - costs[best] > _LEAST_FOR_SCATTER else _SCATTERS[0]


def _noise_of(run: Run, scatter: float, levels: Mapping[str, float]) -> dict[str, float]:
    if run.record == "stable":
        return {"stable": scatter}
    channel = str(run.record)
    level = levels[channel]
    if channel == "chatter_frequency":
        level *= float(np.median((run.whole or run).signals[channel]))
    return {channel: level}


def _with_noise(problem: Problem, noise: Noise) -> Problem:
    return replace(problem, noise=noise)
