"""Which effects the data ask for: candidates fitted on some runs and judged on others."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.effects import candidates, place_of
from chatter.explain.kinds.kind import Effect, Kind
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection.fitting import WORKERS, Fit, over_groups
from chatter.explain.selection.problem import Problem

#: what is left of unseen runs, over the noise, below which nothing more is looked for
_NOTHING_LEFT = 1.0
#: gain in the runs not seen that is beyond chance, and a share of their number of samples
_GAIN, _GAIN_SHARE = 40.0, 0.004
#: share of what is left above the noise that an effect must take away
_SLIVER = 0.05
#: effects are added until this many, or until nothing is gained
_MOST_EFFECTS = 3
#: candidates tried as the first where the best does not lead near the noise, and how near that is
_ALTERNATIVES, _NEAR_NOISE = 2, 1.3
#: candidates that are fitted in full after a first look
_FULL = 4
#: and those that are looked at again once another effect is there
_AGAIN = 3
#: sums of squares that differ by less say nothing about which is better
_EQUAL = 2.0
#: starts of a candidate that are followed after a first look
_FOLLOWED = 2

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect tried on top of others.

    Parameters
    ----------
    effect : Effect
    fit : Fit
        To the runs for fitting.
    unseen : float
        Sum of squares on the other runs.
    """

    effect: Effect
    fit: Fit
    unseen: float


@dataclass(frozen=True, eq=False)
class Stage:
    """An effect that was looked for beside others.

    Parameters
    ----------
    before : Fit
        Of the others, to the runs for fitting.
    unseen : float
        Sum of squares on the other runs, by it.
    tried : tuple of Candidate
        Best first.
    """

    before: Fit
    unseen: float
    tried: tuple[Candidate, ...]

    @property
    def best(self) -> Candidate:
        """Candidate that the unseen runs like best."""
        return self.tried[0]


@dataclass(frozen=True, eq=False)
class Search:
    """What was tried and what came out.

    Parameters
    ----------
    measurement : Measurement
    kind : Kind
    fitted, unseen : tuple of Run
        Runs fitted, and runs kept back.
    first : Stage
        Every candidate alone.
    accepted : tuple of Stage
        One an effect that was added, each tried beside all the others that were.
    problem : Problem
        With the effects accepted, and the noise beside them.
    of_fitted : Fit
        Of it, to the runs for fitting.
    final : Fit
        Of it, to all runs.
    base : Fit
        Of the uncertain values alone, to all runs.
    """

    measurement: Measurement
    kind: Kind
    fitted: tuple[Run, ...]
    unseen: tuple[Run, ...]
    first: Stage
    accepted: tuple[Stage, ...]
    problem: Problem
    of_fitted: Fit
    final: Fit
    base: Fit

    @property
    def left(self) -> dict[str, float]:
        """What is left of each channel over its noise, by the effects accepted."""
        squares: dict[str, list[float]] = {}
        begin = 0
        for run in self.measurement.runs:
            for channel in self.kind.channels(run):
                end = begin + run.signals[channel].size
                parts = self.final.residuals[begin:end]
                squares.setdefault(channel, []).append(float(np.mean(parts**2)))
                begin = end
        return {channel: math.sqrt(np.mean(parts)) for channel, parts in squares.items()}


def split_runs(runs: Sequence[Run]) -> tuple[tuple[Run, ...], tuple[Run, ...]]:
    """Runs to fit and runs to judge by: every third one, so that both cover the conditions."""
    unseen = tuple(run for place, run in enumerate(runs) if place % 3 == 2)
    fitted = tuple(run for place, run in enumerate(runs) if place % 3 != 2)
    return (fitted, unseen) if unseen else (tuple(runs), tuple(runs))


def search(measurement: Measurement, kind: Kind, progress: Progress) -> Search:
    """Refit what is uncertain, then add effects as long as unseen runs gain by them."""
    fitted, unseen = split_runs(measurement.runs)
    problem = Problem(measurement, kind, first_noise(measurement, kind))
    progress("refitting what is uncertain", 0.0)
    now = problem.fit(fitted, rounds=6)
    problem = Problem(measurement, kind, problem.noise_beside(now.by_name))
    now = problem.fit(fitted, now.by_name, rounds=5)
    base_values = now.by_name
    first = _stage(problem, now, fitted, unseen, progress, 0)
    stages, problem, now = _best_way(problem, now, first, fitted, unseen, progress)
    if len(stages) > 1:
        progress("looking again at what was added first", 0.85)
        stages, problem, now = _looked_again(stages, problem, now, fitted, unseen)
    progress("fitting all runs", 0.95)
    reweighted = getattr(kind, "reweighted", None)
    if stages and reweighted is not None:
        measurement = reweighted(measurement, problem.case(now.by_name))
        fitted, unseen = split_runs(measurement.runs)
        problem = replace(problem, measurement=measurement)
        now = problem.fit(fitted, now.by_name, rounds=8)
    final = problem.fit(measurement.runs, now.by_name, rounds=12)
    final = over_groups(final, [problem.count([run]) for run in measurement.runs])
    base = Problem(measurement, kind, problem.noise).fit(measurement.runs, base_values, rounds=5)
    return Search(
        measurement, kind, fitted, unseen, first, tuple(stages), problem, now, final, base
    )


