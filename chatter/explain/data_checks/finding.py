"""What a check of measured signals found: where, how bad, and what is excluded for it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.explain.measurement import Measurement

#: how bad, and what follows: nothing can be concluded from the set; the run, the channel of the
#: run or samples of the run are excluded; nothing follows
FATAL, RUN, CHANNEL, SAMPLES, NOTE = "fatal", "run", "channel", "samples", "note"


@dataclass(frozen=True, eq=False)
class SignalFinding:
    """One finding."""

    severity: str  # "fatal", "run", "channel", "samples" or "note"
    run: str  # name of its file; empty where it concerns the whole set
    channel: str  # empty where it concerns all
    description: str  # one sentence, with numbers
    samples: NDArray[np.bool_] | None = None  # (n,), samples that are excluded

    def as_dict(self) -> dict[str, str]:
        """As it stands in explanation.json."""
        return {
            "severity": self.severity,
            "run": self.run,
            "channel": self.channel,
            "description": self.description,
        }


#: a check of a measurement
Check = Callable[[Measurement], list[SignalFinding]]
#: what follows of a finding, by its severity
FOLLOWS = {
    FATAL: "nothing can be concluded",
    RUN: "the run is excluded",
    CHANNEL: "the channel is excluded in this run",
    SAMPLES: "the samples are excluded",
    NOTE: "a note",
}


def of_all_or_some(
    found: list[SignalFinding], measurement: Measurement, about: str, share: float = 0.5
) -> list[SignalFinding]:
    """Make findings of single runs fatal where they concern more than a share of the runs.

    Findings are one a run at the most; `about` is a sentence on the set with {count} and {runs}.
    """
    count = len({one.run for one in found})
    if count <= share * len(measurement.runs):
        return found
    text = about.format(count=count, runs=len(measurement.runs))
    channels = {one.channel for one in found}
    channel = channels.pop() if len(channels) == 1 else ""
    notes = [SignalFinding(NOTE, one.run, one.channel, one.description) for one in found]
    return [SignalFinding(FATAL, "", channel, text), *notes]
