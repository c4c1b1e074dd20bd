"""From multipliers at points to limits over spindle speed, whatever the method."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress, no_progress
from chatter.stability.crossings import find_crossings, growth_on_net
from chatter.stability.floquet_multiplier import bifurcation_kind
from chatter.stability.limit_curve import LimitCurve

#: multipliers at points: (indices of speeds, depths, progress) -> (n,) complex
AtPoints = Callable[..., NDArray[np.complex128]]
#: multipliers and chatter frequencies (Hz) at points: (indices of speeds, depths) -> 2 x (n,)
Heard = Callable[
    [NDArray[np.int64], NDArray[np.float64]], tuple[NDArray[np.complex128], NDArray[np.float64]]
]


class PointMethod(NamedTuple):
    """What the search asks of a method."""

    plain: AtPoints  # on the net
    refined: AtPoints  # where it matters; the same function where there is but one
    heard: Heard


def growth(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Logarithm of the spectral radius: positive is unstable."""
    return np.log(np.maximum(np.abs(values), 1e-30))


class HeardPoints:
    """Points near limits that have been heard, so that no limit is computed once more to hear it.

    Parameters
    ----------
    at : callable
        Multipliers and chatter frequencies at points.
    """

    #: a point stands for another at the same speed within this share of its depth
    _NEAR = 1e-3

    def __init__(self, at: Heard) -> None:
        self._at = at
        self._point = np.empty(0, dtype=np.int64)
        self._depth, self._frequency = np.empty(0), np.empty(0)
        self._value = np.empty(0, dtype=np.complex128)

    def growth(self, point: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        """Growth at points, which are remembered."""
        value, frequency = self._at(point, depth)
        self._point, self._depth = np.append(self._point, point), np.append(self._depth, depth)
        self._value = np.append(self._value, value)
        self._frequency = np.append(self._frequency, frequency)
        return growth(value)

    def nearest(
        self, point: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        """Multipliers and chatter frequencies next to points, one to a speed."""
        if self._point.size == 0:
            return self._at(point, depth)
        best = np.full(len(point), -1, dtype=np.int64)
        distance = self._NEAR * depth
        place = np.searchsorted(point, self._point)
        for i, k in enumerate(place.tolist()):
            if k < len(point) and point[k] == self._point[i]:
                apart = abs(self._depth[i] - depth[k])
                if apart <= distance[k]:
                    best[k], distance[k] = i, apart
        value, frequency = self._value[best], self._frequency[best]
        unknown = np.flatnonzero(best < 0)
        if unknown.size:
            value[unknown], frequency[unknown] = self._at(point[unknown], depth[unknown])
        return value, frequency


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
        m, ascending, > 0: net on which changes of stability are looked for; an unstable or
        stable stretch that fits between two of its depths is not seen.
    steps : (n,) array of int
        Resolution, to be told.
    progress : callable, optional
        Called with (done, total) points of the net.
    """

    def plain(index: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        return growth(method.plain(index, depth, progress))

    def refined(index: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        return growth(method.refined(index, depth, no_progress))

    same = method.refined is method.plain
    net = growth_on_net(len(speeds), depths, plain, plain if same else refined)
    crossings = find_crossings(net, depths, refined)
    return limits_at(method.heard, speeds, crossings, steps)


def limits_at(
    heard: Heard,
    speeds: NDArray[np.float64],
    crossings: list[NDArray[np.float64]],
    steps: NDArray[np.int64],
) -> LimitCurve:
    """First limit at every speed, what is heard there and of what kind it is.

    Parameters
    ----------
    heard : callable
        Multipliers and chatter frequencies at points.
    speeds : (n,) array of float
        rad/s.
    crossings : list of n arrays
        m, all changes of stability at every speed.
    steps : (n,) array of int
        Resolution, to be told.
    """
    found = np.array([i for i, depth in enumerate(crossings) if depth.size], dtype=np.int64)
    first = np.full(len(speeds), np.inf)
    first[found] = [crossings[i][0] for i in found]
    frequency = np.full(len(speeds), np.nan)
    at_limit, frequency[found] = heard(found, first[found])
    kind = ["none"] * len(speeds)
    for i, value in zip(found.tolist(), at_limit, strict=True):
        kind[i] = bifurcation_kind(complex(value))
    return LimitCurve(speeds, first, frequency, tuple(kind), tuple(crossings), steps)
