"""Prediction of a declared case against every run and channel of a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chatter.explain.data_checks.checking import checked
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.errors_of_runs import ChannelError, errors_of, overall
from chatter.explain.kinds.registry import kind_of
from chatter.explain.measurement import Measurement
from chatter.explain.signature import Signature, signature_of
from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, write_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Comparison:
    """Errors of a case by run and channel.

    Parameters
    ----------
    measurement : Measurement
    errors : sequence of ChannelError
    signature : Signature or None
        Where the residual lives; None where nothing could be predicted.
    checks : tuple of SignalFinding
        What is no good in the signals.
    """

    measurement: Measurement
    errors: Sequence[ChannelError]
    signature: Signature | None
    checks: tuple[SignalFinding, ...] = ()

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

    def plot(self) -> Figure:
        """Picture of measured signals and what the case leaves of them."""
        if self.measurement.kind == "stability":
            return presentation("plots.residual_diagnostics").plot_findings(
                self.signature.findings[:1]
            )
        title = f"{self.measurement.title}: what {self.measurement.case.name} leaves"
        return presentation("plots.explanation").plot_residuals(
            {"left": self.signature.residual}, title
        )

    def plot_signature(self) -> Figure:
        """Picture of where the residual lives."""
        return presentation("plots.residual_diagnostics").plot_findings(
            self.signature.telling or self.signature.findings[:1]
        )

    def save(self, folder: str | Path) -> list[Path]:
        """Write compare.csv, compare.json, compare.png and signature.png."""
        pictures = {}
        if self.signature is not None:
            pictures = {"compare.png": self.plot(), "signature.png": self.plot_signature()}
        texts = {"compare.csv": self._table(), "compare.json": as_json(self.summary())}
        return write_results(folder, texts, pictures)

    def _table(self) -> str:
        heading = "run,channel,rms error [SI],rms error over signal,noise [SI],rms error over noise"
        rows = [
            f"{one.run},{one.channel},{one.error:.6g},{one.relative:.6g},{one.noise:.6g},"
            f"{one.over_noise:.6g}"
            for one in self.errors
        ]
        return "\n".join([heading, *rows]) + "\n"


def compare(measurement: Measurement) -> Comparison:
    """Compare the declared case of a measurement with its runs.

    Raises
    ------
    InputError
        If the measurement or its case cannot be used.
    """
    looked_at = checked(measurement)
    if looked_at.forbids_prediction:
        return Comparison(looked_at.measurement, (), None, looked_at.findings)
    kind, prepared = kind_of(looked_at.measurement)
    signature = signature_of(prepared, kind, prepared.case)
    parts = {(part.run.name, part.channel): part for part in signature.residual.parts}
    errors = []
    for one in errors_of(prepared.case, prepared, kind):
        part = parts[one.run, one.channel]
        errors.append(one._replace(noise=part.noise, over_noise=part.over_noise))
    return Comparison(prepared, errors, signature, looked_at.findings)
