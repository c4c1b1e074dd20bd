"""What a case leaves of every run and channel of a measurement, against its noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.explain.kind import Kind
from chatter.explain.measurement import Measurement, Run
from chatter.explain.noise import white_level

Array = NDArray[np.float64]
Noise = Mapping[str, Mapping[str, float]]

#: noise that is taken where none was found, as a share of the signal
_LEAST_NOISE = 1e-6


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
        for channel in kind.channels(run):
            measured = run.signals[channel]
            level = None if noise is None else noise[run.name][channel]
            deviation = _deviation(kind, run, measured, predicted[channel], level)
            # samples that count less are no noisier than others
            white = getattr(kind, "noise_is_white", True)
            noise_level = deviation.min() if white else np.sqrt(np.mean(deviation**2))
            parts.append(
                Left(
                    run,
                    own,
                    channel,
                    measured,
                    predicted[channel],
                    deviation,
                    float(noise_level),
                )
            )
    return Residual(measurement, kind, case, tuple(parts))


def _deviation(
    kind: Kind, run: Run, measured: Array, predicted: Array, level: float | None
) -> Array:
    certainty = run.signals.get("certainty", np.ones(measured.size))
    if not getattr(kind, "noise_is_white", True):
        if "certainty" in run.signals:
            return 1.0 / certainty
        # verdicts: how far a probability is from one, by itself
        likely = np.clip(predicted, 1e-6, 1.0 - 1e-6)
        return np.sqrt(likely * (1.0 - likely))
    if level is None:
        level = white_level((measured - predicted) * certainty)
    least = _LEAST_NOISE * float(np.sqrt(np.mean(measured**2))) + 1e-300
    return max(level, least) / certainty
