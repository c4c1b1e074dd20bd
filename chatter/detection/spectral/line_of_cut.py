"""Whether a line off the harmonics is that of a cut that chatters, or of the machine."""

from __future__ import annotations

import math

import numpy as np

from chatter.detection.spectral.chatter_lines import (
    MOST_TEETH,
    ChatterLine,
    harmonics_significance,
    strongest_line,
)
from chatter.detection.spectral.envelope import envelope_kurtosis
from chatter.detection.spectral.frame_evidence import Evidence
from chatter.detection.spectral.revolution_frequency import ABOUT_GIVEN, VARIATION
from chatter.detection.spectral.spectra import RATIO_AT_REST, above_floor, mean_of

#: standard deviations of the sidebands of a cut, and where all else is of a cut
SIDEBANDS, _FEWER_SIDEBANDS = 5.0, 4.0
#: the same that need nothing else; of sidebands and harmonics of the teeth together
_SIDEBANDS_FOR_SURE, _TOGETHER = 8.0, 6.0
#: share of the line itself that does without sidebands
_WITHOUT_SIDEBANDS = 0.5
#: standard deviations of the harmonics of the teeth from which a record without idle frames cuts,
#: from which it does so for sure, and between them where a line needs no sidebands
CUTS, _CUTS_FOR_SURE, CUTS_CLEARLY = 4.0, 8.0, 6.0
#: relative variation of amplitude and frequency up to which a line is as steady as electrical ones,
#: which is no chatter where no idle frame shows what the machine does alone
_STEADY, _STEADY_FREQUENCY = 0.03, 1e-4
#: kurtosis of the envelope half way between those of a limit cycle and of a mode shaken by noise
_LIMIT_CYCLE = 1.5
#: the same up to which a line is steady, where frames without entry and exit show it, and the
#: independent readings that it takes
STEADY, READINGS = 1.35, 8.0
#: share of the power that a line has in some frames down to which it is there in others
_IS_THERE = 0.1
#: frequencies of the mains, Hz, how far off they are, and highest harmonic that is heard
_MAINS, _MAINS_TOLERANCE, _MAINS_ORDERS = (50.0, 60.0), 2e-3, 12
#: quantities of the motor, whose lines are of its supply too
_OF_MOTOR = ("current", "power", "torque")
#: frames that show what is there beside a line, or a line without sidebands; the same where
#: nothing else speaks for it
FRAMES, _MANY_FRAMES = 5, 10
#: multiple of a spacing of lines up to which simple fractions of it may be the teeth
_LOW_FRACTION = 8.0
#: relative accuracy of a spacing where many lines show it
_SPACING = 1.5e-4
#: highest harmonic of the teeth that a line is taken for where the speed may be wrong
_LOW_ORDER = 4
#: share of a line width within which a chatter frequency is known
KNOWN = 0.25


def is_line_of_cut(evidence: Evidence, rows: slice) -> bool:
    """Whether the line off the harmonics of some frames is chatter.

    Sidebands one revolution or one tooth apart say so, for a cut makes them: where frames at rest
    show what the machine does alone, or the record cuts, or they are significant. A line without
    them has to be most of the power, a limit cycle, and far above what is there without it.
    """
    line = line_of(evidence, rows)
    if may_be_harmonic(evidence, rows, line.frequency):
        return False
    if is_shaken_by_noise(evidence, rows, line.frequency):
        return False
    sidebands = _median_sidebands(evidence, rows)
    count = rows.stop - rows.start
    if count >= FRAMES:
        sidebands = max(sidebands, line.sidebands)
    is_dominant = (
        count >= (FRAMES if evidence.rest is not None else _MANY_FRAMES)
        and _alone(evidence, rows) >= _WITHOUT_SIDEBANDS
        and is_limit_cycle(evidence, rows, line.frequency)
    )
    if evidence.rest is not None:
        middle = (rows.start + rows.stop) // 2
        rose = bool(evidence.above_rest(evidence.lines[middle].frequency, middle))
        return sidebands >= SIDEBANDS or (rose and is_dominant)
    return _is_of_cut_without_rest(evidence, rows, line.frequency, sidebands, is_dominant)


