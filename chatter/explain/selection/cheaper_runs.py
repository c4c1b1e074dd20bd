"""Candidates screened by the runs of a set-up that cost little to predict.

An FRF of a machine takes milliseconds, a cut or a move in time a second. What the FRFs ask for is
found by them and judged by all runs; what they exclude is not simulated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from chatter.explain.criteria import (
    AT_NOISE,
    CERTAIN_EVIDENCE,
    FITTED_IN_FULL,
    LEAST_SHARE,
    NEAR_NOISE,
    PROMISING,
)
from chatter.explain.effects.effect import Effect
from chatter.explain.fitting import Fit
from chatter.explain.measurement import Run
from chatter.explain.selection.linearised_step import (
    LinearisedStep,
    linearised,
    linearised_from,
    promise_from,
)
from chatter.explain.selection.problem import Problem

#: candidates that are fitted to the cheaper runs where these ask for something
_MOST_SCREENED = 8
#: size of an amount up to which it is nothing, and to which it is to be known for that
_NOTHING = 0.2


class ScreenedCandidate(NamedTuple):
    """A candidate that passed, and where it begins; from its own starts where nothing is known."""

    effect: Effect
    begins: Sequence[Mapping[str, float]] | None = None


def screened_candidates(
    problem: Problem, now: Fit, runs: Sequence[Run], effects: Sequence[Effect]
) -> list[ScreenedCandidate]:
    """Effects that may be missing by the cheaper of some runs, to which the fit is.

    All of them where no runs are cheaper than others.
    """
    cheap = problem.kind.cheaper_runs(problem.measurement.case, runs)
    if not cheap:
        return [ScreenedCandidate(effect) for effect in effects]
    part = problem.part_of(now, runs, cheap)
    kinds = {run.kind for run in cheap}
    shown = [one for one in effects if kinds & set(one.kinds)]
    if part.cost > NEAR_NOISE**2 * part.residuals.size:
        asked = _asked_for(problem, part, cheap, shown)
        if asked:
            return asked
    others = [
        ScreenedCandidate(one)
        for one in effects
        if not kinds & set(one.kinds) and _may_be_missing(problem, one, now, runs)
    ]
    steps = [(one, _step_from_nothing(problem, one, part, cheap)) for one in shown]
    return others + [
        ScreenedCandidate(effect, [step.values])
        for effect, step in steps
        if not _is_excluded(problem, effect, step) and _promises(problem, effect, now, runs)
    ]


def _may_be_missing(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> bool:
    """Whether an effect that the cheaper runs do not show is worth its starts by all runs.

    Where these are at their noise it is small, if it is there. One that the residual proposes does
    not grow from nothing in a straight line.
    """
    if not is_at_noise(now):
        return True
    if type(effect).proposed is not Effect.proposed:
        return True
    return _promises(problem, effect, now, runs)


def _promises(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> bool:
    """Whether all runs, linearised where an effect is not there, promise something by it.

    The cheaper runs are at their noise: an effect that remains is small. Steps from where it
    helps cost several simulations of every run, this one for each of its numbers.
    """
    nothing = effect.nothing(problem.measured_by(effect))
    if not nothing:
        return True
    promised = promise_from(problem, effect, now, runs, _beginning(problem, effect, nothing))
    return promised >= least_promise(problem, now)


def is_at_noise(now: Fit) -> bool:
    """Whether the residual of a fit is no more than noise."""
    return now.cost <= AT_NOISE**2 * now.residuals.size


def least_promise(problem: Problem, now: Fit) -> float:
    """Fall of the sum of squares that must be promised for a closer look.

    A share of what is significant, beside what the fit leaves above the noise.
    """
    fixed, share = problem.kind.least_gain
    misfit = now.cost - now.residuals.size
    return PROMISING * max(fixed + share * now.residuals.size, LEAST_SHARE * misfit)


def _asked_for(
    problem: Problem, part: Fit, cheap: Sequence[Run], effects: Sequence[Effect]
) -> list[ScreenedCandidate]:
    """Candidates that may take a significant part of the residual away, the best first."""
    steps = [(one, linearised(problem, one, part, cheap)) for one in effects]
    least = least_promise(problem, part)
    gaining = [
        (effect, step)
        for effect, step in steps
        if max(step.promised, part.cost - step.cost) >= least
    ]
    gaining.sort(key=lambda entry: entry[1].cost)
    fits = [_fitted_to(problem, cheap, *entry) for entry in gaining[:_MOST_SCREENED]]
    order = sorted(range(len(fits)), key=lambda index: fits[index].cost)
    return [
        ScreenedCandidate(gaining[index][0], [fits[index].by_name])
        for index in order[:FITTED_IN_FULL]
        if _may_be_it(fits[index], fits[order[0]])
    ]


def _fitted_to(problem: Problem, cheap: Sequence[Run], effect: Effect, step: LinearisedStep) -> Fit:
    """Fit of a candidate to the cheaper runs, that of a step where it ends no lower."""
    found = problem.with_effect(effect).fit(cheap, step.values, step.jacobian)
    if found.cost <= step.cost:
        return found
    values = np.array([step.values[one.name] for one in found.parameters])
    residuals = problem.with_effect(effect).residuals(step.values, cheap)
    return replace(found, values=values, residuals=residuals)


def _may_be_it(one: Fit, best: Fit) -> bool:
    """Whether the cheaper runs leave a candidate beside the best of them.

    Where one effect takes them to their noise, another that does not is not the one missing.
    """
    if best.cost > NEAR_NOISE**2 * best.residuals.size:
        return True
    return 0.5 * (one.cost - best.cost) < CERTAIN_EVIDENCE


def _step_from_nothing(
    problem: Problem, effect: Effect, part: Fit, cheap: Sequence[Run]
) -> LinearisedStep:
    """Linearised step of an effect that begins where it is not there."""
    nothing = effect.nothing(problem.measured_by(effect))
    return linearised_from(problem, effect, part, cheap, [_beginning(problem, effect, nothing)])


def _beginning(problem: Problem, effect: Effect, nothing: Mapping[str, float]) -> dict[str, float]:
    """Values of all parameters, by name, where an effect is not there."""
    begin = {one.name: one.start for one in problem.with_effect(effect).parameters()}
    return begin | {f"{effect.name}.{key}": value for key, value in nothing.items()}


def _is_excluded(problem: Problem, effect: Effect, step: LinearisedStep) -> bool:
    """Whether all amounts of an effect are known to be next to nothing."""
    nothing = effect.nothing(problem.measured_by(effect))
    if not nothing:
        return False
    count = step.nuisance.shape[1]
    jacobian = step.jacobian
    # parameters count in sizes: a prior, or next to nothing where there is none
    held = [1.0] * count + [1.0 if one.prior else 1e-6 for one in step.added]
    spread = np.linalg.pinv(jacobian.T @ jacobian + np.diag(held), hermitian=True)
    for index, one in enumerate(step.added):
        key = one.name.partition(".")[2]
        if key not in nothing:
            continue
        away = abs(step.values[one.name] - nothing[key]) / one.size
        if max(away, np.sqrt(spread[count + index, count + index])) > _NOTHING:
            return False
    return True
