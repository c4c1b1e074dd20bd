"""The verdict on a recording as a whole, and for how long each verdict holds."""

from __future__ import annotations

from collections.abc import Sequence

from chatter.detection.spectral.segments import CHATTER, IDLE, NOT_JUDGED, STABLE, Segment

#: in the order in which they matter
_VERDICTS = (CHATTER, STABLE, NOT_JUDGED, IDLE)


def durations_of(segments: Sequence[Segment]) -> dict[str, float]:
    """Duration of each verdict, s."""
    found = dict.fromkeys(_VERDICTS, 0.0)
    for one in segments:
        found[one.verdict] += one.end - one.begin
    return found


def verdict_of(segments: Sequence[Segment]) -> str:
    """Verdict on a recording: chatter where some of it chatters, stable where most of it is so.

    What is idle says nothing of the cut. A cut of which more is not judged than stable is not
    judged: chatter may be in what was left out.
    """
    durations = durations_of(segments)
    if durations[CHATTER] > 0.0:
        return CHATTER
    if durations[STABLE] > durations[NOT_JUDGED]:
        return STABLE
    return NOT_JUDGED if durations[NOT_JUDGED] > 0.0 else IDLE


def in_words(segments: Sequence[Segment]) -> str:
    """The verdict on a recording and for how long each verdict holds."""
    verdict, durations = verdict_of(segments), durations_of(segments)
    others = [
        f"{durations[one]:.2f} s {one}"
        for one in _VERDICTS
        if one != verdict and durations[one] > 0.0
    ]
    if not others:
        return verdict
    whole = sum(durations.values())
    return f"{verdict} for {durations[verdict]:.2f} of {whole:.2f} s, {', '.join(others)}"
