"""Which effects the data ask for: candidates fitted on some runs and judged on others."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from chatter.explain.criteria import (
    HOLDOUT_AT_NOISE,
    LEAST_SHARE_OUT_OF_TOLERANCE,
    MOST_EFFECTS,
    NO_RESIDUAL,
    OUT_OF_TOLERANCE,
)
from chatter.explain.fitting import Fit, over_groups
from chatter.explain.measurement import Measurement
from chatter.explain.prediction import Predictions
from chatter.explain.selection.candidates import (
    Progress,
    Stage,
    fitted,
    fitted_beside,
    stage_of,
    stage_with,
)
from chatter.explain.selection.established import (
    established_alone,
    is_established,
    reaches_nothing,
    stages_of_kept_effects,
)
from chatter.explain.selection.other_starts import declared_put_back, fit_from_elsewhere, objective
from chatter.explain.selection.path import (
    Path,
    best_path,
    gone_on,
    in_other_forms,
    instead_of_two,
    tried_again,
    with_records_of_case,
)
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import Split, split_runs

#: tolerances of a declared value at which it is looked at before it is refitted
_STEPS = (-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0)


@dataclass(frozen=True, eq=False)
class Search:
    """What was tried and what came out."""

    split: Split  # runs fitted, and holdout runs
    first: Stage  # every candidate alone
    #: one an effect that was added, each tried beside all the others that were
    accepted: tuple[Stage, ...]
    helping: tuple[Stage, ...]  # of effects that take some of the residual away, but not for sure
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
        return normalised_residual(self.problem, self.final)

    @property
    def is_at_noise(self) -> bool:
        """Whether every channel is at its noise, and holdout runs are predicted so."""
        return is_at_noise(self.problem, self.final) and self.predicts_holdout

    @property
    def predicts_holdout(self) -> bool:
        """Whether the fit to the other runs predicts the holdout runs as well as noise allows.

        Runs that took part in a fit may be at the noise by values that hold for them alone.
        """
        holdout = self.split.holdout
        path = Path(list(self.accepted), self.problem, self.of_fitted)
        return path.over_noise(holdout) <= HOLDOUT_AT_NOISE

    @property
    def is_certain(self) -> bool:
        """Whether every effect accepted is beyond doubt, whatever is left.

        None is where they leave a good part of the misfit, and declared values their tolerances.
        """
        if self.out_of_tolerance and self.share_removed < LEAST_SHARE_OUT_OF_TOLERANCE:
            return False
        return all(
            is_established(stage, self.problem.without_effect(stage.best.effect), self.split)
            for stage in self.accepted
        )

    @property
    def share_removed(self) -> float:
        """Share of the misfit above the noise that the effects accepted take away together."""
        before, after = (
            float(one.residuals @ one.residuals) - one.residuals.size
            for one in (self.base, self.final)
        )
        return 1.0 - after / max(before, 1e-300)

    @property
    def out_of_tolerance(self) -> Mapping[str, float]:
        """Declared values that the fit pulls out of their tolerances, in standard deviations."""
        pulls = self.problem.declared_pulls(self.final)
        return {name: pull for name, pull in pulls.items() if abs(pull) > OUT_OF_TOLERANCE}


def normalised_residual(problem: Problem, found: Fit) -> dict[str, float]:
    """Rms of the residual of each channel over its noise, by a fit to all runs."""
    squares: dict[str, list[float]] = {}
    begin = 0
    for run in problem.measurement.runs:
        for channel in problem.kind.channels(run):
            end = begin + run.signals[channel].size
            squares.setdefault(channel, []).append(float(np.mean(found.residuals[begin:end] ** 2)))
            begin = end
    return {channel: math.sqrt(np.mean(parts)) for channel, parts in squares.items()}


def is_at_noise(problem: Problem, found: Fit) -> bool:
    """Whether a fit to all runs leaves no more than noise in any channel."""
    return max(normalised_residual(problem, found).values()) <= problem.kind.at_noise


def search(measurement: Measurement, predictions: Predictions, progress: Progress) -> Search:
    """Refit the nuisance parameters, then add effects as long as holdout runs gain by them."""
    kind, split = predictions.kind, split_runs(measurement)
    noise = {run.name: kind.first_noise(run) for run in measurement.runs}
    problem = Problem(measurement, predictions, noise)
    progress("refitting the nuisance parameters", 0.0)
    begin = _nearest_start(problem, split)
    now = problem.fit(split.fitted, begin)
    problem = problem.with_noise_beside(now.by_name)
    now = problem.fit(split.fitted, now.by_name)
    path, split = with_records_of_case(Path([], problem, now), split)
    problem, base_values = path.problem, path.now.by_name
    first = stage_of(problem, path.now, split, progress, 0)
    path = best_path(path, first, split, progress)
    if len(path.stages) > 1:
        progress("trying again the effects added first", 0.85)
        path = tried_again(path, split)
    path, split = _gone_on_with_records(path, split, progress)
    return _concluded(measurement, path, split, first, base_values, progress)


def judged_again(found: Search, measurement: Measurement, progress: Progress) -> Search:
    """Judge what a search found by fewer of its runs, without another search."""
    names = {run.name for run in measurement.runs}
    before = found.measurement
    weighted = before.with_runs([run for run in before.runs if run.name in names])
    split = split_runs(weighted)
    problem = replace(found.problem, measurement=weighted)
    now = problem.fit(split.fitted, found.of_fitted.by_name)
    first = _tried_by(replace(problem, effects=()), found.first, split)
    path = Path(list(found.accepted), problem, now)
    return _concluded(measurement, path, split, first, found.base.by_name, progress)


def _tried_by(problem: Problem, stage: Stage, split: Split) -> Stage:
    """Stage with what it tried fitted to other runs."""
    before = problem.fit(split.fitted, stage.before.by_name)
    if not stage.tried:
        return stage_with(problem, before, split, [])
    own = fitted(problem, stage.best.effect, split, stage.best.fit.by_name)
    others = [(one.effect, one.fit.by_name) for one in stage.tried[1:]]
    tried = fitted_beside(problem, before, split, own, others)
    return stage_with(problem, before, split, tried)


def _concluded(
    measurement: Measurement,
    path: Path,
    split: Split,
    first: Stage,
    base_values: Mapping[str, float],
    progress: Progress,
) -> Search:
    """Fit a path to all runs, and keep of it what they ask for."""
    path, split, final = _to_all_runs(path, split, progress)
    if path.stages and not is_at_noise(path.problem, final):
        before, path = path, in_other_forms(path, split, progress)
        if path is not before and len(path.stages) > 1:
            # another may have stood for what the other member holds
            path = tried_again(path, split)
        final = _of_all_runs(path)
    if len(path.stages) > 1:
        before, path = path, instead_of_two(path, split, progress)
        final = final if path is before else _of_all_runs(path)
    helping: list[Stage] = []
    if path.stages and not is_at_noise(path.problem, final):
        path, helping = established_alone(path, split)
        path = path._replace(now=fit_from_elsewhere(path.problem, path.now, split))
        final = _of_what_is_left(path)
    else:
        path, final = _without_nothing(*_from_declared(path, final, split), split)
    path = stages_of_kept_effects(path, split)
    shown = path.problem.kind.with_records_by(measurement, path.problem.case(path.now.by_name))
    base = replace(path.problem, effects=()).final_fit(shown.runs, base_values)
    return Search(
        split, first, tuple(path.stages), tuple(helping), path.problem, path.now, final, base
    )


def _gone_on_with_records(path: Path, split: Split, progress: Progress) -> tuple[Path, Split]:
    """Path that was gone on with where the case found tells its settled records otherwise.

    What was chosen behind the wrong filter, or by a cut that had not settled, is asked for again,
    and what that hid is sought.
    """
    progress("looking at the settled records again", 0.855)
    found, split = with_records_of_case(path, split)
    if found is path or not found.stages:
        return found, split
    found = tried_again(found, split)
    if len(found.stages) == MOST_EFFECTS or found.over_noise(split.holdout) < NO_RESIDUAL:
        return found, split
    stage = stage_of(found.problem, found.now, split, progress, len(found.stages))
    return gone_on(found, stage, split, progress), split


def _nearest_start(problem: Problem, split: Split) -> dict[str, float]:
    """Values within two tolerances of the declared ones that fit best, looked at one by one."""
    found: dict[str, float] = {}
    for one in problem.kind.searched_at_start(problem.measurement):
        steps = np.clip([one.value(step) for step in _STEPS], one.lower, one.upper)
        costs = [problem.cost({**found, one.name: float(v)}, split.fitted) for v in steps]
        found[one.name] = float(steps[int(np.argmin(costs))])
    return found


def _to_all_runs(path: Path, split: Split, progress: Progress) -> tuple[Path, Split, Fit]:
    """Path with the measurement refined by the case that was found, and the fit to all runs."""
    progress("fitting all runs", 0.86)
    stages, problem, now = path
    measurement = problem.measurement
    if stages:
        measurement = problem.kind.refined(measurement, problem.case(now.by_name))
    if measurement is not problem.measurement:
        split = split_runs(measurement)
        problem = replace(problem, measurement=measurement)
        now = problem.fit(split.fitted, now.by_name)
        path = Path(stages, problem, now)
    return path, split, _of_all_runs(path)


def _of_all_runs(path: Path) -> Fit:
    runs = path.problem.measurement.runs
    final = path.problem.final_fit(runs, path.now.by_name)
    return over_groups(final, [path.problem.count([run]) for run in runs])


def _of_what_is_left(path: Path) -> Fit:
    """Fit to all runs that takes the residual for noise, so that tolerances hold against it."""
    problem, runs = path.problem, path.problem.measurement.runs
    level = normalised_residual(problem, _of_all_runs(path))
    noise = {
        run: {channel: max(1.0, level[channel]) * one for channel, one in channels.items()}
        for run, channels in problem.noise.items()
    }
    final = _of_all_runs(Path(path.stages, replace(problem, noise=noise), path.now))
    return replace(final, residuals=problem.residuals(final.by_name, runs))


def _from_declared(path: Path, final: Fit, split: Split) -> tuple[Path, Fit]:
    """Path and its fit to all runs, from declared values where that is better."""
    begin = declared_put_back(path.problem, final)
    if begin is None:
        return path, final
    back = path._replace(now=path.problem.fit(split.fitted, begin))
    found = _of_all_runs(back)
    return (back, found) if objective(found) < objective(final) else (path, final)


def _without_nothing(path: Path, final: Fit, split: Split) -> tuple[Path, Fit]:
    """Path without effects whose interval reaches nothing, where the rest is at the noise too."""
    while (stage := reaches_nothing(path, final)) is not None:
        problem = path.problem.without_effect(stage.best.effect)
        stages = [one for one in path.stages if one is not stage]
        shorter = Path(stages, problem, problem.fit(split.fitted, path.now.by_name))
        fitted = _of_all_runs(shorter)
        if not is_at_noise(problem, fitted):
            break
        path, final = shorter, fitted
    return path, final
