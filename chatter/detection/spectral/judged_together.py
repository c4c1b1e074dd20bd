"""What the latest revolutions say together, judged as a whole recording is."""

from __future__ import annotations

import math
from typing import NamedTuple

from chatter.detection.spectral.frame_evidence import evidence_of
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.segments import CHATTER, NOT_JUDGED
from chatter.detection.spectral.stated_speed import REFUTED
from chatter.detection.spectral.two_speeds import judged


class JudgedTogether(NamedTuple):
    """The speed by the lines of a recording, and the chatter at its end."""

    spindle_frequency: float  # Hz, as the lines correct the stated one
    speed_is_refuted: bool  # whether the lines fit another speed far better
    chatter_frequency: float  # Hz; nan where it does not end in chatter
    share: float  # of the power, of the chatter; nan without
    shows_rest: bool  # whether a part of it has no cut
    is_doubtful: bool  # whether its end is not judged


def judged_together(recording: Recording, given: float | None, teeth: int | None) -> JudgedTogether:
    """Judge a recording at a speed that was stated, Hz, or at that of its tacho.

    This finds what a single window cannot: lines nearer to a harmonic than its resolution, and
    several without sidebands.
    """
    evidence = evidence_of(recording, given, teeth)
    other = evidence.other_speed
    is_refuted = other is not None and other.relation == REFUTED
    frequency, share = math.nan, math.nan
    last = judged(evidence)[-1]
    if last.verdict == CHATTER:
        frequency, share = last.chatter_frequency, last.share
    revolution = evidence.revolution
    speed = math.nan if revolution is None else revolution.mean
    if given is not None and is_refuted:
        speed = given
    shows_rest, is_doubtful = evidence.rest is not None, last.verdict == NOT_JUDGED
    return JudgedTogether(speed, is_refuted, frequency, share, shows_rest, is_doubtful)
