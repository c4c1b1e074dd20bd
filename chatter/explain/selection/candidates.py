"""Candidates: every effect that may be missing, tried on top of others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.criteria import (
    EQUAL,
    FITTED_IN_FULL,
    FOLLOWED_STARTS,
    MOST_EFFECTS,
    SIMPLE_ENOUGH,
)
from chatter.explain.effects.effect import Effect
from chatter.explain.effects.effect_list import candidates, rank
from chatter.explain.fitting import WORKERS, Fit, Parameter
from chatter.explain.measurement import Run
from chatter.explain.selection.evidence import log_evidence
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.significance import is_significant
from chatter.explain.selection.split import Split

Progress = Callable[[str, float], None]

#: finite difference and fractions of a linearised step, in units of a parameter's size
_DIFFERENCE, _FRACTIONS = 0.05, (1.0, 0.5, 0.2)
#: weight of a linearised step on parameters without a prior, which keeps it finite
_WEAK_PRIOR = 1e-3
#: share of the progress of a stage that the linearised steps take
_LINEARISED_SHARE = 0.7


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect tried on top of others."""

    effect: Effect
    fit: Fit  # to the runs for fitting
    holdout: float  # sum of squares on the holdout runs
    evidence: float  # logarithm


@dataclass(frozen=True, eq=False)
class Stage:
    """An effect that was looked for beside others."""

    before: Fit  # of the others, to the runs for fitting
    holdout: float  # sum of squares on the holdout runs, by it
    evidence: float  # logarithm, by it
    tried: tuple[Candidate, ...]  # best first

    @property
    def best(self) -> Candidate:
        """Candidate of the highest evidence."""
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
    chosen = _chosen(problem, steps)
    tried = []
    for index, (effect, step) in enumerate(chosen):
        share = _LINEARISED_SHARE + (1.0 - _LINEARISED_SHARE) * index / len(chosen)
        progress(f"fitting {effect.name}", (number + share) / (MOST_EFFECTS + 1))
        tried.append(fitted(problem, effect, split, step.values, step.jacobian))
    return stage_with(problem, now, split, tried)


def stage_with(problem: Problem, now: Fit, split: Split, tried: Sequence[Candidate]) -> Stage:
    """Stage of candidates that were tried beside the effects of a problem.

    Those that are significant first, and of the highest evidence; equals in the order of the list
    of effects.
    """
    holdout = problem.cost(now.by_name, split.holdout)
    stage = Stage(now, holdout, log_evidence(problem, now, split), ())
    best = max((one.evidence for one in tried), default=0.0)

    def order(one: Candidate) -> tuple[bool, float, int]:
        significant = is_significant(stage, one, problem, split)
        return not significant, -min(one.evidence, best - EQUAL), rank(one.effect)

    return replace(stage, tried=tuple(sorted(tried, key=order)))


def _chosen(
    problem: Problem, steps: list[tuple[Effect, LinearisedStep]]
) -> list[tuple[Effect, LinearisedStep]]:
    """Most promising effects; of a family its best member, and the simplest where that may do."""
    steps = sorted(steps, key=lambda entry: entry[1].cost)
    names = list(dict.fromkeys(effect.name for effect, _ in steps))[:FITTED_IN_FULL]
    chosen = []
    for name in names:
        members = [entry for entry in steps if entry[0].name == name]
        count = {id(effect): len(effect.parameters(problem.measurement)) for effect, _ in members}
        best = members[0]
        simplest = min(members, key=lambda entry: (count[id(entry[0])], entry[1].cost))
        if simplest[1].cost <= SIMPLE_ENOUGH * best[1].cost:
            best = simplest
        chosen += [best] if best is simplest else [best, simplest]
    return chosen


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
    holdout = trial.cost(found.by_name, split.holdout)
    return Candidate(effect, found, holdout, log_evidence(trial, found, split))


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
