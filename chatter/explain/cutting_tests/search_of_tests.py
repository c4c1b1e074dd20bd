"""Which effects cutting tests ask for: all tests fitted, models compared by their evidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from chatter.explain.cutting_tests.evidence import (
    charged_numbers,
    cost_of_scatter,
    penalised_cost,
    with_scatter,
)
from chatter.explain.cutting_tests.fit_to_tests import fit_tests, fit_tests_widely
from chatter.explain.cutting_tests.misfit import Misfit, misfit_of
from chatter.explain.cutting_tests.mode_of_tests import MissingModeOfTests
from chatter.explain.cutting_tests.refitted import are_off_together, refitted_values
from chatter.explain.cutting_tests.reliability import Reliability, reliability_of
from chatter.explain.cutting_tests.starts import (
    ANNEALED,
    share_of_work,
    starts_of_tests,
    starts_with,
    wide_cost,
)
from chatter.explain.cutting_tests.wear import forms_of_wear
from chatter.explain.effects.effect import Effect
from chatter.explain.effects.effect_list import candidates
from chatter.explain.fitting import Fit
from chatter.explain.kinds.kind import Noise
from chatter.explain.measurement import Measurement, Run
from chatter.explain.prediction import Predictions
from chatter.explain.selection.candidates import Candidate, Progress, Stage, linearised
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.search import Search
from chatter.explain.selection.split import Split

#: rms of the normalised residual of powers up to which they are at their scatter
_AT_SCATTER = 1.5
#: scatter of chatter frequencies, as a share, that readings of a spectrum have at the most
_FREQUENCY_SCATTER = 0.03
#: fall of the penalised cost from which an effect counts as found: odds of 20 to 1
_LEAST_GAIN = 6.0
#: effects added at the most, and members of their families fitted beside the best of each
_MOST_EFFECTS, _MORE_FITTED = 2, 4
#: growth of process damping that wear is begun with
_DAMPING_GROWTHS = (0.0, 1.0, 3.0)


@dataclass(frozen=True, eq=False)
class SearchOfTests(Search):
    """Search over cutting tests, with how reliably it predicts tests that it has not seen."""

    reliability: Reliability
    gain: float  # fall of the penalised cost by the effects accepted
    before: Problem  # without effects, with the scatter that was estimated beside it

    @property
    def is_at_noise(self) -> bool:
        """Whether holdout verdicts, frequencies and powers are predicted as they scatter."""
        power = self.normalised_residual.get("spindle_power", 0.0)
        # single frequencies may be those of another motion: what counts is how most scatter
        scatter = max(
            (
                self.problem.noise[run.name]["chatter_frequency"]
                / float(np.median(run.signals["chatter_frequency"]))
                for run in self.measurement.runs
                if run.record == "chatter_frequency"
            ),
            default=0.0,
        )
        readings = power <= _AT_SCATTER and scatter <= _FREQUENCY_SCATTER
        return self.reliability.is_as_scatter and readings

    @property
    def is_certain(self) -> bool:
        """Every effect accepted has odds of 20 to 1."""
        return True

    @property
    def out_of_tolerance(self) -> Mapping[str, float]:
        """Declared values that moved further than is likely, alone or together, in tolerances."""
        values = refitted_values(self.problem, self.final)
        off = are_off_together(self.problem, self.final)
        chosen = [one for one in values if one.is_doubtful]
        return {one.name: one.pull for one in (chosen or (values[:1] if off else []))}


class _Found(NamedTuple):
    """A model fitted to all tests."""

    problem: Problem
    fit: Fit

    @property
    def cost(self) -> float:
        """Penalised cost."""
        return penalised_cost(self.problem, self.fit)

    @property
    def misfit(self) -> Misfit:
        """What is lost above scatter."""
        return misfit_of(self.problem, self.fit)

    def beside(self, other: Problem) -> float:
        """Penalised cost with the scatter of another problem, so that models compare."""
        return self._cost_with(other.noise)

    def with_its_scatter(self, other: Problem) -> float:
        """Penalised cost with its own scatter of limits, at the price of it; readings as `beside`.

        Of two ways to fit the tests one may need limits to scatter widely.
        """
        own = self.problem.noise
        noise = {
            name: own[name] if "stable" in levels else levels
            for name, levels in other.noise.items()
        }
        return self._cost_with(noise) + cost_of_scatter(self.problem)

    def _cost_with(self, noise: Noise) -> float:
        problem = replace(self.problem, noise=noise)
        residuals = problem.residuals(self.fit.by_name, problem.measurement.runs)
        return penalised_cost(problem, replace(self.fit, residuals=residuals))


class _Path(NamedTuple):
    """Effects added one after the other to declared values that were refitted."""

    base: _Found
    stages: list[Stage]  # of each effect, and of what was tried beside them in vain
    found: _Found


def search_of_tests(
    measurement: Measurement, predictions: Predictions, progress: Progress
) -> Search:
    """Refit the declared values, then add effects as long as the evidence of all tests gains."""
    kind, runs = predictions.kind, measurement.runs
    problem = Problem(measurement, predictions, {run.name: kind.first_noise(run) for run in runs})
    progress("refitting the declared values", 0.0)
    bases = [_refitted(problem, [{}])]
    if not bases[0].misfit.is_scatter:
        # an effect must not gain by a minimum that the declared values alone can leave
        bases.append(_refitted_from_others(problem, progress))
        bases.sort(key=lambda one: one.with_its_scatter(problem))
    path = _path_from(bases[0], progress)
    # limits that scatter widely excuse a misfit
    if not path.found.misfit.is_scatter or cost_of_scatter(path.found.problem) > 0.0:
        other_base = bases[1] if len(bases) > 1 else _refitted_from_others(problem, progress)
        other = _path_from(other_base, progress)
        beside = path.found.problem
        if other.found.with_its_scatter(beside) < path.found.with_its_scatter(beside):
            path = other
    base, stages, found = path
    progress("predicting holdout tests", 0.85)
    accepted = stages[:-1] if len(stages) > len(found.problem.effects) else stages
    split = _split(runs)
    of_fitted = fit_tests(found.problem, split.fitted, found.fit.by_name)
    reliability = reliability_of(found.problem, found.fit)
    gain = base.beside(found.problem) - found.cost
    return SearchOfTests(
        split,
        stages[0],
        tuple(accepted),
        (),
        found.problem,
        of_fitted,
        found.fit,
        base.fit,
        reliability,
        gain,
        base.problem,
    )


def _path_from(base: _Found, progress: Progress) -> _Path:
    """Add effects as long as the evidence of all tests gains."""
    stages: list[Stage] = []
    found = base
    for number in range(_MOST_EFFECTS):
        stage, best = _stage(found, progress, number)
        stages.append(stage)
        if best is None:
            break
        found = best
    return _Path(base, stages, found)


def _refitted(problem: Problem, starts: Sequence[Mapping[str, float]]) -> _Found:
    """Declared values fitted to all tests, from the best of several starts."""
    tried = [_fitted_from(problem, start) for start in starts]
    return min(tried, key=lambda one: one.with_its_scatter(problem))


def _refitted_from_others(problem: Problem, progress: Progress) -> _Found:
    """Declared values fitted to all tests, from starts that are not the declared ones."""
    progress("refitting the declared values from other starts", 0.05)
    return _refitted(problem, starts_of_tests(problem))


def _fitted_from(problem: Problem, start: Mapping[str, float]) -> _Found:
    """Fit from a start, and the scatter beside it."""
    runs = problem.measurement.runs
    first = fit_tests_widely(problem, runs, start, ANNEALED)
    problem = with_scatter(problem, first.by_name)
    return _Found(problem, fit_tests(problem, runs, first.by_name))


def _stage(found: _Found, progress: Progress, number: int) -> tuple[Stage, _Found | None]:
    """Try every effect beside those found; the best where the tests ask for it."""
    problem, runs = found.problem, found.problem.measurement.runs
    tried = []
    for effect, start in _most_promising(found, progress, number):
        progress(f"fitting {effect.name}", 0.25 + 0.35 * number)
        trial = problem.with_effect(effect)
        tried.append(_Found(trial, fit_tests_widely(trial, runs, start, ANNEALED)))
    tried.sort(key=lambda one: one.cost)
    shown = tuple(
        Candidate(one.problem.effects[-1], one.fit, one.fit.cost, -0.5 * one.cost) for one in tried
    )
    stage = Stage(found.fit, found.fit.cost, -0.5 * found.cost, shown)
    if not tried or found.cost - tried[0].cost < _LEAST_GAIN:
        return stage, None
    best = tried[0]
    again = with_scatter(best.problem, best.fit.by_name)
    return stage, _Found(again, fit_tests(again, runs, best.fit.by_name))


def _most_promising(
    found: _Found, progress: Progress, number: int
) -> list[tuple[Effect, Mapping[str, float]]]:
    """Effects to fit in full, each with its best start: the best of every name, then the others."""
    problem, now = found.problem, found.fit.by_name
    named = {effect.name for effect in problem.effects}
    # those of effects stay; the declared values may have been led astray by what is missing
    declared_values = {key: value for key, value in now.items() if key.partition(".")[0] in named}
    ranked: list[tuple[float, Effect, Mapping[str, float]]] = []
    misfit, charged = found.misfit, charged_numbers(problem)
    for effect in _candidates(problem, found.fit):
        numbers = charged_numbers(problem.with_effect(effect)) - charged
        if effect.name in named or not misfit.may_fall_by(_LEAST_GAIN, numbers):
            continue
        progress(f"looking at {effect.name}", 0.1 + 0.35 * number)
        if effect.name == "wear" and _powers(problem):
            cost, start = _start_of_wear(problem, effect, found.fit)
        else:
            (cost, start), *_ = starts_with(problem, effect, [now, declared_values])
        ranked.append((cost, effect, start))
    ranked.sort(key=lambda entry: entry[0])
    best = {entry[1].name: entry for entry in reversed(ranked)}
    others = [entry for entry in ranked if entry is not best[entry[1].name]]
    more = round(_MORE_FITTED * share_of_work(problem))
    return [(effect, start) for _, effect, start in [*best.values(), *others[:more]]]


def _candidates(problem: Problem, now: Fit) -> list[Effect]:
    """Effects that may be missing; of wear the simplest form that the power asks for."""
    measurement = problem.measurement
    others = [one for one in candidates(measurement) if one.name not in ("wear", "missing_mode")]
    wear: list[Effect] = list(forms_of_wear(measurement))
    powers = _powers(problem)
    if wear and powers:
        tried = []
        for form in wear:
            trial = problem.with_effect(form)
            start = linearised(problem, form, fit_tests(problem, powers, now.by_name), powers)
            fit = fit_tests(trial, powers, start.values)
            tried.append(penalised_cost(trial, fit))
        wear = [wear[int(np.argmin(tried))]]
    return [*wear, *others, MissingModeOfTests(share_of_work(problem))]


def _start_of_wear(problem: Problem, effect: Effect, now: Fit) -> tuple[float, Mapping[str, float]]:
    """Cost of the best start of wear, and the values there.

    The power shows when and how forces grow, at no cost; the limits, what becomes of damping.
    """
    runs, powers = problem.measurement.runs, _powers(problem)
    step = linearised(problem, effect, fit_tests(problem, powers, now.by_name), powers)
    acting = ("wear.", "material.")
    own = {key: value for key, value in step.values.items() if key.startswith(acting)}
    grown = "wear.process_damping_increase"
    trials = [now.by_name | own]
    if grown in own:
        trials = [now.by_name | own | {grown: growth} for growth in _DAMPING_GROWTHS]
    trial = problem.with_effect(effect)
    return min(((wide_cost(trial, runs, one), one) for one in trials), key=lambda entry: entry[0])


def _powers(problem: Problem) -> list[Run]:
    return [run for run in problem.measurement.runs if run.record == "spindle_power"]


def _split(runs: Sequence[Run]) -> Split:
    """Every third test held out, of verdicts and readings alike."""
    held = tuple(run for run in runs if run.part is not None and run.part.start % 3 == 2)
    return Split(tuple(run for run in runs if run not in held), held)
