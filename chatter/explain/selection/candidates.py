"""Candidates: every effect that may be missing, tried on top of others."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from chatter.explain.criteria import (
    AT_NOISE,
    EQUAL,
    FINISHED,
    FITTED_IN_FULL,
    MOST_EFFECTS,
    PROMISING,
    SIMPLE_ENOUGH,
)
from chatter.explain.effects.effect import Effect
from chatter.explain.effects.effect_list import candidates, rank
from chatter.explain.fitting import Fit, Matrix
from chatter.explain.measurement import Run
from chatter.explain.selection.cheaper_runs import (
    ScreenedCandidate,
    is_at_noise,
    least_promise,
    screened_candidates,
)
from chatter.explain.selection.evidence import log_evidence
from chatter.explain.selection.joint_steps import JointStep, joint_steps
from chatter.explain.selection.linearised_step import (
    LinearisedStep,
    linearised,
    linearised_from,
    promised_by_secants,
)
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.significance import is_significant
from chatter.explain.selection.split import Split

Progress = Callable[[str, float], None]

#: share of the progress of a stage that the linearised steps take
_LINEARISED_SHARE = 0.7


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect tried on top of others."""

    effect: Effect
    fit: Fit  # to the runs for fitting
    holdout: float  # sum of squares on the holdout runs
    evidence: float  # logarithm

    def without_jacobian(self) -> Candidate:
        """Return the candidate with what compares it, without the Jacobian, by far the largest."""
        none = np.empty((0, len(self.fit.parameters)))
        return replace(self, fit=replace(self.fit, jacobian=none))


@dataclass(frozen=True, eq=False)
class Stage:
    """An effect that was looked for beside others."""

    before: Fit  # of the others, to the runs for fitting
    holdout: float  # sum of squares on the holdout runs, by it
    evidence: float  # logarithm, by it
    tried: tuple[Candidate, ...]  # best first
    together: tuple[JointStep, ...] = ()  # pairs that promise more than each of them

    @property
    def best(self) -> Candidate:
        """Candidate of the highest evidence."""
        return self.tried[0]


def stage_of(problem: Problem, now: Fit, split: Split, progress: Progress, number: int) -> Stage:
    """Try every effect beside those of a problem; `number` is that of the stage, for progress."""
    added = {effect.name for effect in problem.effects}
    effects = [
        one
        for one in candidates(problem.measurement)
        if one.name not in added and one.applies_beside(problem.measured_by(one), added)
    ]
    screened, runs = problem.screened(now, split.fitted)
    progress("looking at what may be missing", number / (MOST_EFFECTS + 1))
    steps = _linearised_steps(screened, now, runs, effects, progress, number)
    chosen = _chosen(problem, steps)
    hopeful = [entry for entry in chosen if _may_be_significant(problem, entry[1], now)]
    # one at the least, so that the report can say how far nothing helps
    chosen = hopeful or chosen[:1]
    tried = []
    rough = _RoughFits(problem, screened, runs, split)
    for index, (effect, step) in enumerate(chosen):
        share = _LINEARISED_SHARE + (1.0 - _LINEARISED_SHARE) * index / len(chosen)
        progress(f"fitting {effect.name}", (number + share) / (MOST_EFFECTS + 1))
        tried.append(rough.of(effect, step.values, step.jacobian))
    most = max((now.cost - one.fit.cost for one in tried), default=0.0)
    found = stage_with(problem, now, split, _finished(problem, now, split, tried, most))
    if problem.effects:
        return found
    together = joint_steps(now, steps, least_promise(problem, now))
    return replace(found, together=tuple(together))


def _linearised_steps(
    problem: Problem,
    now: Fit,
    runs: Sequence[Run],
    effects: Sequence[Effect],
    progress: Progress,
    number: int,
) -> list[tuple[Effect, LinearisedStep]]:
    """Linearised steps of the effects that may be missing, the most promising first.

    Where the residual is at the noise, of those that promise something; where one takes it there,
    of its rivals. One at the least, so that the report can say how far nothing helps.
    """
    steps: list[tuple[Effect, LinearisedStep]] = []
    hopes = _hopes(problem, now, screened_candidates(problem, now, runs, effects), runs)
    least = least_promise(problem, now) if is_at_noise(now) else -math.inf
    for index, (effect, begins, promised) in enumerate(hopes):
        if steps and promised < least:
            break
        share = _LINEARISED_SHARE * index / len(hopes)
        progress(f"looking at {effect.name}", (number + share) / (MOST_EFFECTS + 1))
        step = (
            linearised(problem, effect, now, runs)
            if begins is None
            else linearised_from(problem, effect, now, runs, begins)
        )
        steps.append((effect, step))
        reached = _reached(problem, effect, step, now, runs)
        if reached <= AT_NOISE**2 * now.residuals.size:
            least = max(least, PROMISING * (now.cost - reached))
    return steps


