"""Segments of one verdict: chatter, stable, idle or not judged, with what each verdict rests on."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.chatter_lines import is_half_tooth, tooth_powers
from chatter.detection.spectral.frame_evidence import Evidence, finer_evidence
from chatter.detection.spectral.line_of_cut import (
    CUTS,
    KNOWN,
    SIDEBANDS,
    cut_significance,
    is_line_of_cut,
    is_shaken_by_noise,
    line_of,
    sidebands_of,
)
from chatter.detection.spectral.several_lines import LinesOfCut, all_lines_of_cut
from chatter.detection.spectral.spectra import RATIO_AT_REST
from chatter.detection.spectral.steady_family import steady_families

CHATTER, STABLE, IDLE, NOT_JUDGED = "chatter", "stable", "idle", "not judged"

#: share of the power off the harmonics from which chatter begins, and down to which it goes on
BEGINS, GOES_ON = 0.3, 0.15
#: relative change of the line from frame to frame that is one line
SAME_LINE = 0.02
#: frames that chatter lasts at the least, where there are as many
_LASTS = 5
#: half-tooth share of a flip that grew, and before
_FLIP, _BEFORE_FLIP = 0.3, 0.03
#: power of the harmonics of the teeth before, over that during the flip, of the same cut
_SAME_CUT = 0.25
#: fewest revolutions of which a verdict is given
_FEWEST_REVOLUTIONS = 8.0


@dataclass(frozen=True)
class Segment:
    """A part of a recording with one verdict.

    Attributes
    ----------
    begin, end : float
        s.
    verdict : {"chatter", "stable", "idle", "not judged"}
    chatter_frequency : float
        Hz; nan without chatter.
    bifurcation : {"hopf", "flip", "none"}
    confidence : float
        0 to 1, by the margins of what the verdict rests on; no probability.
    share : float
        Of the power above 1.5 revolutions a second that is the chatter line and its family;
        without chatter of the strongest line off the harmonics. nan where it is not known.
    spindle_frequency : float
        Hz; nan where it is not known.
    reason : str
        One sentence.
    """

    begin: float
    end: float
    verdict: str
    chatter_frequency: float
    bifurcation: str
    confidence: float
    share: float
    spindle_frequency: float
    reason: str


def segments_of(evidence: Evidence) -> list[Segment]:
    """Segments of a recording, in order, without gaps."""
    if evidence.revolution is None:
        return _without_speed(evidence)
    found = _with_speed(evidence)
    if any(one.verdict == CHATTER for one in found):
        return found
    finer = finer_evidence(evidence)
    finer_found = [] if finer is None else _with_speed(finer)
    return finer_found if any(one.verdict == CHATTER for one in finer_found) else found


def _with_speed(evidence: Evidence) -> list[Segment]:
    verdicts = _verdicts(evidence)
    judged = np.array([one in (STABLE, NOT_JUDGED) for one in verdicts])
    several = all_lines_of_cut(evidence, judged) if _is_long_enough(evidence) else []
    for one in several:
        judged[one.rows] = False
    several += steady_families(evidence, judged) if _is_long_enough(evidence) else []
    for one in several:
        verdicts[one.rows] = [CHATTER] * (one.rows.stop - one.rows.start)
    return [
        _segment(evidence, verdicts[first], slice(first, last), several)
        for first, last in _runs(verdicts)
    ]


def _is_long_enough(evidence: Evidence) -> bool:
    return evidence.frames.length * evidence.revolution.mean >= _FEWEST_REVOLUTIONS


def _verdicts(evidence: Evidence) -> list[str]:
    """Verdict of each frame."""
    count = len(evidence.lines)
    if not _is_long_enough(evidence):
        return [NOT_JUDGED] * count
    idle = np.zeros(count, dtype=bool) if evidence.idle is None else evidence.idle
    verdicts = [IDLE if one else STABLE for one in idle]
    if evidence.rest is None and cut_significance(evidence) < CUTS:
        verdicts = [IDLE] * count
    for first, last, large in _runs_of_one_line(evidence, idle):
        rows = slice(first, last)
        lasts = large >= min(_LASTS, count)
        found = CHATTER if lasts and is_line_of_cut(evidence, rows) else NOT_JUDGED
        verdicts[rows] = [found] * (last - first)
    for row in np.flatnonzero(_grown_flip(evidence)):
        if verdicts[row] in (STABLE, IDLE):
            verdicts[row] = CHATTER
    return verdicts


def _runs_of_one_line(evidence: Evidence, idle: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """First and last row of frames with one line off the harmonics, and in how many it is large."""
    runs: list[tuple[int, int, int]] = []
    count = len(evidence.lines)
    row = 0
    while row < count:
        if not _is_large(evidence, idle, row, BEGINS):
            row += 1
            continue
        first, last = row, row + 1
        while last < count and _goes_on(evidence, idle, last, last - 1):
            last += 1
        while first > (runs[-1][1] if runs else 0) and _goes_on(evidence, idle, first - 1, first):
            first -= 1
        large = sum(_is_large(evidence, idle, k, BEGINS) for k in range(first, last))
        if large > 1 or count == 1:
            runs.append((first, last, large))
        row = last
    return runs


def _is_large(evidence: Evidence, idle: NDArray[np.bool_], row: int, share: float) -> bool:
    line = evidence.lines[row]
    if idle[row] or not line.share >= share:
        return False
    return evidence.above_rest(line.frequency, row) is not False


def _goes_on(evidence: Evidence, idle: NDArray[np.bool_], row: int, other: int) -> bool:
    one, two = evidence.lines[row].frequency, evidence.lines[other].frequency
    same = abs(one - two) <= SAME_LINE * two
    return same and _is_large(evidence, idle, row, GOES_ON)


def _grown_flip(evidence: Evidence) -> NDArray[np.bool_]:
    """Frames in which every second tooth became alike during the cut, of an even number of teeth.

    Its lines are harmonics of the spindle, as those of runout are; only growth is no runout. That
    the teeth cut before as they do now is seen by the harmonics of the teeth.
    """
    none = np.zeros(evidence.frames.time.size, dtype=bool)
    if evidence.teeth is None or evidence.teeth % 2 or evidence.revolution.may_be_multiple:
        return none
    teeth, halves, _ = _tooth_powers(evidence)
    shares = half_tooth_shares(evidence)
    flip = shares > _FLIP
    if flip.sum() < _LASTS:
        return none
    cut = teeth > _SAME_CUT * float(np.median(teeth[flip]))
    before = np.flatnonzero(cut & (shares < _BEFORE_FLIP))
    # unbalance is there before, and stands out where the cut ends
    if before.size < _LASTS or not (
        np.median(halves[flip]) > RATIO_AT_REST * np.median(halves[before])
    ):
        return none
    return flip & cut & (np.arange(flip.size) > before[_LASTS - 1])


def _tooth_powers(evidence: Evidence) -> NDArray[np.float64]:
    """Power of each frame at multiples of the tooth passing frequency, at odd halves, of all."""
    frames = evidence.frames
    each = [
        tooth_powers(power, frames.frequency, evidence.comb(row))
        for row, power in enumerate(frames.power)
    ]
    return np.array(each).T


def half_tooth_shares(evidence: Evidence) -> NDArray[np.float64]:
    """Share of the power at odd multiples of half the tooth passing frequency, by frame."""
    _, halves, total = _tooth_powers(evidence)
    return halves / np.maximum(total, 1e-300)


def _segment(
    evidence: Evidence, verdict: str, rows: slice, several: Sequence[LinesOfCut]
) -> Segment:
    begin, end = _bounds(evidence, rows)
    speed = float(np.median(evidence.revolution.frequency[rows]))
    lines = evidence.lines[rows]
    share = float(np.median([line.share for line in lines]))
    if verdict == CHATTER:
        inside = [one for one in several if rows.start <= one.rows.start < rows.stop]
        if inside and (share < BEGINS or any(len(one.frequencies) > 1 for one in inside)):
            return _of_several_lines(inside, begin, end, speed)
        return _chatter_segment(evidence, rows, begin, end, speed)
    confidence, reason = {
        STABLE: _of_stable, IDLE: _of_idle, NOT_JUDGED: _of_not_judged
    }[verdict](evidence, rows)  # fmt: skip
    return Segment(begin, end, verdict, math.nan, "none", confidence, share, speed, reason)


def _of_several_lines(
    found: Sequence[LinesOfCut], begin: float, end: float, speed: float
) -> Segment:
    longest = max(found, key=lambda one: one.rows.stop - one.rows.start)
    names = ", ".join(f"{one:.1f}" for one in longest.frequencies)
    lines, keeps = (
        ("lines", "keep their") if len(longest.frequencies) > 1 else ("a line", "keeps its")
    )
    beside = ", and has sidebands at the teeth" if longest.has_sidebands else ""
    reason = (
        f"{longest.share:.0%} of the power is {lines} at {names} Hz, off the harmonics of the "
        f"spindle, which {keeps} amplitude as chatter does{beside}"
    )
    strength = float(np.clip((longest.share - BEGINS) / 0.4, 0.0, 1.0))
    return Segment(
        begin, end, CHATTER, longest.frequencies[0], "hopf", 0.5 + 0.2 * strength, longest.share,
        speed, reason,
    )  # fmt: skip


def _chatter_segment(
    evidence: Evidence, rows: slice, begin: float, end: float, speed: float
) -> Segment:
    lines = evidence.lines[rows]
    share = float(np.median([line.share for line in lines]))
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    if share < GOES_ON:  # half-tooth lines, which are harmonics of the spindle
        shares = half_tooth_shares(evidence)[rows]
        strongest = _strongest_half_tooth(evidence, rows)
        reason = "lines at half the tooth passing frequency grew during the cut"
        share = float(np.median(shares))
        return Segment(begin, end, CHATTER, strongest, "flip", 0.6, share, speed, reason)
    frequency = line_of(evidence, rows).frequency
    sidebands = sidebands_of(evidence, rows)
    strength = np.clip((share - BEGINS) / 0.4, 0.0, 1.0)
    confidence = 0.5 + 0.2 * float(strength) + 0.28 * float(np.clip(sidebands / 8.0, 0.0, 1.0))
    # what the speed is not known by: a flip needs the tooth passing frequency
    is_flip = (
        evidence.teeth is not None
        and not evidence.revolution.may_be_multiple
        and is_half_tooth(frequency, comb, KNOWN / evidence.frames.length)
    )
    beside = ", and its sidebands" if sidebands >= SIDEBANDS else ""
    reason = (
        f"{share:.0%} of the power is a line at {frequency:.1f} Hz, off the harmonics of the "
        f"spindle{beside}"
    )
    kind = "flip" if is_flip else "hopf"
    return Segment(begin, end, CHATTER, frequency, kind, confidence, share, speed, reason)


def _strongest_half_tooth(evidence: Evidence, rows: slice) -> float:
    """Strongest odd multiple of half the tooth passing frequency, Hz."""
    frames = evidence.frames
    power = frames.power[rows].mean(axis=0)
    tooth = evidence.comb((rows.start + rows.stop - 1) // 2).tooth
    orders = np.arange(0.5, frames.frequency[-1] / tooth)
    strength = [
        power[np.abs(frames.frequency - k * tooth) < frames.half_width].sum() for k in orders
    ]
    return float(orders[int(np.argmax(strength))] * tooth)


def _of_stable(evidence: Evidence, rows: slice) -> tuple[float, str]:
    shares = [line.share for line in evidence.lines[rows]]
    margin = float(np.clip(1.0 - np.quantile(shares, 0.9) / BEGINS, 0.0, 1.0))
    confidence = 0.5 + 0.48 * margin
    if evidence.revolution.source == "given":
        confidence = min(confidence, 0.7)
    reason = (
        f"no line off the harmonics of the spindle has more than {max(shares):.1%} of the power"
    )
    even = evidence.teeth is not None and evidence.teeth % 2 == 0
    if even and np.median(half_tooth_shares(evidence)[rows]) > _FLIP:
        confidence = min(confidence, 0.6)
        reason += "; every second tooth is alike, by runout or by a flip that was there at once"
    return confidence, reason


def _of_idle(evidence: Evidence, rows: slice) -> tuple[float, str]:
    if evidence.rest is None and not evidence.silent[rows].all():
        return 0.6, "neither harmonics of the teeth nor a line with their sidebands stand out"
    if evidence.silent[rows].all():
        return 0.98, "nothing was recorded"
    level = float(np.median(evidence.levels[rows][~evidence.silent[rows]]))
    apart = float(np.median(evidence.levels[~evidence.idle])) - level
    return 0.5 + 0.48 * float(np.clip(apart / 12.0, 0.0, 1.0)), f"{apart:.0f} dB below the cut"


def _of_not_judged(evidence: Evidence, rows: slice) -> tuple[float, str]:
    revolutions = evidence.frames.length * evidence.revolution.mean
    if revolutions < _FEWEST_REVOLUTIONS:
        return (
            0.0,
            f"{revolutions:.1f} revolutions are too few; {_FEWEST_REVOLUTIONS:.0f} are needed",
        )
    line = line_of(evidence, rows)
    if rows.stop - rows.start < _LASTS:
        return 0.0, f"a line at {line.frequency:.1f} Hz comes and goes"
    if is_shaken_by_noise(evidence, rows, line.frequency):
        return 0.0, (
            f"a line at {line.frequency:.1f} Hz has {line.share:.0%} of the power for a while, and "
            "swings as a mode that the noise of the cut shakes: the cut may be near its limit"
        )
    return 0.0, (
        f"a line at {line.frequency:.1f} Hz has {line.share:.0%} of the power, without the "
        "sidebands that a cut gives to chatter: it may be of the machine"
    )


def _without_speed(evidence: Evidence) -> list[Segment]:
    """Idle frames, and others of which nothing can be told."""
    count = evidence.frames.time.size
    idle = np.ones(count, dtype=bool) if evidence.idle is None else evidence.idle
    verdicts = [IDLE if one else NOT_JUDGED for one in idle]
    if evidence.idle is None:
        verdicts = [NOT_JUDGED] * count
    reason = (
        "the spindle speed is not given, and no spacing of lines shows it: state --spindle-speed"
    )
    return [
        Segment(*_bounds(evidence, slice(*run)), verdicts[run[0]], math.nan, "none", 0.0, math.nan,
                math.nan, reason)
        for run in _runs(verdicts)
    ]  # fmt: skip


def _bounds(evidence: Evidence, rows: slice) -> tuple[float, float]:
    """Begin and end of frames, s: half way to those before and after."""
    time, half = evidence.frames.time, 0.5 * evidence.frames.length
    first, last = rows.start, rows.stop - 1
    begin = time[0] - half if first == 0 else 0.5 * (time[first - 1] + time[first])
    end = time[-1] + half if last == time.size - 1 else 0.5 * (time[last] + time[last + 1])
    return float(begin), float(end)


def _runs(values: list[str]) -> list[tuple[int, int]]:
    """First and last row, which is left out, of runs of equal values."""
    edges = [0, *(k for k in range(1, len(values)) if values[k] != values[k - 1]), len(values)]
    return list(itertools.pairwise(edges))
