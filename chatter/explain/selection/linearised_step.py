"""Linearised steps: how far a candidate gets at once, from each of its starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.criteria import FOLLOWED_STARTS, SCREENED_STARTS
from chatter.explain.effects.effect import Effect, Values
from chatter.explain.fitting import WORKERS, Fit
from chatter.explain.measurement import Run
from chatter.explain.parameters import Parameter
from chatter.explain.selection.problem import Problem

#: finite difference and fractions of a linearised step, in units of a parameter's size
_DIFFERENCE, _FRACTIONS = 0.05, (1.0, 0.5, 0.2)
#: share of the promised fall below which a step that holds the declared values is tried beside
_KEPT_PROMISE = 0.5
#: starts with the declared values put back of which a linearised step is made
_SIZABLE_STARTS = 3
#: runs by which many starts are ranked first, and starts that are then ranked by all runs
_FEW_RUNS, _RANKED_STARTS = 2, 2 * SCREENED_STARTS
#: rms of a change, over the noise, that is none: rounding, and where a record lies beside it
_NO_CHANGE = 1e-3
#: standard deviations by which a declared value is drawn where a mode may stand beside another
_DRAWN = 2.0
#: weight of a linearised step on parameters without a prior, which keeps it finite
WEAK_PRIOR = 1e-3


class LinearisedStep(NamedTuple):
    """Where a linearised step of a candidate leads."""

    cost: float
    promised: float  # fall of the sum of squares by linearised models, over no effect
    values: dict[str, float]
    nuisance: NDArray[np.float64]  # columns of the Jacobian that every step has in common
    own: NDArray[np.float64]  # columns of what the effect adds
    begin: dict[str, float]  # where the step begins, and where the Jacobian is from
    offset: NDArray[np.float64]  # residuals there, less those without the effect
    added: Sequence[Parameter]  # of the effect

    @property
    def jacobian(self) -> NDArray[np.float64]:
        """Columns of all parameters."""
        return np.column_stack([self.nuisance, self.own])


def linearised_from(
    problem: Problem,
    effect: Effect,
    now: Fit,
    runs: Sequence[Run],
    begins: Sequence[Mapping[str, float]],
) -> LinearisedStep:
    """Best of the linearised steps from values of all parameters, by name, and the step after it.

    The nuisance parameters move along by the Jacobian that is known of them.
    """
    trial = problem.with_effect(effect)
    added = trial.parameters()[len(now.parameters) :]
    return _best_of(trial, added, now, runs, [{**one, **now.by_name} for one in begins])


def _best_of(
    trial: Problem,
    added: Sequence[Parameter],
    now: Fit,
    runs: Sequence[Run],
    begins: Sequence[dict[str, float]],
) -> LinearisedStep:
    """Best of the steps from some values, and of those that follow on the best."""

    def from_values(values: dict[str, float]) -> LinearisedStep:
        return _one_step(trial, added, values, now, runs)

    with ThreadPoolExecutor(WORKERS) as pool:
        steps = sorted(pool.map(from_values, begins), key=lambda step: step.cost)
        followed = pool.map(lambda step: from_values(step.values), steps[:FOLLOWED_STARTS])
        best = min([*followed, steps[0]], key=lambda step: step.cost)
    return best._replace(promised=max(step.promised for step in steps))


def linearised(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> LinearisedStep:
    """Best of the linearised steps from the starts of an effect and those that are proposed.

    The nuisance parameters move along by the Jacobian that is known of them.
    """
    begins = _Begins.of(problem, effect, now, runs)
    secants = _secants_of(problem, effect, now, runs)
    own, sizable = (
        _worth_all_runs(problem, effect, now, runs, some) for some in (begins.own, begins.sizable)
    )
    chosen = secants.best(own, SCREENED_STARTS)
    chosen += secants.best(sizable, _SIZABLE_STARTS)
    chosen += begins.proposed
    trial = problem.with_effect(effect)
    added = trial.parameters()[len(now.parameters) :]
    return _best_of(trial, added, now, runs, chosen or [begins.declared])


def promised_by_secants(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> float:
    """Fall of the sum of squares on the best line from no effect through one of its starts.

    One prediction a run for each start that few runs leave. Where the residual is at the noise an
    effect is small, so that what it does grows along such a line.
    """
    begins = _Begins.of(problem, effect, now, runs)
    worth = _worth_all_runs(problem, effect, now, runs, [*begins.own, *begins.sizable])
    every = [*worth, *begins.proposed] or [begins.declared]
    return now.cost - min(_secants_of(problem, effect, now, runs).costs(every))


def _worth_all_runs(
    problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run], begins: list[dict[str, float]]
) -> list[dict[str, float]]:
    """Starts whose lines do best by the few runs in which most is left; all where they are few.

    Frequencies are sought by dozens of starts, most of which a run or two tell to be of no use.
    """
    if len(begins) <= _RANKED_STARTS or len(runs) <= _FEW_RUNS:
        return begins
    left = [problem.part_of(now, runs, [run]) for run in runs]
    order = sorted(range(len(runs)), key=lambda k: left[k].residuals.size - left[k].cost)
    few = [runs[k] for k in sorted(order[:_FEW_RUNS])]
    part = problem.part_of(now, runs, few)
    return _secants_of(problem, effect, part, few).best(begins, _RANKED_STARTS)


class _Begins(NamedTuple):
    """Values of all parameters, by name, from which an effect is looked for."""

    declared: dict[str, float]  # the effect where its parameters begin
    own: list[dict[str, float]]  # its starts
    sizable: list[dict[str, float]]  # with declared values put back, where they were drawn far
    proposed: list[dict[str, float]]  # by the residual

    @classmethod
    def of(cls, problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> _Begins:
        """Beside a fit to some runs."""
        parameters = problem.with_effect(effect).parameters()
        measured = problem.measurement.with_runs(list(runs)).of_kinds(effect.kinds)
        own = problem.measured_by(effect)

        def values_at(start: Values) -> dict[str, float]:
            moved = {f"{effect.name}.{key}": value for key, value in start.items()}
            return {one.name: one.start for one in parameters} | now.by_name | moved

        sizable = []
        if any(abs(pull) > _DRAWN for pull in problem.declared_pulls(now).values()):
            declared = {one.name: one.start for one in now.parameters if one.prior}
            sizable = [values_at(start) | declared for start in effect.sizable_starts(own)]
        predicted = problem.predicted(now.by_name, runs)
        return cls(
            values_at({}),
            [values_at(start) for start in effect.starts(own)],
            sizable,
            [values_at(start) for start in effect.proposed(measured, predicted)],
        )


def _secants_of(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> _Secants:
    """Lines from no effect, beside a fit to some runs."""
    trial = problem.with_effect(effect)
    nothing = effect.nothing(problem.measurement.with_runs(list(runs)).of_kinds(effect.kinds))
    added = trial.parameters()[len(now.parameters) :]
    amounts = [one for one in added if one.name.partition(".")[2] in nothing]
    return _Secants(trial, now, runs, amounts)


class _Secants:
    """Lines from no effect through its starts, the nuisance parameters moving along.

    Where a start does nothing yet, the effect moves along its amounts.
    """

    def __init__(
        self, trial: Problem, now: Fit, runs: Sequence[Run], amounts: Sequence[Parameter]
    ) -> None:
        self.trial, self.now, self.runs, self.amounts = trial, now, runs, amounts
        # what all starts have in common
        self.normal = now.jacobian.T @ now.jacobian + np.eye(len(now.parameters))
        self.gradient = now.jacobian.T @ now.residuals

    def best(self, begins: list[dict[str, float]], most: int) -> list[dict[str, float]]:
        """Starts on whose lines the sum of squares falls most, all where there are few."""
        if len(begins) <= most:
            return begins
        costs = self.costs(begins)
        ranked = sorted(range(len(begins)), key=lambda index: costs[index])
        return [begins[index] for index in ranked[:most]]

    def costs(self, begins: Sequence[Mapping[str, float]]) -> list[float]:
        """Least sums of squares on the lines through some starts."""
        with ThreadPoolExecutor(WORKERS) as pool:
            return list(pool.map(self.cost, begins))

    def cost(self, values: Mapping[str, float]) -> float:
        """Least sum of squares on the line through a start.

        One prediction a run says how well what the effect does there resembles the residual.
        """
        now, across = self.now, self._directions(values)
        coupled = now.jacobian.T @ across
        own = across.T @ across + WEAK_PRIOR * np.eye(across.shape[1])
        normal = np.block([[self.normal, coupled], [coupled.T, own]])
        gradient = np.concatenate([self.gradient, across.T @ now.residuals])
        return now.cost - float(gradient @ np.linalg.solve(normal, gradient))

    def _directions(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        """Changes of the residuals (n, k) by an effect: by all of it, or by each of its amounts."""
        there = self.trial.residuals(values, self.runs)
        secant = there - self.now.residuals
        if float(np.sqrt(np.mean(secant**2))) > _NO_CHANGE or not self.amounts:
            return secant[:, None]
        return _columns(self.trial, self.amounts, values, there, self.runs)


def _promised(
    jacobian: NDArray[np.float64], weight: NDArray[np.float64], residual: NDArray[np.float64]
) -> float:
    """Fall of the sum of squares that the linearised model promises, priors counted."""
    gradient = jacobian.T @ residual
    return float(gradient @ np.linalg.solve(jacobian.T @ jacobian + np.diag(weight), gradient))


def promise_from(
    problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run], begin: Mapping[str, float]
) -> float:
    """Fall of the sum of squares, over no effect, that its linearised model promises there.

    From values of all parameters, by name; the nuisance parameters move along.
    """
    trial = problem.with_effect(effect)
    added = trial.parameters()[len(now.parameters) :]
    values = {**begin, **now.by_name}
    residual = trial.residuals(values, runs)
    jacobian = np.column_stack([now.jacobian, _columns(trial, added, values, residual, runs)])
    promised = _promised(jacobian, _weights(now, added), residual)
    return promised + now.cost - float(residual @ residual)


def _columns(
    trial: Problem,
    added: Sequence[Parameter],
    values: Mapping[str, float],
    residual: NDArray[np.float64],
    runs: Sequence[Run],
) -> NDArray[np.float64]:
    """Differences (n, k) of the residuals by the parameters of an effect, per size."""
    columns = []
    for one in added:
        at = one.counted(values[one.name])
        step = _DIFFERENCE if at + _DIFFERENCE <= one.counted(one.upper) else -_DIFFERENCE
        moved = trial.residuals({**values, one.name: one.value(at + step)}, runs)
        columns.append((moved - residual) / step)
    return np.column_stack(columns) if columns else np.empty((residual.size, 0))


def _weights(now: Fit, added: Sequence[Parameter]) -> NDArray[np.float64]:
    """Weights of a linearised step on the parameters of a fit and on those added."""
    own = [1.0 if one.prior else WEAK_PRIOR for one in added]
    return np.array([1.0] * len(now.parameters) + own)


def _one_step(
    trial: Problem,
    added: Sequence[Parameter],
    values: dict[str, float],
    now: Fit,
    runs: Sequence[Run],
) -> LinearisedStep:
    residual = trial.residuals(values, runs)
    own = _columns(trial, added, values, residual, runs)
    jacobian = np.column_stack([now.jacobian, own])
    weight = _weights(now, added)
    offset = residual - now.residuals
    begin = float(residual @ residual)
    fall = _promised(jacobian, weight, residual)
    everything = [*now.parameters, *added]

    def along(weights: NDArray[np.float64]) -> tuple[float, dict[str, float]]:
        step = -np.linalg.solve(jacobian.T @ jacobian + np.diag(weights), jacobian.T @ residual)
        return _shortened(trial, everything, values, step, begin, runs)

    cost, moved = along(weight)
    if begin - cost < _KEPT_PROMISE * fall:
        # beside a large misfit the declared values are drawn far from where the model is a line
        held = weight.copy()
        held[: len(now.parameters)] = max(1.0, begin / residual.size)
        cost, moved = min((cost, moved), along(held), key=lambda entry: entry[0])
    promised = now.cost - begin + fall
    return LinearisedStep(cost, promised, moved, now.jacobian, own, values, offset, added)


def _shortened(
    trial: Problem,
    parameters: Sequence[Parameter],
    values: dict[str, float],
    step: NDArray[np.float64],
    begin: float,
    runs: Sequence[Run],
) -> tuple[float, dict[str, float]]:
    """Sum of squares and values after the longest part of a step that lowers it; none: as begun."""
    for fraction in _FRACTIONS:
        moved = {
            one.name: one.moved(values[one.name], fraction * float(change))
            for one, change in zip(parameters, step, strict=True)
        }
        cost = trial.cost(moved, runs)
        if cost < begin:
            return cost, moved
    return begin, values
