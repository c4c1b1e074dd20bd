"""What a measurement says that its declared case lacks, or that nothing is missing."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.case import Case
from chatter.explain.errors_of_runs import errors_of, overall
from chatter.explain.fitting import Fit
from chatter.explain.kinds import kind_of
from chatter.explain.measurement import Measurement
from chatter.explain.search import Candidate, Search, search
from chatter.explain.signals import SignalFinding, checked
from chatter.explain.signature import signature_of
from chatter.explain.unusable import Unusable
from chatter.result_files import as_json, finite_or_none, write_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: what is left over the noise up to which the measurement is at its noise floor
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
            "error": self._errors(),
            "candidates": self._candidates(),
            "signature": signature_of(self.measurement, self.found.kind, self.case),
            "left_over_noise": finite_or_none(self.found.left),
        }

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
            "holdout_before": error(self._case_of_fitted(0), unseen),
            "holdout_after": error(self._case_of_fitted(-1), unseen),
        }

    def _case_of_fitted(self, place: int) -> Case:
        """Case fitted to the runs for fitting alone: before any effect, or with all of them."""
        stages = self.found.stages
        if place == 0 or self.verdict != "explained":
            values = stages[0].before.by_name
            return self.measurement.case.patch(values) if values else self.measurement.case
        last = [stage for stage in stages if stage.accepted][-1].tried[0]
        return self.found.problem.case(last.fit.by_name)

    def _noise_floor(self) -> float | None:
        floor = getattr(self.found.kind, "noise_floor", None)
        if floor is not None:
            return finite_or_none(floor(self.measurement))
        shares = {}
        for run in self.measurement.runs:
            for channel in self.found.kind.channels(run):
                level = float(np.sqrt(np.mean(run.signals[channel] ** 2)))
                noise = self.found.problem.noise[run.name][channel]
                shares.setdefault(channel, []).append((noise / max(level, 1e-300)) ** 2)
        return finite_or_none(float(np.mean([math.sqrt(np.mean(v)) for v in shares.values()])))

    def _effects(self) -> list[dict[str, Any]]:
        found = []
        for stage in self.found.stages:
            if not stage.accepted:
                continue
            best = stage.tried[0]
            found.append(
                {
                    "name": best.effect.name,
                    "parameters": parameters_of(self.found.final, best.effect.name),
                    "probability": round(probability(stage.tried, best), 4),
                    "confounded_with": self._confounded(stage.tried, stage.unseen),
                    "says": best.effect.says,
                }
            )
        return found

    def _confounded(self, tried: tuple[Candidate, ...], before: float) -> list[str]:
        best = tried[0]
        gain = before - best.unseen
        return [
            other.effect.name
            for other in tried[1:]
            if before - other.unseen > (1.0 - _ALIKE) * gain
        ]

    def _candidates(self) -> list[dict[str, Any]]:
        if not self.found.stages:
            return []
        stage = self.found.stages[0]
        count = stage.before.count
        return [
            {
                "name": one.effect.name,
                "holdout_error": finite_or_none(math.sqrt(one.unseen / max(1, self._unseen_count))),
                "bic": finite_or_none(
                    one.fit.cost + len(one.fit.parameters) * math.log(max(count, 2))
                ),
            }
            for one in stage.tried
        ]

    @property
    def _unseen_count(self) -> int:
        kind = self.found.kind
        return sum(
            run.signals[channel].size for run in self.found.unseen for channel in kind.channels(run)
        )

    def plot(self) -> Figure:
        """Picture of what is left of the runs, before and after."""
        from chatter.plots.explanation import plot_explanation

        return plot_explanation(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write explanation.json, case-updated.toml, report.html and residual.png."""
        from chatter.explain.report import report_of

        summary = self.summary()
        picture = self.plot()
        written = write_results(
            folder,
            {
                "explanation.json": as_json(summary),
                "report.html": report_of(self, summary, picture),
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
    accepted = any(stage.accepted for stage in found.stages)
    at_noise = found.left <= getattr(kind, "at_noise", AT_NOISE)
    if accepted and at_noise:
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


def parameters_of(fit: Fit, effect: str) -> dict[str, dict[str, Any]]:
    """Parameters of an effect with their 95 % intervals; runout as offset and angle."""
    own: dict[str, dict[str, Any]] = {}
    for place, one in enumerate(fit.parameters):
        name, _, key = one.name.partition(".")
        if name == effect:
            low, high = fit.interval(place)
            own[key] = {"value": float(fit.values[place]), "unit": one.unit, "ci95": [low, high]}
    if effect == "runout":
        return _polar(fit, "runout.across", "runout.along")
    return own


def _polar(fit: Fit, across: str, along: str) -> dict[str, Mapping[str, Any]]:
    names = [one.name for one in fit.parameters]
    places = [names.index(across), names.index(along)]
    x, y = fit.values[places]
    offset, angle = math.hypot(x, y), math.atan2(y, x) % (2.0 * math.pi)
    covariance = fit.covariance[np.ix_(places, places)]
    out = np.array([x, y]) / max(offset, 1e-300)
    side = np.array([-out[1], out[0]])
    spread = 1.96 * math.sqrt(max(out @ covariance @ out, 0.0))
    turn = 1.96 * math.sqrt(max(side @ covariance @ side, 0.0)) / max(offset, 1e-300)
    return {
        "offset": {
            "value": offset,
            "unit": "m",
            "ci95": [max(offset - spread, 0.0), offset + spread],
        },
        "angle": {"value": angle, "unit": "rad", "ci95": [angle - turn, angle + turn]},
    }