def _is_of_cut_without_rest(
    evidence: Evidence, rows: slice, line: float, sidebands: float, is_dominant: bool
) -> bool:
    """The same where no frame shows what the machine does alone."""
    harmonics = cut_significance(evidence)
    rose = _rose(evidence, rows, line)
    wanders = line_wanders(evidence, rows, line)
    if is_dominant and harmonics > CUTS and (rose or (wanders and harmonics > CUTS_CLEARLY)):
        return True
    if not wanders and may_be_of_mains(evidence, line):
        return False
    is_of_motor = any(one in _OF_MOTOR for one in evidence.recording.quantities)
    # two signs of a cut together, as Stouffer (1949) adds them
    together = (sidebands + harmonics) / math.sqrt(2.0)
    is_large = _alone(evidence, rows) >= _WITHOUT_SIDEBANDS
    by_both = is_large and sidebands >= SIDEBANDS and together >= _TOGETHER
    if (sidebands >= _SIDEBANDS_FOR_SURE or by_both) and not is_of_motor:
        return True
    cuts = harmonics > _CUTS_FOR_SURE
    # the best of several spacings finds sidebands of a fan or an inverter too
    moves = wanders and harmonics > CUTS
    lasts = rows.stop - rows.start >= _MANY_FRAMES
    enough = _FEWER_SIDEBANDS if cuts and moves and lasts else SIDEBANDS
    return (cuts or moves or rose) and sidebands >= enough


def line_of(evidence: Evidence, rows: slice) -> ChatterLine:
    """Strongest line off the harmonics in the mean spectrum of frames."""
    middle = (rows.start + rows.stop - 1) // 2
    power, above = mean_of(evidence.frames, rows)
    return strongest_line(power, above, evidence.frames.frequency, evidence.comb(middle))


def sidebands_of(evidence: Evidence, rows: slice) -> float:
    """Median over the frames, and at least that of their mean spectrum."""
    return max(_median_sidebands(evidence, rows), line_of(evidence, rows).sidebands)


def _median_sidebands(evidence: Evidence, rows: slice) -> float:
    return float(np.median([line.sidebands for line in evidence.lines[rows]]))


def cut_significance(evidence: Evidence) -> float:
    """Significance of the harmonics of a cut over what was recorded, loud frames or not."""
    frames = evidence.frames
    power = frames.power[~evidence.silent]
    power = np.mean(power / np.maximum(power.sum(axis=1, keepdims=True), 1e-300), axis=0)
    above = above_floor(power, frames.frequency, frames.length)
    row = evidence.frames.time.size // 2
    return harmonics_significance(above, frames.frequency, evidence.comb(row))


def _alone(evidence: Evidence, rows: slice) -> float:
    """Share of the line itself, without its sidebands."""
    return float(np.median([line.alone for line in evidence.lines[rows]]))


def is_limit_cycle(
    evidence: Evidence, rows: slice, line: float, most: float = _LIMIT_CYCLE
) -> bool:
    """Whether the line swings as chatter does, and not as a mode that noise shakes."""
    frames = evidence.frames
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    begin = float(frames.time[rows.start]) - 0.5 * frames.length
    end = float(frames.time[rows.stop - 1]) + 0.5 * frames.length
    kurtosis = envelope_kurtosis(evidence.recording, begin, end, line, comb.revolution)
    return kurtosis < most


