"""General second-order filters of a set point, in continuous and in sampled form.

H(s) = (s^2/w_n^2 + 2 D_z s/w_n + 1)/(s^2/w_d^2 + 2 D_n s/w_d + 1), with the natural frequencies
f_n of the numerator and f_d of the denominator, and the dampings D_z of the numerator (Zähler)
and D_n of the denominator (Nenner), as in the current set-point filters of drive controllers.

Sampled by the bilinear transform, prewarped for the numerator at f_n and for the denominator at
f_d: s/w -> (1 - z^-1)/(1 + z^-1)/tan(w T/2) in each (Oppenheim and Schafer 2010, section 7.2.2).
The factor (1 + z^-1)^2 cancels, so that a notch stays at f_n, the poles stay at f_d and the gain
at rest stays 1. A numerator of infinite f_n (low pass) becomes (1 + z^-1)^2/4, zero at Nyquist.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba.extending import register_jitable
from numpy.typing import ArrayLike, NDArray

from dynamics.compiled import INLINED
from dynamics.control.sampling import (
    ControlError,
    require_limit,
    require_not_negative,
    require_positive,
)

#: coefficients b0, b1, b2, a1, a2 of a filter that does nothing
UNFILTERED = np.array([1.0, 0.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class SecondOrderFilter:
    """Second-order filter by its natural frequencies and dampings.

    Raises
    ------
    ControlError
        If a frequency is not above 0, D_z is negative or D_n is not above 0.
    """

    numerator_frequency: float  # f_n, Hz; infinite: low pass
    numerator_damping: float  # D_z; 0 makes a full notch at f_n
    denominator_frequency: float  # f_d, Hz
    denominator_damping: float  # D_n

    def __post_init__(self):
        part = "second-order filter"
        require_limit(part, "numerator frequency", self.numerator_frequency)
        require_not_negative(part, "numerator damping", self.numerator_damping)
        require_positive(part, "denominator frequency", self.denominator_frequency)
        require_positive(part, "denominator damping", self.denominator_damping)

    def sampled(self, sample_time: float) -> NDArray[np.float64]:
        """Return b0, b1, b2, a1, a2 at a sample time, s (a0 = 1).

        Raises ControlError if a finite frequency lies at or above the Nyquist frequency.
        """
        top = _warped(self.numerator_frequency, self.numerator_damping, sample_time, "numerator")
        bottom = _warped(
            self.denominator_frequency, self.denominator_damping, sample_time, "denominator"
        )
        return np.array([*(top / bottom[0]), *(bottom[1:] / bottom[0])])

    def continuous_response(self, frequencies: ArrayLike) -> NDArray[np.complex128]:
        """Return H(j 2 pi f) of the filter before it is sampled; frequencies in Hz."""
        s = 1j * np.asarray(frequencies, dtype=np.float64)
        top, bottom = s / self.numerator_frequency, s / self.denominator_frequency
        return (top**2 + 2.0 * self.numerator_damping * top + 1.0) / (
            bottom**2 + 2.0 * self.denominator_damping * bottom + 1.0
        )


def low_pass(frequency: float, damping: float = math.sqrt(0.5)) -> SecondOrderFilter:
    """Return a second-order low pass of natural frequency, Hz, and damping."""
    return SecondOrderFilter(math.inf, 0.0, frequency, damping)


def notch(
    frequency: float, numerator_damping: float, denominator_damping: float
) -> SecondOrderFilter:
    """Return a band stop at a frequency, Hz; its gain there is D_z/D_n."""
    return SecondOrderFilter(frequency, numerator_damping, frequency, denominator_damping)


def _warped(frequency: float, damping: float, sample_time: float, side: str) -> NDArray:
    """Coefficients of 1, z^-1, z^-2 of one side, times (1 + z^-1)^2."""
    if math.isinf(frequency):
        return np.array([1.0, 2.0, 1.0])
    nyquist = 0.5 / sample_time
    if frequency >= nyquist:
        raise ControlError(
            f"second-order filter: {side} frequency {frequency:g} Hz is not below the Nyquist "
            f"frequency {nyquist:g} Hz of its sample time {sample_time:g} s"
        )
    c = 1.0 / math.tan(math.pi * frequency * sample_time)
    return np.array(
        [c * c + 2.0 * damping * c + 1.0, 2.0 - 2.0 * c * c, c * c - 2 * damping * c + 1]
    )


def sampled_response(
    coefficients: NDArray[np.float64], frequencies: ArrayLike, sample_time: float
) -> NDArray[np.complex128]:
    """Return the z-domain response of coefficients b0, b1, b2, a1, a2; frequencies in Hz."""
    z1 = np.exp(-2j * np.pi * np.asarray(frequencies, dtype=np.float64) * sample_time)
    b0, b1, b2, a1, a2 = coefficients
    return (b0 + z1 * (b1 + z1 * b2)) / (1.0 + z1 * (a1 + z1 * a2))


@register_jitable(**INLINED)
def second_order_sample(b0, b1, b2, a1, a2, first, second, value):
    """Output of a filter at a sample, and its two states for the next (transposed direct form)."""
    output = b0 * value + first
    return output, b1 * value - a1 * output + second, b2 * value - a2 * output


@dataclass(frozen=True)
class ReferenceModel:
    """Second-order lag before the integral part of a velocity controller.

    It stands for the loop under proportional control, so that the integral part answers
    disturbances only and a step of the set point does not overshoot; the proportional part sees
    the set point itself (Groß, Hamann and Wiegärtner 2001, Electrical Feed Drives in Automation).

    Raises
    ------
    ControlError
        If one of them is not above 0.
    """

    natural_frequency: float  # f_r, Hz
    damping: float  # D_r

    def __post_init__(self):
        require_positive("reference model", "natural frequency", self.natural_frequency)
        require_positive("reference model", "damping", self.damping)

    def sampled(self, sample_time: float) -> NDArray[np.float64]:
        """Return b0, b1, b2, a1, a2 at a sample time, s; see `filters`."""
        return low_pass(self.natural_frequency, self.damping).sampled(sample_time)
