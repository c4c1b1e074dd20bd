"""What lies between the samples of an input, and what it does to an estimated FRF.

The ratio of the transforms of samples is not the FRF G of the structure. An input rebuilt from its
samples holds, beside each line, its images at every multiple of the sampling frequency, each
weighted by the hold H; sampling the response folds them back onto the line (K. J. Astrom and
B. Wittenmark, 1997, Computer-Controlled Systems, 3rd ed., chapter 7):

    G_sampled(s) = sum over m of H(s_m) G(s_m),  s_m = s + 2 pi i m / T

The term m = 0 is taken off by dividing by H. The others, small where the sampling is fast, are
known in closed form where the structure answers to them by its inertia alone.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.frf.container import DERIVATIVE_ORDER, Frf


@dataclass(frozen=True)
class Hold:
    """How a continuous input was made from samples."""

    name: str
    power: int  # of sinc(f T) in its transfer function, 1
    delay: float  # samples

    def transfer(self, s: ArrayLike, step: float) -> NDArray[np.complex128]:
        """Return the transfer function of the hold, 1, at s, rad/s, for a step, s."""
        half = 0.5 * step * np.asarray(s, dtype=np.complex128)
        safe = np.where(half == 0.0, 1.0, half)
        sinc = np.where(half == 0.0, 1.0, np.sinh(safe) / safe)
        return sinc**self.power * np.exp(-2.0 * self.delay * half)


#: samples kept until the next one: torque commands of drives, sample k from step k to k + 1
ZERO_ORDER_HOLD = Hold("zero-order hold", 1, 0.5)
#: samples joined by straight lines: forces put on a machine from outside
FIRST_ORDER_HOLD = Hold("first-order hold", 2, 0.0)
#: nothing above half the sampling frequency: both channels measured behind anti-aliasing filters
BAND_LIMITED = Hold("band-limited", 0, 0.0)


def laplace(frf: Frf) -> NDArray[np.complex128]:
    """Return s of each line of an FRF, i omega and any decay added by a window, rad/s."""
    return frf.added_decay + 2j * np.pi * frf.frequency


def without_hold(frf: Frf, hold: Hold, step: float) -> Frf:
    """Return an FRF of samples freed of the hold of its input.

    It is the ratio of the transforms of response and input, both sampled at the step, s.
    """
    return replace(frf, values=frf.values / hold.transfer(laplace(frf), step))


def without_images(frf: Frf, hold: Hold, step: float, inverse_mass: float) -> Frf:
    """Return an FRF, freed of the hold already, freed of the folded images too.

    At the images the structure is taken to answer by its inertia, receptance inverse_mass / s^2,
    which holds where its modes lie well below half the sampling frequency. The inverse mass is the
    accelerance far above all modes, response row . M^-1 . force column, 1/kg; 0 where response and
    force act on different masses. The hold is that of the input, the step in s; nothing is to do
    for `BAND_LIMITED`.

    Of receptances, as from the estimators of this package, the images are a small part: at a tenth
    of the sampling frequency 0.02 % of the inertia line with forces joined by lines and 0.07 % with
    forces held, at a quarter 1.5 % and 3 %. Of accelerances they are far larger, 3.4 % at a tenth:
    record displacements of a simulation, and let `Frf.as_quantity` differentiate.
    """
    if hold.power == 0:
        return frf
    s = laplace(frf)
    slope = 2 - DERIVATIVE_ORDER[frf.quantity]
    share = image_share(s, step, slope + hold.power)
    line = inverse_mass / np.where(s == 0.0, 1.0, s) ** slope
    return replace(frf, values=frf.values - line * share)


def image_share(s: ArrayLike, step: float, power: int) -> NDArray[np.complex128]:
    """Return the sum over m != 0 of (x / (x + m))^power with x = s T / (2 pi i).

    That of the images to the line itself, for a hold and an inertia line that fall together as
    s^-power, power 1 to 4; s in rad/s, 0 < |Im s| T < 2 pi, or 0, and the step T in s. Of power 1
    the sum is that of m and -m together: a response that jumps is then sampled in the middle of its
    jump. Source: derivatives of the partial fractions of pi cot(pi x).
    """
    turn = np.asarray(s, dtype=np.complex128) * step / 2j
    safe = np.where(turn == 0.0, 0.5, turn)
    sine, cosine = np.sin(safe), np.cos(safe)
    sums = {
        1: cosine / sine,
        2: 1.0 / sine**2,
        3: cosine / sine**3,
        4: (1.0 - 2.0 / 3.0 * sine**2) / sine**4,
    }
    return np.where(turn == 0.0, 0.0, safe**power * sums[power] - 1.0)
