"""What a measurement says that its declared case lacks, or that nothing is missing."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.before_after import BeforeAfter, before_after
from chatter.explain.data_checks.checking import checked
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.data_checks.unusable import Unusable
from chatter.explain.errors_of_runs import errors_of, overall
from chatter.explain.kinds.kind import Effect
from chatter.explain.kinds.registry import kind_of
from chatter.explain.measurement import Measurement
from chatter.explain.selection.fitting import Fit
from chatter.explain.selection.problem import NUMERICS
from chatter.explain.selection.search import Candidate, Search, Stage, search
from chatter.explain.selection.separation import separation
from chatter.explain.signature import Signatures, signatures_of
from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, finite_or_none, write_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from chatter.explain.lobes_before_after import LobesBeforeAfter

#: what is left of any channel over the noise up to which the measurement is at its noise floor
AT_NOISE = 1.12
#: gain that a candidate may lack against the best and still not be told from it, as a share
_ALIKE = 0.03
#: samples that count as one: residuals beside a wrong model are not independent
_CORRELATED = 20.0

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Explanation:
    """Verdict on a measurement.

    Parameters
    ----------
    measurement : Measurement
        As prepared for its kind.
    found : Search
    verdict : str
        "explained", "nothing-missing" or "unexplained".
    checks : tuple of SignalFinding
        What is no good in the signals, and was left out.
    """

    measurement: Measurement
    found: Search
    verdict: str
    checks: tuple[SignalFinding, ...] = ()

    @property
    def case(self) -> Case:
        """Case refitted, with the effects added where they explain."""
        if self.verdict == "explained":
            return self.found.problem.case(self.found.final.by_name)
        return self.refitted

    @property
    def refitted(self) -> Case:
        """Declared case with what is merely uncertain refitted to all runs."""
        names = {one.name for one in self.found.base.parameters}
        values = {key: v for key, v in self.found.base.by_name.items() if key in names}
        return self.measurement.case.patch(values) if values else self.measurement.case

    def summary(self) -> dict[str, Any]:
        """Content of explanation.json."""
        return {
            "verdict": self.verdict,
            "checks": [one.as_dict() for one in self.checks],
            "effects": self._effects() if self.verdict == "explained" else [],
            # what helps, but leaves something that is not known
            "partial": self._effects() if self.verdict == "unexplained" else [],
            "error": self._errors(),
            "candidates": self._candidates(),
            "error_by_channel": self.before_after.summary(),
            "signature": self.signatures.summary(),
            "left_over_noise": {
                channel: finite_or_none(left) for channel, left in self.found.left.items()
            },
        }

    @cached_property
    def signatures(self) -> Signatures:
        """Where the residual lives, before and after."""
        return signatures_of(self)

    @cached_property
    def before_after(self) -> BeforeAfter:
        """Errors by channel, before and after."""
        return before_after(self, self.signatures.refitted.residual)

    @cached_property
    def lobes(self) -> LobesBeforeAfter | None:
        """Stability lobes before and after; None where the case holds no cut."""
        from chatter.explain.lobes_before_after import lobes_before_after

        return lobes_before_after(self)

    def _errors(self) -> dict[str, Any]:
        kind, measurement = self.found.kind, self.measurement
        unseen = self.found.unseen

        def error(case: Case, runs=None) -> float | None:
            return finite_or_none(overall(errors_of(case, measurement, kind, runs)))

        before, after = self.refitted, self.case
        return {
            "metric": "nrmse",
            "noise_floor": self._noise_floor(),
            "declared": error(measurement.case),
            "before": error(before),
            "after": error(after),
            "holdout_before": error(self.refitted_to_fitted, unseen),
            "holdout_after": error(self.explained_by_fitted, unseen),
        }

    @property
    def refitted_to_fitted(self) -> Case:
        """Declared case refitted to the runs for fitting alone."""
        values = self.found.first.before.by_name
        return self.measurement.case.patch(values) if values else self.measurement.case

    @property
    def explained_by_fitted(self) -> Case:
        """Case with the effects added, fitted to the runs for fitting alone."""
        if self.verdict != "explained":
            return self.refitted_to_fitted
        return self.found.problem.case(self.found.of_fitted.by_name)

    def _noise_floor(self) -> float | None:
        floor = getattr(self.found.kind, "noise_floor", None)
        if floor is not None:
            return finite_or_none(floor(self.measurement, self.case))
        shares = {}
        for run in self.measurement.runs:
            for channel in getattr(self.found.kind, "judged", self.found.kind.channels)(run):
                level = float(np.sqrt(np.mean(run.signals[channel] ** 2)))
                noise = self.found.problem.noise[run.name][channel]
                shares.setdefault(channel, []).append((noise / max(level, 1e-300)) ** 2)
        return finite_or_none(float(np.mean([math.sqrt(np.mean(v)) for v in shares.values()])))

    def _effects(self) -> list[dict[str, Any]]:
        return [
            {
                "name": stage.best.effect.name,
                "parameters": parameters_of(self.found.final, stage.best.effect),
                "probability": round(probability(stage.tried, stage.best), 4),
                "confounded_with": [one.effect.name for one in _confounded(stage)],
                "told_apart_by": self._told_apart(stage),
                "says": stage.best.effect.says,
            }
            for stage in self.found.accepted
        ]

    def _told_apart(self, stage: Stage) -> dict[str, Any]:
        """Confounded effect -> measurement that would tell it from the one named, if any would."""
        problem = self.found.problem
        others = tuple(e for e in problem.effects if e is not stage.best.effect)

        def case_with(one: Candidate) -> Case:
            trial = replace(problem, effects=(*others, one.effect))
            # what was tried may have been beside effects that were dropped since
            found = {**self.found.final.by_name, **one.fit.by_name}
            return trial.case({p.name: found.get(p.name, p.start) for p in trial.parameters()})

        cases = {one.effect.name: case_with(one) for one in _confounded(stage)}
        named = case_with(stage.best)
        measurement, kind = self.found.measurement, self.found.kind
        return {
            name: separation(measurement, kind, problem.noise, named, case)
            for name, case in cases.items()
        }

    def _candidates(self) -> list[dict[str, Any]]:
        stage = self.found.first
        count, unseen = stage.before.count, self.found.problem.count(self.found.unseen)
        return [
            {
                "name": one.effect.name,
                "holdout_error": finite_or_none(math.sqrt(one.unseen / unseen)),
                "bic": finite_or_none(
                    one.fit.cost + len(one.fit.parameters) * math.log(max(count, 2))
                ),
            }
            for one in stage.tried
        ]

    def plot(self) -> Figure:
        """Picture of what is left of the runs, before and after."""
        return presentation("plots.explanation").plot_explanation(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write explanation.json, case-updated.toml, report.html and residual.png."""
        summary = self.summary()
        picture = self.plot()
        written = write_results(
            folder,
            {
                "explanation.json": as_json(summary),
                "report.html": presentation("report.explanation").report_of(self, summary, picture),
            },
            {"residual.png": picture},
        )
        path = Path(folder) / "case-updated.toml"
        self.case.save(path)
        return [*written, path]


