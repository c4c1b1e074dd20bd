"""A spindle that changes its speed in the record: it runs up, or the override is turned.

The harmonics of the new speed lie off those of the old one, as chatter does. So the speed is
followed over the whole record, by that course of it which the spacing of the lines bears best, and
the record is judged at even angles of the spindle, where its harmonics are lines again (order
tracking; Fyfe and Munck 1997, Mech. Syst. Signal Process. 11, 187).
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from chatter.detection.spectral.activity import activity_levels, idle_frames, silent_frames
from chatter.detection.spectral.frame_evidence import Evidence, evidence_of, frames_about
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import (
    ABOUT_GIVEN,
    REFINED,
    line_autocorrelations,
    spacing_scores,
)
from chatter.detection.spectral.segments import Segment
from chatter.detection.spectral.spectra import Frames
from chatter.detection.spectral.two_speeds import judged

Array = NDArray[np.float64]

#: speeds that are tried about the stated one
_SPEEDS = 481
#: standard deviations that a frame counts at the most, and those that a change by 1 % costs
_AT_MOST, _PRICE = 30.0, 9.0
#: relative difference of another speed, frames that have it at the least, standard deviations that
#: it has there, and how much better than the usual speed, and what is within half as much of it
_OTHER, _FEWEST, _PLAUSIBLE, _BETTER = 8e-3, 5, 5.0, 1.7


class SpeedOverTime(NamedTuple):
    """Frequency of the revolution over the record."""

    time: Array  # (m,) s
    frequency: Array  # (m,) Hz

    def at(self, time: Array) -> Array:
        """Frequency at times, s; before the first and behind the last it stays."""
        return np.interp(time, self.time, self.frequency)


def varied_speed(recording: Recording, stated: float, teeth: int | None) -> SpeedOverTime | None:
    """Speed over a record that has another one for some frames.

    Parameters
    ----------
    recording : Recording
    stated : float
        Hz.
    teeth : int or None

    Returns
    -------
    SpeedOverTime or None
        None where one speed explains the lines.
    """
    frames = frames_about(recording, stated)
    speeds = stated * np.geomspace(1.0 - ABOUT_GIVEN, 1.0 + ABOUT_GIVEN, _SPEEDS)
    scores = _scores(frames, speeds, teeth or 1)
    # what is there in the air has spacings of its own
    idle = idle_frames(activity_levels(frames, silent_frames(recording, frames)))
    if idle is not None:
        scores[idle] = 0.0
    course = _best_course(scores, _PRICE * 100.0 * np.log(speeds[1] / speeds[0]))
    one = int(np.argmax(scores.sum(axis=0)))
    is_other = np.abs(speeds[course] / speeds[one] - 1.0) > _OTHER
    if idle is not None:
        is_other &= ~idle
    if is_other.sum() < _FEWEST:
        return None
    near = np.abs(speeds / speeds[one] - 1.0) < 0.5 * _OTHER
    along = scores[np.arange(len(scores)), course][is_other]
    beside = scores[is_other][:, near].max(axis=1)
    if not (along.mean() > _PLAUSIBLE and along.sum() > _BETTER * beside.sum()):
        return None
    return SpeedOverTime(frames.time, speeds[course])


def _scores(frames: Frames, speeds: Array, teeth: int) -> Array:
    """Standard deviations by which speeds, as spacings of lines, exceed others in a frame, (m, k).

    A frame counts with its neighbours.
    """
    each = line_autocorrelations(frames)
    found = np.empty((len(each), speeds.size))
    for row in range(len(each)):
        together = each[max(row - 1, 0) : row + 2].sum(axis=0)
        scores = spacing_scores(together, frames.step, speeds, teeth)
        scores = scores - np.median(scores)
        found[row] = scores / max(1.4826 * float(np.median(np.abs(scores))), 1e-12)
    return np.clip(found, 0.0, _AT_MOST)


def _best_course(scores: Array, price: float) -> NDArray[np.intp]:
    """Column of each row (m, k) with the largest sum, less the price of each column crossed."""
    count, size = scores.shape
    columns = np.arange(size)
    origins = np.empty((count, size), dtype=np.intp)
    best = scores[0]
    for row in range(1, count):
        best, origins[row] = _reached(best, price * columns)
        best = best + scores[row]
    course = np.empty(count, dtype=np.intp)
    course[-1] = np.argmax(best)
    for row in range(count - 1, 0, -1):
        course[row - 1] = origins[row, course[row]]
    return course


def _reached(best: Array, prices: Array) -> tuple[Array, NDArray[np.intp]]:
    """Best sum with which each column is reached from any other, and from which."""
    upwards, from_below = _reached_upwards(best, prices)
    downwards, from_above = _reached_upwards(best[::-1], prices)
    downwards, from_above = downwards[::-1], best.size - 1 - from_above[::-1]
    is_upwards = upwards >= downwards
    return np.where(is_upwards, upwards, downwards), np.where(is_upwards, from_below, from_above)


def _reached_upwards(best: Array, prices: Array) -> tuple[Array, NDArray[np.intp]]:
    raised = best + prices
    highest = np.maximum.accumulate(raised)
    origin = np.maximum.accumulate(np.where(raised == highest, np.arange(best.size), 0))
    return highest - prices, origin


def judged_at_even_angles(
    recording: Recording, speed: SpeedOverTime, teeth: int | None
) -> list[Segment]:
    """Segments of a record whose speed changes, judged at even angles of the spindle."""
    time = recording.start + recording.time_step * np.arange(len(recording.values))
    frequency = speed.at(time)
    mean = float(frequency.mean())
    even = np.concatenate([[0.0], np.cumsum(0.5 * (frequency[1:] + frequency[:-1]))])
    even = recording.start + recording.time_step * even / mean
    sample = np.interp(time, even, np.arange(time.size, dtype=np.float64))[None, :]
    values = [map_coordinates(one, sample, order=3, mode="nearest") for one in recording.values.T]
    resampled = replace(recording, values=np.column_stack(values), tacho=None)
    segments = judged(evidence_of(resampled, mean, teeth))
    return [_at_its_time(one, even, time, speed, mean) for one in segments]


def _at_its_time(
    segment: Segment, even: Array, time: Array, speed: SpeedOverTime, mean: float
) -> Segment:
    """Segment in the time of the record, its frequencies as they were there."""
    begin, end = (float(np.interp(one, even, time)) for one in (segment.begin, segment.end))
    inside = (speed.time >= begin) & (speed.time <= end)
    middle = np.array([0.5 * (begin + end)])
    there = speed.frequency[inside] if inside.any() else speed.at(middle)
    factor = float(np.median(there)) / mean
    return replace(
        segment,
        begin=begin,
        end=end,
        chatter_frequency=segment.chatter_frequency * factor,
        spindle_frequency=segment.spindle_frequency * factor,
        reason=f"{segment.reason} (frequencies as at {60.0 * mean:.0f} rpm)"
        if re.search(r"\b(Hz|rpm)\b", segment.reason)
        else segment.reason,
    )


def with_speed(evidence: Evidence, speed: SpeedOverTime) -> Evidence:
    """What the frames of a record say, with the speed that it has over time."""
    frequency = speed.at(evidence.frames.time)
    revolution = evidence.revolution._replace(
        frequency=frequency, mean=float(frequency.mean()), source=REFINED
    )
    return replace(evidence, revolution=revolution, other_speed=None)
