"""Bifurcation of a sustained motion: quasi-periodic (Hopf), of double (flip) or n-fold period."""

import math

import numpy as np
from numpy.typing import NDArray

from chatter.detection.chatter_frequency import ChatterLine
from chatter.detection.deviations import directions_of

#: |Im| below this share of |mu| is a real multiplier
_REAL_SHARE = 1e-6
#: periods of an orbit that are looked for
_LONGEST = 12
#: share of the variance from period to period that an orbit of n periods may leave unexplained
_UNEXPLAINED = 0.01
#: angle by which a doubled period may seem to drift over the window, rad
_DRIFT = 0.5
#: share of the variance that one alternating shape has to explain
_ONE_SHAPE = 0.97
#: steady enough for an orbit to close, growth over the window
_STEADY = 0.3


def bifurcation_of_multiplier(multiplier: complex) -> str:
    """``"flip"`` where a dominant Floquet multiplier is real and negative, else ``"hopf"``."""
    is_real = abs(multiplier.imag) <= _REAL_SHARE * abs(multiplier)
    return "flip" if is_real and multiplier.real < 0.0 else "hopf"


def bifurcation_of(
    values: NDArray[np.float64], line: ChatterLine, growth_rate: float, noise: float
) -> tuple[str, int]:
    """Name the bifurcation of a motion that does not repeat from period to period.

    By the later part of the record (periods, points, k), its chatter line, the logarithm of its
    growth a period, and the rms of the noise of one sample: "flip" and 2, "period-n" and n, or
    "hopf" and 0.
    """
    count = len(values)
    drift = abs(math.pi - line.rotation) * count
    if drift < _DRIFT or (drift < 2.0 * math.pi and _only_alternates(values, noise)):
        return "flip", 2
    if abs(growth_rate) * count > _STEADY:
        return "hopf", 0
    for period in range(2, min(_LONGEST, count // 3) + 1):
        if _unexplained(values, period, noise) < _UNEXPLAINED:
            return ("flip", 2) if period == 2 else ("period-n", period)
    return "hopf", 0


def _only_alternates(values: NDArray[np.float64], noise: float) -> bool:
    """Whether one shape changes its sign every period, however its size changes.

    The multiplier of a flip is real. The fit of a rotation of steady growth is misled while such a
    motion saturates; a complex multiplier would turn the shape.
    """
    differences = np.diff(values, axis=0).reshape(len(values) - 1, -1)
    differences[1::2] *= -1.0
    left, singular = directions_of(differences)
    total = np.sum(singular**2) - 2.0 * noise**2 * differences.size
    one_shape = singular[0] ** 2 > _ONE_SHAPE * total
    return bool(one_shape and (np.all(left[:, 0] > 0.0) or np.all(left[:, 0] < 0.0)))


def _unexplained(values: NDArray[np.float64], period: int, noise: float) -> float:
    """Share of the variance from period to period that an orbit of this length leaves."""
    count, points, channels = values.shape
    total = np.sum((values - values.mean(axis=0)) ** 2)
    left = sum(
        np.sum((values[first::period] - values[first::period].mean(axis=0)) ** 2)
        for first in range(period)
    )
    by_noise = noise**2 * points * channels
    left = max(left - by_noise * (count - period), 0.0)
    return float(left / max(total - by_noise * (count - 1), 1e-300))
