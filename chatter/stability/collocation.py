"""Collocation on elements: multipliers, limits and chatter frequencies of any cut.

See `element_map`. Unlike semi-discretization it takes any pitch, helix, edge, runout and variation
of the spindle speed, and converges spectrally.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from chatter.stability import drivers
from chatter.stability.crossings import moved_crossings
from chatter.stability.cut_arrays import RESOLUTION, CutArrays
from chatter.stability.element_assembly import MapArrays, map_arrays
from chatter.stability.first_use import compile_side_by_side
from chatter.stability.following import followed_crossings
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import HeardPoints, growth, limits_at
from chatter.stability.multiplier import Multiplier
from chatter.stability.spindle_turn import spindle_turn
from chatter.stability.sweep import Progress, no_progress, sweep

#: resolutions of a single point, one after the other until two agree
FINER = ((10, 0.7), (12, 0.5), (12, 0.3), (12, 0.15))
#: of a limit, relative to its depth
DEPTH_TOLERANCE = 1e-6
#: largest estimated error of limits, relative to their depth
LIMIT_ERROR = 1e-3
#: of `FINER` for no more than that: a serrated edge, with kinks everywhere, would take minutes
_DAILY = 2
#: limits that are looked at again with finer elements
_CHECKED = 16
#: Gauss points of the elements that they are looked at with, and their length over that they had:
#: so fine that where the chip has kinks, and errors fall but as the square, a tenth is left
_CHECK = (12, 0.3)
_ALLOWANCE = 1.1
#: the frequency of a varying speed may be moved by this share while limits are first looked for,
#: and where they are looked at again
LOOSE_TUNING, _CHECK_TUNING = 2e-2, 5e-4
#: finer elements move a limit by no more than some of its errors, relative to its depth
_REACH, _LARGEST_REACH = 4.0, 0.1
#: limits are searched to this share of the largest error
_SEARCHED = 0.1
#: speeds from one to the next of those at which all depths are looked at
STRIDE = 4
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
    return _solved(cut, speeds, depths, np.zeros(len(speeds), dtype=np.bool_), progress)[0]


def _solved(
    cut: CutArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    listened: NDArray[np.bool_],
    progress: Progress = no_progress,
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Multipliers, and chatter frequencies (Hz) of the points listened to, nan elsewhere."""
    if len(speeds) == 0:
        return np.empty(0, dtype=np.complex128), np.empty(0)
    compile_side_by_side(cut)
    order, arrays = _neighbours_together(cut, speeds, depths), map_arrays(cut)
    parts = sweep(
        lambda index: _solved_together(
            cut, arrays, speeds[order[index]], depths[order[index]], listened[order[index]]
        ),
        len(speeds),
        progress,
        _POINTS_A_CHUNK,
    )
    multiplier, frequency = np.empty(len(speeds), dtype=np.complex128), np.empty(len(speeds))
    multiplier[order] = np.concatenate([part[0] for part in parts])
    frequency[order] = np.concatenate([part[1] for part in parts])
    return multiplier, frequency


