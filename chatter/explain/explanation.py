"""What a measurement says that its declared case lacks, or that nothing is missing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chatter.description.case import Case
from chatter.description.given_path import path_given
from chatter.description.whole_files import write_whole
from chatter.explain.blas_threads import one_blas_thread
from chatter.explain.checking import checked
from chatter.explain.contradiction import Contradiction
from chatter.explain.criteria import MOST_PROBABLE, MOST_PROBABLE_BESIDE_UNKNOWN, OUT_OF_TOLERANCE
from chatter.explain.cutting_tests.report_on_tests import entries_on_tests
from chatter.explain.cutting_tests.search_of_tests import search_of_tests
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.empirical.learning import Learnt, learnt
from chatter.explain.errors import (
    DECLARED,
    REFITTED,
    REPAIRED,
    BeforeAfter,
    before_after,
    errors_of,
    overall,
)
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.kinds.stability import Stability
from chatter.explain.lobes_before_after import Added, LobesBeforeAfter, lobes_before_after
from chatter.explain.measurement import Measurement, Run
from chatter.explain.measurement_file import read_measurement
from chatter.explain.new_values import in_usual_units
from chatter.explain.next_measurement.proposal import next_measurement
from chatter.explain.prediction import Predictions, kept_predictions
from chatter.explain.reported_effects import confounded, parameters_of, probability
from chatter.explain.residuals.residual_dependence import ResidualDependence
from chatter.explain.residuals.signature import Signature, signature_of
from chatter.explain.selection.candidates import Candidate, Progress, Stage
from chatter.explain.selection.discriminating_test import discriminating_test
from chatter.explain.selection.search import Search, judged_again, search
from chatter.explain.verdict import COMPLETE, EXPLAINED, EXPLAINED_IN_PART, UNEXPLAINED, verdict_of
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, finite_or_none, write_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Explanation(NotebookResult):
    """Verdict on a measurement.

    Parameters
    ----------
    measurement : Measurement
        As prepared for its kind.
    found : Search
    verdict : str
        "explained", "explained-in-part", "nothing-missing" or "unexplained".
    predictions : Predictions
        Made so far.
    checks : tuple of SignalFinding
        What is unusable in the signals, and was excluded.
    empirical : Learnt, optional
        Terms learnt from what no known effect explains.
    """

    measurement: Measurement
    found: Search
    verdict: str
    predictions: Predictions
    checks: tuple[SignalFinding, ...] = ()
    empirical: Learnt | None = None

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        return f"<Explanation {self.measurement.title!r}, {self.verdict}>"

    @property
    def adds_effects(self) -> bool:
        """Whether effects are named and added to the case."""
        return self.verdict in (EXPLAINED, EXPLAINED_IN_PART)

    @cached_property
    def case(self) -> Case:
        """Case refitted, with the effects added that were found, and the terms learnt."""
        return self._explained if self.empirical is None else self.empirical.case

    @property
    def _explained(self) -> Case:
        """Case refitted, with the effects added that were found."""
        return self._with_effects if self.adds_effects else self.refitted

    @cached_property
    def refitted(self) -> Case:
        """Declared case with the nuisance parameters refitted to all runs."""
        return self.measurement.with_values(self.found.base.by_name)

    @cached_property
    def _with_effects(self) -> Case:
        return self.found.problem.case(self.found.final.by_name)

    @cached_property
    def _of_fitted(self) -> dict[str, Case]:
        """Model -> case fitted to the runs for fitting alone."""
        cases = {
            DECLARED: self.measurement.case,
            REFITTED: self.measurement.with_values(self.found.first.before.by_name),
        }
        if self.adds_effects:
            cases[REPAIRED] = self.found.problem.case(self.found.of_fitted.by_name)
        return cases

    @one_blas_thread()
    def summary(self) -> dict[str, Any]:
        """Content of explanation.json."""
        return self._summary

    @cached_property
    def _summary(self) -> dict[str, Any]:
        dependence = self.residual_dependence
        return {
            "verdict": self.verdict,
            "checks": [one.as_dict() for one in self.checks],
            "effects": self._effects(self._added, MOST_PROBABLE),
            **self._learnt(),
            # what helps, but is not beyond doubt
            "partial": self._effects(self.helping, MOST_PROBABLE_BESIDE_UNKNOWN),
            "out_of_tolerance": self._out_of_tolerance(),
            **self._errors(),
            "candidates": self._candidates(),
            "error_by_channel": self.before_after.summary(),
            "signature": {
                "refitted": self.refitted_signature.summary(),
                "repaired_model": self.repaired_signature.summary()
                if self.repaired_signature
                else None,
                "residual_dependence": dependence.summary() if dependence else None,
            },
            "normalised_residual": {
                channel: finite_or_none(rms)
                for channel, rms in self.found.normalised_residual.items()
            },
            "next_measurement": next_measurement(self.found),
            **entries_on_tests(self.found, self.case),
        }

    @cached_property
    def refitted_signature(self) -> Signature:
        """Where the residual of the refitted case lives."""
        noise = self.found.problem.noise
        return signature_of(self.measurement, self.predictions, self.refitted, noise)

    @cached_property
    def repaired_signature(self) -> Signature | None:
        """Residual diagnostics with the effects added, also where they explain a part alone."""
        if not self.found.accepted:
            return None
        # samples count as far as the law that was found is certain of them
        problem = self.found.problem
        return signature_of(
            problem.measurement, self.predictions, self._with_effects, problem.noise
        )

    @cached_property
    def residual_dependence(self) -> ResidualDependence | None:
        """On what a residual that no effect explains depends; None where there is none."""
        if self.verdict in COMPLETE:
            return None
        repaired = self.repaired_signature
        if repaired is not None and repaired.dependence.finding.significant:
            return repaired.dependence
        return self.refitted_signature.dependence

    @cached_property
    def before_after(self) -> BeforeAfter:
        """Errors by channel of the declared, the refitted and the repaired case."""
        residual = self.refitted_signature.residual
        return before_after(self._of_fitted, self.predictions, self.found.split, residual)

    @cached_property
    def lobes(self) -> LobesBeforeAfter | None:
        """Stability lobes before and after; None where the case holds no cut."""
        cases = {DECLARED: self.measurement.case, REFITTED: self.refitted}
        added = None
        if self.adds_effects:
            cases[REPAIRED] = self._explained
            nuisance = {one.name for one in self.found.base.parameters}
            values = {key: v for key, v in self.found.final.by_name.items() if key in nuisance}
            added = Added(self.found.effect_names, self.measurement.with_values(values))
        return lobes_before_after(self.measurement, cases, added)

    def _errors(self) -> dict[str, Any]:
        """Errors over all runs, and of a set-up by kind of measurement as well."""
        found: dict[str, Any] = {"error": self._errors_of(self.measurement.runs)}
        if self.measurement.parts:
            found["error_by_kind"] = {
                kind: self._errors_of([run for run in self.measurement.runs if run.kind == kind])
                for kind in self.measurement.kinds
            }
        return found

    def _errors_of(self, runs: Sequence[Run]) -> dict[str, Any]:
        """Errors of the models over some runs."""
        names = {run.name for run in runs}
        holdout = [run for run in self.found.split.holdout if run.name in names]
        signature = self.refitted_signature
        if self.adds_effects:
            signature = self.repaired_signature
        parts = [one for one in signature.residual.parts if one.run.name in names]
        floor = self.predictions.kind.noise_floor(parts)
        fitted = list(self._of_fitted.values())

        def error(case: Case, some: Sequence[Run] = runs) -> float | None:
            # of a kind of one run none is held out
            errors = errors_of(case, self.predictions, some)
            return finite_or_none(overall(errors)) if errors else None

        return {
            "metric": "nrmse",
            "noise_floor": finite_or_none(floor),
            "declared": error(self.measurement.case),
            "before": error(self.refitted),
            "after": error(self._explained),
            "holdout_before": error(fitted[1], holdout),
            "holdout_after": error(fitted[-1], holdout),
        }

    def _learnt(self) -> dict[str, Any]:
        """Terms learnt, with the errors before and after; nothing where there are none."""
        if self.empirical is None:
            return {}
        holdout = self.found.split.holdout
        before = self._of_fitted[REPAIRED if self.adds_effects else REFITTED]

        def error(case: Case) -> float | None:
            return finite_or_none(overall(errors_of(case, self.predictions, holdout)))

        errors = {"holdout_before": error(before), "holdout_after": error(self.empirical.of_fitted)}
        return {"empirical": [{**one, **errors} for one in self.empirical.summary()]}

    @property
    def helping(self) -> tuple[Stage, ...]:
        """Effects that take some of the residual away, but are not added."""
        return (
            self.found.helping if self.adds_effects else (*self.found.accepted, *self.found.helping)
        )

    @property
    def _added(self) -> tuple[Stage, ...]:
        """Effects that are added to the case."""
        return self.found.accepted if self.adds_effects else ()

    def _effects(self, stages: tuple[Stage, ...], most_probable: float) -> list[dict[str, Any]]:
        added = set(self.found.effect_names)
        return [
            {
                "name": stage.best.effect.name,
                "parameters": parameters_of(
                    self.found.final if stage.best.effect.name in added else stage.best.fit,
                    stage.best.effect,
                ),
                "probability": round(probability(stage, most_probable), 4),
                "confounded_with": [one.effect.name for one in confounded(stage)],
                "discriminating_test": self._discriminating_tests(stage),
                "description": stage.best.effect.help,
            }
            for stage in stages
        ]

    def _out_of_tolerance(self) -> list[dict[str, Any]]:
        """Declared values that the refit pulls out of their tolerances."""
        fit = self.found.final if self.adds_effects else self.found.base
        declared = {one.name: one.start for one in fit.parameters}
        return [
            {"path": name, "declared": declared[name], "refitted": fit.by_name[name],
             "standard_deviations": pull}
            for name, pull in self.found.problem.declared_pulls(fit).items()
            if abs(pull) > OUT_OF_TOLERANCE
        ]  # fmt: skip

    def _discriminating_tests(self, stage: Stage) -> dict[str, Any]:
        """Confounded effect -> measurement that tells it from the one named, if any does."""
        problem = self.found.problem
        names = {one.name for one in problem.effects} - {stage.best.effect.name}
        others = replace(
            problem, effects=tuple(one for one in problem.effects if one.name in names)
        )

        def case_with(one: Candidate) -> Case:
            trial = replace(others, effects=(*others.effects, one.effect))
            # what was tried may have been beside effects that were dropped since
            found = {**self.found.final.by_name, **one.fit.by_name}
            return trial.case({p.name: found.get(p.name, p.start) for p in trial.parameters()})

        alike = confounded(stage)
        if not alike:
            return {}
        named, kind = case_with(stage.best), self.predictions.kind
        return {
            one.effect.name: discriminating_test(
                problem.measurement, kind, problem.noise, named, case_with(one)
            )
            for one in alike
        }

    def _candidates(self) -> list[dict[str, Any]]:
        stage = self.found.first
        holdout = self.found.problem.count(self.found.split.holdout)
        count = max(stage.before.residuals.size, 2)
        return [
            {
                "name": one.effect.name,
                "evidence": finite_or_none(one.evidence - stage.evidence),
                "holdout_error": finite_or_none(math.sqrt(one.holdout / holdout)),
                "bic": finite_or_none(one.fit.cost + len(one.fit.parameters) * math.log(count)),
            }
            for one in stage.tried
        ]

    def plot(self) -> Figure:
        """Picture of the residuals of some runs, before and after."""
        return presentation("plots.explanation").plot_explanation(self)

    @one_blas_thread()
    def save(self, folder: str | Path) -> list[Path]:
        """Write explanation.json, report.html, residual.png and case-updated.toml."""
        with ThreadPoolExecutor(max_workers=1) as beside:
            lobes = beside.submit(lambda: self.lobes)
            summary = self.summary()
            picture = presentation("plots.style").png_of(self.plot())
            lobes.result()
        page = presentation("report.explanation").page_of(self, summary, picture)
        texts = {"explanation.json": as_json(summary), "report.html": page}
        written = write_results(folder, texts, {})
        residuals, case = (Path(folder) / name for name in ("residual.png", "case-updated.toml"))
        write_whole(residuals, picture)
        in_usual_units(self.case, self.measurement.case).save(case)
        self.predictions.kept.discard()
        return [*written, residuals, case]


@one_blas_thread()
def explain(
    measurement: str | Path | Measurement,
    case: str | Path | Case | None = None,
    progress: Progress = lambda *_: None,
    folder: str | Path | None = None,
) -> Explanation | Contradiction:
    """Find out what the declared case of a measurement lacks.

    Parameters
    ----------
    measurement : path or Measurement
        Folder with measurement.toml, or what was read from one.
    case : path or Case, optional
        Instead of the case that the folder names.
    progress : callable, optional
        Called with (what is being done, share done).
    folder : path, optional
        Keeps predictions below the result cache there until `Explanation.save` has written the
        results, and goes on from those of an earlier run that was ended.

    Raises
    ------
    InputError
        If the measurement or its case cannot be used.
    RunError
        If it is interrupted while predictions are kept.
    OSError
        If they cannot be kept.

    Notes
    -----
    Where the checks find the set or its declared case plainly wrong, no effect is looked for.
    """
    measurement = as_measurement(measurement, case)
    progress("checking the signals", 0.0)
    usable = checked(measurement)
    if usable.is_fatal:
        return Contradiction(usable)
    kind = KINDS[measurement.kind]
    prepared = kind.prepared(usable.measurement)
    predictions = Predictions(kind, kept_predictions(folder, "explain", prepared))
    with predictions.kept.going_on():
        prepared, found, slow = _searched(prepared, predictions, progress)
        verdict = verdict_of(found)
        terms = None if verdict in COMPLETE else _learnt(found, verdict, progress)
    # errors, as the search, of the records as the case found tells them
    shown = kind.with_records_by(prepared, found.problem.case(found.of_fitted.by_name))
    findings = (*usable.findings, *slow)
    return Explanation(shown, found, verdict, predictions, findings, terms)


def _searched(
    measurement: Measurement, predictions: Predictions, progress: Progress
) -> tuple[Measurement, Search, list[SignalFinding]]:
    """Search; where something is left, again without runs that it tells need not have settled."""
    kind = predictions.kind
    searched = search_of_tests if kind.name == Stability.name else search
    found = searched(measurement, predictions, progress)
    if verdict_of(found) in COMPLETE:
        return measurement, found, []
    fewer, slow = kind.without_too_slow(measurement, _case_found(found))
    if not slow:
        return measurement, found, []
    found = searched(fewer, predictions, progress)
    while verdict_of(found) not in COMPLETE:
        # a case that was found without some runs may tell so of others
        fewer, more = kind.without_too_slow(fewer, _case_found(found))
        if not more:
            break
        slow = [*slow, *more]
        found = judged_again(found, fewer, progress)
    return fewer, found, slow


def _case_found(found: Search) -> Case:
    """Case of a search, fitted to the runs for fitting."""
    return found.problem.case(found.of_fitted.by_name)


def _learnt(found: Search, verdict: str, progress: Progress) -> Learnt | None:
    """Terms learnt from what is left beside the effects that are reported."""
    problem, now = found.problem, found.of_fitted
    if verdict == UNEXPLAINED and problem.effects:
        problem = replace(problem, effects=())
        now = problem.fit(found.split.fitted, found.first.before.by_name)
    return learnt(problem, now, found.split, progress)


def as_measurement(
    given: str | Path | Measurement, case: str | Path | Case | None = None
) -> Measurement:
    """Return a measurement as it is, or read its folder; with another case declared, if given."""
    if not isinstance(given, Measurement):
        return read_measurement(path_given(given, "a measurement folder"), case)
    if case is None:
        return given
    return given.with_case(case if isinstance(case, Case) else Case.from_file(case))
