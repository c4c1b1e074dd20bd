"""Checks of a measurement, group by group, and the exclusion of what they find."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from chatter.explain.data_checks.exclusion import excluding
from chatter.explain.data_checks.finding import FATAL, FOLLOWS, SignalFinding
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement import Measurement

#: channels without which no prediction can stand beside a signal
_ABSCISSAE = ("time", "spindle_angle", "spindle_speed")


@dataclass(frozen=True, eq=False)
class Checked:
    """A measurement, what was found in it, and what of it can be used.

    Parameters
    ----------
    measurement : Measurement
        Without what is unusable.
    findings : tuple of SignalFinding
        The worst first.
    """

    measurement: Measurement
    findings: tuple[SignalFinding, ...]

    @property
    def is_fatal(self) -> bool:
        """Whether nothing can be concluded from the measurement beside its declared case."""
        return any(one.severity == FATAL for one in self.findings)

    @property
    def forbids_prediction(self) -> bool:
        """Whether not even times and samples are such that a prediction can stand beside them."""
        return any(one.severity == FATAL and one.channel in _ABSCISSAE for one in self.findings)

    def as_list(self) -> list[dict[str, Any]]:
        """Findings as they stand in explanation.json."""
        return [one.as_dict() for one in self.findings]


def checked(measurement: Measurement) -> Checked:
    """Check a measurement by the checks of its kind and exclude what is unusable.

    Parameters
    ----------
    measurement : Measurement
        As read.

    Raises
    ------
    InputError
        If the case lacks a section, or a run a column that its kind needs.
    """
    kind = KINDS[measurement.kind]
    kind.require(measurement)
    found: list[SignalFinding] = []
    usable = measurement
    for group in kind.checks:
        new = [finding for check in group for finding in check(usable)]
        found += new
        remaining = excluding(usable, new)
        if any(one.severity == FATAL for one in new):
            break
        if not remaining.runs:
            description = f"none of the {len(measurement.runs)} runs can be used"
            found.append(SignalFinding(FATAL, "", "", description))
            break
        usable = remaining
    ranks = list(FOLLOWS)
    return Checked(usable, tuple(sorted(_once(found), key=lambda one: ranks.index(one.severity))))


def _once(found: Sequence[SignalFinding]) -> list[SignalFinding]:
    """Findings without those that report the same again."""
    seen: dict[tuple[str, str, str], SignalFinding] = {}
    for one in found:
        seen.setdefault((one.severity, one.run, one.description), one)
    return list(seen.values())
