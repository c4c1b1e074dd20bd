"""What is said of data that contradict themselves or their case: nothing is looked for in them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.checking import Checked
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.errors import errors_of, overall
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement import Measurement
from chatter.explain.prediction import Predictions
from chatter.explain.verdict import UNEXPLAINED
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, finite_or_none, write_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Contradiction(NotebookResult):
    """Verdict on data that would mislead any search for effects.

    Parameters
    ----------
    checked : Checked
        With a finding that is fatal.
    """

    checked: Checked
    verdict: str = field(default=UNEXPLAINED, init=False)

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        return f"<Contradiction {self.measurement.title!r}, {self.verdict}>"

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
            "out_of_tolerance": [],
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
            "signature": {"refitted": None, "repaired_model": None, "residual_dependence": None},
            "normalised_residual": {},
            "next_measurement": None,
        }

    def _error(self) -> float | None:
        """Error of the declared case, where it can be predicted."""
        if self.checked.forbids_prediction:
            return None
        try:
            kind = KINDS[self.measurement.kind]
            runs = kind.prepared(self.measurement).runs
            return finite_or_none(overall(errors_of(self.case, Predictions(kind), runs)))
        except (InputError, RunError):
            return None

    def plot(self) -> Figure:
        """Picture of the signals as recorded."""
        return presentation("plots.explanation").plot_signals(self.measurement)

    def save(self, folder: str | Path) -> list[Path]:
        """Write explanation.json, report.html and the case as declared."""
        summary = self.summary()
        page = presentation("report.explanation").page_of_contradiction(self, summary)
        texts = {"explanation.json": as_json(summary), "report.html": page}
        written = write_results(folder, texts, {})
        path = Path(folder) / "case-updated.toml"
        self.case.save(path)
        return [*written, path]
