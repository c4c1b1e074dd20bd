"""Families of pitch angles, and the rule that says which of them cancel regeneration.

The wave that a tooth meets was left a pitch ago; with delays P_j/Omega the mean of its effect at
a chatter frequency omega goes with (1/N) sum_j exp(-i omega P_j/Omega). The rule sets that to
nothing: neighbouring waves half a cycle apart where two pitches alternate (Slavicek 1965), and N of
them evenly around the cycle where the pitch grows from tooth to tooth (Altintas, Engin and Budak
1999, J. Manuf. Sci. Eng. 121:173; Budak 2003, J. Manuf. Sci. Eng. 125:29).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from chatter.description.arrays import Array

_REVOLUTION = 2.0 * math.pi


def alternating(teeth: int, difference: float) -> Array:
    """Pitch angles (N,), rad: p, p + d, p, p + d, ...; of an even number of teeth."""
    sides = np.where(np.arange(teeth) % 2 == 0, -0.5, 0.5)
    return _REVOLUTION / teeth + difference * sides


def linear(teeth: int, difference: float) -> Array:
    """Pitch angles (N,), rad, each larger than the one before by a difference."""
    return _REVOLUTION / teeth + difference * (np.arange(teeth) - 0.5 * (teeth - 1))


def _half_cycles(teeth: int, speed: float, frequency: float, count: int) -> Array:
    """Differences at which neighbouring waves are an odd number of half cycles apart, rad."""
    del teeth
    return math.pi * speed / frequency * (2.0 * np.arange(count) + 1.0)


def _even_phases(teeth: int, speed: float, frequency: float, count: int) -> Array:
    """Differences at which the waves of N teeth lie evenly around the cycle, rad."""
    cycles = np.array([k for k in range(1, 2 * count + 1) if k % teeth])[:count]
    return _REVOLUTION * cycles / teeth * speed / frequency


@dataclass(frozen=True)
class Family:
    """Pitch angles of one parameter."""

    name: str
    angles: Callable[[int, float], Array]  # (teeth, difference) -> pitch angles, rad
    #: (teeth, speed, chatter frequency in rad/s, count) -> differences by the rule, rad
    cancelling: Callable[[int, float, float, int], Array]
    #: (teeth) -> deviation of the largest pitch from the mean, for a difference of one
    widest: Callable[[int], float]


def families(teeth: int) -> tuple[Family, ...]:
    """Families that a tool with this many teeth can have."""
    growing = Family("linear", linear, _even_phases, lambda count: 0.5 * (count - 1))
    if teeth % 2:
        return (growing,)
    return (Family("alternating", alternating, _half_cycles, lambda _: 0.5), growing)


def regeneration(pitch: Array, speed: float, frequency: float) -> float:
    """Magnitude of the mean of the waves that the teeth meet, 1 where all are in phase.

    Pitch angles (N,) in rad; speed of the spindle and frequency of chatter in rad/s.
    """
    return float(abs(np.exp(-1j * frequency * np.asarray(pitch) / speed).mean()))
