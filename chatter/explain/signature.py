"""Signature of a residual: where it lives, told by every view that makes sense."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from chatter.description.case import Case
from chatter.explain.kinds.kind import Kind
from chatter.explain.measurement import Measurement
from chatter.explain.residuals.diagnostics import look, nothing_beyond_chance
from chatter.explain.residuals.finding import Finding
from chatter.explain.residuals.normalised_residual import Noise, Residual, residual_of
from chatter.explain.residuals.residual_dependence import Lead, lead_of

if TYPE_CHECKING:
    from chatter.explain.explanation import Explanation


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


@dataclass(frozen=True, eq=False)
class Signatures:
    """Signatures of a measurement before and after.

    Parameters
    ----------
    refitted : Signature
        Of the declared case, refitted within its tolerances.
    with_added : Signature or None
        Of the case with the effects that were added, also where they explain a part alone.
    unexplained : bool
    """

    refitted: Signature
    with_added: Signature | None
    unexplained: bool

    @cached_property
    def lead(self) -> Lead | None:
        """Free-form description of what nothing known explains; None where nothing is."""
        if not self.unexplained:
            return None
        if self.with_added is not None and self.with_added.lead.finding.beyond_chance:
            return self.with_added.lead
        return self.refitted.lead

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json."""
        return {
            "refitted": self.refitted.summary(),
            "with_what_was_added": self.with_added.summary() if self.with_added else None,
            "lead": self.lead.summary() if self.lead else None,
        }


def signatures_of(explanation: Explanation) -> Signatures:
    """Look at what the refitted case leaves, and at what is left beside what was added."""
    found, measurement = explanation.found, explanation.measurement
    noise = found.problem.noise
    added = None
    if found.accepted:
        case = found.problem.case(found.final.by_name)
        # samples count as far as the law that was found is certain of them
        added = signature_of(found.measurement, found.kind, case, noise)
    return Signatures(
        signature_of(measurement, found.kind, explanation.refitted, noise),
        added,
        explanation.verdict == "unexplained",
    )
