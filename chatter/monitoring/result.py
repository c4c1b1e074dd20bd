"""What was detected in a recording: verdicts over time, chatter frequency, advice; picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.description.case import Case
from chatter.detection.spectral.frame_evidence import Evidence
from chatter.detection.spectral.overload import NOTED, overloaded
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import VARIATION, Revolution
from chatter.detection.spectral.segments import Segment
from chatter.detection.spectral.stated_speed import REFUTED, OtherSpeed
from chatter.detection.spectral.two_speeds import pulses_in_words
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, finite_or_none, write_results
from chatter.monitoring.advice import ChatterMode, ProposedSpeed, as_rows, in_words
from chatter.monitoring.overall_verdict import durations_of, verdict_of
from chatter.monitoring.overall_verdict import in_words as verdict_in_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: difference of the speed from the one that was given that is worth a note
_DIFFERS = 0.01


@dataclass(frozen=True)
class Advice:
    """What to do about chatter.

    Attributes
    ----------
    segment : Segment
        The chatter that it is about.
    proposed : tuple of ProposedSpeed
    mode : ChatterMode or None
        Of the case.
    case : Case or None
    case_is_stable : bool
        Whether the case has the cut as stable, against the recording.
    """

    segment: Segment
    proposed: tuple[ProposedSpeed, ...]
    mode: ChatterMode | None = None
    case: Case | None = None
    case_is_stable: bool = False

    @property
    def sentences(self) -> list[str]:
        """The advice in words."""
        frequency = self.segment.chatter_frequency
        return in_words(list(self.proposed), self.mode, self.case, frequency, self.case_is_stable)


@dataclass(frozen=True, eq=False, repr=False)
class DetectedChatter(NotebookResult):
    """Verdicts over a recording.

    Parameters
    ----------
    recording : Recording
    evidence : Evidence
    segments : tuple of Segment
    given : float or None
        Hz, frequency of the spindle as it was stated.
    case : Case or None
    advice : Advice or None
        None without chatter.
    """

    recording: Recording
    evidence: Evidence
    segments: tuple[Segment, ...]
    given: float | None
    case: Case | None
    advice: Advice | None

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        return f"<DetectedChatter {self.recording.name!r}, {self.headline}>"

    @property
    def verdict(self) -> str:
        """Of the recording: that of its segments which matters most."""
        return verdict_of(self.segments)

    @property
    def headline(self) -> str:
        """The verdict, and for how long each verdict holds."""
        return verdict_in_words(self.segments)

    @property
    def chatter_frequency(self) -> float | None:
        """Of the longest chatter, Hz; None without chatter."""
        return None if self.advice is None else self.advice.segment.chatter_frequency

    def summary(self) -> dict[str, Any]:
        """Content of detection.json."""
        revolution, other = self.evidence.revolution, self.refuting_speed
        return {
            "recording": self.recording.name,
            "channels": list(self.recording.channels),
            "duration_s": self.recording.duration,
            "verdict": self.verdict,
            "verdict_durations_s": durations_of(self.segments),
            "chatter_frequency_Hz": self.chatter_frequency,
            "spindle_speed_rpm": None if revolution is None else 60.0 * revolution.mean,
            "spindle_speed_source": None if revolution is None else revolution.source,
            "spindle_speed_of_lines_rpm": None if other is None else 60.0 * other.frequency,
            "teeth": self.evidence.teeth,
            "segments": [
                {
                    "from_s": one.begin,
                    "to_s": one.end,
                    "verdict": one.verdict,
                    "chatter_frequency_Hz": finite_or_none(one.chatter_frequency),
                    "bifurcation": one.bifurcation,
                    "confidence": one.confidence,
                    "share_off_harmonics": finite_or_none(one.share),
                    "spindle_speed_rpm": finite_or_none(60.0 * one.spindle_frequency),
                    "reason": one.reason,
                }
                for one in self.segments
            ],
            "advice": [] if self.advice is None else self.advice.sentences,
            "proposed_speeds": [] if self.advice is None else as_rows(list(self.advice.proposed)),
            "mode": self._mode(),
            "notes": self.notes,
        }

    @property
    def refuting_speed(self) -> OtherSpeed | None:
        """Speed that the lines speak for where they speak against the stated one."""
        other = self.evidence.other_speed
        return other if other is not None and other.relation == REFUTED else None

    def _mode(self) -> dict[str, Any] | None:
        mode = None if self.advice is None else self.advice.mode
        return None if mode is None else {"number": mode.number, "frequency_Hz": mode.frequency}

    @property
    def notes(self) -> list[str]:
        """What the reader should know."""
        notes = []
        revolution = self.evidence.revolution
        if self.refuting_speed is not None and self.given is not None:
            notes.append(in_words_of(self.refuting_speed, self.given, self.evidence.teeth))
        by_tacho = revolution is not None and revolution.source == "tacho"
        if by_tacho and self.given is None and not self.recording.once_per_revolution:
            notes.append(self._of_pulses(revolution))
        if revolution is not None and self.given is not None:
            slowest, fastest = (60.0 * one(revolution.frequency) for one in (np.min, np.max))
            ratio = revolution.mean / self.given
            if fastest > (1.0 + 2.0 * VARIATION) * slowest:
                notes.append(
                    f"the spindle changes its speed: {slowest:.0f} to {fastest:.0f} rpm by the "
                    f"{_by(revolution)}, {60.0 * self.given:.0f} rpm were stated"
                )
            elif abs(ratio - 1.0) > _DIFFERS:
                notes.append(
                    f"the spindle runs at {60.0 * revolution.mean:.0f} rpm by the {_by(revolution)}"
                    f", {60.0 * self.given:.0f} rpm were stated"
                )
        if self.refuting_speed is None and revolution is not None and revolution.source == "given":
            notes.append("no spacing of lines confirms the spindle speed")
        if revolution is not None and revolution.may_be_multiple:
            notes.append(
                "the spindle speed is the spacing of the lines: that of a revolution, or of "
                "several teeth; state --spindle-speed and --teeth for better verdicts"
            )
        share = float(overloaded(self.recording).mean())
        if share > NOTED:
            notes.append(
                f"{share:.0%} of the samples stand at the ends of the range: the recorder was "
                "overloaded"
            )
        if self.advice is not None and self.evidence.teeth is None:
            notes.append("state --teeth for the speeds that the chatter frequency proposes")
        return notes

    def _of_pulses(self, revolution: Revolution) -> str:
        """How many pulses a revolution the speed by a tacho is read with."""
        other, pulses = self.evidence.other_speed, pulses_in_words(revolution.pulses)
        said = (
            f"{60.0 * revolution.mean:.0f} rpm is the speed at {pulses} of the tacho a revolution"
        )
        if other is not None:
            several = round(revolution.pulses * revolution.mean / other.frequency)
            return (
                f"{said}; its lines fit {60.0 * other.frequency:.0f} rpm too, at {several}: state "
                "--spindle-speed"
            )
        if revolution.may_have_more_pulses:
            return f"{said}; where it gives more, state --spindle-speed"
        return f"{said}, which its lines show; where it gives another number, state --spindle-speed"

    def plot(self) -> Figure:
        """Spectrogram with verdicts, harmonics and chatter lines marked."""
        return presentation("plots.detection").plot_detection(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write detection.json and detection.png."""
        return write_results(
            folder, {"detection.json": as_json(self.summary())}, {"detection.png": self.plot()}
        )


def in_words_of(other: OtherSpeed, stated: float, teeth: int | None) -> str:
    """That the lines speak for another speed than the stated one, Hz."""
    return (
        f"the record speaks for {60.0 * other.frequency:.0f} rpm, {60.0 * stated:.0f} rpm were "
        f"stated: its lines are {other.spacing:.1f} Hz apart{_if_alike(other, teeth)}. That would "
        f"be an override of {other.frequency / stated:.0%}, another cut, or another number of "
        "teeth: state --spindle-speed and --teeth as they were"
    )


def _if_alike(other: OtherSpeed, teeth: int | None) -> str:
    """Other speeds that have lines so far apart, where teeth are alike."""
    if teeth is None:
        return ""
    each = [60.0 * other.spacing / parts for parts in range(teeth, 0, -1) if teeth % parts == 0]
    rest = [f"{one:.0f}" for one in each if abs(one / (60.0 * other.frequency) - 1.0) > _DIFFERS]
    if not rest:
        return ""
    return f", which may also be {' or '.join(rest)} rpm where some of its {teeth} teeth are alike"


def _by(revolution: Revolution) -> str:
    return "tacho" if revolution.source == "tacho" else "spacing of its lines"
