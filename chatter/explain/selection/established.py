"""Which effects are beyond doubt though something else is left, and which are none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from chatter.explain.criteria import CERTAIN_EVIDENCE, REACHES_NOTHING, SIGNED_RANK_LEVEL
from chatter.explain.effects.effect import Effect
from chatter.explain.fitting import Fit
from chatter.explain.measurement import Measurement
from chatter.explain.selection.candidates import Stage, fitted, fitted_beside, stage_with
from chatter.explain.selection.path import Path
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.significance import share_removed
from chatter.explain.selection.split import Split

#: runs of which no test can say that most gain
_FEW_RUNS = 4


def established_alone(path: Path, split: Split) -> tuple[Path, list[Stage]]:
    """Path with the effects alone that are beyond doubt beside each other, and the other stages."""
    helping: list[Stage] = []
    while path.stages:
        stages = [_beside_the_others(path, stage, split) for stage in path.stages]
        path = Path(stages, path.problem, path.now)
        uncertain = [
            stage
            for stage in stages
            if not is_established(stage, path.problem.without_effect(stage.best.effect), split)
        ]
        if not uncertain:
            break
        least = min(uncertain, key=lambda stage: stage.best.evidence - stage.evidence)
        helping.append(least)
        problem = path.problem.without_effect(least.best.effect)
        now = problem.fit(split.fitted, path.now.by_name)
        path = Path([one for one in stages if one is not least], problem, now)
    return path, helping


def stages_of_kept_effects(path: Path, split: Split) -> Path:
    """Path whose stages are all beside the effects that are left.

    A stage from before another effect was dropped would compare models that are no more.
    """
    stages = []
    for stage in path.stages:
        others = path.problem.without_effect(stage.best.effect).parameters()
        is_left = set(stage.before.by_name) == {one.name for one in others}
        stages.append(stage if is_left else _beside_the_others(path, stage, split))
    return Path(stages, path.problem, path.now)


def _beside_the_others(path: Path, stage: Stage, split: Split) -> Stage:
    """Stage of an effect, tried beside all the others with the noise as it is now."""
    effect = stage.best.effect
    without = path.problem.without_effect(effect)
    before = without.fit(split.fitted, path.now.by_name)
    names = {one.name for one in without.effects} | {effect.name}
    own = fitted(without, effect, split, path.now.by_name)
    if len(path.stages) > 1:
        return stage_with(without, before, split, [own])
    others = [
        (one.effect, {**one.fit.by_name, **before.by_name})
        for one in stage.tried
        if one.effect.name not in names
    ]
    found = stage_with(without, before, split, fitted_beside(without, before, split, own, others))
    tried = (own, *(one for one in found.tried if one.effect is not effect))
    return Stage(before, found.holdout, found.evidence, tried)


def is_established(stage: Stage, others: Problem, split: Split) -> bool:
    """Whether an effect takes much of the misfit away, in nearly every run."""
    best = stage.best
    if best.evidence - stage.evidence < CERTAIN_EVIDENCE:
        return False
    if share_removed(stage, best, others, split) < others.kind.least_share_in_part:
        return False
    if any(_is_at({key: 0.0}, best.fit, best.effect) for key in best.effect.essential):
        return False
    runs = others.measurement.runs
    trial = others.with_effect(best.effect)
    gains = [
        others.cost(stage.before.by_name, [run]) - trial.cost(best.fit.by_name, [run])
        for run in runs
    ]
    return gain_in_most(gains)


def gain_in_most(gains: Sequence[float]) -> bool:
    """Whether runs gain by an effect rather than lose, by Wilcoxon's (1945) signed-rank test.

    A run that loses little counts less than one that gains much; of four runs or fewer all gain.
    """
    if min(gains) > 0.0:
        return True
    if len(gains) <= _FEW_RUNS:
        return False
    return bool(scipy.stats.wilcoxon(gains, alternative="greater").pvalue <= SIGNED_RANK_LEVEL)


def reaches_nothing(path: Path, final: Fit) -> Stage | None:
    """First effect whose interval reaches no effect at all; None where none does."""
    for stage in path.stages:
        if _reaches_nothing(final, stage.best.effect, path.problem.measurement):
            return stage
    return None


def _reaches_nothing(final: Fit, effect: Effect, measurement: Measurement) -> bool:
    """Whether all of an effect's amounts together are as without it."""
    nothing = effect.nothing(measurement.of_kinds(effect.kinds))
    return bool(nothing) and _is_at(nothing, final, effect)


def _is_at(nothing: Mapping[str, float], final: Fit, effect: Effect) -> bool:
    """Wald's (1943) test of amounts of an effect against those of no effect."""
    names = [one.name for one in final.parameters]
    indices = [names.index(f"{effect.name}.{key}") for key in nothing]
    away = final.values[indices] - np.array(list(nothing.values()))
    covariance = final.covariance[np.ix_(indices, indices)]
    distance = float(away @ np.linalg.pinv(covariance, hermitian=True) @ away)
    return distance < float(scipy.stats.chi2.ppf(REACHES_NOTHING, len(indices)))
