"""Signature of a residual: where it lives, told by every view that makes sense."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from chatter.case import Case
from chatter.explain.kind import Kind
from chatter.explain.measurement import Measurement
from chatter.explain.residual.finding import Finding
from chatter.explain.residual.lead import Lead, lead_of
from chatter.explain.residual.left import Noise, Residual, residual_of
from chatter.explain.residual.views import look, nothing_beyond_chance


@dataclass(frozen=True, eq=False)
class Signature:
    """What the views say of a residual.

    Parameters
    ----------
    residual : Residual
    findings : tuple of Finding
        One a view.
    """

    residual: Residual
    findings: tuple[Finding, ...]

    @property
    def telling(self) -> tuple[Finding, ...]:
        """Findings beyond chance."""
        return tuple(finding for finding in self.findings if finding.beyond_chance)

    @property
    def nothing(self) -> str:
        """One sentence for the views that show nothing."""
        return nothing_beyond_chance(self.findings)

    @cached_property
    def lead(self) -> Lead:
        """Free-form description of the residual."""
        return lead_of(self.residual, self.findings)

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json."""
        return {
            "views": [finding.summary() for finding in self.findings],
            "nothing_beyond_chance": self.nothing,
        }


def signature_of(
    measurement: Measurement, kind: Kind, case: Case, noise: Noise | None = None
) -> Signature:
    """Look at what a case leaves of a measurement.

    Parameters
    ----------
    measurement : Measurement
        As prepared for its kind.
    kind : Kind
    case : Case
    noise : mapping, optional
        Run -> channel -> standard deviation, SI; read from what is left where it is not given.
    """
    residual = residual_of(measurement, kind, case, noise)
    return Signature(residual, look(residual))
