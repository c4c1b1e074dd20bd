"""Which effects the data ask for: candidates fitted on some runs and judged on others."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from chatter.explain.effects import candidates
from chatter.explain.fitting import Fit
from chatter.explain.kind import Effect, Kind
from chatter.explain.measurement import Measurement, Run
from chatter.explain.problem import Problem

#: what is left, over the noise, up to which nothing structured is left
_AT_NOISE = 1.12
#: gain in the runs not seen that is beyond chance, and a share of their number of samples
_GAIN, _GAIN_SHARE = 40.0, 0.004
#: effects are added until this many, or until nothing is gained
_MOST_EFFECTS = 3
#: candidates that are fitted in full after a first look
_FULL = 4
#: starts of a candidate that are followed after a first look
_FOLLOWED = 2

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect tried on top of those accepted.

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
    """One round of the search.

    Parameters
    ----------
    before : Fit
        Of the effects accepted so far.
    unseen : float
        Sum of squares on the other runs, by it.
    tried : tuple of Candidate
        Best first.
    accepted : bool
        Whether the best was added.
    """

    before: Fit
    unseen: float
    tried: tuple[Candidate, ...]
    accepted: bool


@dataclass(frozen=True, eq=False)
class Search:
    """What was tried and what came out.

    Parameters
    ----------
    measurement : Measurement
    kind : Kind
    fitted, unseen : tuple of Run
        Runs fitted, and runs kept back.
    stages : tuple of Stage
    problem : Problem
        With the effects accepted, and the noise beside them.
    final : Fit
        To all runs.
    base : Fit
        Of the uncertain values alone, to all runs.
    """

    measurement: Measurement
    kind: Kind
    fitted: tuple[Run, ...]
    unseen: tuple[Run, ...]
    stages: tuple[Stage, ...]
    problem: Problem
    final: Fit
    base: Fit
    notes: tuple[str, ...] = field(default_factory=tuple)

    @property
    def left(self) -> float:
        """What is left of all runs over the noise, by the effects accepted."""
        return math.sqrt(self.final.cost / self.final.count)


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
    now = problem.fit(fitted, rounds=5)
    problem = Problem(measurement, kind, problem.noise_beside(now.by_name))
    now = problem.fit(fitted, now.by_name, rounds=4)
    base_values = now.by_name
    stages: list[Stage] = []
    for round_number in range(_MOST_EFFECTS):
        left = _cost(problem, now.by_name, unseen)
        if math.sqrt(left / _count(problem, unseen)) < 1.0 and stages:
            break
        tried = _try_all(problem, now, fitted, unseen, progress, round_number)
        # what every candidate gains, the uncertain values gained by going on
        left = min(left, max((one.unseen for one in tried), default=left))
        accepted = bool(tried) and _beyond_chance(left, tried[0], problem, unseen)
        stages.append(Stage(now, left, tuple(tried), accepted))
        if not accepted:
            break
        best = tried[0]
        problem = problem.with_effect(best.effect)
        problem = Problem(
            measurement, kind, problem.noise_beside(best.fit.by_name), problem.effects
        )
        now = problem.fit(fitted, best.fit.by_name, rounds=8)
    progress("fitting all runs", 0.95)
    final = problem.fit(measurement.runs, now.by_name, rounds=5)
    base = Problem(measurement, kind, problem.noise).fit(measurement.runs, base_values, rounds=4)
    return Search(measurement, kind, fitted, unseen, tuple(stages), problem, final, base)


def first_noise(measurement: Measurement, kind: Kind) -> dict[str, dict[str, float]]:
    """A share of every signal, before anything better is known."""
    return {
        run.name: {
            channel: 0.03 * float(np.sqrt(np.mean(run.signals[channel] ** 2))) + 1e-30
            for channel in kind.channels(run)
        }
        for run in measurement.runs
    }


def _count(problem: Problem, runs: Sequence[Run]) -> int:
    return sum(run.signals[channel].size for run in runs for channel in problem.kind.channels(run))


def _cost(problem: Problem, values: Mapping[str, float], runs: Sequence[Run]) -> float:
    left = problem.residuals(values, runs)
    return float(left @ left)


def _beyond_chance(left: float, best: Candidate, problem: Problem, unseen: Sequence[Run]) -> bool:
    gain = left - best.unseen
    least, share = getattr(problem.kind, "least_gain", (_GAIN, _GAIN_SHARE))
    return gain > least + share * _count(problem, unseen)


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
        looked += [
            (cost, effect, start) for cost, start in first_looks(problem, effect, now, fitted)
        ]
    looked.sort(key=lambda entry: entry[0])
    best_of: dict[str, tuple[float, Effect, dict[str, float]]] = {}
    for entry in looked:
        best_of.setdefault(entry[1].name, entry)
    chosen = list(best_of.values())[:_FULL]
    found = []
    for place, (_, effect, start) in enumerate(chosen):
        share = (round_number + 0.7 + 0.3 * place / len(chosen)) / (_MOST_EFFECTS + 1)
        progress(f"fitting {effect.name}", share)
        trial = problem.with_effect(effect)
        fitted_now = trial.fit(fitted, start, rounds=6)
        found.append(Candidate(effect, fitted_now, _cost(trial, fitted_now.by_name, unseen)))
    found.sort(key=lambda candidate: candidate.unseen)
    return found


def first_looks(
    problem: Problem, effect: Effect, now: Fit, runs: Sequence[Run]
) -> list[tuple[float, dict[str, float]]]:
    """Cost after one linearised step of every start of an effect, cheapest first.

    The uncertain values move along by the Jacobian that is known of them.
    """
    trial = problem.with_effect(effect)
    parameters = trial.parameters()
    known = len(now.parameters)
    results = []
    for start in effect.starts(problem.measurement):
        values = {one.name: one.start for one in parameters}
        values |= now.by_name
        values |= {f"{effect.name}.{key}": value for key, value in start.items()}
        results.append(_one_step(trial, parameters[known:], values, now, runs))
    results.sort(key=lambda result: result[0])
    followed = [
        _one_step(trial, parameters[known:], values, now, runs) for _, values in results[:_FOLLOWED]
    ]
    return sorted(followed, key=lambda result: result[0])


def _one_step(
    trial: Problem, added: Sequence, values: dict[str, float], now: Fit, runs: Sequence[Run]
) -> tuple[float, dict[str, float]]:
    residual = trial.residuals(values, runs)
    best, reached = float(residual @ residual), values
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
    for factor in (1.0, 0.5, 0.2):
        moved = {
            one.name: float(
                np.clip(values[one.name] + factor * change * one.size, one.lower, one.upper)
            )
            for one, change in zip(everything, step, strict=True)
        }
        after = trial.residuals(moved, runs)
        cost = float(after @ after)
        if cost < best:
            return cost, moved
    return best, reached