def _solved_together(
    cut: CutArrays,
    arrays: MapArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    listened: NDArray[np.bool_],
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    plans = drivers.cut_plans(cut, speeds, depths)
    return drivers.element_multipliers(arrays, plans, speeds, listened)


def _neighbours_together(
    cut: CutArrays, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Order of the points in which those follow each other that can share work."""
    if cut.variation.amplitude > 0.0:
        # the pattern of a varying speed changes with its mean
        return np.lexsort((depths, speeds))
    # at one depth much is shared, at neighbouring speeds most of it
    _, row, count = np.unique(depths, return_inverse=True, return_counts=True)
    return np.lexsort((speeds, np.where(count[row] > 1, depths, 0.0)))


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
    return _solved(cut, speeds, depths, np.ones(len(speeds), dtype=np.bool_))[1]


def chatter_frequency(cut: CutArrays, speed: float, depth: float) -> float:
    """The same (Hz) at one point."""
    return float(chatter_frequencies(cut, np.array([speed]), np.array([depth]))[0])


def limit_curve(
    cut: CutArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
    tolerance: float = DEPTH_TOLERANCE,
    stride: int = STRIDE,
) -> LimitCurve:
    """Limits of stability at every spindle speed, by following the boundary.

    Parameters
    ----------
    cut : CutArrays
    speeds : (n,) array of float
        rad/s, ascending.
    depths : (m,) array of float
        Net on which changes of stability are looked for, m.
    progress : callable, optional
        Called with (done, total) speeds.
    tolerance : float
        Of a limit, relative to its depth.
    stride : int
        All depths are looked at for every so many speeds, a power of two; see `following` for what
        may be missed between them.
    """

    def growth_at(points: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        return growth(multipliers(cut, speeds[points], depth))

    near_limits = _near_limits(cut, speeds)
    # over the long periods of a varying speed listening costs more than a point does
    varied = cut.variation.amplitude > 0.0
    refined = growth_at if varied else near_limits.growth
    crossings = followed_crossings(
        len(speeds), depths, growth_at, tolerance, stride, progress, refined
    )
    steps = drivers.points_of_periods(cut, speeds, float(depths[-1]))
    return limits_at(near_limits.nearest, speeds, crossings, steps)


def _near_limits(cut: CutArrays, speeds: NDArray[np.float64]) -> HeardPoints:
    def heard(
        points: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        return _solved(cut, speeds[points], depth, np.ones(len(points), dtype=np.bool_))

    return HeardPoints(heard)


def _moved_limits(
    limits: LimitCurve, cut: CutArrays, depths: NDArray[np.float64], tolerance: float
) -> LimitCurve:
    """Limits of a finer cut, looked for next to those of a coarser one."""
    speeds = limits.spindle_speed
    near_limits = _near_limits(cut, speeds)
    speed = np.repeat(np.arange(len(speeds)), [found.size for found in limits.crossings])
    reach = min(_LARGEST_REACH, _REACH * limits.error)
    depth = np.concatenate([np.empty(0), *limits.crossings])
    moved = moved_crossings(speed, depth, reach, near_limits.growth, tolerance)
    # what comes or goes with the finer elements is looked for in the whole
    gone = np.unique(speed[np.isnan(moved) | (moved > depths[-1])])
    crossings = [moved[speed == i] for i in range(len(speeds))]
    if gone.size:
        anew = limit_curve(cut, speeds[gone], depths, no_progress, tolerance, 1)
        for i, found in zip(gone.tolist(), anew.crossings, strict=True):
            crossings[i] = found
    steps = drivers.points_of_periods(cut, speeds, float(depths[-1]))
    return limits_at(near_limits.nearest, speeds, crossings, steps)


def converged_limit_curve(
    cut_at: CutAt,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
    tolerance: float = LIMIT_ERROR,
) -> LimitCurve:
    """Limits at every spindle speed, with finer elements until they are good to a tolerance.

    Parameters
    ----------
    cut_at : callable
        Cut at a resolution.
    speeds, depths, progress
        As for `limit_curve`.
    tolerance : float
        On the depths of the limits, relative.

    Returns
    -------
    LimitCurve
        With the estimated error.
    """
    search = _SEARCHED * tolerance
    # shorter periods of a varying speed: what that moves is moved back by finer cuts
    cut = tuned(cut_at(*RESOLUTION), LOOSE_TUNING)
    limits = limit_curve(cut, speeds, depths, progress, search)
    limits = limits._replace(error=_limit_error(limits, cut, cut_at, RESOLUTION))
    for finer in FINER if tolerance < LIMIT_ERROR else FINER[:_DAILY]:
        if limits.error <= tolerance:
            break
        cut = cut_at(*finer)
        limits = _moved_limits(limits, cut, depths, search)
        limits = limits._replace(error=_limit_error(limits, cut, cut_at, finer))
    return limits


def tuned(cut: CutArrays, tuning: float) -> CutArrays:
    """The cut with the frequency of a varying speed moved by no more than a share."""
    return cut._replace(variation=cut.variation._replace(tuning=tuning))


def _rates(
    cut: CutArrays, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Growth at points for each period of the tool, which the period of a cut may hold many of."""
    grown = growth(multipliers(cut, speeds, depths))
    if cut.variation.amplitude == 0.0:
        return grown
    turns = [spindle_turn(cut.variation, float(speed), cut.period_angle) for speed in speeds]
    return grown / np.array([turn.patterns for turn in turns])


def _limit_error(
    limits: LimitCurve, cut: CutArrays, cut_at: CutAt, resolution: tuple[int, float]
) -> float:
    """Largest error of the limit depth, relative, of some limits, by a far finer resolution."""
    found = np.flatnonzero(np.isfinite(limits.critical_depth))
    if found.size == 0:
        return 0.0
    # the slowest speeds have the most waves in a cut: none of them is left out
    picked = found
    if found.size > _CHECKED:
        picked = found[np.unique(np.geomspace(1, found.size, _CHECKED).round().astype(int) - 1)]
    speed, depth = limits.spindle_speed[picked], limits.critical_depth[picked]
    finer = tuned(cut_at(_CHECK[0], _CHECK[1] * resolution[1]), _CHECK_TUNING)
    step = 1e-3 * depth
    left, right = (_rates(cut, speed, depth + s) for s in (-step, step))
    slope = np.maximum(np.abs(right - left) / (2.0 * step), 1e-300)
    # at the limit of the finer cut there would be no growth: what the search leaves counts as well
    left = np.abs(_rates(finer, speed, depth))
    return float(_ALLOWANCE * np.max(left / (slope * depth)))
