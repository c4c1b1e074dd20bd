"""Errors of predictions by run and channel, as shares of the signals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from chatter.description.case import Case
from chatter.explain.kinds.kind import Kind
from chatter.explain.measurement import Measurement, Run


class ChannelError(NamedTuple):
    """Error of one channel of one run."""

    run: str
    channel: str
    error: float  # rms, SI
    relative: float  # over the rms of the signal, 1
    noise: float = math.nan  # rms, SI, where it was looked at
    over_noise: float = math.nan  # rms over the noise, sample by sample


def errors_of(
    case: Case, measurement: Measurement, kind: Kind, runs: Sequence[Run] | None = None
) -> list[ChannelError]:
    """Errors of a case's predictions of runs, by run and channel."""
    found = []
    for run in measurement.runs if runs is None else runs:
        predicted = kind.predict(run.of(case), run)
        weighted = getattr(kind, "weights", None)
        weight = weighted(run) ** 2 if weighted else None
        for channel in getattr(kind, "judged", kind.channels)(run):
            signal = run.signals[channel]
            left = (predicted[channel] - signal) * run.usable(signal.size)
            error = float(np.sqrt(np.average(left**2, weights=weight)))
            level = float(np.sqrt(np.mean(signal**2)))
            found.append(ChannelError(run.name, channel, error, error / max(level, 1e-300)))
    return found


def by_channel(errors: Sequence[ChannelError]) -> dict[str, float]:
    """Rms over the runs of the normalised errors, by channel."""
    return {
        channel: float(np.sqrt(np.mean([e.relative**2 for e in errors if e.channel == channel])))
        for channel in dict.fromkeys(one.channel for one in errors)
    }


def overall(errors: Sequence[ChannelError]) -> float:
    """Normalised error of several runs: the mean over the channels of the rms over the runs."""
    return float(np.mean(list(by_channel(errors).values())))
