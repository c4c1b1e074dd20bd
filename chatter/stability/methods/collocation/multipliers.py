"""Collocation on elements: multipliers, limits and chatter frequencies of any cut.

See `element_map`. Unlike semi-discretization it takes any pitch, helix, edge, runout and variation
of the spindle speed, and converges spectrally.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import kept_threads, sweep, worker_count
from chatter.stability.boundary_continuation import followed_crossings
from chatter.stability.brackets import Growth
from chatter.stability.floquet_multiplier import Multiplier
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import HeardPoints, growth, limits_at
from chatter.stability.methods.collocation import drivers
from chatter.stability.methods.collocation.cut_arrays import RESOLUTION, CutArrays
from chatter.stability.methods.collocation.element_assembly import MapArrays, map_arrays
from chatter.stability.methods.collocation.first_use import compile_side_by_side
from chatter.stability.methods.collocation.varying_speed import tool_periods, turns, varies
from chatter.stability.simd_batch import LANES

#: resolutions of a single point, one after the other until two agree
FINER = ((10, 0.7), (12, 0.5), (12, 0.3), (12, 0.15))
#: of a limit, relative to its depth
DEPTH_TOLERANCE = 1e-6
#: vibrations in a period of the tool, all of which a delay may hold, and in one of a varying speed
_MOST_VIBRATIONS, _MOST_OF_VARYING = 1_000, 10_000
#: speeds from one to the next of those at which all depths are looked at
STRIDE = 4
#: points handed to a thread at once, about: many enough to fill the lanes of the kernels; so many
#: that a second thread is worth it
_POINTS_A_CHUNK, _FEW_POINTS = 128, 64
#: the same at a varying speed, where a point takes long: the least, and parts of all for a thread
_FEWEST_POINTS, _PARTS = 16, 4

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
    _refuse_endless(cut, speeds)
    compile_side_by_side(cut)
    order, arrays = _neighbours_together(cut, speeds, depths), map_arrays(cut)
    parts = sweep(
        lambda index: _solved_together(
            cut, arrays, speeds[order[index]], depths[order[index]], listened[order[index]]
        ),
        len(speeds),
        progress,
        _points_a_chunk(cut, len(speeds)),
    )
    multiplier, frequency = np.empty(len(speeds), dtype=np.complex128), np.empty(len(speeds))
    multiplier[order] = np.concatenate([part[0] for part in parts])
    frequency[order] = np.concatenate([part[1] for part in parts])
    return multiplier, frequency


def _refuse_endless(cut: CutArrays, speeds: NDArray[np.float64]) -> None:
    """Raise RunError where a period at one of the speeds (rad/s) holds too many vibrations."""
    hertz = cut.resolution.fastest / (2.0 * math.pi)
    of_tool = hertz * cut.period_angle / float(np.min(speeds))
    slowest = rpm(float(np.min(speeds)))
    if of_tool > _MOST_VIBRATIONS:
        raise RunError(
            f"at {slowest:.4g} rpm the tool takes {of_tool:.3g} vibrations of {hertz:.4g} Hz to "
            f"look the same again; at most {_MOST_VIBRATIONS} can be computed: raise the lowest "
            "spindle speed, or leave out modes that are far too stiff to chatter"
        )
    if not varies(cut):
        return
    longest = float(np.max(hertz * cut.period_angle / speeds * tool_periods(cut, speeds)))
    if longest > _MOST_OF_VARYING:
        raise RunError(
            f"cut.speed_variation.frequency: at {cut.variation.frequency:.4g} Hz the cut takes "
            f"{longest:.3g} vibrations of {hertz:.4g} Hz to repeat itself; at most "
            f"{_MOST_OF_VARYING} can be computed: for so slow a variation take the limits at the "
            "constant speeds that it goes through"
        )


def _points_a_chunk(cut: CutArrays, count: int) -> int:
    """As many for every thread, in full lanes."""
    threads = worker_count()
    if varies(cut):
        return max(_FEWEST_POINTS, math.ceil(count / (_PARTS * threads)))
    parts = threads * max(1, round(count / (threads * _POINTS_A_CHUNK)))
    return max(_FEW_POINTS, LANES * math.ceil(count / (parts * LANES)))


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
    if varies(cut):
        # those of like periods go side by side
        periods = np.array([(turn.patterns, turn.cycles) for turn in turns(cut, speeds)])
        return np.lexsort((speeds, depths, periods[:, 1], periods[:, 0]))
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


def rates(
    cut: CutArrays, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Growth at n points for each period of the tool, which the period of a cut may hold many of.

    Speeds in rad/s, depths in m.
    """
    return growth(multipliers(cut, speeds, depths)) / tool_periods(cut, speeds)


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
    heard = near_limits(cut, speeds)
    growth_at = rates_at(cut, speeds)
    # over the long periods of a varying speed listening costs more than a point does
    refined = growth_at if varies(cut) else heard.growth
    with kept_threads():
        crossings = followed_crossings(
            len(speeds), depths, growth_at, tolerance, stride, progress, refined
        )
        return limits_at(heard.nearest, speeds, crossings, points_of_periods(cut, speeds, depths))


def rates_at(cut: CutArrays, speeds: NDArray[np.float64]) -> Growth:
    """Growth for each period of the tool as the search for limits asks for it.

    Parameters
    ----------
    cut : CutArrays
    speeds : (n,) array of float
        rad/s.
    """

    def growth_at(points: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        return rates(cut, speeds[points], depth)

    return growth_at


def points_of_periods(
    cut: CutArrays, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Collocation points (n,) in a period at n speeds (rad/s) and the last of the depths (m)."""
    return drivers.points_of_periods(cut, speeds, float(depths[-1]))


def near_limits(cut: CutArrays, speeds: NDArray[np.float64]) -> HeardPoints:
    """Points near limits at n speeds (rad/s), multipliers and frequencies with them."""

    def heard(
        points: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        return _solved(cut, speeds[points], depth, np.ones(len(points), dtype=np.bool_))

    return HeardPoints(heard)
