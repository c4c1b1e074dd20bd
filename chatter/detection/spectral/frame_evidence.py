"""What the frames of a recording say: speed, activity, and the line off the harmonics of each."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.activity import activity_levels, idle_frames, silent_frames
from chatter.detection.spectral.chatter_lines import ChatterLine, Comb, strongest_line
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import (
    Revolution,
    about_given,
    from_spectrum,
    from_tacho,
    over_frames,
    stated_alone,
)
from chatter.detection.spectral.spectra import Frames, frames_of
from chatter.detection.spectral.stated_speed import REFUTED, LinesOfRecord, OtherSpeed

Array = NDArray[np.float64]

#: revolutions of a frame, at the most and at the least, and frames that a recording should hold
_REVOLUTIONS, _FEWEST_REVOLUTIONS, _FRAMES = 24.0, 12.0, 2.0
#: revolutions of the longer frames that the mean speed is read off
_LONG = 96.0
#: length of longer frames over that of the others from which they are of use
_LONGER = 1.5
#: length below which a frame holds no more than a burst of a lightly damped mode, s
_SHORTEST = 0.25
#: length of frames while the speed is not known, s
_UNKNOWN = 1.0
#: frames that overlap: hop over length; most frames, of which those of long recordings are apart
_HOP, _MOST_FRAMES = 0.25, 2000.0
#: least ratio of a line to what is there at rest
RATIO_AT_REST = 10.0


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the frames of a recording say.

    Attributes
    ----------
    frames : Frames
    revolution : Revolution or None
        None where the speed is neither given nor to be read off the lines.
    teeth : int or None
    lines : tuple of ChatterLine
        Of each frame; empty without a speed.
    levels : (m,) array of float
        Activity, dB above the quiet frames.
    idle : (m,) array of bool or None
        Frames without a cut. None where the levels of the frames make no two classes.
    silent : (m,) array of bool
        Frames in which nothing was recorded.
    recording : Recording
    rest : (b,) array of float or None
        Power spectrum where nothing is cut; None where no frame shows it.
    other_speed : OtherSpeed or None
        That the lines speak for, against the one that was stated.
    """

    frames: Frames
    revolution: Revolution | None
    teeth: int | None
    lines: tuple[ChatterLine, ...]
    levels: Array
    idle: NDArray[np.bool_] | None
    silent: NDArray[np.bool_]
    recording: Recording
    rest: Array | None
    other_speed: OtherSpeed | None = None

    def comb(self, row: int) -> Comb:
        """Harmonics of the spindle in a frame."""
        return comb_of(self.revolution, self.teeth, float(self.revolution.frequency[row]), self)

    def above_rest(self, frequency: float, row: int) -> bool | None:
        """Whether a line is far above what is there at rest; None where no frame is at rest."""
        if self.rest is None:
            return None
        near = np.abs(self.frames.frequency - frequency) < self.frames.half_width
        own = float(self.frames.power[row, near].sum())
        return own > RATIO_AT_REST * float(self.rest[near].sum())


def comb_of(revolution: Revolution, teeth: int | None, frequency: float, of: Evidence) -> Comb:
    """Harmonics of a frequency of the spindle, Hz."""
    return Comb(frequency, frequency * (teeth or 1), revolution.uncertainty, of.frames.half_width)


def evidence_of(
    recording: Recording, spindle_frequency: float | None, teeth: int | None
) -> Evidence:
    """Spectra, speed, activity and lines of a recording.

    Parameters
    ----------
    recording : Recording
    spindle_frequency : float or None
        Hz, as set; None where it is not known.
    teeth : int or None
    """
    frames, revolution, other = _with_speed(recording, spindle_frequency, teeth)
    return replace(_with_lines(recording, frames, revolution, teeth), other_speed=other)


def evidence_at(recording: Recording, frequency: float, teeth: int | None) -> Evidence:
    """The same with a speed, Hz, that the lines show: no other is sought."""
    frames, long = _frames(recording, frequency, _REVOLUTIONS), _frames(recording, frequency, _LONG)
    revolution = about_given(long, frames, frequency, teeth or 1)
    return _with_lines(recording, frames, revolution, teeth)


