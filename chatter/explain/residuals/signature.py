"""Signature of a residual: what every diagnostic of the kind of measurement finds in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from chatter.description.case import Case
from chatter.explain.measurement import Measurement
from chatter.explain.residuals.finding import Finding
from chatter.explain.residuals.residual import Residual, residual_of
from chatter.explain.residuals.residual_dependence import ResidualDependence, residual_dependence

if TYPE_CHECKING:
    from chatter.explain.kinds.kind import Noise
    from chatter.explain.prediction import Predictions


@dataclass(frozen=True, eq=False)
class Signature:
    """What the diagnostics find in a residual."""

    residual: Residual
    findings: tuple[Finding, ...]  # one a diagnostic

    @property
    def significant(self) -> tuple[Finding, ...]:
        """Findings that show more than chance does."""
        return tuple(finding for finding in self.findings if finding.significant)

    @property
    def no_significant_dependence(self) -> str:
        """One sentence for the diagnostics that find nothing."""
        return no_significant_dependence(self.findings)

    @cached_property
    def dependence(self) -> ResidualDependence:
        """On what the residual depends most."""
        kind = self.residual.kind
        leading = kind.leading(self.residual)
        findings = self.findings if leading is self.residual else diagnosed(leading)
        return residual_dependence(leading, findings)

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json."""
        return {
            "diagnostics": [finding.summary() for finding in self.findings],
            "no_significant_dependence": self.no_significant_dependence,
        }


def diagnosed(residual: Residual) -> tuple[Finding, ...]:
    """Findings of every diagnostic of the kind of measurement."""
    return residual.kind.findings(residual)


def signature_of(
    measurement: Measurement, predictions: Predictions, case: Case, noise: Noise | None = None
) -> Signature:
    """Signature of the residual of a measurement by a case.

    Arguments as of `residual_of`.
    """
    residual = residual_of(measurement, predictions, case, noise)
    return Signature(residual, diagnosed(residual))


def no_significant_dependence(findings: Sequence[Finding]) -> str:
    """One sentence for all diagnostics that find nothing."""
    silent = [finding.description for finding in findings if not finding.significant]
    sentences = [text for text in silent if text.endswith(".")]
    names = [text for text in silent if not text.endswith(".")]
    if names:
        listed = ", ".join(names[:-1]) + f" and {names[-1]}" if len(names) > 1 else names[0]
        sentences.append(f"No significant dependence on {listed}.")
    return " ".join(sentences)
