"""Segments of a recording whose lines speak for another spindle speed than the stated one.

A cut is called stable only where it is so at both speeds. Chatter is found at the speed of the
lines, for the harmonics of another one are lines off a comb that is not theirs.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from chatter.detection.spectral.chatter_lines import LOWEST_ORDER
from chatter.detection.spectral.frame_evidence import (
    Evidence,
    cut_confirms_speed,
    evidence_at,
    share_on_harmonics,
)
from chatter.detection.spectral.revolution_frequency import ABOUT_GIVEN, Revolution
from chatter.detection.spectral.segments import (
    CHATTER,
    GOES_ON,
    IDLE,
    NOT_JUDGED,
    STABLE,
    Segment,
    segments_of,
)
from chatter.detection.spectral.sideband_family import with_sideband_families
from chatter.detection.spectral.stated_speed import FASTER, REFUTED

#: confidence of a verdict, at the most, while the speed is in doubt
_IN_DOUBT = 0.7
#: of chatter, at the most, that another speed has as stable
_UNCERTAIN = 0.5
#: share of the power of the lines that the harmonics hold of a stable cut, at the least
_ON_HARMONICS = 0.5
#: relative difference of speeds that are the same
_SAME = 5e-3


def judged(evidence: Evidence) -> list[Segment]:
    """Segments of a recording, in order, without gaps, with a verdict that the speed bears.

    Parameters
    ----------
    evidence : Evidence
    """
    return _joined(with_sideband_families(_judged_at_speeds(evidence), evidence))


def _judged_at_speeds(evidence: Evidence) -> list[Segment]:
    """Segments by the speed that was stated and by another that the lines speak for."""
    own = segments_of(evidence)
    if not any(one.verdict == CHATTER for one in own):
        own = [_supported(one, evidence) for one in own]
    other = evidence.other_speed
    if other is None:
        speed = evidence.revolution
        if speed is None or not speed.may_have_more_pulses:
            return own
        return [_below_tacho(one, evidence) for one in own]
    if other.relation == REFUTED:
        return _of_two_speeds(evidence, own)
    if other.relation == FASTER and CHATTER in {one.verdict for one in own}:
        return own
    found = segments_of(evidence_at(evidence.recording, other.frequency, evidence.teeth))
    if other.relation == FASTER:
        return _stable_at_both(evidence, own, found)
    return _joined(_maybe_of_slower(stated, one, evidence) for stated, one in _together(own, found))


def _supported(segment: Segment, evidence: Evidence) -> Segment:
    """What is stable where the harmonics hold the lines; not judged where they do not.

    Several lines that are none of them large are off the harmonics of a speed that is not true.
    """
    if segment.verdict != STABLE:
        return segment
    is_unconfirmed = evidence.revolution.source == "given" and evidence.other_speed is None
    if is_unconfirmed and not cut_confirms_speed(evidence):
        return replace(segment, verdict=NOT_JUDGED, confidence=0.0, reason=_unconfirmed(segment))
    time = evidence.frames.time
    rows = np.flatnonzero((time >= segment.begin) & (time <= segment.end))
    share = share_on_harmonics(evidence, slice(rows[0], rows[-1] + 1)) if rows.size else 1.0
    if share >= _ON_HARMONICS:
        return segment
    reason = (
        f"{1.0 - share:.0%} of the power of the lines is off the harmonics of "
        f"{60.0 * segment.spindle_frequency:.0f} rpm, at several frequencies: the speed may be "
        "another"
    )
    return replace(segment, verdict=NOT_JUDGED, confidence=0.0, reason=reason)


def _below_tacho(segment: Segment, evidence: Evidence) -> Segment:
    """Not judged where a large line is too low to be searched, of a tacho whose pulses are unknown.

    With several pulses a revolution it may be a harmonic of the spindle, or chatter.
    """
    if segment.verdict not in (STABLE, IDLE):
        return segment
    frames = evidence.frames
    rows = (frames.time >= segment.begin) & (frames.time <= segment.end)
    power = frames.power[rows].mean(axis=0) if rows.any() else frames.power.mean(axis=0)
    comb = evidence.comb(frames.time.size // 2)
    low = (frames.frequency < LOWEST_ORDER * comb.revolution) & comb.off(frames.frequency)
    strongest = int(np.argmax(np.where(low, power, 0.0)))
    line = float(frames.frequency[strongest])
    near = low & (np.abs(frames.frequency - line) < comb.half_width)
    if power[near].sum() < GOES_ON * power.sum():
        return segment
    reason = (
        f"a line at {line:.1f} Hz is no harmonic of {60.0 * comb.revolution:.0f} rpm, the speed "
        f"{_said_by(evidence.revolution)}"
    )
    return replace(segment, verdict=NOT_JUDGED, confidence=0.0, reason=reason)


def pulses_in_words(count: int) -> str:
    """Return ``"one pulse"``, ``"3 pulses"``."""
    return "one pulse" if count == 1 else f"{count} pulses"


def _unconfirmed(segment: Segment) -> str:
    return (
        f"no spacing of lines confirms {60.0 * segment.spindle_frequency:.0f} rpm, and a line of "
        "chatter may be on a harmonic of a speed that is not true: check --spindle-speed and "
        "--teeth, or record a tacho or a longer cut"
    )


def _stable_at_both(evidence: Evidence, own: list[Segment], faster: list[Segment]) -> list[Segment]:
    """What is stable as stated is so no more where a multiple of that speed has chatter."""
    if not any(one.verdict == CHATTER for one in faster):
        return own
    return _joined(
        stated if stated.verdict == one.verdict == IDLE else _disagreeing(stated, one, evidence)
        for stated, one in _together(own, faster)
    )


def _maybe_of_slower(stated: Segment, slower: Segment, evidence: Evidence) -> Segment:
    """Chatter that a slower spindle makes a cut without it is not certain."""
    if evidence.revolution.source == "tacho":  # which has this speed or that: neither is likelier
        is_same = stated.verdict == slower.verdict
        return slower if is_same else _disagreeing(stated, slower, evidence)
    if stated.verdict == slower.verdict or stated.verdict == NOT_JUDGED:
        return stated
    if stated.verdict != CHATTER:
        return _disagreeing(stated, slower, evidence) if slower.verdict == CHATTER else stated
    if slower.verdict == STABLE:
        return _disagreeing(stated, slower, evidence)
    reason = (
        f"{stated.reason}; its lines may be harmonics of a cut without chatter at "
        f"{60.0 * evidence.other_speed.frequency:.0f} rpm"
    )
    return replace(stated, confidence=min(stated.confidence, _UNCERTAIN), reason=reason)


def _of_two_speeds(evidence: Evidence, own: list[Segment]) -> list[Segment]:
    """Verdict of both speeds where they agree; chatter at that of the lines stays chatter."""
    other = evidence.other_speed
    found = segments_of(evidence_at(evidence.recording, other.frequency, evidence.teeth))
    slowest = other.spacing / (evidence.teeth or 1)
    # chatter that is none where the lines are those of the teeth is a harmonic of the spindle
    if slowest < (1.0 - _SAME) * other.frequency:
        finest = segments_of(evidence_at(evidence.recording, slowest, evidence.teeth))
        found = [
            _disagreeing(fine, one, evidence)
            if one.verdict == CHATTER and fine.verdict != CHATTER
            else one
            for fine, one in _together(finest, found)
        ]
    own = _stable_as_read(evidence, own)
    pairs = _together(own, found)
    agree = all(
        one.verdict in (CHATTER, stated.verdict) or stated.verdict == IDLE for stated, one in pairs
    )
    return _joined(_of_pair(stated, one, evidence, agree) for stated, one in pairs)


def _stable_as_read(evidence: Evidence, own: list[Segment]) -> list[Segment]:
    """What is stable as stated, and not at the speed near it that the lines show, is not judged.

    Lines one revolution apart, taken for those of the teeth of a slower spindle, speak for it; and
    of a speed one per cent off, high harmonics lie on any chatter line.
    """
    stated, other = evidence.revolution.mean, evidence.other_speed
    if abs(other.spacing / stated - 1.0) > ABOUT_GIVEN or STABLE not in {s.verdict for s in own}:
        return own
    read = segments_of(evidence_at(evidence.recording, stated, evidence.teeth))
    return _joined(
        _not_judged_as_read(one, near) if one.verdict == STABLE and near.verdict == CHATTER else one
        for one, near in _together(own, read)
    )


def _not_judged_as_read(stated: Segment, near: Segment) -> Segment:
    reason = (
        f"{_verdict(near)} at {60.0 * near.spindle_frequency:.0f} rpm, the speed near the stated "
        "one that the lines show, and stable at the stated one"
    )
    return replace(stated, verdict=NOT_JUDGED, confidence=0.0, reason=reason)


def _of_pair(stated: Segment, found: Segment, evidence: Evidence, agree: bool) -> Segment:
    if stated.verdict == IDLE and evidence.rest is not None:
        return stated  # by its level, which no speed changes
    if found.verdict == CHATTER:
        return replace(
            found,
            confidence=min(found.confidence, _IN_DOUBT),
            reason=f"{found.reason}, at the {60.0 * evidence.other_speed.frequency:.0f} rpm that "
            "the lines speak for",
        )
    if stated.verdict == found.verdict and (agree or found.verdict != STABLE):
        return replace(stated, confidence=min(stated.confidence, found.confidence, _IN_DOUBT))
    return _disagreeing(stated, found, evidence)


def _disagreeing(stated: Segment, found: Segment, evidence: Evidence) -> Segment:
    """Not judged, for the speeds have different verdicts."""
    other = evidence.other_speed
    was = evidence.revolution.mean
    reason = (
        f"{_verdict(found)} at {60.0 * other.frequency:.0f} rpm, which the lines speak for, and "
        f"{_verdict(stated)} at {60.0 * was:.0f} rpm, " + _said_by(evidence.revolution)
    )
    return replace(
        stated, verdict=NOT_JUDGED, chatter_frequency=math.nan, bifurcation="none", confidence=0.0,
        reason=reason,
    )  # fmt: skip


def _said_by(revolution: Revolution) -> str:
    if revolution.source != "tacho":
        return "as stated"
    return (
        f"by {pulses_in_words(revolution.pulses)} of the tacho a revolution: state --spindle-speed"
    )


def _verdict(segment: Segment) -> str:
    if segment.verdict == CHATTER:
        return f"chatter at {segment.chatter_frequency:.1f} Hz"
    return segment.verdict


def _together(one: list[Segment], other: list[Segment]) -> list[tuple[Segment, Segment]]:
    """Segments of both, cut where either changes."""
    edges = sorted({s.begin for s in [*one, *other]})
    edges.append(max(one[-1].end, other[-1].end))
    found = []
    for begin, end in itertools.pairwise(edges):
        middle = 0.5 * (begin + end)
        pair = [next(s for s in each if middle < s.end or s is each[-1]) for each in (one, other)]
        found.append(tuple(replace(s, begin=begin, end=end) for s in pair))
    return found


def _says(segment: Segment) -> str:
    """All but when, as text: a nan is then that of another."""
    return repr(replace(segment, begin=0.0, end=0.0))


def _joined(segments) -> list[Segment]:
    """Neighbours that say the same are one."""
    found: list[Segment] = []
    for one in segments:
        if found and _says(one) == _says(found[-1]):
            found[-1] = replace(found[-1], end=one.end)
        else:
            found.append(one)
    return found
