"""A measurement that is plainly at odds with its declared case: said, and nothing explained."""

from __future__ import annotations

import html
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.data_checks.checking import Checked
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.errors_of_runs import errors_of, overall
from chatter.explain.kinds.registry import kind_of
from chatter.explain.measurement import Measurement
from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, finite_or_none, write_results


@dataclass(frozen=True, eq=False)
class Unusable:
    """Verdict "unexplained" on data that would mislead any search for effects.

    Parameters
    ----------
    checked : Checked
        With a finding that is fatal.
    """

    checked: Checked
    verdict: str = "unexplained"

    @property
    def measurement(self) -> Measurement:
        """What was measured."""
        return self.checked.measurement

    @property
    def checks(self) -> tuple[SignalFinding, ...]:
        """What was found."""
        return self.checked.findings

    @property
    def case(self) -> Case:
        """The declared case, as it is."""
        return self.measurement.case

    def summary(self) -> dict[str, Any]:
        """Content of explanation.json."""
        declared = self._error()
        return {
            "verdict": self.verdict,
            "checks": self.checked.as_list(),
            "effects": [],
            "partial": [],
            "error": {
                "metric": "nrmse",
                "noise_floor": None,
                "declared": declared,
                "before": declared,
                "after": declared,
                "holdout_before": None,
                "holdout_after": None,
            },
            "candidates": [],
            "signature": {"refitted": None, "with_what_was_added": None, "lead": None},
            "left_over_noise": {},
        }

    def _error(self) -> float | None:
        """Error of the declared case, where it can be told."""
        if self.checked.forbids_prediction:
            return None
        try:
            kind, prepared = kind_of(self.measurement)
            return finite_or_none(overall(errors_of(prepared.case, prepared, kind)))
        except (InputError, RunError):
            return None

    def save(self, folder: str | Path) -> list[Path]:
        """Write explanation.json, report.html and the case as declared."""
        summary = self.summary()
        title = html.escape(self.measurement.title)
        body = (
            f"<h1>{title}</h1><p><b>{self.verdict}</b>. The data and the declared case contradict "
            "each other so plainly that no effect was looked for. Put right what is said below, "
            "and explain again.</p>"
            + presentation("report.explanation.sections").findings_of(summary["checks"])
        )
        written = write_results(
            folder,
            {
                "explanation.json": as_json(summary),
                "report.html": presentation("report.explanation.page").page_of(title, body),
            },
            {},
        )
        path = Path(folder) / "case-updated.toml"
        self.case.save(path)
        return [*written, path]
