"""Candidates: every effect that may be missing, tried on top of others."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.criteria import EQUAL, FITTED_IN_FULL, FOLLOWED_STARTS, MOST_EFFECTS
from chatter.explain.effects.effect import Effect
from chatter.explain.effects.effect_list import candidates, rank
from chatter.explain.fitting import WORKERS, Fit, Parameter
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem

Progress = Callable[[str, float], None]

#: finite difference and fractions of a linearised step, in units of a parameter's size
_DIFFERENCE, _FRACTIONS = 0.05, (1.0, 0.5, 0.2)
#: weight of a linearised step on parameters without a prior, which keeps it finite
_WEAK_PRIOR = 1e-3
#: share of the progress of a stage that the linearised steps take
_LINEARISED_SHARE = 0.7


class Split(NamedTuple):
    """Runs to fit, and runs held out to judge by."""

    fitted: tuple[Run, ...]
    holdout: tuple[Run, ...]


def split_runs(runs: Sequence[Run]) -> Split:
    """Hold out every third run, so that both parts cover the conditions."""
    holdout = tuple(run for index, run in enumerate(runs) if index % 3 == 2)
    fitted = tuple(run for index, run in enumerate(runs) if index % 3 != 2)
    return Split(fitted, holdout) if holdout else Split(tuple(runs), tuple(runs))


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect tried on top of others."""

    effect: Effect
    fit: Fit  # to the runs for fitting
    holdout: float  # sum of squares on the holdout runs


@dataclass(frozen=True, eq=False)
class Stage:
    """An effect that was looked for beside others."""

    before: Fit  # of the others, to the runs for fitting
    holdout: float  # sum of squares on the holdout runs, by it
    tried: tuple[Candidate, ...]  # best first

    @property
    def best(self) -> Candidate:
        """Candidate with the least residual of the holdout runs."""
        return self.tried[0]


class LinearisedStep(NamedTuple):
    """Where a linearised step of a candidate leads."""

    cost: float
    values: dict[str, float]
    jacobian: NDArray[np.float64]


def stage_of(problem: Problem, now: Fit, split: Split, progress: Progress, number: int) -> Stage:
    """Try every effect beside those of a problem; `number` is that of the stage, for progress."""
    added = {effect.name for effect in problem.effects}
    effects = [one for one in candidates(problem.measurement) if one.name not in added]
    steps: list[tuple[Effect, LinearisedStep]] = []
    for index, effect in enumerate(effects):
        share = _LINEARISED_SHARE * index / len(effects)
        progress(f"looking at {effect.name}", (number + share) / (MOST_EFFECTS + 1))
        steps.append((effect, linearised(problem, effect, now, split.fitted)))
    steps.sort(key=lambda entry: entry[1].cost)
    best_of_name: dict[str, tuple[Effect, LinearisedStep]] = {}
    for effect, step in steps:
        best_of_name.setdefault(effect.name, (effect, step))
    chosen = list(best_of_name.values())[:FITTED_IN_FULL]
    tried = []
    for index, (effect, step) in enumerate(chosen):
        share = _LINEARISED_SHARE + (1.0 - _LINEARISED_SHARE) * index / len(chosen)
        progress(f"fitting {effect.name}", (number + share) / (MOST_EFFECTS + 1))
        tried.append(fitted(problem, effect, split, step.values, step.jacobian))
    # what every candidate gains, the nuisance parameters gained by going on
    holdout = problem.cost(now.by_name, split.holdout)
    holdout = min(holdout, max((one.holdout for one in tried), default=holdout))
    return Stage(now, holdout, ranked(tried))


def fitted(
    problem: Problem,
    effect: Effect,
    split: Split,
    start: Mapping[str, float],
    jacobian: NDArray[np.float64] | None = None,
) -> Candidate:
    """Fit a problem with an effect added."""
    trial = problem.with_effect(effect)
    found = trial.fit(split.fitted, start, jacobian)
    return Candidate(effect, found, trial.cost(found.by_name, split.holdout))


def ranked(tried: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Candidates, best on the holdout runs first; equals in the order of the list of effects."""
    best = min((one.holdout for one in tried), default=0.0)
    return tuple(sorted(tried, key=lambda one: (max(one.holdout, best + EQUAL), rank(one.effect))))


def linearised(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> LinearisedStep:
    """Best of the linearised steps from every start of an effect.

    The nuisance parameters move along by the Jacobian that is known of them.
    """
    trial = problem.with_effect(effect)
    parameters = trial.parameters()
    added = parameters[len(now.parameters) :]

    def from_start(start: Mapping[str, float]) -> LinearisedStep:
        values = {one.name: one.start for one in parameters}
        values |= now.by_name
        values |= {f"{effect.name}.{key}": value for key, value in start.items()}
        return _one_step(trial, added, values, now, runs)

    with ThreadPoolExecutor(WORKERS) as pool:
        steps = list(pool.map(from_start, effect.starts(problem.measurement)))
        steps.sort(key=lambda step: step.cost)
        followed = pool.map(
            lambda step: _one_step(trial, added, step.values, now, runs), steps[:FOLLOWED_STARTS]
        )
        return min([*followed, steps[0]], key=lambda step: step.cost)


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
    weight = [1.0] * len(now.parameters) + [1.0 if one.prior else _WEAK_PRIOR for one in added]
    normal = jacobian.T @ jacobian + np.diag(weight)
    step = -np.linalg.solve(normal, jacobian.T @ residual)
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
            return LinearisedStep(cost, moved, jacobian)
    return LinearisedStep(float(residual @ residual), values, jacobian)
