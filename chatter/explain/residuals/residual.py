"""Residual of a measurement: of every run and channel, against the noise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from chatter.description.case import Case
from chatter.explain.criteria import AT_NOISE
from chatter.explain.measurement import Measurement
from chatter.explain.residuals.channel_residual import ChannelResidual

if TYPE_CHECKING:
    from chatter.explain.kinds.kind import Kind, Noise
    from chatter.explain.prediction import Predictions


@dataclass(frozen=True, eq=False)
class Residual:
    """Residual of a measurement by a case."""

    measurement: Measurement
    kind: Kind
    case: Case
    parts: tuple[ChannelResidual, ...]  # run by run, channel by channel

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels, in the order of the first run."""
        return tuple(dict.fromkeys(part.channel for part in self.parts))

    @property
    def above_noise(self) -> tuple[str, ...]:
        """Channels above their noise: noise depends on nothing."""
        return tuple(channel for channel in self.channels if self.is_above_noise(channel))

    def of(self, channel: str) -> tuple[ChannelResidual, ...]:
        """Parts of one channel, one a run."""
        return tuple(part for part in self.parts if part.channel == channel)

    def over_noise(self, channel: str) -> float:
        """Root mean square of the normalised residual of a channel."""
        return over_noise(self.of(channel))

    def is_above_noise(self, channel: str) -> bool:
        """Whether a channel is above its noise."""
        return self.over_noise(channel) > AT_NOISE


def over_noise(parts: Sequence[ChannelResidual]) -> float:
    """Root mean square of the normalised residual of several runs."""
    return math.sqrt(float(np.mean([part.over_noise**2 for part in parts])))


def residual_of(
    measurement: Measurement, predictions: Predictions, case: Case, noise: Noise | None = None
) -> Residual:
    """Residual of a measurement by a case.

    The noise, run -> channel -> standard deviation, SI, is estimated from the residual where it is
    not given. InputError or RunError if the case cannot predict a run.
    """
    kind, parts = predictions.kind, []
    for run in measurement.runs:
        own, predicted = run.of(case), predictions.of(case, run)
        levels = kind.known_noise(run) if noise is None else noise[run.name]
        for channel in kind.channels(run):
            expected = predicted[channel]
            # samples that are excluded count as predicted
            usable = np.ones(expected.size) if run.usable is None else run.usable
            measured = np.where(usable > 0.0, run.signals[channel], expected)
            deviation = kind.deviation(run, channel, measured, expected, levels.get(channel))
            parts.append(ChannelResidual(run, own, channel, measured, expected, *deviation))
    return Residual(measurement, kind, case, tuple(parts))
