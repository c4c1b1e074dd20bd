"""From multipliers at points to limits over spindle speed, whatever the method."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress, no_progress
from chatter.detection.bifurcation_type import bifurcation_of_multiplier
from chatter.stability.crossings import find_crossings, growth_rate_on_grid
from chatter.stability.limit_curve import LimitCurve, limits_at

#: multipliers at points: (indices of speeds, depths, progress) -> (n,) complex
AtPoints = Callable[..., NDArray[np.complex128]]
#: chatter frequencies (Hz) at points: (indices of speeds, depths) -> (n,)
Frequencies = Callable[[NDArray[np.int64], NDArray[np.float64]], NDArray[np.float64]]
#: multipliers and chatter frequencies (Hz) at points
MultipliersAndFrequencies = Callable[
    [NDArray[np.int64], NDArray[np.float64]], tuple[NDArray[np.complex128], NDArray[np.float64]]
]

#: harmonics searched for the chatter frequency reach this far beyond the highest mode
_HIGHEST = 2.0


class PointMethod(NamedTuple):
    """What the search needs of a method."""

    plain: AtPoints  # screening of the grid
    refined: AtPoints  # where it matters; the same function where there is but one
    frequencies: Frequencies


def growth_rate(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Logarithm of the spectral radius: positive is unstable."""
    return np.log(np.maximum(np.abs(values), 1e-30))


def kinds_of(values: NDArray[np.complex128]) -> list[str]:
    """Bifurcations of multipliers at limits."""
    return [bifurcation_of_multiplier(complex(value)) for value in values]


def extrapolated(
    coarse: NDArray[np.complex128],
    fine: NDArray[np.complex128],
    order: int,
    largest_correction: float,
) -> NDArray[np.complex128]:
    """Multipliers from steps and steps of half the length (Richardson).

    Parameters
    ----------
    coarse, fine : (n,) array of complex
    order : int
        Of the error that is removed.
    largest_correction : float
        Share beyond which two multipliers have changed places: then the fine one is taken.
    """
    correction = (fine - coarse) / (2.0**order - 1.0)
    correction[np.abs(correction) > largest_correction * np.abs(fine)] = 0.0
    value = fine + correction
    return value.real + 1j * np.abs(value.imag)


def frequency_of_motion(
    multiplier: complex,
    period: float,
    time: NDArray[np.float64],
    motion: NDArray[np.complex128],
    weight: NDArray[np.float64],
    natural_frequency: NDArray[np.float64],
) -> float:
    """Frequency (Hz) at which a motion that belongs to a multiplier is largest.

    A multiplier mu fixes the frequencies (arg mu + 2 pi l)/T only up to that of the period; the one
    with the largest amplitude of displacement is the chatter frequency.

    Parameters
    ----------
    multiplier : complex
    period : float
        s.
    time : (n,) array of float
        s.
    motion : (n, r) array of complex
        Displacement at the times.
    weight : (n,) array of float
        Of each time, s.
    natural_frequency : (k,) array of float
        rad/s.
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

    Parameters
    ----------
    evaluate : callable
        Multipliers and chatter frequencies at points.
    """

    #: a point stands for another at the same speed within this share of its depth
    _NEAR = 1e-3

    def __init__(self, evaluate: MultipliersAndFrequencies) -> None:
        self._evaluate = evaluate
        self._point = np.empty(0, dtype=np.int64)
        self._depth, self._frequency = np.empty(0), np.empty(0)
        self._value = np.empty(0, dtype=np.complex128)

    def growth_rate(
        self, point: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Growth rate at points, which are remembered."""
        value, frequency = self._evaluate(point, depth)
        self._point, self._depth = np.append(self._point, point), np.append(self._depth, depth)
        self._value = np.append(self._value, value)
        self._frequency = np.append(self._frequency, frequency)
        return growth_rate(value)

    def at_limits(
        self, point: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> tuple[list[str], NDArray[np.float64]]:
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
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: NDArray[np.int64],
    progress: Progress = no_progress,
) -> LimitCurve:
    """Limits of stability at every spindle speed.

    Parameters
    ----------
    method : PointMethod
    speeds : (n,) array of float
        rad/s.
    depths : (m,) array of float
        m, ascending, > 0: grid on which changes of stability are searched; an unstable or stable
        interval that fits between two of its depths is not seen.
    steps : (n,) array of int
        Resolution, as it is reported.
    progress : callable, optional
        Called with (done, total) points of the grid.
    """

    def plain(index: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        return growth_rate(method.plain(index, depth, progress))

    def refined(index: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        return growth_rate(method.refined(index, depth, no_progress))

    def at_limits(
        index: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> tuple[list[str], NDArray[np.float64]]:
        values = method.refined(index, depth, no_progress)
        return kinds_of(values), method.frequencies(index, depth)

    same = method.refined is method.plain
    grid = growth_rate_on_grid(len(speeds), depths, plain, plain if same else refined)
    crossings = find_crossings(grid, depths, refined)
    return limits_at(at_limits, speeds, crossings, steps)
