"""One effect in the place of two that stand for it together."""

from __future__ import annotations

from collections.abc import Mapping

from chatter.explain.criteria import LEAST_EVIDENCE, MOST_LOST
from chatter.explain.effects.effect import Effect
from chatter.explain.selection.candidates import Progress, Stage, fitted, stage_with
from chatter.explain.selection.path import Path
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import Split

#: starts that are fitted from, the nearest of those of the member
_FITTED = 3


def one_for_two(path: Path, split: Split, progress: Progress) -> Path:
    """Put a richer member of a family in the place of two effects, unless they do clearly better.

    A simple member takes most of what is missing, and another effect may take the rest in the place
    of what the richer member holds.
    """
    for stage in path.stages:
        measurement = path.problem.measurement
        for member in stage.best.effect.richer:
            others = [
                other for other in path.stages if other.best.effect.name in member.mistaken_for
            ]
            if others and member.applies(measurement.of_kinds(member.kinds)):
                progress(f"looking at other forms of {member.name}", 0.85)
                for other in others:
                    further = _in_place_of(path, (stage, other), member, split)
                    if further is not path:
                        return further
    return path


def _in_place_of(path: Path, pair: tuple[Stage, Stage], member: Effect, split: Split) -> Path:
    """Path with a member in the place of a pair; itself where the pair does clearly better."""
    without = path.problem
    for stage in pair:
        without = without.without_effect(stage.best.effect)
    before = without.fit(split.fitted, path.now.by_name)
    tried = [
        fitted(without, member, split, start) for start in _starts(path, without, member, split)
    ]
    one = max(tried, key=lambda candidate: candidate.evidence)
    lost = path.evidence_beside(path.problem, split) - one.evidence
    holdout = path.problem.cost(path.now.by_name, split.holdout)
    if lost > LEAST_EVIDENCE or one.holdout > MOST_LOST * holdout:
        return path
    found = stage_with(without, before, split, [one])
    kept = [stage for stage in path.stages if stage not in pair]
    problem = without.with_effect(one.effect).with_noise_beside(one.fit.by_name)
    now = problem.fit(split.fitted, one.fit.by_name)
    return Path([*kept, found], problem, now)


def _starts(
    path: Path, without: Problem, member: Effect, split: Split
) -> list[Mapping[str, float]]:
    """Values of the path, with those starts of a member that come nearest to the data."""
    trial = without.with_effect(member)
    named = trial.parameters()
    measured = path.problem.measurement.of_kinds(member.kinds)
    starts = []
    for own in member.starts(measured):
        begun = {f"{member.name}.{key}": value for key, value in own.items()}
        kept = {one.name: path.now.by_name.get(one.name, one.start) for one in named}
        starts.append({**kept, **begun})
    return sorted(starts, key=lambda values: trial.cost(values, split.fitted))[:_FITTED]
