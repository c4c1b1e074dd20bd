"""Sample times as whole numbers of steps, and what a sample, a hold and a delay do to a sinusoid.

A sinusoid of angular frequency w that is sampled every T, held over N finer samples and sampled
again there has, at w itself, the amplitude of the mean of the N delays; the images at
w + 2 pi m/T are other frequencies (Franklin, Powell and Workman 1998, Digital Control of Dynamic
Systems, section 5.2 and chapter 11). Nested loops therefore multiply like filters at w, above their
Nyquist frequency too.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: of a sample time over the step, from a whole number
_WHOLE = 1e-6


class ControlError(ValueError):
    """A drive specification that makes no sense; the message names the drive's part."""


def require_positive(part: str, key: str, value: float) -> None:
    """Raise ControlError unless value is a finite number above zero."""
    if not (math.isfinite(value) and value > 0.0):
        raise ControlError(f"{part}: {key} is {value}; a finite number above 0 is needed")


def require_not_negative(part: str, key: str, value: float) -> None:
    """Raise ControlError unless value is a finite number, zero or above."""
    if not (math.isfinite(value) and value >= 0.0):
        raise ControlError(f"{part}: {key} is {value}; a finite number, 0 or above, is needed")


def require_limit(part: str, key: str, value: float) -> None:
    """Raise ControlError unless value is above zero; infinity means no limit."""
    if not value > 0.0:
        raise ControlError(f"{part}: {key} is {value}; a number above 0 is needed (inf: no limit)")


def require_samples(part: str, key: str, value: int) -> None:
    """Raise ControlError unless value is a whole number of samples, zero or above."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 0:
        raise ControlError(f"{part}: {key} is {value}; a whole number of samples, 0 or above")


def whole_ratio(loop: str, sample_time: float, name: str, unit: float) -> int:
    """Return sample_time / unit as a whole number.

    Both in s; loop and name of the unit are for the message of the ControlError that is raised
    unless the sample time is a whole multiple of the unit, one at least.
    """
    ratio = sample_time / unit
    count = round(ratio)
    if count < 1 or abs(ratio - count) > _WHOLE * count:
        raise ControlError(
            f"{loop} loop: sample time {sample_time:g} s is not a whole multiple of "
            f"{name} {unit:g} s (ratio {ratio:.6g})"
        )
    return count


def delay_response(
    frequencies: ArrayLike, sample_time: float, samples: int
) -> NDArray[np.complex128]:
    """Return the response of a delay by a number of samples; frequencies in Hz."""
    w = 2.0 * np.pi * np.asarray(frequencies, dtype=np.float64)
    return np.exp(-1j * w * sample_time * samples)


def sample_and_hold_response(
    frequencies: ArrayLike, finer: float, count: int
) -> NDArray[np.complex128]:
    """Return the response at the same frequency of a hold over count finer samples.

    Frequencies in Hz, finer time step in s.
    """
    w = 2.0 * np.pi * np.asarray(frequencies, dtype=np.float64)
    return np.exp(-1j * w[..., None] * finer * np.arange(count)).mean(axis=-1)


def zero_order_hold_response(frequencies: ArrayLike, step: float) -> NDArray[np.complex128]:
    """Return the response at the same frequency of a continuous hold over a step, s.

    (1 - exp(-jwh))/(jwh): to be multiplied where a torque held over each step of time acts on a
    continuous structure.
    """
    f = np.asarray(frequencies, dtype=np.float64)
    return np.sinc(f * step) * np.exp(-1j * np.pi * f * step)