def is_shaken_by_noise(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether a line that is not most of the power is a mode that the noise of the cut shakes.

    The teeth modulate that noise, which gives the mode sidebands as chatter has them. It exceeds
    any share of the power for a while: all frames around show it that have the line.
    """
    share = float(np.median([one.share for one in evidence.lines[rows]]))
    return share < _WITHOUT_SIDEBANDS and kurtosis_around(evidence, rows, line) > STEADY


def _with_the_line(evidence: Evidence, rows: slice, line: float) -> slice:
    """Frames of the cut around some, without a gap, that have a line as they have."""
    frames = evidence.frames
    near = np.abs(frames.frequency - line) < frames.half_width
    power = frames.power[:, near].sum(axis=1)
    there = (power > _IS_THERE * np.median(power[rows])) & ~evidence.silent
    if evidence.idle is not None:
        there &= ~evidence.idle
    first, last = rows.start, rows.stop
    while first > 0 and there[first - 1]:
        first -= 1
    while last < there.size and there[last]:
        last += 1
    return slice(first, last)


def kurtosis_around(evidence: Evidence, rows: slice, line: float) -> float:
    """Kurtosis of the envelope of a line over some frames and those around that have it.

    From the middle of the first frame to that of the last, which may hold the entry and the exit;
    the ends of the recording are none. It is nan where too few independent readings show it.
    """
    frames, rows = evidence.frames, _with_the_line(evidence, rows, line)
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    begin, end = float(frames.time[rows.start]), float(frames.time[rows.stop - 1])
    if rows.start == 0:
        begin -= 0.5 * frames.length
    if rows.stop == frames.time.size:
        end += 0.5 * frames.length
    order = line / comb.revolution
    if (end - begin) * abs(order - round(order)) * comb.revolution < READINGS:
        return math.nan
    return envelope_kurtosis(evidence.recording, begin, end, line, comb.revolution)


def may_be_harmonic(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether another speed that is not ruled out makes the line a harmonic."""
    if evidence.revolution.may_be_multiple:
        return _is_low_fraction(evidence, rows, line)
    if evidence.revolution.source != "given":
        return False
    return is_low_harmonic_nearby(evidence, rows, line)


def is_low_harmonic_nearby(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether a speed some percent off makes the line a low harmonic, and has as clear ones."""
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    order = max(round(line / comb.tooth), 1)
    if order > _LOW_ORDER or abs(line / (order * comb.tooth) - 1.0) > ABOUT_GIVEN:
        return False
    own, others = _clarity_as_harmonic(evidence, rows, line, order)
    return others >= own


def is_harmonic_of_changed_speed(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether a speed as a change of load makes it has the line, and clearer ones, as harmonics."""
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    order = max(round(line / comb.tooth), 1)
    if abs(line / (order * comb.tooth) - 1.0) > VARIATION:
        return False
    own, others = _clarity_as_harmonic(evidence, rows, line, order)
    return others > max(own, CUTS)


def _clarity_as_harmonic(
    evidence: Evidence, rows: slice, line: float, order: int
) -> tuple[float, float]:
    """Significance of the harmonics of the teeth, and of those of which the line is one."""
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    tooth = line / order
    other = comb._replace(revolution=comb.revolution * tooth / comb.tooth, tooth=tooth)
    power, above = mean_of(evidence.frames, rows)
    if evidence.rest is not None:  # lines of a bearing are there without the cut
        above = np.where(power > RATIO_AT_REST * evidence.rest, above, 0.0)
    frequency = evidence.frames.frequency
    # of the line and its multiples the other speed would be confirmed by what it is to explain
    left_out = order if order > 1 else 0
    return (
        harmonics_significance(above, frequency, comb),
        harmonics_significance(above, frequency, other, left_out),
    )


def may_be_of_mains(evidence: Evidence, line: float) -> bool:
    """Whether a line is a low harmonic of the mains: others of them lie beside it as sidebands."""
    for mains in _MAINS:
        order = round(line / mains)
        tolerance = KNOWN / evidence.frames.length + _MAINS_TOLERANCE * line
        if 1 <= order <= _MAINS_ORDERS and abs(line - order * mains) < tolerance:
            return True
    return False


def _is_low_fraction(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether a line is a simple fraction of a spacing that may be that of several teeth."""
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    if line > _LOW_FRACTION * comb.revolution:
        # near some fraction by chance; halves, as exactly as they are read, are those of two teeth
        half = 0.5 * comb.revolution
        apart = abs(line - round(line / half) * half)
        return apart < KNOWN / evidence.frames.length + _SPACING * line
    tolerance = KNOWN / evidence.frames.length + comb.uncertainty * line
    parts = comb.revolution / np.arange(1, MOST_TEETH + 1)
    return bool(np.any(np.abs(line - np.round(line / parts) * parts) < tolerance))


def _rose(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether the line is far above what the other frames have there."""
    frames = evidence.frames
    others = ~evidence.silent
    others[rows] = False
    if others.sum() < FRAMES:
        return False
    near = np.abs(frames.frequency - line) < frames.half_width
    power = frames.power[:, near].sum(axis=1)
    return bool(np.median(power[rows]) > RATIO_AT_REST * np.median(power[others]))


def line_wanders(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether amplitude and frequency of the line vary over the frames: no electrical one does."""
    frames = evidence.frames
    near = np.abs(frames.frequency - line) < frames.half_width
    amplitude = np.sqrt(frames.power[rows][:, near].sum(axis=1))
    frequency = np.array([one.frequency for one in evidence.lines[rows]])
    same = np.abs(frequency - line) < frames.half_width
    return bool(
        amplitude.std() > _STEADY * amplitude.mean()
        and same.any()
        and frequency[same].std() > _STEADY_FREQUENCY * line
    )
