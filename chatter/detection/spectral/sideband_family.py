"""Chatter by a line and its sidebands at the teeth, which show the speed that it is judged by.

A speed that all lines show together, or that was stated, may be off by just what puts a line of
chatter on a harmonic: of few lines the strongest decides. The distance of its own sidebands is that
of the teeth whatever else is heard, and a harmonic is a whole number of revolutions of that.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.chatter_lines import LOWEST_ORDER
from chatter.detection.spectral.envelope import envelope_kurtosis
from chatter.detection.spectral.frame_evidence import Evidence
from chatter.detection.spectral.line_of_cut import READINGS, STEADY
from chatter.detection.spectral.revolution_frequency import ABOUT_GIVEN, REFINED
from chatter.detection.spectral.segments import CHATTER, IDLE, NOT_JUDGED, SAME_LINE, Segment

Array = NDArray[np.float64]

#: orders of sidebands that are looked for
_ORDERS = (-3, -2, -1, 1, 2, 3)
#: logarithm above the floor of a peak, and strongest peaks of a frame that are looked at
_STANDS_OUT, _MOST = 2.5, 5
#: distance of a sideband from where it belongs, and accuracy of a peak, in bins of the frame
_BESIDE, _ACCURACY = 0.4, 0.12
#: range about the known speed in which two sidebands are enough; within ABOUT_GIVEN three are
_NEAR, _ENOUGH, _MORE = 0.02, 2, 3
#: lines of a family up to which none is missing
_FEW = 4
#: least share of the power of a line with its sidebands
_LEAST = 0.08
#: least distance from a harmonic: in revolutions, in bins of the frame, and in standard deviations
_APART, _BINS_APART, _DEVIATIONS = 0.05, 0.5, 4.0
#: frames of chatter, and of what is not judged; relative change of the speed between two, and its
#: relative scatter about a straight line over time
_FRAMES, _FEWER, _CHANGE, _SCATTER = 5, 4, 0.015, 3e-3
#: distance from a harmonic of the known speed, in bins, and its relative accuracy
_ON_HARMONIC, _KNOWN = 0.5, 2e-4
#: confidence of chatter that is found so
_CONFIDENCE = 0.6


class _Family(NamedTuple):
    """A line off the harmonics, and its sidebands at the teeth."""

    time: float  # s, middle of the frame
    line: float  # Hz
    alone: float  # share of the power
    share: float  # the same with the sidebands
    revolution: float  # Hz, as the sidebands show it


def with_sideband_families(segments: list[Segment], evidence: Evidence) -> list[Segment]:
    """Segments of a recording in which no chatter was found, with what the sidebands show.

    A line that keeps its amplitude is chatter; one that does not, or is too short to tell, leaves
    nothing stable.
    """
    revolution, teeth = evidence.revolution, evidence.teeth
    if revolution is None or revolution.source not in ("given", REFINED) or teeth in (None, 1):
        return segments
    if any(one.verdict == CHATTER for one in segments):
        return segments
    families = _longest_run([_largest(evidence, row) for row in range(evidence.frames.time.size)])
    if len(families) < _FEWER or _scatter(families) > _SCATTER:
        return segments
    is_chatter = len(families) >= _FRAMES and _kurtosis(evidence, families) < STEADY
    found = _segment(families, evidence, CHATTER if is_chatter else NOT_JUDGED)
    return list(_with(segments, found))


def _largest(evidence: Evidence, row: int) -> _Family | None:
    """Family of the largest line of a frame that is off the harmonics of its own sidebands.

    None of a frame at rest, and none of a line that is there at rest.
    """
    if evidence.idle is not None and evidence.idle[row]:
        return None
    frames, known = evidence.frames, evidence.revolution.mean
    searched = frames.frequency > LOWEST_ORDER * known
    total = float(frames.power[row][searched].sum())
    at, power = _peaks(frames.power[row], frames.above[row], frames.step)
    inside = at > LOWEST_ORDER * known
    at, power = at[inside], power[inside]
    left, found = power.copy(), []
    for _ in range(min(_MOST, at.size)):
        line = float(at[int(np.argmax(left))])
        beside = np.abs(at - line) >= frames.half_width
        left[~beside] = 0.0
        for within, enough in ((_NEAR, _ENOUGH), (ABOUT_GIVEN, _MORE)):
            orders, index = _sidebands(at, power * beside, line, evidence, within)
            if len(orders) < enough or not _are_nearest(orders):
                continue
            revolution = _spacing(line, at[index], orders) / evidence.teeth
            if not _is_off(line, revolution, orders, evidence):
                continue
            if any(_are_harmonics(at[index], one, evidence) for one in _speeds(evidence, row)):
                continue
            shares = [
                float(frames.power[row][np.abs(frames.frequency - one) < frames.half_width].sum())
                for one in (line, *at[index])
            ]
            time = float(frames.time[row])
            found.append(_Family(time, line, shares[0] / total, sum(shares) / total, revolution))
    large = [
        one
        for one in found
        if one.share >= _LEAST and evidence.above_rest(one.line, row) is not False
    ]
    return max(large, key=lambda one: one.alone, default=None)


def _peaks(power: Array, above: Array, step: float) -> tuple[Array, Array]:
    """Frequencies, Hz, and powers of the peaks of a spectrum, by the parabola of three bins."""
    middle = power[1:-1]
    is_peak = (middle > power[:-2]) & (middle >= power[2:]) & (above[1:-1] > _STANDS_OUT)
    index = np.flatnonzero(is_peak) + 1
    low, high = (np.log(np.maximum(power[index + side], 1e-300)) for side in (-1, 1))
    curvature = low - 2.0 * np.log(power[index]) + high
    shift = np.where(curvature < 0.0, 0.5 * (low - high) / np.minimum(curvature, -1e-12), 0.0)
    return (index + np.clip(shift, -1.0, 1.0)) * step, power[index]


def _sidebands(
    at: Array, power: Array, line: float, evidence: Evidence, within: float
) -> tuple[Array, NDArray[np.intp]]:
    """Orders and places of the peaks that are sidebands of a line at one distance.

    Of the distances between the line and a peak that the teeth may have, that which most peaks fit,
    and then the largest. Those of the line itself have no power.
    """
    tooth = evidence.teeth * evidence.revolution.mean
    wide = _BESIDE / evidence.frames.length
    best: tuple[tuple[int, float], list[int], list[int]] = ((0, 0.0), [], [])
    for order in _ORDERS:
        reach = within * abs(order) * tooth + 0.5 * wide
        near = np.flatnonzero((np.abs(at - line - order * tooth) < reach) & (power > 0.0))
        for spacing in (at[near] - line) / order:
            if not abs(spacing / tooth - 1.0) < within:
                continue
            orders, index = _fitting(at, line, float(spacing), wide)
            quality = len(orders), float(np.log(power[index]).sum())
            if quality > best[0]:
                best = quality, orders, index
    return np.array(best[1], dtype=np.float64), np.array(best[2], dtype=np.intp)


def _fitting(at: Array, line: float, spacing: float, wide: float) -> tuple[list[int], list[int]]:
    """Orders and places of the peaks that lie whole multiples of a distance from a line."""
    orders, index = [], []
    for order in _ORDERS:
        apart = np.abs(at - line - order * spacing)
        nearest = int(np.argmin(apart))
        if apart[nearest] < wide:
            orders.append(order)
            index.append(nearest)
    return orders, index


def _spacing(line: float, sidebands: Array, orders: Array) -> float:
    """Distance of sidebands from a line, Hz, by least squares."""
    return float(orders @ (sidebands - line) / (orders @ orders))


def _is_off(line: float, revolution: float, orders: Array, evidence: Evidence) -> bool:
    """Whether a line is off the harmonics of a revolution that its sidebands show."""
    bin_width = 1.0 / evidence.frames.length
    order = line / revolution
    apart = abs(order - round(order))
    accuracy = _ACCURACY * bin_width / revolution
    accuracy *= 1.0 + order / (evidence.teeth * math.sqrt(float(orders @ orders)))
    least = max(_APART, _DEVIATIONS * accuracy, _BINS_APART * bin_width / revolution)
    return apart > least


def _are_nearest(orders: Array) -> bool:
    """Whether no sideband between two others, or the line and another, is missing of a few."""
    places = np.sort(np.append(orders, 0.0))
    return places.size > _FEW or bool(np.all(np.diff(places) == 1.0))


def _speeds(evidence: Evidence, row: int) -> list[float]:
    """Revolutions, Hz, whose harmonics the lines of a frame may be."""
    other = evidence.other_speed
    others = [] if other is None else [other.frequency, other.spacing]
    return [float(evidence.revolution.frequency[row]), *others]


def _are_harmonics(sidebands: Array, revolution: float, evidence: Evidence) -> bool:
    """Whether all but one of the sidebands of a line are harmonics of a revolution, Hz.

    Where harmonics stand close, some are as far from any line as the teeth of a speed in the range.
    """
    order = sidebands / revolution
    apart = np.abs(order - np.round(order)) * revolution
    is_off = apart > _ON_HARMONIC / evidence.frames.length + _KNOWN * sidebands
    return int(is_off.sum()) < _ENOUGH


def _longest_run(found: Sequence[_Family | None]) -> list[_Family]:
    """Longest run of frames with one line at a speed that hardly changes; one may be missing."""
    best: list[_Family] = []
    for first, one in enumerate(found):
        if one is None:
            continue
        run, missing = [one], 0
        for other in found[first + 1 :]:
            if other is None or not _goes_on(run, other):
                missing += 1
                if missing > 1:
                    break
                continue
            run.append(other)
            missing = 0
        best = max(best, run, key=len)
    return best


def _goes_on(run: Sequence[_Family], other: _Family) -> bool:
    is_same = abs(other.line / run[0].line - 1.0) < SAME_LINE
    return is_same and abs(other.revolution / run[-1].revolution - 1.0) < _CHANGE


def _scatter(families: Sequence[_Family]) -> float:
    """Relative scatter of the speed that sidebands show about a straight line over time."""
    time = np.array([one.time for one in families])
    speed = np.array([one.revolution for one in families])
    rest = speed - np.polyval(np.polyfit(time - time.mean(), speed, 1), time - time.mean())
    return 1.4826 * float(np.median(np.abs(rest)) / np.median(speed))


def _kurtosis(evidence: Evidence, families: Sequence[_Family]) -> float:
    """Kurtosis of the envelope of the line, between the middles of the first and last frame.

    It is nan where they hold too few independent readings.
    """
    line, revolution = _medians(families)
    begin, end = families[0].time, families[-1].time
    order = line / revolution
    if (end - begin) * abs(order - round(order)) * revolution < READINGS:
        return math.nan
    return envelope_kurtosis(evidence.recording, begin, end, line, revolution)


def _medians(families: Sequence[_Family]) -> tuple[float, float]:
    """Frequency of the line, and of the revolution, Hz."""
    line, revolution = (
        float(np.median([getattr(one, name) for one in families]))
        for name in ("line", "revolution")
    )
    return line, revolution


def _segment(families: Sequence[_Family], evidence: Evidence, verdict: str) -> Segment:
    """Segment over the frames: to half way to those before and after, or the ends of the record."""
    line, revolution = _medians(families)
    share = float(np.median([one.share for one in families]))
    tooth = evidence.teeth * revolution
    reason = (
        f"{share:.0%} of the power is a line at {line:.1f} Hz with sidebands {tooth:.1f} Hz apart: "
        f"they show {60.0 * revolution:.0f} rpm, of which the line is no harmonic"
    )
    if verdict != CHATTER:
        reason += "; whether it keeps its amplitude, as chatter does, is not seen"
    apart = line / tooth % 1.0
    is_flip = abs(apart - 0.5) * tooth < _BESIDE / evidence.frames.length
    time, half = evidence.frames.time, 0.5 * evidence.frames.length
    first, last = np.searchsorted(time, (families[0].time, families[-1].time))
    begin = float(time[0] - half if first == 0 else 0.5 * (time[first - 1] + time[first]))
    is_last = last == time.size - 1
    end = float(time[-1] + half if is_last else 0.5 * (time[last] + time[last + 1]))
    kind = "none" if verdict != CHATTER else "flip" if is_flip else "hopf"
    return Segment(
        begin, end, verdict, line if verdict == CHATTER else math.nan,
        kind, _CONFIDENCE if verdict == CHATTER else 0.0, share, revolution, reason,
    )  # fmt: skip


def _with(segments: Sequence[Segment], found: Segment) -> Iterator[Segment]:
    """Segments of which a part is another one; what is not judged changes only what is stable."""
    unchanged = (CHATTER,) if found.verdict == CHATTER else (CHATTER, IDLE, NOT_JUDGED)
    for one in segments:
        begin, end = max(one.begin, found.begin), min(one.end, found.end)
        if begin >= end or one.verdict in unchanged:
            yield one
            continue
        if one.begin < begin:
            yield replace(one, end=begin)
        yield replace(found, begin=begin, end=end)
        if end < one.end:
            yield replace(one, begin=end)
