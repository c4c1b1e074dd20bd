"""Chatter detection while a recording goes on: a verdict every revolution, or every 20 ms."""

from __future__ import annotations

import itertools
import math
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from chatter.detection.spectral.activity import are_cutting, idle_frames
from chatter.detection.spectral.chatter_lines import ChatterLine, Comb, strongest_line
from chatter.detection.spectral.frame_evidence import Evidence
from chatter.detection.spectral.judged_together import JudgedTogether, judged_together
from chatter.detection.spectral.line_of_cut import (
    FRAMES,
    is_harmonic_of_changed_speed,
    is_line_of_cut,
    line_of,
)
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import VARIATION, Revolution, rates_of_pulses
from chatter.detection.spectral.running_speed import RunningSpeed
from chatter.detection.spectral.segments import (
    BEGINS,
    CHATTER,
    GOES_ON,
    IDLE,
    NOT_JUDGED,
    SAME_LINE,
    STABLE,
)
from chatter.detection.spectral.spectra import Frames, above_floor, added_up, spectrum_of
from chatter.detection.spectral.speed_by_tacho import SpeedByTacho

Array = NDArray[np.float64]

#: least time from one verdict to the next, s: revolutions of fast spindles take less than a verdict
_SHORTEST_HOP = 0.02
#: revolutions of the window, and its least length, s
_REVOLUTIONS, _SHORTEST = 24.0, 0.25
#: windows that are remembered begin a quarter of one apart
_QUARTER = 4
#: relative uncertainty of a speed that is read off the lines
_UNCERTAINTY = 1e-3
#: such windows that a verdict rests on
_HISTORY = 48
#: such windows from one look at them together to the next, and the time, s, at the least
_TOGETHER_EVERY, _TOGETHER_SHORTEST = 16, 2.0
#: the same while fewer windows are remembered than can be: such a look takes less time
_EARLY_EVERY, _EARLY_SHORTEST = 8, 1.0
#: share of the power of a line down to which it goes on
_AS_BEFORE = 0.25
#: verdicts in a row of which the first is believed
_IN_A_ROW = 2
#: levels that tell idle from cutting
_LEVELS = 400


class Observation(NamedTuple):
    """Verdict over the window that ends at a time."""

    time: float  # s
    verdict: str  # "chatter", "stable", "idle" or "not judged"
    chatter_frequency: float  # Hz; nan without chatter
    share: float  # of the power, of the strongest line off the harmonics and its family
    spindle_frequency: float  # Hz
    #: whether the lines of late do not fit the given speed, but another one far better
    speed_is_refuted: bool = False
    #: whether the lines of late showed a speed some percent off the given one, which holds since
    speed_is_corrected: bool = False


class _Window(NamedTuple):
    """The latest revolutions at one time."""

    recording: Recording
    frames: Frames  # of one frame
    spectra: Array  # (k, b) power of the channels
    line: ChatterLine
    level: float  # dB
    speed: float  # Hz, of the spindle


class _Held(NamedTuple):
    """Chatter that the latest windows showed together."""

    frequency: float  # Hz
    share: float
    power: float  # near the frequency, of the last window


