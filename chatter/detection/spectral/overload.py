"""Samples at the ends of a recorder's range: an overloaded sound shows neither levels nor lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.segments import CHATTER, NOT_JUDGED, Segment

#: share of the samples at both ends of the range that is worth a note, and from which a cut without
#: chatter is not judged
NOTED, _TOO_MANY = 0.01, 0.2


def overloaded(recording: Recording) -> NDArray[np.bool_]:
    """Samples (n,) of which some channel stands at an end of its range, as a neighbour does.

    A signal that is 0 in the air stands at one end of its range alone, and counts for none.
    """
    found = np.zeros(len(recording.values), dtype=bool)
    for values in recording.values.T:
        ends = [_stays(values == end) for end in (values.max(), values.min())]
        if min(float(one.mean()) for one in ends) > 0.5 * NOTED:
            found |= ends[0] | ends[1]
    return found


def _stays(at_end: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Samples at an end beside another one there."""
    beside = np.zeros_like(at_end)
    beside[1:] |= at_end[:-1]
    beside[:-1] |= at_end[1:]
    return at_end & beside


def judged_by_range(segments: Sequence[Segment], recording: Recording) -> tuple[Segment, ...]:
    """Segments of which those without chatter are not judged where the recorder was overloaded."""
    ends = overloaded(recording)
    if not ends.any():
        return tuple(segments)
    return tuple(_by_range(one, ends, recording) for one in segments)


def _by_range(segment: Segment, ends: NDArray[np.bool_], recording: Recording) -> Segment:
    first, last = (
        round((one - recording.start) / recording.time_step) for one in (segment.begin, segment.end)
    )
    share = float(ends[first : max(last, first + 1)].mean())
    if segment.verdict in (CHATTER, NOT_JUDGED) or share < _TOO_MANY:
        return segment
    reason = (
        f"{share:.0%} of the samples stand at the ends of the range: the recorder was overloaded; "
        "record it less loud"
    )
    return replace(segment, verdict=NOT_JUDGED, confidence=0.0, reason=reason)
