"""Effects that were added one after the other or in pairs, and whether the data ask for each."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from chatter.explain.criteria import (
    FITTED_AGAIN,
    LEAST_EVIDENCE,
    MOST_EFFECTS,
    MOST_LOST,
    NEAR_NOISE,
    NO_RESIDUAL,
    PAIRED,
)
from chatter.explain.effects.effect import Effect
from chatter.explain.effects.effect_list import other_variants, richer_forms
from chatter.explain.fitting import Fit
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection.candidates import (
    Candidate,
    Progress,
    Stage,
    fitted,
    fitted_beside,
    stage_of,
    stage_with,
)
from chatter.explain.selection.cheaper_runs import least_promise, screened_candidates
from chatter.explain.selection.evidence import log_evidence
from chatter.explain.selection.linearised_step import LinearisedStep, linearised, linearised_from
from chatter.explain.selection.other_starts import fit_from_elsewhere
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.significance import is_significant
from chatter.explain.selection.split import Split, split_runs

#: times that members of families give way to richer ones
_MOST_RICHER = 2
#: other forms of an effect that may be missing in a measurement
Forms = Callable[[Effect, Measurement], list[Effect]]


class Path(NamedTuple):
    """Effects added to a problem, each in its stage, and the fit to the runs for fitting."""

    stages: list[Stage]
    problem: Problem
    now: Fit

    def over_noise(self, holdout: Sequence[Run]) -> float:
        """Rms of the normalised residual of holdout runs."""
        cost = self.problem.cost(self.now.by_name, holdout)
        return math.sqrt(cost / self.problem.count(holdout))

    def evidence_beside(self, other: Problem, split: Split) -> float:
        """Logarithm of the evidence with the noise of a problem, so that paths compare."""
        alike = replace(self.problem, noise=other.noise)
        residuals = alike.residuals(self.now.by_name, split.fitted)
        return log_evidence(alike, replace(self.now, residuals=residuals), split)


def best_path(begin: Path, first: Stage, split: Split, progress: Progress) -> Path:
    """Follow the best candidate and, where that does not lead to the noise, richer forms and pairs.

    Of two effects that are missing, neither may do well alone, and a third best in their place.
    """
    best = gone_on(begin, first, split, progress)
    if best.over_noise(split.holdout) < NEAR_NOISE:
        return best
    # far fewer are the richer forms of what was found than the pairs
    richer = _in_other_forms(best, split, richer_forms, progress)
    if richer.over_noise(split.holdout) < NEAR_NOISE:
        return richer
    progress("fitting pairs of effects", 0.8)
    for path in _pairs(begin, first, best, split):
        best = _better(path, best, begin.problem, split)
    return best


def _better(one: Path, other: Path, problem: Problem, split: Split) -> Path:
    """Path of the higher evidence, the other where they hardly differ."""
    gain = one.evidence_beside(problem, split) - other.evidence_beside(problem, split)
    return one if gain > LEAST_EVIDENCE else other


def gone_on(begin: Path, stage: Stage, split: Split, progress: Progress) -> Path:
    """Add effects, the first as ranked by a stage, as long as holdout runs gain by them."""
    stages, problem, now = list(begin.stages), begin.problem, begin.now
    while stage.tried and is_significant(stage, stage.best, problem, split):
        stages.append(stage)
        values = stage.best.fit.by_name
        problem = problem.with_effect(stage.best.effect).with_noise_beside(values)
        progress("fitting from other starting values", len(stages) / (MOST_EFFECTS + 1))
        now = fit_from_elsewhere(problem, problem.fit(split.fitted, values), split)
        path = Path(stages, problem, now)
        if len(stages) == MOST_EFFECTS or path.over_noise(split.holdout) < NO_RESIDUAL:
            break
        stage = stage_of(problem, now, split, progress, len(stages))
    return Path(stages, problem, now)


def with_records_of_case(path: Path, split: Split) -> tuple[Path, Split]:
    """Path with the settled records as its case tells them, and its runs; itself if as they are.

    Effects stay, and their stages as they were found.
    """
    problem, values = path.problem, path.now.by_name
    measurement = problem.kind.with_records_by(problem.measurement, problem.case(values))
    if measurement is problem.measurement:
        return path, split
    split = split_runs(measurement)
    problem = replace(problem, measurement=measurement)
    now = problem.fit(split.fitted, values)
    problem = problem.with_noise_beside(now.by_name)
    return Path(path.stages, problem, problem.fit(split.fitted, now.by_name)), split


def _pairs(begin: Path, first: Stage, best: Path, split: Split) -> list[Path]:
    """Pairs of the first candidates, fitted jointly, of which both are significant together."""
    seen = {frozenset(stage.best.effect.name for stage in best.stages)}
    proposed = [
        (one, other.effect, {**other.fit.by_name, **one.fit.by_name})
        for one, other in itertools.combinations(first.tried[:PAIRED], 2)
    ]
    alone = {one.effect.name: one for one in first.tried}
    for step in first.together:
        # the one that does more alone is the first
        first_effect, second_effect = sorted(step.effects, key=lambda one: one.name not in alone)
        candidate = alone.get(first_effect.name)
        if candidate is None or candidate.effect is not first_effect:
            candidate = fitted(begin.problem, first_effect, split, step.values)
        proposed.append((candidate, second_effect, step.values))
    paths = []
    for candidate, effect, values in proposed:
        names = frozenset((candidate.effect.name, effect.name))
        if len(names) < 2 or names in seen:
            continue
        seen.add(names)
        paths += _pair(begin, candidate, effect, values, split)
    return paths


def _pair(
    begin: Path, one: Candidate, other: Effect, values: Mapping[str, float], split: Split
) -> list[Path]:
    """Path of two effects fitted jointly; none where one of them gains nothing beside the other."""
    alone = begin.problem.with_effect(one.effect)
    rough = alone.with_effect(other).rough_fit(split.fitted, values)
    if one.fit.cost - rough.cost < least_promise(alone, one.fit):
        return []
    joint = fitted(alone, other, split, rough.by_name, rough.jacobian)
    start = stage_with(begin.problem, begin.now, split, [one])
    added = Stage(one.fit, one.holdout, one.evidence, (joint,))
    # the first of them may gain nothing alone
    if not all(
        is_significant(before, joint, problem, split)
        for before, problem in ((start, begin.problem), (added, alone))
    ):
        return []
    problem = alone.with_effect(other).with_noise_beside(joint.fit.by_name)
    now = problem.fit(split.fitted, joint.fit.by_name)
    return [Path([start, added], problem, now)]


def tried_again(path: Path, split: Split) -> Path:
    """Ask of every effect whether it is needed, or another does better beside the others.

    The first was chosen when the others were not there, and may have stood for them.
    """
    stages, problem, now = path
    kept = list(stages)
    for stage in stages:
        without = problem.without_effect(stage.best.effect)
        before = without.fit(split.fitted, now.by_name)
        names = {effect.name for effect in without.effects}
        others = [
            (one.effect, {**one.fit.by_name, **before.by_name})
            for one in stage.tried[1:FITTED_AGAIN]
            if one.effect.name not in names
        ]
        own = fitted(without, stage.best.effect, split, now.by_name)
        tried = fitted_beside(without, before, split, own, others)
        found = stage_with(without, before, split, tried)
        index = kept.index(stage)
        if not is_significant(found, found.best, without, split):
            del kept[index]
            problem, now = without, before
            continue
        kept[index] = found
        problem, now = without.with_effect(found.best.effect), found.best.fit
    return Path(kept, problem, now)


def in_other_forms(path: Path, split: Split, progress: Progress) -> Path:
    """Put other members of families in the place of those added, as long as the data ask.

    Which variant did best was asked when the effects added later were not there.
    """
    path = _in_other_forms(path, split, other_variants, progress)
    for _ in range(_MOST_RICHER):
        if path.over_noise(split.holdout) < NO_RESIDUAL:
            break
        further = _in_other_forms(path, split, richer_forms, progress)
        if further is path:
            break
        path = further
    return path


def _in_other_forms(path: Path, split: Split, forms_of: Forms, progress: Progress) -> Path:
    """Path with the best other member of each family; itself where the data ask for none."""
    for index, stage in enumerate(path.stages):
        effect = stage.best.effect
        others = forms_of(effect, path.problem.measurement)
        if not others:
            continue
        progress(f"looking at other forms of {effect.name}", 0.88)
        without = path.problem.without_effect(effect)
        before = without.fit(split.fitted, path.now.by_name)
        own = fitted(without, effect, split, path.now.by_name)
        member = _better_member(without, before, own, others, split)
        if member is None:
            continue
        found = stage_with(without, before, split, [member, own])
        problem = without.with_effect(member.effect).with_noise_beside(member.fit.by_name)
        now = problem.fit(split.fitted, member.fit.by_name)
        path = Path([*path.stages[:index], found, *path.stages[index + 1 :]], problem, now)
    return path


def _better_member(
    without: Problem, before: Fit, own: Candidate, others: Sequence[Effect], split: Split
) -> Candidate | None:
    """First other member of a family that does better than the one added; None where none does.

    In the order of what linearised steps gain: one that gains most of the runs fitted may predict
    the holdout runs worse, where another predicts them better.
    """
    steps = _steps(without, before, split.fitted, others)
    for one, step in sorted(steps, key=lambda entry: entry[1].cost):
        member = fitted(without, one, split, step.values)
        gain = member.evidence - own.evidence
        if gain >= LEAST_EVIDENCE and member.holdout <= own.holdout:
            return member
    return None


def instead_of_two(path: Path, split: Split, progress: Progress) -> Path:
    """Put a richer member of a family in the place of it and of another effect.

    The other was sought beside the simpler member, and may stand for what the richer one holds.
    """
    for stage, other in itertools.permutations(path.stages, 2):
        effect = stage.best.effect
        forms = richer_forms(effect, path.problem.measurement)
        if not forms:
            continue
        progress(f"looking at other forms of {effect.name}", 0.89)
        without = path.problem.without_effect(effect).without_effect(other.best.effect)
        members = [one for form in forms if (one := _instead(path, without, form, split))]
        if not members:
            continue
        before = without.fit(split.fitted, path.now.by_name)
        found = stage_with(without, before, split, members)
        rest = [one for one in path.stages if one is not stage and one is not other]
        problem = without.with_effect(found.best.effect)
        return Path([*rest, found], problem, found.best.fit)
    return path


def _instead(path: Path, without: Problem, form: Effect, split: Split) -> Candidate | None:
    """Form of an effect that does better than a path does; None where it does not."""
    rough = without.with_effect(form).rough_fit(split.fitted, path.now.by_name)
    if rough.cost > MOST_LOST * path.now.cost:
        return None
    found = fitted(without, form, split, rough.by_name, rough.jacobian)
    gain = found.evidence - log_evidence(path.problem, path.now, split)
    as_good = found.holdout <= path.problem.cost(path.now.by_name, split.holdout)
    return found if gain > LEAST_EVIDENCE and as_good else None


def _steps(
    problem: Problem, now: Fit, runs: Sequence[Run], effects: Sequence[Effect]
) -> list[tuple[Effect, LinearisedStep]]:
    """Effects that the cheaper runs leave, each with its linearised step."""
    return [
        (
            effect,
            linearised(problem, effect, now, runs)
            if begins is None
            else linearised_from(problem, effect, now, runs, begins),
        )
        for effect, begins in screened_candidates(problem, now, runs, effects)
    ]
