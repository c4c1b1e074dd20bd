"""Prediction of a declared case against every run and channel of a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.explain.errors_of_runs import ChannelError, overall
from chatter.explain.kinds import kind_of
from chatter.explain.measurement import Measurement
from chatter.explain.residual.left import Left
from chatter.explain.signature import Signature, signature_of
from chatter.result_files import as_json, write_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Comparison:
    """Errors of a case by run and channel.

    Parameters
    ----------
    measurement : Measurement
    errors : sequence of ChannelError
    signature : Signature
        Where the residual lives.
    """

    measurement: Measurement
    errors: Sequence[ChannelError]
    signature: Signature

    def summary(self) -> dict[str, Any]:
        """Content of compare.json."""
        return {
            "title": self.measurement.title,
            "kind": self.measurement.kind,
            "nrmse": overall(self.errors),
            "runs": [one._asdict() for one in self.errors],
            "signature": self.signature.summary(),
        }

    def plot(self) -> Figure:
        """Picture of measured signals and what the case leaves of them."""
        from chatter.plots.explanation import plot_residuals
        from chatter.plots.findings import plot_findings

        if self.measurement.kind == "stability":
            return plot_findings(self.signature.findings[:1])
        title = f"{self.measurement.title}: what {self.measurement.case.name} leaves"
        return plot_residuals({"left": self.signature.residual}, title)

    def plot_signature(self) -> Figure:
        """Picture of where the residual lives."""
        from chatter.plots.findings import plot_findings

        return plot_findings(self.signature.telling or self.signature.findings[:1])

    def save(self, folder: str | Path) -> list[Path]:
        """Write compare.csv, compare.json, compare.png and signature.png."""
        return write_results(
            folder,
            {"compare.csv": self._table(), "compare.json": as_json(self.summary())},
            {"compare.png": self.plot(), "signature.png": self.plot_signature()},
        )

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
    kind, prepared = kind_of(measurement)
    signature = signature_of(prepared, kind, prepared.case)
    errors = [_error(part) for part in signature.residual.parts]
    return Comparison(prepared, errors, signature)


def _error(part: Left) -> ChannelError:
    error = float(np.sqrt(np.mean(part.values**2)))
    return ChannelError(
        part.run.name, part.channel, error, part.relative, part.noise, part.over_noise
    )
