"""What a case leaves of every run and channel of a measurement, against its noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.kinds.kind import Kind
from chatter.explain.measurement import Measurement, Run
from chatter.explain.residuals.noise import white_level

Array = NDArray[np.float64]
Noise = Mapping[str, Mapping[str, float]]

#: noise that is taken where none was found, as a share of the signal
_LEAST_NOISE = 1e-6
#: weight of a sample that counts for nothing
_LEAST_CERTAIN = 1e-6


@dataclass(frozen=True, eq=False)
class Left:
    """What is left of one channel of one run.

    Parameters
    ----------
    run : Run
    case : Case
        With the overrides of the run.
    channel : str
    measured, predicted : (n,) array of float
        SI.
    deviation : (n,) array of float
        Standard deviation of the noise, SI; larger where a sample counts less.
    noise : float
        Root mean square of the noise, SI.
    """

    run: Run
    case: Case
    channel: str
    measured: Array
    predicted: Array
    deviation: Array
    noise: float

    @property
    def values(self) -> Array:
        """Measured less predicted, SI."""
        return self.measured - self.predicted

    @property
    def scaled(self) -> Array:
        """The same over the noise."""
        return self.values / self.deviation

    @property
    def over_noise(self) -> float:
        """Root mean square over that of the noise; 1 where noise alone is left."""
        return float(np.sqrt(np.mean(self.scaled**2)))

    @property
    def relative(self) -> float:
        """Root mean square over that of the signal."""
        level = float(np.sqrt(np.mean(self.measured**2)))
        return float(np.sqrt(np.mean(self.values**2))) / max(level, 1e-300)

    @property
    def step(self) -> float:
        """Time between samples, s."""
        return float(np.median(np.diff(self.run.signals["time"])))


@dataclass(frozen=True, eq=False)
class Residual:
    """What a case leaves of a measurement.

    Parameters
    ----------
    measurement : Measurement
    kind : Kind
    case : Case
    parts : tuple of Left
        Run by run, channel by channel.
    """

    measurement: Measurement
    kind: Kind
    case: Case
    parts: tuple[Left, ...]

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels, in the order of the first run."""
        return tuple(dict.fromkeys(part.channel for part in self.parts))

    def of(self, channel: str) -> tuple[Left, ...]:
        """Parts of one channel, one a run."""
        return tuple(part for part in self.parts if part.channel == channel)


def residual_of(
    measurement: Measurement, kind: Kind, case: Case, noise: Noise | None = None
) -> Residual:
    """What a case leaves of a measurement.

    Parameters
    ----------
    measurement : Measurement
        As prepared for its kind.
    kind : Kind
    case : Case
    noise : mapping, optional
        Run -> channel -> standard deviation, SI; read from what is left where it is not given.

    Raises
    ------
    InputError, RunError
        If the case cannot predict a run.
    """
    parts = []
    for run in measurement.runs:
        own = run.of(case)
        predicted = kind.predict(own, run)
        levels = noise[run.name] if noise is not None else _known(kind, run)
        for channel in kind.channels(run):
            # samples that are no good count as predicted
            usable = run.usable(run.signals[channel].size) > 0.0
            measured = np.where(usable, run.signals[channel], predicted[channel])
            certainty = _certainty(run, channel)
            if getattr(kind, "noise_is_white", True) or hasattr(kind, "noise"):
                level = levels.get(channel)
                if level is None:
                    level = white_level((measured - predicted[channel]) * certainty)
                least = _LEAST_NOISE * float(np.sqrt(np.mean(measured**2))) + 1e-300
                level = max(level, least)
                deviation = level / certainty
            else:
                deviation = _scatter(run, certainty, predicted[channel])
                level = float(np.sqrt(np.mean(deviation**2)))
            parts.append(Left(run, own, channel, measured, predicted[channel], deviation, level))
    return Residual(measurement, kind, case, tuple(parts))


def _known(kind: Kind, run: Run) -> Mapping[str, float]:
    """Noise that a kind knows beforehand, by channel."""
    return kind.noise(run) if hasattr(kind, "noise") else {}


def _certainty(run: Run, channel: str) -> Array:
    """How much samples of a channel count, 1 at the most."""
    for name in (f"{channel} certainty", "certainty"):
        if name in run.signals:
            return np.maximum(run.signals[name], _LEAST_CERTAIN)
    return np.ones(run.signals[channel].size)


def _scatter(run: Run, certainty: Array, predicted: Array) -> Array:
    """Standard deviation of every line of a FRF, or of a verdict."""
    if "certainty" in run.signals:
        return 1.0 / run.signals["certainty"]
    # verdicts: how far a probability is from one, by itself
    likely = np.clip(predicted, 1e-6, 1.0 - 1e-6)
    return np.sqrt(likely * (1.0 - likely)) / certainty
