"""The same low-pass for every signal of a record.

A regression whose effort and motion went through different filters mistakes phase for friction
and inertia. Here one linear, zero-phase operator acts on all of them (parallel filtering of
inverse-dynamics identification: Gautier 1997, IEEE Int. Conf. Control Applications, 192-197).
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.frf.container import MeasurementError


@lru_cache(maxsize=64)
def _sections(order: int, cutoff: float) -> NDArray[np.float64]:
    """Second-order sections of a Butterworth low-pass; a fit applies the same one many times."""
    return scipy.signal.butter(order, cutoff, output="sos")


@dataclass(frozen=True)
class LowPass:
    """Zero-phase Butterworth low-pass: run forward and backward.

    ValueError if a parameter is out of its range.
    """

    cutoff: float  # frequency where one pass has -3 dB (both have -6 dB), Hz; above 0
    order: int = 4  # of one pass; from 1 to 8

    def __post_init__(self) -> None:
        if not 0.0 < self.cutoff < math.inf:
            raise ValueError(f"low-pass: cutoff must be above 0 Hz, not {self.cutoff}")
        if not 1 <= self.order <= 8:
            raise ValueError(f"low-pass: order must be from 1 to 8, not {self.order}")

    @property
    def settling(self) -> float:
        """Time over which a jump is spread to either side, s (half a period of the cutoff)."""
        return 0.5 / self.cutoff

    def apply(self, values: NDArray[np.float64], sample_time: float) -> NDArray[np.float64]:
        """Filtered columns of values (n,) or (n, k) sampled every `sample_time` seconds.

        Raises MeasurementError if the cutoff is not below half the sampling rate, or the record is
        too short.
        """
        nyquist = 0.5 / sample_time
        if not self.cutoff < nyquist:
            raise MeasurementError(
                f"drive record: a low-pass at {self.cutoff:g} Hz needs a sampling rate above "
                f"{2.0 * self.cutoff:g} Hz; the record has {1.0 / sample_time:g} Hz"
            )
        # enough reflected samples for the ends to settle
        pad = max(3 * (2 * self.order + 1), math.ceil(self.settling / sample_time))
        if len(values) <= pad:
            raise MeasurementError(
                f"drive record: a low-pass at {self.cutoff:g} Hz needs more than {pad} samples; "
                f"the record has {len(values)}"
            )
        sections = _sections(self.order, self.cutoff / nyquist)
        return scipy.signal.sosfiltfilt(sections, values, axis=0, padlen=pad)
