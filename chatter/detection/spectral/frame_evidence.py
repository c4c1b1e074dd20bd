"""What the frames of a recording say: speed, activity, and the line off the harmonics of each."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.activity import (
    activity_levels,
    frames_at_rest,
    harmonic_levels,
    idle_frames,
    silent_frames,
)
from chatter.detection.spectral.chatter_lines import (
    LOWEST_ORDER,
    ChatterLine,
    Comb,
    share_of_harmonics,
    strongest_line,
)
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import (
    FASTEST,
    PLAUSIBLE,
    Revolution,
    about_given,
    from_spectrum,
    from_tacho,
    over_frames,
    stated_alone,
)
from chatter.detection.spectral.spectra import (
    RATIO_AT_REST,
    Frames,
    above_floor,
    frames_of,
    mean_of,
)
from chatter.detection.spectral.stated_speed import REFUTED, SLOWER, LinesOfRecord, OtherSpeed
from chatter.detection.spectral.tacho_pulses import MOST_PULSES, pulses_by_lines

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
#: share of the lines a spacing apart that are there at rest, of what is no spindle that cuts, and
#: share of the power of what the cut adds that is on the harmonics of a speed that is true
_OF_MACHINE, _OF_CUT = 0.5, 0.8
#: logarithm above the floor from which a bin counts to a line
_STANDS_OUT = 2.0
#: relative difference of speeds that are the same
_SAME = 5e-3


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
        frequency = float(self.revolution.frequency[row])
        return comb_of(self.revolution, self.teeth, frequency, self.frames.half_width)

    def above_rest(self, frequency: float, row: int) -> bool | None:
        """Whether a line is far above what is there at rest; None where no frame is at rest."""
        if self.rest is None:
            return None
        near = np.abs(self.frames.frequency - frequency) < self.frames.half_width
        own = float(self.frames.power[row, near].sum())
        return own > RATIO_AT_REST * float(self.rest[near].sum())


def comb_of(revolution: Revolution, teeth: int | None, frequency: float, half_width: float) -> Comb:
    """Harmonics of a frequency of the spindle, Hz."""
    return Comb(frequency, frequency * (teeth or 1), revolution.uncertainty, half_width)


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
    found = _with_lines(recording, frames, revolution, teeth)
    if other is None or other.relation != REFUTED or not _may_be_there_at_rest(found, other):
        return replace(found, other_speed=other)
    return replace(found, other_speed=other if _cut_speaks_for(found, other) else None)


def _may_be_there_at_rest(evidence: Evidence, other: OtherSpeed) -> bool:
    """Whether lines that speak for another speed may be there without a cut: of a bearing, a fan.

    Most lines a spacing apart are there then, or what the cut adds is on the stated harmonics. A
    spindle that turns in the air has its lines too, and one line alone may be on any harmonics.
    """
    if evidence.rest is None:
        return False
    frames = evidence.frames
    above = above_floor(evidence.rest, frames.frequency, frames.length)
    comb = Comb(other.spacing, other.spacing, 0.0, frames.half_width)
    if share_of_harmonics(above, frames.frequency, comb) >= _OF_MACHINE:
        return True
    return share_on_harmonics(evidence, _cuts(evidence)) >= _OF_CUT


def _cut_speaks_for(evidence: Evidence, other: OtherSpeed) -> bool:
    """Whether those lines that the cut adds speak for another speed than the stated one."""
    return _lines_of_cut(evidence).speak_for(other)


def cut_confirms_speed(evidence: Evidence) -> bool:
    """Whether those lines that the cut adds are as far apart as the stated speed has them.

    Lines that are there at rest, as of a bearing, may hide it over the whole recording.
    """
    if evidence.rest is None:
        return False
    stated = evidence.revolution.mean
    found = _lines_of_cut(evidence).near(stated)
    is_same = abs(found.frequency / stated - 1.0) < _SAME
    return is_same and found.spacing.significance > PLAUSIBLE


def _lines_of_cut(evidence: Evidence) -> LinesOfRecord:
    """Lines that the cut adds to what is there at rest."""
    frames, rows = evidence.frames, _cuts(evidence)
    cut = frames._replace(
        time=frames.time[rows], power=frames.power[rows], above=frames.above[rows]
    )
    return LinesOfRecord(cut, evidence.revolution.mean, evidence.teeth, evidence.rest)


def _cuts(evidence: Evidence) -> NDArray[np.bool_]:
    """Frames in which something is cut, where some are at rest."""
    return ~evidence.idle & ~evidence.silent


def share_on_harmonics(evidence: Evidence, rows: slice | NDArray[np.bool_]) -> float:
    """Share of the power of the lines of some frames that is on the harmonics of the spindle.

    Lines are what stands above the floor, and far above what is there at rest.
    """
    frames = evidence.frames
    comb = evidence.comb(int(np.median(np.arange(frames.time.size)[rows])))
    power, above = mean_of(frames, rows)
    lines = (above > _STANDS_OUT) & (frames.frequency > LOWEST_ORDER * comb.revolution)
    if evidence.rest is not None:
        lines &= power > RATIO_AT_REST * evidence.rest
    total = float(power[lines].sum())
    return 1.0 if total <= 0.0 else float(power[lines & ~comb.off(frames.frequency)].sum()) / total


def evidence_at(recording: Recording, frequency: float, teeth: int | None) -> Evidence:
    """The same with a speed, Hz, that the lines show: no other is sought."""
    frames, long = _frames(recording, frequency, _REVOLUTIONS), _frames(recording, frequency, _LONG)
    revolution = about_given(long, frames, frequency, teeth or 1)
    if revolution.source != "given":
        revolution = revolution._replace(source="spectrum")
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
    levels, idle = _activity(frames, revolution, teeth, silent)
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


def _activity(
    frames: Frames, revolution: Revolution | None, teeth: int | None, silent: NDArray[np.bool_]
) -> tuple[Array, NDArray[np.bool_] | None]:
    """Levels of the frames, dB, and which of them are at rest: as a whole, then by the teeth."""
    levels = activity_levels(frames, silent)
    if revolution is None:
        return levels, idle_frames(levels)
    combs = [
        comb_of(revolution, teeth, float(one), frames.half_width) for one in revolution.frequency
    ]
    idle = frames_at_rest(levels, frames, combs)
    if idle is not None:
        return levels, idle
    by_teeth = harmonic_levels(frames, combs, silent)
    idle = frames_at_rest(by_teeth, frames, combs)
    return (levels, None) if idle is None else (by_teeth, idle)


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
        by_tacho = _by_tacho(recording, frames, given)
        if by_tacho is not None:
            return by_tacho
    if given is not None:
        return frames, *_stated_speed(recording, frames, given, teeth)
    spacing = from_spectrum(frames, teeth)
    if spacing is None:
        return frames, None, None
    frames, long = _frames(recording, spacing, _REVOLUTIONS), _frames(recording, spacing, _LONG)
    revolution = about_given(long, frames, spacing, teeth or 1)
    return frames, revolution._replace(source="spectrum", may_be_multiple=True), None


def _by_tacho(
    recording: Recording, frames: Frames, given: float | None
) -> tuple[Frames, Revolution, OtherSpeed | None] | None:
    """The same by a tacho; None where it has no pulses of a spindle.

    Without a speed that is given, Hz, the lines tell how many pulses it has a revolution, unless
    its name does.
    """

    def read(frames: Frames) -> Revolution | None:
        return from_tacho(recording.tacho, recording.time_step, recording.start, frames, given)

    found = read(frames)
    if found is None:
        return None
    if given is not None or recording.once_per_revolution:
        return *_read_over(recording, found, read), None
    long = _frames(recording, found.mean / MOST_PULSES, _LONG)
    count, least = pulses_by_lines(long, read(long).frequency)
    slowest = found.with_pulses(count)
    chosen = found.with_pulses(max(least, math.ceil(found.mean / FASTEST)))
    frames, revolution = _read_over(recording, chosen, read)
    other = OtherSpeed(slowest.mean, slowest.mean, SLOWER)
    revolution = revolution._replace(may_have_more_pulses=count == 1)
    return frames, revolution, other if count > chosen.pulses else None


def _read_over(
    recording: Recording, found: Revolution, read: Callable[[Frames], Revolution | None]
) -> tuple[Frames, Revolution]:
    """Frames of so many revolutions, and the speed by the tacho over them."""
    frames = _frames(recording, found.mean, _REVOLUTIONS)
    return frames, read(frames).with_pulses(found.pulses)


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


def frames_about(recording: Recording, frequency: float) -> Frames:
    """Frames as a recording is judged in at a speed, Hz."""
    return _frames(recording, frequency, _REVOLUTIONS)


def _frames(recording: Recording, frequency: float, most: float) -> Frames:
    """Frames of so many revolutions at the most; fewer where the recording is short."""
    revolutions = recording.duration * frequency
    longest = max(most, _SHORTEST * frequency)
    wanted = min(max(revolutions / _FRAMES, _FEWEST_REVOLUTIONS), longest, revolutions)
    length = wanted / frequency
    return frames_of(recording, length, max(_HOP * length, recording.duration / _MOST_FRAMES))
