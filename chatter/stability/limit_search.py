"""From multipliers at points to limits over spindle speed, whatever the method."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array, ComplexArray, IntegerArray
from chatter.description.progress import Progress, no_progress
from chatter.detection.bifurcation_type import bifurcation_of_multiplier
from chatter.engine.parallel import each
from chatter.stability.crossings import find_crossings, growth_rate_on_grid
from chatter.stability.limit_curve import LimitCurve, limits_at

#: multipliers and chatter frequencies (Hz) at points
MultipliersAndFrequencies = Callable[[IntegerArray, Array], tuple[ComplexArray, Array]]

#: harmonics searched for the chatter frequency reach this far beyond the highest mode
_HIGHEST = 2.0


class PointMethod(NamedTuple):
    """What the search needs of a method."""

    #: (indices of speeds, depths, refinements, progress) -> multipliers (n,)
    multipliers: Callable[..., ComplexArray]
    refinements: tuple[int, ...]  # of the steps; the first alone is enough to screen the grid
    frequency: Callable[[int, float], float]  # of chatter, Hz: (index of speed, depth)


def growth_rate(values: ComplexArray) -> Array:
    """Logarithm of the spectral radius: positive is unstable."""
    return np.log(np.maximum(np.abs(values), 1e-30))


def kinds_of(values: ComplexArray) -> list[str]:
    """Bifurcations of multipliers at limits."""
    return [bifurcation_of_multiplier(complex(value)) for value in values]


def extrapolated(
    coarse: ComplexArray, fine: ComplexArray, order: int, largest_correction: float
) -> ComplexArray:
    """Multipliers (n,) from steps and steps of half the length (Richardson).

    The error of this order is removed. Beyond the share `largest_correction` two multipliers have
    changed places: then the fine one is taken.
    """
    correction = (fine - coarse) / (2.0**order - 1.0)
    correction[np.abs(correction) > largest_correction * np.abs(fine)] = 0.0
    value = fine + correction
    return value.real + 1j * np.abs(value.imag)


def frequency_of_motion(
    multiplier: complex,
    period: float,
    time: Array,
    motion: ComplexArray,
    weight: Array,
    natural_frequency: Array,
) -> float:
    """Frequency (Hz) at which a motion that belongs to a multiplier is largest.

    A multiplier mu fixes the frequencies (arg mu + 2 pi l)/T only up to that of the period; the one
    with the largest amplitude of displacement is the chatter frequency.

    The period is in s; the motion (n, r) is the displacement at the times (n,), s, each of which
    has a weight (n,), s; natural frequencies (k,) are in rad/s.
    """
    base = np.log(complex(multiplier) if multiplier != 0.0 else 1e-300) / period
    line = 2.0 * np.pi / period
    most = math.ceil(_HIGHEST * float(natural_frequency.max()) / line) + 1
    exponent = base + 1j * line * np.arange(-most, most + 1)
    wave = np.exp(-np.outer(exponent, time)) * weight
    amplitude = np.linalg.norm(wave @ motion, axis=1)
    return float(abs(exponent[np.argmax(amplitude)].imag)) / (2.0 * np.pi)


class EvaluatedPoints:
    """Points near limits whose chatter frequency has been evaluated, so that it is done once.

    `evaluate` gives multipliers and chatter frequencies at points.
    """

    #: a point stands for another at the same speed within this share of its depth
    _NEAR = 1e-3

    def __init__(self, evaluate: MultipliersAndFrequencies) -> None:
        self._evaluate = evaluate
        self._point = np.empty(0, dtype=np.int64)
        self._depth, self._frequency = np.empty(0), np.empty(0)
        self._value = np.empty(0, dtype=np.complex128)

    def growth_rate(self, point: IntegerArray, depth: Array) -> Array:
        """Growth rate at points, which are remembered."""
        value, frequency = self._evaluate(point, depth)
        self._point, self._depth = np.append(self._point, point), np.append(self._depth, depth)
        self._value = np.append(self._value, value)
        self._frequency = np.append(self._frequency, frequency)
        return growth_rate(value)

    def at_limits(self, point: IntegerArray, depth: Array) -> tuple[list[str], Array]:
        """Bifurcations and chatter frequencies next to points, one to a speed."""
        best = np.full(len(point), -1, dtype=np.int64)
        distance = self._NEAR * depth
        index = np.searchsorted(point, self._point)
        for i, k in enumerate(index.tolist()):
            if k < len(point) and point[k] == self._point[i]:
                apart = abs(self._depth[i] - depth[k])
                if apart <= distance[k]:
                    best[k], distance[k] = i, apart
        unknown = np.flatnonzero(best < 0)
        if unknown.size == len(point):
            value, frequency = self._evaluate(point, depth)
        else:
            value, frequency = self._value[best], self._frequency[best]
            if unknown.size:
                value[unknown], frequency[unknown] = self._evaluate(point[unknown], depth[unknown])
        return kinds_of(value), frequency


def limit_curve_by(
    method: PointMethod,
    speeds: Array,
    depths: Array,
    steps: IntegerArray,
    progress: Progress = no_progress,
) -> LimitCurve:
    """Limits of stability at every spindle speed (n,), rad/s.

    Changes of stability are searched on a grid of depths (m,), m, ascending, > 0: an unstable or
    stable interval that fits between two of them is not seen. `steps` (n,) is the resolution, as it
    is reported; `progress` is called with (done, total) points of the grid.
    """

    def plain(index: IntegerArray, depth: Array) -> Array:
        return growth_rate(method.multipliers(index, depth, method.refinements[:1], progress))

    def refined(index: IntegerArray, depth: Array) -> Array:
        return growth_rate(method.multipliers(index, depth, method.refinements, no_progress))

    def at_limits(index: IntegerArray, depth: Array) -> tuple[list[str], Array]:
        values = method.multipliers(index, depth, method.refinements, no_progress)
        at = list(zip(index.tolist(), depth.tolist(), strict=True))
        frequency = each(lambda i: method.frequency(*at[i]), len(at), points_a_chunk=8)
        return kinds_of(values), np.array(frequency)

    same = len(method.refinements) == 1
    grid = growth_rate_on_grid(len(speeds), depths, plain, plain if same else refined)
    crossings = find_crossings(grid, depths, refined)
    return limits_at(at_limits, speeds, crossings, steps)