def explain(
    measurement: Measurement, progress: Progress = lambda *_: None
) -> Explanation | Unusable:
    """Find out what the declared case of a measurement lacks.

    Parameters
    ----------
    measurement : Measurement
    progress : callable, optional
        Called with (what is being done, share done).

    Raises
    ------
    InputError
        If the measurement or its case cannot be used.

    Notes
    -----
    Where the checks find the set or its declared case plainly wrong, no effect is looked for.
    """
    progress("checking the signals", 0.0)
    looked_at = checked(measurement)
    if looked_at.is_fatal:
        return Unusable(looked_at)
    kind, prepared = kind_of(looked_at.measurement)
    found = search(prepared, kind, progress)
    at_noise = max(found.left.values()) <= getattr(kind, "at_noise", AT_NOISE)
    if found.accepted and at_noise:
        verdict = "explained"
    elif at_noise:
        verdict = "nothing-missing"
    else:
        verdict = "unexplained"
    return Explanation(prepared, found, verdict, looked_at.findings)


def probability(tried: tuple[Candidate, ...], of: Candidate) -> float:
    """Probability of a candidate among those tried, by their fit to unseen runs."""
    best = min(one.unseen for one in tried)
    scale = 2.0 * _CORRELATED
    weights = {one.effect.name: math.exp(-(one.unseen - best) / scale) for one in tried}
    return weights[of.effect.name] / sum(weights.values())


def _confounded(stage: Stage) -> list[Candidate]:
    """Candidates no more intricate than the best that gain nearly as much."""
    gain = stage.unseen - stage.best.unseen
    intricate = len(stage.best.fit.parameters)
    return [
        other
        for other in stage.tried[1:]
        if stage.unseen - other.unseen > (1.0 - _ALIKE) * gain
        and len(other.fit.parameters) <= intricate
    ]


def parameters_of(fit: Fit, effect: Effect) -> dict[str, dict[str, Any]]:
    """Numbers that people want of an effect, with their 95 % intervals."""
    places, own = [], {}
    for place, one in enumerate(fit.parameters):
        name, _, key = one.name.partition(".")
        if name == effect.name:
            places.append(place)
            own[key] = one
    values = fit.values[places]
    keys = list(own)

    def numbers(at: NDArray[np.float64]) -> dict[str, tuple[float, str]]:
        given = dict(zip(keys, (float(v) for v in at), strict=True))
        if effect.told is None:
            return {key: (value, own[key].unit) for key, value in given.items()}
        return dict(effect.told(given))

    told = numbers(values)
    # spread of what is told by its slopes over the parameters
    deviation = np.sqrt(np.maximum(np.diag(fit.covariance)[places], 0.0))
    slopes = {key: np.zeros(len(places)) for key in told}
    for place, moved in enumerate(1e-3 * deviation):
        if moved > 0.0:
            beside = numbers(values + moved * (np.arange(len(places)) == place))
            for key in told:
                slopes[key][place] = (beside[key][0] - told[key][0]) / moved
    covariance = fit.covariance[np.ix_(places, places)]
    found = {}
    for key, (value, unit) in told.items():
        half = 1.96 * math.sqrt(max(slopes[key] @ covariance @ slopes[key], 0.0))
        # the simulation itself is no better than this
        half = math.hypot(half, NUMERICS * abs(value))
        found[key] = {"value": value, "unit": unit, "ci95": [value - half, value + half]}
    return found