def _reached(
    problem: Problem, effect: Effect, step: LinearisedStep, now: Fit, runs: Sequence[Run]
) -> float:
    """Sum of squares where a step leads, and a rough fit from there if that is most of the way."""
    misfit = now.cost - now.residuals.size
    if now.cost - step.cost < FINISHED * misfit:
        return step.cost
    found = problem.with_effect(effect).rough_fit(runs, step.values, step.jacobian)
    return min(step.cost, found.cost)


class _Hope(NamedTuple):
    """An effect that may be missing, and what it promises."""

    effect: Effect
    begins: Sequence[Mapping[str, float]] | None  # from its own starts where nothing is known
    promised: float  # fall of the sum of squares by a line through a start; infinite if not asked


def _hopes(
    problem: Problem, now: Fit, screened: Sequence[ScreenedCandidate], runs: Sequence[Run]
) -> list[_Hope]:
    """Effects in the order of what they promise."""
    hopes = [
        _Hope(
            effect, begins, math.inf if begins else promised_by_secants(problem, effect, now, runs)
        )
        for effect, begins in screened
    ]
    return sorted(hopes, key=lambda hope: -hope.promised)


def _finished(
    problem: Problem, now: Fit, split: Split, tried: Sequence[Candidate], most: float
) -> list[Candidate]:
    """Candidates that were fitted roughly, in full those whose gain comes near the most."""
    least = max(FINISHED * most, least_promise(problem, now))
    return [
        fitted(problem, one.effect, split, one.fit.by_name)
        if now.cost - one.fit.cost >= least
        else one
        for one in tried
    ]


class _RoughFits(NamedTuple):
    """Fits near enough to rank candidates by, to a problem as it was screened."""

    problem: Problem
    screened: Problem
    runs: Sequence[Run]  # for fitting, as they were screened
    split: Split

    def of(
        self, effect: Effect, start: Mapping[str, float], jacobian: Matrix | None = None
    ) -> Candidate:
        """Fit the problem with an effect added."""
        found = self.screened.with_effect(effect).rough_fit(self.runs, start, jacobian)
        trial = self.problem.with_effect(effect)
        return _candidate(trial, trial.judged(found, self.split.fitted), self.split)


def fitted_beside(
    problem: Problem,
    now: Fit,
    split: Split,
    own: Candidate,
    others: Sequence[tuple[Effect, Mapping[str, float]]],
) -> list[Candidate]:
    """Return a candidate, and others with their starts: in full where they come near the best."""
    screened, runs = problem.screened(now, split.fitted)
    rough = _RoughFits(problem, screened, runs, split)
    tried = [rough.of(effect, start) for effect, start in others]
    most = now.cost - min([own.fit.cost, *(one.fit.cost for one in tried)])
    return [own, *_finished(problem, now, split, tried, most)]


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

    ordered = sorted(tried, key=order)
    return replace(stage, tried=(*ordered[:1], *(one.without_jacobian() for one in ordered[1:])))


def _may_be_significant(problem: Problem, step: LinearisedStep, now: Fit) -> bool:
    """Whether a full fit may yet make significant what linearised steps promise or gain."""
    return max(step.promised, now.cost - step.cost) >= least_promise(problem, now)


def _chosen(
    problem: Problem, steps: list[tuple[Effect, LinearisedStep]]
) -> list[tuple[Effect, LinearisedStep]]:
    """Most promising effects; of a family its best member, and the simplest where that may do."""
    steps = sorted(steps, key=lambda entry: entry[1].cost)
    names = list(dict.fromkeys(effect.name for effect, _ in steps))[:FITTED_IN_FULL]
    chosen = []
    for name in names:
        members = [entry for entry in steps if entry[0].name == name]
        count = {
            id(effect): len(effect.parameters(problem.measured_by(effect))) for effect, _ in members
        }
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
    jacobian: Matrix | None = None,
) -> Candidate:
    """Fit a problem with an effect added; with the Jacobian at the start where it is known."""
    trial = problem.with_effect(effect)
    return _candidate(trial, trial.fit(split.fitted, start, jacobian), split)


def _candidate(trial: Problem, found: Fit, split: Split) -> Candidate:
    holdout = trial.cost(found.by_name, split.holdout)
    return Candidate(trial.effects[-1], found, holdout, log_evidence(trial, found, split))
