"""Which effects the data ask for: candidates fitted on some runs and judged on others."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from chatter.explain.criteria import (
    ALTERNATIVES,
    FITTED_AGAIN,
    LEAST_SHARE,
    MOST_EFFECTS,
    NEAR_NOISE,
    NO_RESIDUAL,
)
from chatter.explain.fitting import Fit, over_groups
from chatter.explain.measurement import Measurement, Run
from chatter.explain.prediction import Predictions
from chatter.explain.selection.candidates import (
    Progress,
    Split,
    Stage,
    fitted,
    ranked,
    split_runs,
    stage_of,
)
from chatter.explain.selection.problem import Problem


@dataclass(frozen=True, eq=False)
class Search:
    """What was tried and what came out."""

    split: Split  # runs fitted, and holdout runs
    first: Stage  # every candidate alone
    #: one an effect that was added, each tried beside all the others that were
    accepted: tuple[Stage, ...]
    problem: Problem  # with the effects accepted, and the noise beside them
    of_fitted: Fit  # of it, to the runs for fitting
    final: Fit  # of it, to all runs
    base: Fit  # of the nuisance parameters alone, to all runs

    @property
    def measurement(self) -> Measurement:
        """As it was weighted in the end."""
        return self.problem.measurement

    @property
    def effect_names(self) -> tuple[str, ...]:
        """Names of the effects accepted."""
        return tuple(stage.best.effect.name for stage in self.accepted)

    @property
    def normalised_residual(self) -> dict[str, float]:
        """Rms of the residual of each channel over its noise, by the effects accepted."""
        squares: dict[str, list[float]] = {}
        begin = 0
        for run in self.measurement.runs:
            for channel in self.problem.kind.channels(run):
                end = begin + run.signals[channel].size
                parts = self.final.residuals[begin:end]
                squares.setdefault(channel, []).append(float(np.mean(parts**2)))
                begin = end
        return {channel: math.sqrt(np.mean(parts)) for channel, parts in squares.items()}


class Path(NamedTuple):
    """Effects added one after the other."""

    stages: list[Stage]
    problem: Problem
    now: Fit

    def over_noise(self, holdout: Sequence[Run]) -> float:
        """Rms of the normalised residual of holdout runs."""
        cost = self.problem.cost(self.now.by_name, holdout)
        return math.sqrt(cost / self.problem.count(holdout))

    def cost_beside(self, other: Problem, holdout: Sequence[Run]) -> float:
        """Sum of squares on holdout runs with the noise of a problem, so that paths compare."""
        return replace(self.problem, noise=other.noise).cost(self.now.by_name, holdout)


def search(measurement: Measurement, predictions: Predictions, progress: Progress) -> Search:
    """Refit the nuisance parameters, then add effects as long as holdout runs gain by them."""
    kind, split = predictions.kind, split_runs(measurement.runs)
    noise = {run.name: kind.first_noise(run) for run in measurement.runs}
    problem = Problem(measurement, predictions, noise)
    progress("refitting the nuisance parameters", 0.0)
    now = problem.fit(split.fitted, {})
    problem = problem.with_noise_beside(now.by_name)
    now = problem.fit(split.fitted, now.by_name)
    base_values = now.by_name
    first = stage_of(problem, now, split, progress, 0)
    path = _best_path(Path([], problem, now), first, split, progress)
    if len(path.stages) > 1:
        progress("trying again the effects added first", 0.85)
        path = _tried_again(path, split)
    stages, problem, now = path
    progress("fitting all runs", 0.95)
    if stages:
        measurement = kind.reweighted(measurement, problem.case(now.by_name))
    if measurement is not problem.measurement:
        split = split_runs(measurement.runs)
        problem = replace(problem, measurement=measurement)
        now = problem.fit(split.fitted, now.by_name)
    final = problem.fit(measurement.runs, now.by_name)
    final = over_groups(final, [problem.count([run]) for run in measurement.runs])
    base = replace(problem, effects=()).fit(measurement.runs, base_values)
    return Search(split, first, tuple(stages), problem, now, final, base)


def _best_path(begin: Path, first: Stage, split: Split, progress: Progress) -> Path:
    """Follow the best candidate and, where that does not lead to the noise, the next ones too.

    Of two effects that are missing, neither may do well alone, and a third best in their place.
    """
    best = _forward(begin, first, split, progress, MOST_EFFECTS)
    for index in range(1, min(ALTERNATIVES + 1, len(first.tried))):
        if not best.stages or best.over_noise(split.holdout) < NEAR_NOISE:
            break
        turned = (first.tried[index], *first.tried[:index], *first.tried[index + 1 :])
        path = _forward(begin, replace(first, tried=turned), split, progress, 2)
        costs = [one.cost_beside(begin.problem, split.holdout) for one in (path, best)]
        if costs[0] < costs[1]:
            best = path
    return best


def _forward(begin: Path, stage: Stage, split: Split, progress: Progress, most: int) -> Path:
    """Add effects, the first as ranked by a stage, as long as holdout runs gain by them."""
    stages, problem, now = [], begin.problem, begin.now
    while stage.tried and _is_significant(stage.holdout, stage.best.holdout, problem, split):
        stages.append(stage)
        values = stage.best.fit.by_name
        problem = problem.with_effect(stage.best.effect).with_noise_beside(values)
        now = problem.fit(split.fitted, values)
        path = Path(stages, problem, now)
        if len(stages) == most or path.over_noise(split.holdout) < NO_RESIDUAL:
            break
        stage = stage_of(problem, now, split, progress, len(stages))
    return Path(stages, problem, now)


def _tried_again(path: Path, split: Split) -> Path:
    """Ask of every effect but the last whether it is needed, or another does better beside them.

    The first was chosen when the others were not there, and may have stood for them.
    """
    stages, problem, now = path
    kept = list(stages)
    for stage in stages[:-1]:
        without = problem.without_effect(stage.best.effect)
        before = without.fit(split.fitted, now.by_name)
        holdout = without.cost(before.by_name, split.holdout)
        names = {effect.name for effect in without.effects}
        tried = []
        for one in stage.tried[:FITTED_AGAIN]:
            if one.effect.name in names:
                continue
            start = {**one.fit.by_name, **before.by_name}
            start = now.by_name if one.effect is stage.best.effect else start
            tried.append(fitted(without, one.effect, split, start))
        found = Stage(before, holdout, ranked(tried))
        index = kept.index(stage)
        if not _is_significant(holdout, found.best.holdout, problem, split):
            del kept[index]
            problem, now = without, before
            continue
        kept[index] = found
        problem, now = without.with_effect(found.best.effect), found.best.fit
    return Path(kept, problem, now)


def _is_significant(before: float, after: float, problem: Problem, split: Split) -> bool:
    """Whether the sum of squares of holdout runs falls by more than chance, or a sliver of it."""
    least, share = problem.kind.least_gain
    count = problem.count(split.holdout)
    return before - after > max(least + share * count, LEAST_SHARE * (before - count))
