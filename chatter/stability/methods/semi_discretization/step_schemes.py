"""How one step of a period is discretized: the semi-discretizations, and full discretization.

All take the exact mean of the directional matrix over the step. Semi-discretization (Insperger and
Stepan 2004, 2011) solves the step exactly with the delayed motion a polynomial: of order 0 its mean
at both ends, of order 1 a straight line, of order 2 a parabola through a third node. Full
discretization (Ding, Zhu, Zhang and Ding 2010, Int. J. Mach. Tools Manuf. 50) solves the free
motion exactly and takes the present motion, too, as a straight line, which becomes implicit.
With averaged coefficients every one of them is of second order in the step; they differ by the
size of the error.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.engine.presets import INNER_KERNEL


class FirstOrder(NamedTuple):
    """Delayed motion linear over a step."""

    third_nodes: int = 0


class OtherScheme(NamedTuple):
    """One of the other schemes, chosen as it runs: they are compiled together."""

    number: int
    third_nodes: int = 0


Scheme = FirstOrder | OtherScheme
#: numbers of the other schemes: delayed motion constant, and a parabola through a third node;
#: delayed and present motion linear
CONSTANT, PARABOLA, FULL = 0, 1, 2
FIRST_ORDER, ZEROTH_ORDER = FirstOrder(), OtherScheme(CONSTANT)
SECOND_ORDER, FULL_DISCRETIZATION = OtherScheme(PARABOLA, third_nodes=1), OtherScheme(FULL)


@njit(**INNER_KERNEL)
def _generator(arrays, stiffness, dashpot, generator, gain):
    """Fill the state matrix (2n, 2n) and the input matrix (2n, r) of a unit force."""
    modes, rank = arrays.shape.shape
    generator[:, :] = 0.0
    gain[:, :] = 0.0
    for i in range(modes):
        w = arrays.natural_frequency[i]
        generator[2 * i, 2 * i + 1] = w
        generator[2 * i + 1, 2 * i] -= w
        generator[2 * i + 1, 2 * i + 1] -= 2.0 * arrays.damping[i] * w
        for k in range(rank):
            gain[2 * i + 1, k] = arrays.force_gain[i, k]
            for j in range(modes):
                for m in range(rank):
                    push = arrays.force_gain[i, k]
                    reach = arrays.shape[j, m] / arrays.natural_frequency[j]
                    present = stiffness[k, m] + arrays.stiffening * dashpot[k, m]
                    generator[2 * i + 1, 2 * j] -= push * present * reach
                    generator[2 * i + 1, 2 * j + 1] -= push * dashpot[k, m] * arrays.shape[j, m]


@njit(**INNER_KERNEL)
def _exponential(a):
    """Matrix exponential by scaling, a Taylor series and squaring."""
    n = a.shape[0]
    norm = 0.0
    for i in range(n):
        norm = max(norm, np.abs(a[i]).sum())
    doublings = max(0, math.ceil(math.log2(max(norm, 1e-300))) + 2)
    scaled = a / 2.0**doublings
    out, term = np.eye(n), np.eye(n)
    for order in range(1, 14):
        term = term @ scaled / order
        out = out + term
    for _ in range(doublings):
        out = out @ out
    return out


@njit(**INNER_KERNEL)
def _exact(generator, gain, duration):
    """Propagator, and what unit inputs 1, s/h and (s/h)^2 make over a step of length h."""
    size, rank = gain.shape
    whole = np.zeros((size + 3 * rank, size + 3 * rank))
    whole[:size, :size] = generator * duration
    whole[:size, size : size + rank] = gain * duration
    for k in range(2 * rank):
        whole[size + k, size + rank + k] = 1.0
    power = _exponential(whole)
    constant = power[:size, size : size + rank].copy()
    ramp = power[:size, size + rank : size + 2 * rank].copy()
    square = 2.0 * power[:size, size + 2 * rank :]
    return power[:size, :size].copy(), constant, ramp, square


@njit(**INNER_KERNEL)
def semi_discretized(arrays, stiffness, dashpot, duration):
    """Propagator and responses to the delayed motion 1, s/h, (s/h)^2, in the cut."""
    modes, rank = arrays.shape.shape
    generator, gain = np.empty((2 * modes, 2 * modes)), np.empty((2 * modes, rank))
    _generator(arrays, stiffness, dashpot, generator, gain)
    return _exact(generator, gain @ stiffness, duration)


@njit(**INNER_KERNEL)
def fully_discretized(arrays, stiffness, dashpot, duration):
    """Propagator and responses to the delayed motion at the left and the right end."""
    modes, rank = arrays.shape.shape
    size = 2 * modes
    generator, gain = np.empty((size, size)), np.empty((size, rank))
    none = np.zeros((rank, rank))
    _generator(arrays, none, none, generator, gain)
    free, constant, ramp, _ = _exact(generator, gain, duration)
    feedback = np.zeros((rank, size))
    for j in range(modes):
        for k in range(rank):
            for m in range(rank):
                reach = arrays.shape[j, m]
                present = stiffness[k, m] + arrays.stiffening * dashpot[k, m]
                feedback[k, 2 * j] += present * reach / arrays.natural_frequency[j]
                feedback[k, 2 * j + 1] += dashpot[k, m] * reach
    implicit = np.linalg.inv(np.eye(size) + ramp @ feedback)
    transition = implicit @ (free - (constant - ramp) @ feedback)
    return transition, implicit @ ((constant - ramp) @ stiffness), implicit @ (ramp @ stiffness)