class Way(NamedTuple):
    """Effects added one after the other."""

    stages: list[Stage]
    problem: Problem
    now: Fit


def _stage(
    problem: Problem,
    now: Fit,
    fitted: Sequence[Run],
    unseen: Sequence[Run],
    progress: Progress,
    round_number: int,
) -> Stage:
    tried = _try_all(problem, now, fitted, unseen, progress, round_number)
    # what every candidate gains, the uncertain values gained by going on
    left = _cost(problem, now.by_name, unseen)
    left = min(left, max((one.unseen for one in tried), default=left))
    return Stage(now, left, tuple(tried))


def _best_way(
    problem: Problem,
    now: Fit,
    first: Stage,
    fitted: Sequence[Run],
    unseen: Sequence[Run],
    progress: Progress,
) -> Way:
    """Follow the best candidate and, where that does not lead to the noise, the next ones too.

    Of two effects that are missing, neither may do well alone, and a third best in their place.
    """
    best = _forward(problem, now, first, fitted, unseen, progress)
    for place in range(1, min(_ALTERNATIVES + 1, len(first.tried))):
        if not best.stages or _over_noise(best, unseen) < _NEAR_NOISE:
            break
        turned = (first.tried[place], *first.tried[:place], *first.tried[place + 1 :])
        start = replace(first, tried=turned)
        way = _forward(problem, now, start, fitted, unseen, progress, most=2)
        if _cost_alike(way, problem, unseen) < _cost_alike(best, problem, unseen):
            best = way
    return best


def _forward(
    problem: Problem,
    now: Fit,
    stage: Stage,
    fitted: Sequence[Run],
    unseen: Sequence[Run],
    progress: Progress,
    most: int = _MOST_EFFECTS,
) -> Way:
    """Add effects, the first as told by a stage, as long as unseen runs gain by them."""
    stages: list[Stage] = []
    while stage.tried and _beyond_chance(stage.unseen, stage.best.unseen, problem, unseen):
        stages.append(stage)
        problem = problem.with_effect(stage.best.effect)
        values = stage.best.fit.by_name
        problem = replace(problem, noise=problem.noise_beside(values))
        now = problem.fit(fitted, values, rounds=8)
        way = Way(stages, problem, now)
        if len(stages) == most or _over_noise(way, unseen) < _NOTHING_LEFT:
            break
        stage = _stage(problem, now, fitted, unseen, progress, len(stages))
    return Way(stages, problem, now)


def _over_noise(way: Way, unseen: Sequence[Run]) -> float:
    """What is left of unseen runs over their noise."""
    left = _cost(way.problem, way.now.by_name, unseen)
    return math.sqrt(left / way.problem.count(unseen))


def _cost_alike(way: Way, problem: Problem, unseen: Sequence[Run]) -> float:
    """Sum of squares on unseen runs with the noise of a problem, so that ways compare."""
    return _cost(replace(way.problem, noise=problem.noise), way.now.by_name, unseen)


def _looked_again(
    stages: list[Stage], problem: Problem, now: Fit, fitted: Sequence[Run], unseen: Sequence[Run]
) -> tuple[list[Stage], Problem, Fit]:
    """Ask of every effect but the last whether it is needed, or another does better beside them.

    The first was chosen when the others were not there, and may have stood for them.
    """
    kept = list(stages)
    for stage in stages[:-1]:
        others = tuple(e for e in problem.effects if e is not stage.best.effect)
        without = replace(problem, effects=others)
        before = without.fit(fitted, now.by_name, rounds=6)
        left = _cost(without, before.by_name, unseen)
        names = {effect.name for effect in others}
        tried = []
        for one in stage.tried[:_AGAIN]:
            if one.effect.name in names:
                continue
            trial = without.with_effect(one.effect)
            begin = {**one.fit.by_name, **before.by_name}
            begin = now.by_name if one.effect is stage.best.effect else begin
            found = trial.fit(fitted, begin, rounds=6)
            tried.append(Candidate(one.effect, found, _cost(trial, found.by_name, unseen)))
        tried = ranked(tried)
        place = kept.index(stage)
        if not _beyond_chance(left, tried[0].unseen, problem, unseen):
            del kept[place]
            problem, now = without, before
            continue
        kept[place] = Stage(before, left, tuple(tried))
        problem = without.with_effect(tried[0].effect)
        now = tried[0].fit
    return kept, problem, now


def first_noise(measurement: Measurement, kind: Kind) -> dict[str, dict[str, float]]:
    """Noise where the kind knows it; else a share of every signal, until something is known."""
    known = getattr(kind, "noise", None)
    if known is not None:
        return {run.name: known(run) for run in measurement.runs}
    return {
        run.name: {
            channel: 0.03 * float(np.sqrt(np.mean(run.signals[channel] ** 2))) + 1e-30
            for channel in kind.channels(run)
        }
        for run in measurement.runs
    }


