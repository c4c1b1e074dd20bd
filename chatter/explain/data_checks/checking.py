"""The table of checks, and going through it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from chatter.explain.data_checks.channel_assignment import wrong_arrangement
from chatter.explain.data_checks.clock import clock_findings
from chatter.explain.data_checks.displacement import wrong_displacements
from chatter.explain.data_checks.exclusion import left_out
from chatter.explain.data_checks.finding import FATAL, NOTE, Check, SignalFinding
from chatter.explain.data_checks.motion import wrong_motion
from chatter.explain.data_checks.responses import disagreeing_responses, wrong_responses
from chatter.explain.data_checks.samples import copies, dead_channels, dropouts, flat_tops, gaps
from chatter.explain.data_checks.scale import wrong_scales
from chatter.explain.data_checks.spindle import wrong_speeds, wrong_teeth
from chatter.explain.data_checks.verdicts import wrong_verdicts
from chatter.explain.kinds.columns import require_columns
from chatter.explain.kinds.registry import require_sections
from chatter.explain.measurement import Measurement

_TIME = ("milling", "axis")
_SAMPLED = ("milling", "axis", "frf")

#: checks in the order in which they are made; where one of a group finds what is fatal, those of
#: the groups after it would only repeat it
CHECKS: tuple[tuple[Check, ...], ...] = (
    (
        Check("copies", _SAMPLED, copies, "runs with the same numbers"),
        Check("dead", _SAMPLED, dead_channels, "channels that never change"),
        Check("gaps", _SAMPLED, gaps, "samples that are no numbers"),
        Check("flat tops", _SAMPLED, flat_tops, "saturation"),
        Check("dropouts", _TIME, dropouts, "samples at exactly zero in between"),
        Check("clock", _TIME, clock_findings, "clocks that run back, jump, jitter; units"),
    ),
    (
        Check("speed", ("milling",), wrong_speeds, "spindle speed against angle and forces"),
        Check("teeth", ("milling",), wrong_teeth, "teeth counted in the forces"),
        Check("motion", ("axis",), wrong_motion, "velocity, position and force of an axis"),
        Check("responses", ("frf",), wrong_responses, "units and directions of FRFs"),
        Check("verdicts", ("stability",), wrong_verdicts, "units and sense of verdicts"),
    ),
    (
        Check("scale", ("milling",), wrong_scales, "units of the forces, dead sensors"),
        Check("repetitions", ("frf",), disagreeing_responses, "FRFs that should be alike"),
    ),
    (Check("arrangement", ("milling",), wrong_arrangement, "axes, signs, mode and depths"),),
    (Check("displacements", ("milling",), wrong_displacements, "axes, signs, units of motion"),),
)


@dataclass(frozen=True, eq=False)
class Checked:
    """A measurement, what was found in it, and what of it can be used.

    Parameters
    ----------
    measurement : Measurement
        Without what is no good.
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
        alone = {"time", "spindle_angle", "spindle_speed"}
        return self.is_fatal and (
            any(one.severity == FATAL and one.channel in alone for one in self.findings)
        )

    def as_list(self) -> list[dict[str, Any]]:
        """Findings as they stand in explanation.json."""
        return [one.as_dict() for one in self.findings]


def checked(measurement: Measurement, checks: Sequence[Sequence[Check]] = CHECKS) -> Checked:
    """Check a measurement and leave out what is no good.

    Parameters
    ----------
    measurement : Measurement
        As read.
    checks : sequence of sequence of Check

    Raises
    ------
    InputError
        If the case lacks a section, or a run a column that its kind needs.
    """
    require_sections(measurement)
    require_columns(measurement)
    found: list[SignalFinding] = []
    usable = measurement
    for group in checks:
        new = [
            finding
            for check in group
            if measurement.kind in check.kinds
            for finding in check.finds(usable)
        ]
        found += new
        remaining = left_out(usable, new)
        if any(one.severity == FATAL for one in new):
            break
        if not remaining.runs:
            says = f"none of the {len(measurement.runs)} runs can be used"
            found.append(SignalFinding(FATAL, "", "", says))
            break
        usable = remaining
    return Checked(usable, tuple(sorted(_once(found), key=_rank)))


_RANKS = {FATAL: 0, "run": 1, "channel": 2, "samples": 3, NOTE: 4}


def _rank(finding: SignalFinding) -> int:
    return _RANKS[finding.severity]


def _once(found: Sequence[SignalFinding]) -> list[SignalFinding]:
    """Findings without those that say the same again."""
    seen: set[tuple[str, str, str]] = set()
    kept = []
    for one in found:
        key = (one.severity, one.run, one.says)
        if key not in seen:
            seen.add(key)
            kept.append(one)
    return kept
