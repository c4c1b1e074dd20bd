"""Linearised steps: how far a candidate gets at once, from each of its starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.criteria import FOLLOWED_STARTS, SCREENED_STARTS
from chatter.explain.effects.effect import Effect, Values
from chatter.explain.fitting import WORKERS, Fit, Parameter
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem

#: finite difference and fractions of a linearised step, in units of a parameter's size
_DIFFERENCE, _FRACTIONS = 0.05, (1.0, 0.5, 0.2)
#: weight of a linearised step on parameters without a prior, which keeps it finite
_WEAK_PRIOR = 1e-3


class LinearisedStep(NamedTuple):
    """Where a linearised step of a candidate leads."""

    cost: float
    promised: float  # fall of the sum of squares by linearised models, over no effect
    values: dict[str, float]
    jacobian: NDArray[np.float64]


def linearised(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> LinearisedStep:
    """Best of the linearised steps from the starts of an effect and those that are proposed.

    The nuisance parameters move along by the Jacobian that is known of them.
    """
    trial = problem.with_effect(effect)
    parameters = trial.parameters()
    added = parameters[len(now.parameters) :]

    def values_at(start: Values) -> dict[str, float]:
        own = {f"{effect.name}.{key}": value for key, value in start.items()}
        return {one.name: one.start for one in parameters} | now.by_name | own

    def from_values(values: dict[str, float]) -> LinearisedStep:
        return _one_step(trial, added, values, now, runs)

    measured = problem.measurement.with_runs(list(runs))
    predicted = problem.predicted(now.by_name, runs)
    with ThreadPoolExecutor(WORKERS) as pool:
        begins = [values_at(start) for start in effect.starts(problem.measurement)]
        if len(begins) > SCREENED_STARTS:
            costs = list(pool.map(lambda values: _along_secant(trial, values, now, runs), begins))
            ranked = sorted(range(len(begins)), key=lambda index: costs[index])
            begins = [begins[index] for index in ranked[:SCREENED_STARTS]]
        begins += [values_at(start) for start in effect.proposed(measured, predicted)]
        steps = sorted(pool.map(from_values, begins), key=lambda step: step.cost)
        followed = pool.map(lambda step: from_values(step.values), steps[:FOLLOWED_STARTS])
        best = min([*followed, steps[0]], key=lambda step: step.cost)
    return best._replace(promised=max(step.promised for step in steps))


def _along_secant(
    trial: Problem, values: Mapping[str, float], now: Fit, runs: Sequence[Run]
) -> float:
    """Least sum of squares on the line from no effect through a start, others moving along.

    One prediction a run says how well what the effect does there resembles the residual. A start
    at which the effect does nothing says nothing: it comes first.
    """
    secant = trial.residuals(values, runs) - now.residuals
    if not np.any(secant):
        return -np.inf
    jacobian = np.column_stack([now.jacobian, secant])
    weight = np.append(np.ones(len(now.parameters)), _WEAK_PRIOR)
    return now.cost - _promised(jacobian, weight, now.residuals)


def _promised(
    jacobian: NDArray[np.float64], weight: NDArray[np.float64], residual: NDArray[np.float64]
) -> float:
    """Fall of the sum of squares that the linearised model promises, priors counted."""
    gradient = jacobian.T @ residual
    return float(gradient @ np.linalg.solve(jacobian.T @ jacobian + np.diag(weight), gradient))


def _one_step(
    trial: Problem,
    added: Sequence[Parameter],
    values: dict[str, float],
    now: Fit,
    runs: Sequence[Run],
) -> LinearisedStep:
    residual = trial.residuals(values, runs)
    columns = []
    for one in added:
        step = _DIFFERENCE * one.size
        if values[one.name] + step > one.upper:
            step = -step
        moved = trial.residuals({**values, one.name: values[one.name] + step}, runs)
        columns.append((moved - residual) / (step / one.size))
    jacobian = np.column_stack([now.jacobian, *columns])
    weight = np.array(
        [1.0] * len(now.parameters) + [1.0 if one.prior else _WEAK_PRIOR for one in added]
    )
    normal = jacobian.T @ jacobian + np.diag(weight)
    step = -np.linalg.solve(normal, jacobian.T @ residual)
    left = float(residual @ residual) - _promised(jacobian, weight, residual)
    promised = now.cost - left
    everything = [*now.parameters, *added]
    for fraction in _FRACTIONS:
        moved = {
            one.name: float(
                np.clip(values[one.name] + fraction * change * one.size, one.lower, one.upper)
            )
            for one, change in zip(everything, step, strict=True)
        }
        cost = trial.cost(moved, runs)
        if cost < residual @ residual:
            return LinearisedStep(cost, promised, moved, jacobian)
    return LinearisedStep(float(residual @ residual), promised, values, jacobian)
