"""Reference model of a velocity controller: the loop as it behaves under proportional control.

The set point that the integral part compares with the measured velocity first passes a
second-order lag of natural frequency f_r and damping D_r, a replica of the proportionally
controlled loop. The integral part then answers disturbances only, and a step of the set point no
longer overshoots (Groß, Hamann and Wiegärtner 2001, Electrical Feed Drives in Automation; the
function of the same name of drive controllers). The proportional part sees the set point itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.control.filters import low_pass
from dynamics.control.sampling import require_positive


@dataclass(frozen=True)
class ReferenceModel:
    """Second-order lag before the integral part.

    Parameters
    ----------
    natural_frequency : float
        f_r, Hz.
    damping : float
        D_r.

    Raises
    ------
    ControlError
        If one of them is not above 0.
    """

    natural_frequency: float
    damping: float

    def __post_init__(self):
        require_positive("reference model", "natural frequency", self.natural_frequency)
        require_positive("reference model", "damping", self.damping)

    def sampled(self, sample_time: float) -> NDArray[np.float64]:
        """Return b0, b1, b2, a1, a2 at a sample time, s; see `filters`."""
        return low_pass(self.natural_frequency, self.damping).sampled(sample_time)
