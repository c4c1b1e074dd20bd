"""Chatter detection while a recording goes on: a verdict every revolution."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.activity import idle_frames
from chatter.detection.spectral.chatter_lines import Comb, strongest_line
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import best_spacing, line_autocorrelations
from chatter.detection.spectral.segments import BEGINS, CHATTER, GOES_ON, IDLE, SIDEBANDS, STABLE
from chatter.detection.spectral.spectra import Frames, frames_of

Array = NDArray[np.float64]

#: revolutions of the window, and its least length, s
_REVOLUTIONS, _SHORTEST = 24.0, 0.25
#: windows that the speed is read off, one every quarter of a window
_WINDOWS, _QUARTER = 24, 4
#: relative range about the given speed in which the lines correct it, the significance that it
#: takes, and the uncertainty of what is read so
_RANGE, _SIGNIFICANT, _UNCERTAINTY = 0.015, 8.0, 1e-3
#: verdicts in a row of which the first is believed
_IN_A_ROW = 2
#: levels that tell idle from cutting
_LEVELS = 400


class Observation(NamedTuple):
    """Verdict over the window that ends at a time."""

    time: float  # s
    verdict: str  # "chatter", "stable" or "idle"
    chatter_frequency: float  # Hz; nan without chatter
    share: float  # of the power, of the strongest line off the harmonics and its family
    spindle_frequency: float  # Hz


class RunningDetection:
    """Detects chatter in samples as they come.

    Parameters
    ----------
    start : Recording
        Of any length: its channels, its step of time and what they are of. Its samples are not
        taken.
    spindle_frequency : float
        Hz, right within 1.5 %.
    teeth : int or None
    """

    def __init__(self, start: Recording, spindle_frequency: float, teeth: int | None) -> None:
        self._start = start
        self._speed = self._given = spindle_frequency
        self._teeth = teeth
        self._hop = max(round(1.0 / (spindle_frequency * start.time_step)), 1)
        length = max(_REVOLUTIONS / spindle_frequency, _SHORTEST)
        self._window = round(length / start.time_step)
        self._samples = np.empty((0, len(start.channels)))
        self._taken = 0
        self._autocorrelations: deque[Array] = deque(maxlen=_WINDOWS)
        self._levels: deque[float] = deque(maxlen=_LEVELS)
        self._count = 0
        self._large = 0
        self._verdict = STABLE

    def take(self, values: Array) -> list[Observation]:
        """Take samples (n, k); return an observation for each revolution that they complete."""
        self._samples = np.concatenate([self._samples, values])
        found = []
        while len(self._samples) >= self._window + self._hop:
            self._samples = self._samples[self._hop :]
            self._taken += self._hop
            found.append(self._observation(self._samples[: self._window]))
        return found

    def _observation(self, values: Array) -> Observation:
        frames = self._frame(values)
        self._follow_speed(frames)
        self._levels.append(_level(values))
        teeth = self._teeth or 1
        comb = Comb(self._speed, teeth * self._speed, _UNCERTAINTY, frames.half_width)
        line = strongest_line(frames.power[0], frames.above[0], frames.frequency, comb)
        enough = GOES_ON if self._verdict == CHATTER else BEGINS
        sidebands = self._verdict == CHATTER or line.sidebands >= SIDEBANDS
        self._large = self._large + 1 if line.share >= enough and sidebands else 0
        chatters = self._large >= (1 if self._verdict == CHATTER else _IN_A_ROW)
        self._verdict = CHATTER if chatters else IDLE if self._is_idle() else STABLE
        time = self._start.start + (self._taken + self._window) * self._start.time_step
        frequency = line.frequency if chatters else math.nan
        return Observation(time, self._verdict, frequency, line.share, self._speed)

    def _frame(self, values: Array) -> Frames:
        start = self._start
        one = Recording(start.name, start.time_step, start.channels, start.quantities, values)
        return frames_of(one, one.duration, one.duration)

    def _follow_speed(self, frames: Frames) -> None:
        """Correct the speed by the lines of the windows of late."""
        quarter = max(round(self._window / (self._hop * _QUARTER)), 1)
        if self._count % quarter == 0:
            self._autocorrelations.append(line_autocorrelations(frames)[0])
            found = best_spacing(
                np.sum(self._autocorrelations, axis=0),
                frames.step,
                self._given * (1.0 - _RANGE),
                self._given * (1.0 + _RANGE),
                self._teeth or 1,
            )
            if found.significance > _SIGNIFICANT:
                self._speed = found.frequency
        self._count += 1

    def _is_idle(self) -> bool:
        idle = idle_frames(np.array(self._levels))
        return idle is not None and bool(idle[-1])


def _level(values: Array) -> float:
    """Level of samples about their mean, dB, sum of channels."""
    return 10.0 * math.log10(float(np.sum(np.var(values, axis=0))) + 1e-300)
