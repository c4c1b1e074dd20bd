"""Residual of one channel of one run, against its noise."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.measurement import Run

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ChannelResidual:
    """Residual of one channel of one run."""

    run: Run
    case: Case  # with the overrides of the run
    channel: str
    measured: Array  # (n,), SI
    predicted: Array  # (n,), SI
    deviation: Array  # (n,), standard deviation of the noise, SI; larger where a sample counts less
    noise: float  # root mean square of the noise, SI

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


#: white noise has a periodogram of an exponential distribution, whose median is this share of it
_MEDIAN = math.log(2.0)


def white_level(residual: NDArray[np.float64]) -> float:
    """Standard deviation of the white noise in a residual, whatever stands out of it in lines.

    The median over the lines of the periodogram forgets lines and resonances that fill less than
    half of the band.
    """
    lines = np.abs(np.fft.rfft(residual - residual.mean())[1:-1]) ** 2
    if lines.size < 4:
        return float(np.std(residual))
    return math.sqrt(float(np.median(lines)) / _MEDIAN / residual.size)
