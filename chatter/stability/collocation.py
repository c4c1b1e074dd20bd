"""Collocation on elements: multipliers, limits and chatter frequencies of any cut.

See `element_map`. Unlike semi-discretization it takes any pitch, helix, edge, runout and variation
of the spindle speed, and converges spectrally.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from chatter.stability import drivers
from chatter.stability.cut_arrays import RESOLUTION, CutArrays
from chatter.stability.following import followed_crossings
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import PointMethod, growth, limit_curve_by
from chatter.stability.multiplier import Multiplier
from chatter.stability.sweep import Progress, no_progress, sweep

#: resolutions of a single point, one after the other until two agree
FINER = ((10, 1.0), (12, 0.8), (12, 0.5), (12, 0.3), (12, 0.15))
#: points handed to a thread at once: many enough to fill the lanes of the kernels
_POINTS_A_CHUNK = 64

#: a cut at a resolution: (points, waves) -> CutArrays
CutAt = Callable[[int, float], CutArrays]


def multipliers(
    cut: CutArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
) -> NDArray[np.complex128]:
    """Dominant multiplier over one period at every point.

    Parameters
    ----------
    cut : CutArrays
    speeds, depths : (n,) array of float
        rad/s and m, point by point.
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    (n,) array of complex
        Imaginary part >= 0.
    """
    if len(speeds) == 0:
        return np.empty(0, dtype=np.complex128)
    return _solved(cut, speeds, depths, np.zeros(len(speeds), dtype=np.bool_), progress)[0]


def _solved(
    cut: CutArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    listened: NDArray[np.bool_],
    progress: Progress = no_progress,
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Multipliers, and chatter frequencies (Hz) of the points listened to, nan elsewhere."""
    # points of one depth share much work, at neighbouring speeds most of it
    _, row, shared = np.unique(depths, return_inverse=True, return_counts=True)
    level = np.where(shared[row] > 1, depths, 0.0)
    order = np.lexsort((speeds, level))
    parts = sweep(
        lambda index: drivers.element_multipliers(
            cut, speeds[order[index]], depths[order[index]], listened[order[index]]
        ),
        len(speeds),
        progress,
        _POINTS_A_CHUNK,
    )
    multiplier, frequency = np.empty(len(speeds), dtype=np.complex128), np.empty(len(speeds))
    multiplier[order] = np.concatenate([part[0] for part in parts])
    frequency[order] = np.concatenate([part[1] for part in parts])
    return multiplier, frequency


def converged_multiplier(
    cut_at: CutAt, speed: float, depth: float, tolerance: float = 2e-5
) -> Multiplier:
    """Dominant multiplier at one point, refined until two resolutions agree.

    Parameters
    ----------
    cut_at : callable
        Cut at a resolution.
    speed, depth : float
        rad/s, m.
    tolerance : float
        On |mu|, relative to max(1, |mu|).
    """
    point = np.array([speed]), np.array([depth])
    cut = cut_at(*RESOLUTION)
    value, error = complex(multipliers(cut, *point)[0]), np.inf
    for finer in FINER:
        cut = cut_at(*finer)
        better = complex(multipliers(cut, *point)[0])
        error = abs(abs(better) - abs(value))
        value = better
        if error <= tolerance * max(1.0, abs(value)):
            break
    steps = int(drivers.points_of_periods(cut, point[0], depth)[0])
    return Multiplier(value, steps, float(error))


def chatter_frequencies(
    cut: CutArrays, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Frequency (Hz) at which the motion of the dominant multiplier is largest, at n points."""
    if len(speeds) == 0:
        return np.empty(0)
    return _solved(cut, speeds, depths, np.ones(len(speeds), dtype=np.bool_))[1]


def chatter_frequency(cut: CutArrays, speed: float, depth: float) -> float:
    """The same (Hz) at one point."""
    return float(chatter_frequencies(cut, np.array([speed]), np.array([depth]))[0])


def followed_limits(
    cut: CutArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    tolerance: float = 5e-3,
) -> list[NDArray[np.float64]]:
    """Limits at every speed by following the boundary, for a diagram that follows a slider.

    Parameters
    ----------
    cut : CutArrays
        At any resolution: 6 points an element do for a picture.
    speeds : (n,) array of float
        rad/s, ascending.
    depths : (m,) array of float
        Coarse net, m.
    tolerance : float
        Of a limit, relative to its depth.

    Returns
    -------
    list of n arrays
        m; all changes of stability, lost at even places; see `following` for what may be missed.
    """

    def at(points: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        return growth(multipliers(cut, speeds[points], depth))

    return followed_crossings(len(speeds), depths, at, tolerance)


def limit_curve(
    cut: CutArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
) -> LimitCurve:
    """Limits of stability at every spindle speed; see `limit_search`."""

    def at(
        points: NDArray[np.int64], depth: NDArray[np.float64], report: Progress = no_progress
    ) -> NDArray[np.complex128]:
        return multipliers(cut, speeds[points], depth, report)

    def heard(speed: int, depth: float) -> float:
        return chatter_frequency(cut, float(speeds[speed]), depth)

    steps = drivers.points_of_periods(cut, speeds, float(depths[-1]))
    return limit_curve_by(PointMethod(at, at, heard), speeds, depths, steps, progress)
