"""Residual of one channel of one run, against its noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.measurement import Run

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ChannelResidual:
    """Residual of one channel of one run.

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
    def normalised(self) -> Array:
        """Residual over the standard deviation of the noise, 1."""
        return self.values / self.deviation

    @property
    def over_noise(self) -> float:
        """Root mean square of the normalised residual; 1 where it is noise alone."""
        return float(np.sqrt(np.mean(self.normalised**2)))

    @property
    def step(self) -> float:
        """Time between samples, s."""
        return float(np.median(np.diff(self.run.signals["time"])))
