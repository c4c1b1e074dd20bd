"""Prediction of a declared case against every run and channel of a measurement."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chatter.description.case import Case
from chatter.explain.checking import checked
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.errors import ChannelError, errors_of, overall
from chatter.explain.explanation import as_measurement
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement import Measurement
from chatter.explain.prediction import Predictions
from chatter.explain.residuals.signature import Signature, signature_of
from chatter.io.headings import signal_unit
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, write_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(NotebookResult):
    """Errors of a case by run and channel.

    Parameters
    ----------
    measurement : Measurement
    errors : sequence of ChannelError
    signature : Signature or None
        Residual diagnostics; None where nothing could be predicted.
    checks : tuple of SignalFinding
        What is unusable in the signals.
    """

    measurement: Measurement
    errors: Sequence[ChannelError]
    signature: Signature | None
    checks: tuple[SignalFinding, ...] = ()

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        return f"<Comparison {self.measurement.title!r}, {len(self.errors)} channels of runs>"

    def summary(self) -> dict[str, Any]:
        """Content of compare.json."""
        return {
            "title": self.measurement.title,
            "kind": self.measurement.kind,
            "nrmse": overall(self.errors) if self.errors else None,
            "checks": [one.as_dict() for one in self.checks],
            "runs": [one._asdict() for one in self.errors],
            "signature": self.signature.summary() if self.signature is not None else None,
        }

    @property
    def headline(self) -> str:
        """How far the prediction is from the measurement, from the best channel to the worst."""
        if not self.errors:
            return "nothing could be predicted"
        shares = _span([100.0 * one.relative for one in self.errors])
        told = f"the prediction misses by {shares} % of the signals"
        multiples = [one.over_noise for one in self.errors if math.isfinite(one.over_noise)]
        return f"{told}, {_span(multiples)} times their noise" if multiples else told

    def sentences(self) -> list[str]:
        """Return what the checks found, and the error of each run and channel."""
        return [str(one.as_dict()["description"]) for one in self.checks] + [
            f"{one.run}, {one.channel}: error {100.0 * one.relative:.3g} % of the signal, "
            f"{one.over_noise:.3g} times the noise"
            for one in self.errors
        ]

    def plot(self) -> Figure:
        """Picture of measured signals and their residuals."""
        return presentation("plots.explanation").plot_comparison(self)

    def plot_signature(self) -> Figure:
        """Picture of where the residual lives."""
        findings = self.signature.significant or self.signature.findings[:1]
        return presentation("plots.residual_diagnostics").plot_findings(findings)

    def save(self, folder: str | Path) -> list[Path]:
        """Write compare.csv, compare.json, compare.png and signature.png."""
        pictures = {}
        if self.signature is not None:
            pictures = {"compare.png": self.plot(), "signature.png": self.plot_signature()}
        texts = {"compare.csv": self._table(), "compare.json": as_json(self.summary())}
        return write_results(folder, texts, pictures)

    def _table(self) -> str:
        heading = "run,channel,unit,rms error,rms error over signal,noise,rms error over noise"
        rows = []
        for one in self.errors:
            unit = signal_unit(one.channel)
            error, noise = one.error * unit.factor, one.noise * unit.factor
            rows.append(
                f"{one.run},{one.channel},{unit.name},{error:.6g},{one.relative:.6g},{noise:.6g},"
                f"{one.over_noise:.6g}"
            )
        return "\n".join([heading, *rows]) + "\n"


def compare(
    measurement: str | Path | Measurement, case: str | Path | Case | None = None
) -> Comparison:
    """Compare the predictions of a case with the runs of a measurement.

    Parameters
    ----------
    measurement : path or Measurement
        Folder with measurement.toml, or what was read from one.
    case : path or Case, optional
        Instead of the case that the folder names.

    Raises
    ------
    InputError
        If the measurement or its case cannot be used.
    RunError
        If the case cannot predict a run.
    """
    usable = checked(as_measurement(measurement, case))
    if usable.forbids_prediction:
        return Comparison(usable.measurement, (), None, usable.findings)
    kind = KINDS[usable.measurement.kind]
    prepared, predictions = kind.prepared(usable.measurement), Predictions(kind)
    # the records as `explain` has them
    prepared = kind.with_records_by(prepared, prepared.case)
    signature = signature_of(prepared, predictions, prepared.case)
    parts = {(part.run.name, part.channel): part for part in signature.residual.parts}
    errors = []
    for one in errors_of(prepared.case, predictions, prepared.runs):
        part = parts[one.run, one.channel]
        errors.append(one._replace(noise=part.noise, over_noise=part.over_noise))
    return Comparison(prepared, errors, signature, usable.findings)


def _span(values: list[float]) -> str:
    low, high = (f"{end:.3g}" for end in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"