class RunningDetection:
    """Detects chatter in samples as they come.

    Parameters
    ----------
    start : Recording
        Of any length: its channels, its step of time and what they are of. Its samples are not
        taken. Where it has a tacho, so have the samples, as their last column.
    spindle_frequency : float or None
        Hz, right within 12 %: the lines correct it. Beside a tacho, whose pulses show the speed, it
        tells how many of them are a revolution, and None is one unless the lines show more.
    teeth : int or None
    """

    def __init__(
        self, start: Recording, spindle_frequency: float | None, teeth: int | None
    ) -> None:
        self._start = start
        self._speed = _speed_of(start, spindle_frequency, teeth)
        self._teeth = teeth
        spindle_frequency = self._speed.mean
        hop = max(1.0 / spindle_frequency, _SHORTEST_HOP)
        self._hop = max(round(hop / start.time_step), 1)
        length = max(_REVOLUTIONS / spindle_frequency, _SHORTEST)
        self._window = round(length / start.time_step)
        self._samples = np.empty((0, len(start.channels) + (start.tacho is not None)))
        self._taken = 0
        self._quarter = max(round(self._window / (self._hop * _QUARTER)), 1)
        self._history: deque[_Window] = deque(maxlen=_HISTORY)
        self._levels: deque[float] = deque(maxlen=_LEVELS)
        self._count = 0
        self._large = 0
        self._verdict = STABLE
        self._speed_is_refuted = False
        #: level below which nothing is cut and windows for which that was asked, and the answer
        self._below: tuple[float, int] = (math.nan, 0)
        self._cuts_when_quiet = False
        # beside the verdicts, which it would hold up
        self._background = ThreadPoolExecutor(1)
        self._together: Future[JudgedTogether] | None = None
        quarter = self._quarter * self._hop * start.time_step
        self._together_every = max(_TOGETHER_EVERY, math.ceil(_TOGETHER_SHORTEST / quarter))
        self._early_every = max(_EARLY_EVERY, math.ceil(_EARLY_SHORTEST / quarter))
        #: chatter that windows showed together, and that holds
        self._held: _Held | None = None
        #: whether windows together could not be judged the last time
        self._is_doubtful = False

    @property
    def judges_together(self) -> bool:
        """Whether the latest windows are being judged together, beside the verdicts."""
        return self._together is not None and not self._together.done()

    def take(self, values: Array) -> list[Observation]:
        """Take samples (n, k); return an observation for each step that they complete.

        A step is a revolution, or 20 ms where that is less.
        """
        self._samples = np.concatenate([self._samples, values])
        found = []
        while len(self._samples) >= self._window + self._hop:
            self._samples = self._samples[self._hop :]
            self._taken += self._hop
            found.append(self._observation(self._samples[: self._window]))
        return found

    def _observation(self, values: Array) -> Observation:
        window = self._window_of(values)
        self._remember(window)
        self._levels.append(window.level)
        self._verdict = self._verdict_of(window)
        time = self._start.start + (self._taken + self._window) * self._start.time_step
        verdict, frequency, share = self._verdict, window.line.frequency, window.line.share
        if verdict == IDLE:
            self._held = None
        elif verdict != CHATTER and self._held is not None:
            verdict, (frequency, share, _) = CHATTER, self._held
        elif verdict == STABLE and self._is_doubtful:
            verdict = NOT_JUDGED
        if verdict != CHATTER:
            frequency = math.nan
        return Observation(
            time, verdict, frequency, share, self._speed.current,
            self._speed_is_refuted, self._speed.is_corrected,
        )  # fmt: skip

    def _verdict_of(self, window: _Window) -> str:
        chattered = self._verdict == CHATTER
        is_large = window.line.share >= (GOES_ON if chattered else BEGINS)
        self._large = self._large + 1 if is_large else 0
        if chattered and is_large and self._count % self._quarter != 1 % self._quarter:
            return CHATTER
        if self._is_idle():
            return IDLE
        if self._large < _IN_A_ROW:
            # on the harmonics of a wrong speed lies what chatters as well
            return NOT_JUDGED if self._speed_is_refuted else STABLE
        # looked at again as it goes on, for the more windows there are the surer it is, until what
        # was there before the line is forgotten
        evidence, rows = self._evidence(window)
        if chattered and evidence.rest is None and self._is_old(rows):
            return CHATTER
        if not chattered and self._may_be_of_speed(evidence, rows):
            return NOT_JUDGED
        return CHATTER if is_line_of_cut(evidence, rows) else NOT_JUDGED

    def _may_be_of_speed(self, evidence: Evidence, rows: slice) -> bool:
        """Whether a new line may be a harmonic of another speed, of the spindle or of a moment.

        A spindle slows down as the load comes on, and turns faster as it goes; chatter lasts.
        """
        if self._speed.is_contradicted:
            return True
        is_new = rows.stop - rows.start < FRAMES
        line = line_of(evidence, rows).frequency
        return is_new and is_harmonic_of_changed_speed(evidence, rows, line)

    def _is_old(self, rows: slice) -> bool:
        """Whether too little is remembered of the time before a line to tell it from the line."""
        return len(self._history) == _HISTORY and rows.start < FRAMES

    def _window_of(self, values: Array) -> _Window:
        start = self._start
        begin = start.start + self._taken * start.time_step
        tacho = None
        if start.tacho is not None:
            values, tacho = values[:, :-1], values[:, -1]
        recording = Recording(
            start.name, start.time_step, start.channels, start.quantities, values, begin, tacho,
            once_per_revolution=start.once_per_revolution,
        )  # fmt: skip
        if isinstance(self._speed, SpeedByTacho):
            self._speed.take_pulses(recording)
        frequency, spectra = spectrum_of(recording)
        power = added_up(spectra[:, None])
        above = above_floor(power, frequency, recording.duration)
        middle = np.array([begin + 0.5 * recording.duration])
        frames = Frames(middle, frequency, power, above, recording.duration)
        level = _level(values)
        is_kept = self._count % self._quarter == 0
        if is_kept and self._speed.take(frames, level, self._idle_level):
            self._look_again()
        line = strongest_line(power[0], above[0], frequency, self._comb(frames))
        return _Window(recording, frames, spectra, line, level, self._speed.current)

    def _comb(self, frames: Frames) -> Comb:
        speed = self._speed.current
        return Comb(speed, (self._teeth or 1) * speed, _UNCERTAINTY, frames.half_width)

    def _remember(self, window: _Window) -> None:
        """Keep windows a quarter of their length apart."""
        if self._count % self._quarter == 0:
            self._history.append(window)
            self._judge_together()
        self._count += 1

    def _judge_together(self) -> None:
        """Judge every so many windows together, beside the verdicts: the speed, and chatter."""
        if self._together is not None and self._together.done():
            found = self._together.result()
            self._speed_is_refuted, self._is_doubtful = found.speed_is_refuted, found.is_doubtful
            is_other = abs(found.spindle_frequency / self._speed.mean - 1.0) > VARIATION
            if is_other and self._speed.go_on_with(found.spindle_frequency):
                self._look_again()
            if not math.isnan(found.chatter_frequency):
                power = self._power_near(found.chatter_frequency)
                self._held = _Held(found.chatter_frequency, found.share, power)
            elif found.shows_rest or found.speed_is_refuted or not self._goes_on():
                self._held = None
            self._together = None
        is_early = len(self._history) < _HISTORY
        every = self._early_every if is_early else self._together_every
        if self._together is None and (self._count // self._quarter + 1) % every == 0:
            joined = _joined([one.recording for one in self._history])
            self._together = self._background.submit(
                judged_together, joined, self._speed.given, self._teeth
            )

    def _power_near(self, frequency: float) -> float:
        frames = self._history[-1].frames
        near = np.abs(frames.frequency - frequency) < frames.half_width
        return float(frames.power[0, near].sum())

    def _goes_on(self) -> bool:
        """Whether the line of windows together is as it was; how it began may be forgotten."""
        held = self._held
        return held is not None and self._power_near(held.frequency) > _AS_BEFORE * held.power

    def _look_again(self) -> None:
        """Find the lines of the windows of late anew, for another speed has other lines."""
        self._history = deque(
            (
                one._replace(
                    line=strongest_line(
                        one.frames.power[0],
                        one.frames.above[0],
                        one.frames.frequency,
                        self._comb(one.frames),
                    )
                )
                for one in self._history
            ),
            maxlen=_HISTORY,
        )

    def _evidence(self, window: _Window) -> tuple[Evidence, slice]:
        """What the windows of late say, and in which of them the line of the last one is."""
        level = self._idle_level()
        known = [one for one in self._history if one is not window]
        rest = [one for one in known if one.level < level]
        cut = [one for one in known if one.level >= level] + [window]
        power = added_up(np.stack([one.spectra for one in [*rest, *cut]], axis=1))
        first = len(cut) - 1
        while first > 0 and self._is_same_line(cut[first - 1], window):
            first -= 1
        frames = Frames(
            np.concatenate([one.frames.time for one in cut]),
            window.frames.frequency,
            power[len(rest) :],
            np.concatenate([one.frames.above for one in cut]),
            window.frames.length,
        )
        revolution = Revolution(
            self._speed.over([one.speed for one in cut]),
            _UNCERTAINTY,
            self._speed.source,
            self._speed.mean,
        )
        at_rest = np.median(power[: len(rest)], axis=0) if rest else None
        evidence = Evidence(
            frames, revolution, self._teeth, tuple(one.line for one in cut),
            np.array([one.level for one in cut]), None, np.zeros(len(cut), dtype=bool),
            _joined([one.recording for one in cut[first:]]), at_rest,
        )  # fmt: skip
        return evidence, slice(first, len(cut))

    @staticmethod
    def _is_same_line(one: _Window, other: _Window) -> bool:
        apart = abs(one.line.frequency - other.line.frequency)
        return one.line.share >= GOES_ON and apart <= SAME_LINE * other.line.frequency

    def _idle_level(self) -> float:
        """Level below which nothing is cut, dB; -inf where the levels make no two classes."""
        levels = np.array(self._levels)
        idle = idle_frames(levels)
        if idle is None:
            return -math.inf
        level = float(levels[~idle].min())
        return -math.inf if self._cuts_below(level) else level

    def _cuts_below(self, level: float) -> bool:
        """Whether the teeth are heard below a level, dB, that chatter alone exceeds."""
        if self._below != (level, len(self._history)):
            self._below = level, len(self._history)
            quiet = [one for one in self._history if one.level < level]
            self._cuts_when_quiet = len(quiet) > 0 and self._are_cutting(quiet)
        return self._cuts_when_quiet

    def _are_cutting(self, windows: list[_Window]) -> bool:
        frames = windows[-1].frames._replace(
            power=added_up(np.stack([one.spectra for one in windows], axis=1))
        )
        combs = [self._comb(frames)] * len(windows)
        return are_cutting(frames, combs, np.arange(len(windows)))

    def _is_idle(self) -> bool:
        return self._levels[-1] < self._idle_level()


def _joined(recordings: list[Recording]) -> Recording:
    """One recording of some that overlap."""
    last = recordings[-1]
    new = [
        slice(0, round((following.start - one.start) / one.time_step))
        for one, following in itertools.pairwise(recordings)
    ]
    parts = [*zip(recordings[:-1], new, strict=True), (last, slice(None))]
    values = np.concatenate([one.values[rows] for one, rows in parts])
    tacho = None
    if last.tacho is not None:
        tacho = np.concatenate([one.tacho[rows] for one, rows in parts])
    return replace(last, values=values, start=recordings[0].start, tacho=tacho)


def _speed_of(
    start: Recording, stated: float | None, teeth: int | None
) -> RunningSpeed | SpeedByTacho:
    """Speed as the tacho of a recording has it; as stated, Hz, where it has no pulses."""
    pulses = None if start.tacho is None else rates_of_pulses(start.tacho, start.time_step)
    if pulses is not None:
        first = float(1.0 / np.mean(1.0 / pulses[1]))
        return SpeedByTacho(first, stated, once_per_revolution=start.once_per_revolution)
    if stated is None:
        raise InputError(
            f"{start.name}: what is written so far has no pulses of a tacho; state the speed of "
            "the spindle"
        )
    return RunningSpeed(stated, teeth or 1)


def _level(values: Array) -> float:
    """Level of samples about their mean, dB, sum of channels."""
    return 10.0 * math.log10(float(np.sum(np.var(values, axis=0))) + 1e-300)