def _cost(problem: Problem, values: Mapping[str, float], runs: Sequence[Run]) -> float:
    left = problem.residuals(values, runs)
    return float(left @ left)


def _beyond_chance(left: float, reached: float, problem: Problem, unseen: Sequence[Run]) -> bool:
    least, share = getattr(problem.kind, "least_gain", (_GAIN, _GAIN_SHARE))
    count = problem.count(unseen)
    # what takes away a sliver of a misfit stands for something else
    return left - reached > max(least + share * count, _SLIVER * (left - count))


def _try_all(
    problem: Problem,
    now: Fit,
    fitted: Sequence[Run],
    unseen: Sequence[Run],
    progress: Progress,
    round_number: int,
) -> list[Candidate]:
    """Candidates, best on the unseen runs first."""
    added = {effect.name for effect in problem.effects}
    effects = [one for one in candidates(problem.measurement) if one.name not in added]
    looked = []
    for place, effect in enumerate(effects):
        share = (round_number + 0.7 * place / len(effects)) / (_MOST_EFFECTS + 1)
        progress(f"looking at {effect.name}", share)
        best = first_look(problem, effect, now, fitted)
        looked.append((best.cost, effect, best))
    looked.sort(key=lambda entry: entry[0])
    chosen = _one_a_name(looked)[:_FULL]
    found = []
    for place, (_, effect, look) in enumerate(chosen):
        share = (round_number + 0.7 + 0.3 * place / len(chosen)) / (_MOST_EFFECTS + 1)
        progress(f"fitting {effect.name}", share)
        trial = problem.with_effect(effect)
        fitted_now = trial.fit(fitted, look.values, 10, look.jacobian)
        found.append(Candidate(effect, fitted_now, _cost(trial, fitted_now.by_name, unseen)))
    return ranked(found)


def _one_a_name(looked: list[tuple[float, Effect, Look]]) -> list[tuple[float, Effect, Look]]:
    """Best variant of every effect, in their order."""
    kept: dict[str, tuple[float, Effect, Look]] = {}
    for entry in looked:
        kept.setdefault(entry[1].name, entry)
    return list(kept.values())


def ranked(found: Sequence[Candidate]) -> list[Candidate]:
    """Candidates, best on the unseen runs first; equals in the order of the list of effects."""
    best = min((one.unseen for one in found), default=0.0)
    return sorted(found, key=lambda one: (max(one.unseen, best + _EQUAL), place_of(one.effect)))


class Look(NamedTuple):
    """Where a linearised step of a candidate leads."""

    cost: float
    values: dict[str, float]
    jacobian: NDArray[np.float64]


def first_look(problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]) -> Look:
    """Best of the linearised steps from every start of an effect.

    The uncertain values move along by the Jacobian that is known of them.
    """
    trial = problem.with_effect(effect)
    parameters = trial.parameters()
    added = parameters[len(now.parameters) :]

    def from_start(start: Mapping[str, float]) -> Look:
        values = {one.name: one.start for one in parameters}
        values |= now.by_name
        values |= {f"{effect.name}.{key}": value for key, value in start.items()}
        return _one_step(trial, added, values, now, runs)

    with ThreadPoolExecutor(WORKERS) as pool:
        looks = list(pool.map(from_start, effect.starts(problem.measurement)))
        looks.sort(key=lambda look: look.cost)
        followed = pool.map(
            lambda look: _one_step(trial, added, look.values, now, runs), looks[:_FOLLOWED]
        )
        return min([*followed, looks[0]], key=lambda look: look.cost)


def _one_step(
    trial: Problem, added: Sequence, values: dict[str, float], now: Fit, runs: Sequence[Run]
) -> Look:
    residual = trial.residuals(values, runs)
    columns = []
    for one in added:
        step = 0.05 * one.size
        if values[one.name] + step > one.upper:
            step = -step
        moved = trial.residuals({**values, one.name: values[one.name] + step}, runs)
        columns.append((moved - residual) / (step / one.size))
    full = np.column_stack([now.jacobian, *columns])
    weight = np.array([1.0] * len(now.parameters) + [1.0 if one.prior else 1e-3 for one in added])
    normal = full.T @ full + np.diag(weight)
    step = -np.linalg.solve(normal, full.T @ residual)
    everything = [*now.parameters, *added]
    best = Look(float(residual @ residual), values, full)
    for factor in (1.0, 0.5, 0.2):
        moved = {
            one.name: float(
                np.clip(values[one.name] + factor * change * one.size, one.lower, one.upper)
            )
            for one, change in zip(everything, step, strict=True)
        }
        after = trial.residuals(moved, runs)
        cost = float(after @ after)
        if cost < best.cost:
            return Look(cost, moved, full)
    return best