def finer_evidence(coarse: Evidence) -> Evidence | None:
    """The same with longer frames, in which lines are told from harmonics nearer to them.

    None where the recording is too short: the speed is not known well enough then.
    """
    revolution, recording = coarse.revolution, coarse.recording
    if revolution is None or recording.duration * revolution.mean < _LONG:
        return None
    length = _LONG / revolution.mean
    if length < _LONGER * coarse.frames.length:
        return None
    frames = frames_of(recording, length, max(_HOP * length, recording.duration / _MOST_FRAMES))
    followed = np.interp(frames.time, coarse.frames.time, revolution.frequency)
    return _with_lines(recording, frames, revolution._replace(frequency=followed), coarse.teeth)


def _with_lines(
    recording: Recording, frames: Frames, revolution: Revolution | None, teeth: int | None
) -> Evidence:
    silent = silent_frames(recording, frames)
    levels = activity_levels(frames, silent)
    idle = idle_frames(levels)
    at_rest = None if idle is None else frames.power[idle & ~silent]
    if idle is None and silent.any():
        idle = silent
    bare = Evidence(
        frames, revolution, teeth, (), levels, idle, silent, recording,
        None if at_rest is None or not len(at_rest) else np.median(at_rest, axis=0),
    )  # fmt: skip
    if revolution is None:
        return bare
    lines = tuple(
        strongest_line(power, logarithm, frames.frequency, bare.comb(row))
        for row, (power, logarithm) in enumerate(zip(frames.power, frames.above, strict=True))
    )
    return replace(bare, lines=lines)


def _with_speed(
    recording: Recording, given: float | None, teeth: int | None
) -> tuple[Frames, Revolution | None, OtherSpeed | None]:
    """Frames of so many revolutions, the speed over them, and another that the lines speak for."""
    if given is not None:
        frames = _frames(recording, given, _REVOLUTIONS)
    else:
        length = min(_UNKNOWN, recording.duration)
        frames = frames_of(recording, length, max(_HOP * length, recording.duration / _MOST_FRAMES))
    if recording.tacho is not None:
        found = from_tacho(recording.tacho, recording.time_step, recording.start, frames)
        if found is not None:
            frames = _frames(recording, found.mean, _REVOLUTIONS)
            again = from_tacho(recording.tacho, recording.time_step, recording.start, frames)
            return frames, again, None
    if given is not None:
        return frames, *_stated_speed(recording, frames, given, teeth)
    spacing = from_spectrum(frames, teeth)
    if spacing is None:
        return frames, None, None
    frames, long = _frames(recording, spacing, _REVOLUTIONS), _frames(recording, spacing, _LONG)
    revolution = about_given(long, frames, spacing, teeth or 1)
    return frames, revolution._replace(source="spectrum", may_be_multiple=True), None


def other_speed_of(recording: Recording, given: float, teeth: int | None) -> OtherSpeed | None:
    """Speed that the lines of a recording speak for, and not the given one, Hz; None where none."""
    return LinesOfRecord(_frames(recording, given, _LONG), given, teeth).other_speed()


def _stated_speed(
    recording: Recording, frames: Frames, given: float, teeth: int | None
) -> tuple[Revolution, OtherSpeed | None]:
    """Speed that was stated, Hz, as the lines correct it, and another that they speak for."""
    long = _frames(recording, given, _LONG)
    lines = LinesOfRecord(long, given, teeth)
    other = lines.other_speed()
    if other is not None and other.relation == REFUTED:
        return stated_alone(frames, given), other
    revolution = about_given(long, frames, given, teeth or 1)
    corrected = lines.corrected(revolution.mean)
    if corrected != revolution.mean:
        revolution = over_frames(frames, corrected, teeth or 1)
    return revolution, other


def _frames(recording: Recording, frequency: float, most: float) -> Frames:
    """Frames of so many revolutions at the most; fewer where the recording is short."""
    revolutions = recording.duration * frequency
    longest = max(most, _SHORTEST * frequency)
    wanted = min(max(revolutions / _FRAMES, _FEWEST_REVOLUTIONS), longest, revolutions)
    length = wanted / frequency
    return frames_of(recording, length, max(_HOP * length, recording.duration / _MOST_FRAMES))
