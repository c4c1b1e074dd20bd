"""Prediction of a declared case against every run and channel of a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from chatter.explain.errors_of_runs import ChannelError, errors_of, overall
from chatter.explain.kinds import kind_of
from chatter.explain.measurement import Measurement
from chatter.explain.signals import SignalFinding, checked
from chatter.explain.signature import signature_of
from chatter.result_files import as_json, write_results


@dataclass(frozen=True, eq=False)
class Comparison:
    """Errors of a case by run and channel.

    Parameters
    ----------
    measurement : Measurement
    errors : sequence of ChannelError
    signature : dict
        Where the residual lives.
    checks : tuple of SignalFinding
        What is no good in the signals.
    """

    measurement: Measurement
    errors: Sequence[ChannelError]
    signature: dict[str, Any]
    checks: tuple[SignalFinding, ...] = ()

    def summary(self) -> dict[str, Any]:
        """Content of compare.json."""
        return {
            "title": self.measurement.title,
            "kind": self.measurement.kind,
            "nrmse": overall(self.errors) if self.errors else None,
            "checks": [one.as_dict() for one in self.checks],
            "runs": [one._asdict() for one in self.errors],
            "signature": self.signature,
        }

    def save(self, folder: str | Path) -> list[Path]:
        """Write compare.csv and compare.json."""
        rows = [
            f"{one.run},{one.channel},{one.error:.6g},{one.relative:.6g}" for one in self.errors
        ]
        text = "\n".join(["run,channel,rms error [SI],rms error over signal", *rows]) + "\n"
        return write_results(
            folder, {"compare.csv": text, "compare.json": as_json(self.summary())}, {}
        )


def compare(measurement: Measurement) -> Comparison:
    """Compare the declared case of a measurement with its runs.

    Raises
    ------
    InputError
        If the measurement or its case cannot be used.
    """
    looked_at = checked(measurement)
    if looked_at.forbids_prediction:
        return Comparison(looked_at.measurement, (), {}, looked_at.findings)
    kind, prepared = kind_of(looked_at.measurement)
    errors = errors_of(prepared.case, prepared, kind)
    signature = signature_of(prepared, kind, prepared.case)
    return Comparison(prepared, errors, signature, looked_at.findings)
