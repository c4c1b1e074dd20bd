"""`detect`: chatter or not over a recording of a cut, and what to do about it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from chatter.description.case import Case, load
from chatter.description.described_or_path import described_or_read
from chatter.description.errors import InputError
from chatter.description.given_path import path_given
from chatter.description.given_values import whole_number_given
from chatter.description.units import QuantityError, parse
from chatter.detection.spectral.frame_evidence import evidence_of
from chatter.detection.spectral.overload import judged_by_range
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.segments import CHATTER, Segment
from chatter.detection.spectral.two_speeds import judged
from chatter.detection.spectral.varied_speed import judged_at_even_angles, varied_speed, with_speed
from chatter.monitoring.advice import is_stable, mode_of, proposed_by_frequency, stable_speeds
from chatter.monitoring.recording_file import read_recording
from chatter.monitoring.result import Advice, DetectedChatter
from chatter.stability.lobes import lobes

_REVOLUTION = 2.0 * math.pi
#: most teeth that a milling tool is believed to have
_MOST_TEETH = 200


def detect(
    recording: str | Path | Recording,
    spindle_speed: str | float | None = None,
    teeth: int | None = None,
    case: str | Path | Case | None = None,
    channels: Sequence[str] = (),
    sampling_rate: str | float | None = None,
    columns: str | None = None,
) -> DetectedChatter:
    """Detect chatter in a recording of sound, vibration, force, current or power.

    A stable cut has its lines at the harmonics of the spindle, runout and all. Chatter has lines
    elsewhere, with sidebands one tooth passing frequency apart (Altintas 2012, Manufacturing
    Automation, section 4.4), and they take a large share of the power. The speed is read off the
    spacing of the lines near the one that is given, for what is set is often some percent off.

    Parameters
    ----------
    recording : path or Recording
        File of any format that holds signals, or the signals.
    spindle_speed : str or float, optional
        ``"1656 rpm"``, or rad/s; by default of the case, of a tacho or a measured speed in the
        file, or by the lines.
    teeth : int, optional
        By default of the case. Without them no flip is recognised and no speed is proposed.
    case : path or Case, optional
        For the advice: which mode chatters, the nearest stable speeds at this depth.
    channels : sequence of str
        Names of the columns to use; by default all that vibrate.
    sampling_rate : str or float, optional
        ``"25.6 kHz"``, or Hz, where the file has no time.
    columns : str, optional
        Names and units of all columns in their order, such as ``"time [s], Fx [N]"``, where the
        file has no heading.

    Returns
    -------
    DetectedChatter

    Raises
    ------
    InputError
        If the file cannot be read or used, or a value is wrong.
    """
    if case is not None:
        case = described_or_read(case, Case, load)
    given = spindle_frequency(spindle_speed, case)
    teeth = teeth_of(teeth, case)
    if not isinstance(recording, Recording):
        rate = sampling_frequency(sampling_rate)
        recording = path_given(recording, "a recording")
        recording = read_recording(recording, channels, rate, columns)
    if given is None:
        given = recording.spindle_frequency
    _refuse_unseen(recording, given)
    evidence = evidence_of(recording, given, teeth)
    speed = None
    if given is not None and evidence.revolution.source != "tacho":
        speed = varied_speed(recording, given, teeth)
    if speed is None:
        found = judged(evidence)
    else:
        found = judged_at_even_angles(recording, speed, teeth)
        evidence = with_speed(evidence, speed)
    segments = judged_by_range(found, recording)
    return DetectedChatter(
        recording, evidence, segments, given, case, _advice(segments, evidence.teeth, case)
    )


def _refuse_unseen(recording: Recording, given: float | None) -> None:
    """Refuse a speed of the spindle that the sampling of a recording cannot show."""
    highest = 0.5 / recording.time_step
    if given is not None and not given < highest:
        raise InputError(
            f"{recording.name}: {2.0 * highest:.4g} samples a second show nothing above "
            f"{highest:.4g} Hz; the spindle turns at {given:.4g} Hz ({60.0 * given:.4g} rpm)"
        )


def _advice(segments: Sequence[Segment], teeth: int | None, case: Case | None) -> Advice | None:
    """Advice for the longest segment of chatter; None without chatter."""
    found = [one for one in segments if one.verdict == CHATTER]
    if not found:
        return None
    worst = max(found, key=lambda one: one.end - one.begin)
    if case is not None:
        case.require("tool", "cut")
        diagram = lobes(case)
        speed = worst.spindle_frequency
        return Advice(
            worst,
            tuple(stable_speeds(diagram, speed)),
            mode_of(diagram, worst.chatter_frequency, speed),
            case,
            is_stable(diagram, speed),
        )
    if teeth is None:
        return Advice(worst, ())
    proposed = proposed_by_frequency(worst.chatter_frequency, worst.spindle_frequency, teeth)
    return Advice(worst, tuple(proposed))


def spindle_frequency(given: str | float | None, case: Case | None) -> float | None:
    """Frequency of the spindle, Hz, as given or of the case."""
    if given is None:
        cut = None if case is None else case.cut
        return None if cut is None or cut.spindle_speed is None else cut.spindle_speed / _REVOLUTION
    value = _quantity(given, "angular_speed", "spindle speed") / _REVOLUTION
    if not 0.0 < value < math.inf:
        raise InputError(f"the spindle speed is {given}; it must be above zero, such as 1656 rpm")
    return value


def sampling_frequency(given: str | float | None) -> float | None:
    """Sampling rate, Hz."""
    if given is None:
        return None
    value = _quantity(given, "frequency", "sampling rate")
    if not 0.0 < value < math.inf:
        raise InputError(f"the sampling rate is {given}; it must be above zero, such as 25.6 kHz")
    return value


def _quantity(given: str | float, dimension: str, what: str) -> float:
    try:
        return float(parse(given, dimension).value)
    except QuantityError as error:
        raise InputError(f"{what}: {error}") from error


def teeth_of(given: int | None, case: Case | None) -> int | None:
    """Number of teeth, as given or of the case; None where neither tells."""
    if given is None:
        return None if case is None or case.tool is None else case.tool.teeth
    return whole_number_given(given, "--teeth", 1, _MOST_TEETH)
