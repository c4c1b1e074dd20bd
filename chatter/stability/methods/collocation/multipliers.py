"""Collocation on elements: multipliers, limits and chatter frequencies of any cut.

See `monodromy`. Unlike semi-discretization it takes any pitch, helix, edge, runout and variation of
the spindle speed, and converges spectrally.
"""

import math

import numpy as np

from chatter.description.arrays import Array, BooleanArray, ComplexArray, IntegerArray
from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import kept_threads, sweep, worker_count
from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.brackets import GrowthRate
from chatter.stability.limit_curve import LimitCurve, limits_at
from chatter.stability.limit_search import EvaluatedPoints, growth_rate
from chatter.stability.methods.collocation import drivers
from chatter.stability.methods.collocation.coupling_assembly import coupling_assemblies
from chatter.stability.methods.collocation.element_assembly import OperatorArrays, operator_arrays
from chatter.stability.methods.collocation.element_cut import RESOLUTION, CutAt, ElementCut
from chatter.stability.methods.collocation.first_use import compile_side_by_side
from chatter.stability.methods.collocation.varying_speed import periods, tool_periods, varies
from chatter.stability.simd_batch import BATCH_SIZE
from chatter.stability.stability_method import Multiplier

#: resolutions of a single point, one after the other until two agree
FINER = ((10, 0.7), (12, 0.5), (12, 0.3), (12, 0.15))
#: multiplier from which on the cut chatters beyond doubt
_BEYOND_DOUBT = 1e3
#: of a limit, relative to its depth
DEPTH_TOLERANCE = 1e-6
#: vibrations in a period of the tool, all of which a delay may hold, and in one of a varying speed
_MOST_VIBRATIONS, _MOST_OF_VARYING = 1_000, 10_000
#: speeds from one to the next of those at which all depths are evaluated
STRIDE = 4
#: points handed to a thread at once, about: many enough to fill the SIMD batches of the kernels; so
#: many that a second thread is worth it
_CHUNK_SIZE, _FEW_POINTS = 128, 64
#: the same at a varying speed, where a point takes long: the least, and parts of all for a thread
_FEWEST_POINTS, _PARTS = 16, 4


def multipliers(
    cut: ElementCut, speeds: Array, depths: Array, progress: Progress = no_progress
) -> ComplexArray:
    """Dominant multiplier (n,) over one period at every point, imaginary part >= 0.

    Speeds (n,), rad/s, and depths (n,), m, are point by point.
    """
    return _solved(cut, speeds, depths, np.zeros(len(speeds), dtype=np.bool_), progress)[0]


def _solved(
    cut: ElementCut,
    speeds: Array,
    depths: Array,
    frequency_wanted: BooleanArray,
    progress: Progress = no_progress,
) -> tuple[ComplexArray, Array]:
    """Multipliers, and chatter frequencies (Hz) where they are required, nan elsewhere."""
    if len(speeds) == 0:
        return np.empty(0, dtype=np.complex128), np.empty(0)
    _refuse_endless(cut, speeds)
    compile_side_by_side(cut)
    order, arrays = _neighbours_together(cut, speeds, depths), operator_arrays(cut)
    parts = sweep(
        lambda index: _solved_together(
            cut, arrays, speeds[order[index]], depths[order[index]], frequency_wanted[order[index]]
        ),
        len(speeds),
        progress,
        _chunk_size(cut, len(speeds)),
    )
    multiplier, frequency = np.empty(len(speeds), dtype=np.complex128), np.empty(len(speeds))
    multiplier[order] = np.concatenate([part[0] for part in parts])
    frequency[order] = np.concatenate([part[1] for part in parts])
    return multiplier, frequency


def _refuse_endless(cut: ElementCut, speeds: Array) -> None:
    """Raise RunError where a period at one of the speeds (rad/s) holds too many vibrations."""
    hertz = cut.arrays.fastest / (2.0 * math.pi)
    of_tool = hertz * cut.arrays.period_angle / float(np.min(speeds))
    slowest = rpm(float(np.min(speeds)))
    if of_tool > _MOST_VIBRATIONS:
        raise RunError(
            f"at {slowest:.4g} rpm the tool takes {of_tool:.3g} vibrations of {hertz:.4g} Hz to "
            f"repeat itself; at most {_MOST_VIBRATIONS} can be computed: raise the lowest spindle "
            "speed, or leave out modes that are far too stiff to chatter"
        )
    if not varies(cut):
        return
    longest = float(np.max(hertz * cut.arrays.period_angle / speeds * tool_periods(cut, speeds)))
    if longest > _MOST_OF_VARYING:
        raise RunError(
            f"cut.speed_variation.frequency: at {cut.arrays.variation.frequency:.4g} Hz the cut "
            f"takes {longest:.3g} vibrations of {hertz:.4g} Hz to repeat itself; at most "
            f"{_MOST_OF_VARYING} can be computed: for so slow a variation take the limits at the "
            "constant speeds that it goes through"
        )


def _chunk_size(cut: ElementCut, count: int) -> int:
    """As many for every thread, in full SIMD batches."""
    threads = worker_count()
    if varies(cut):
        return max(_FEWEST_POINTS, math.ceil(count / (_PARTS * threads)))
    parts = threads * max(1, round(count / (threads * _CHUNK_SIZE)))
    return max(_FEW_POINTS, BATCH_SIZE * math.ceil(count / (parts * BATCH_SIZE)))


def _solved_together(
    cut: ElementCut,
    arrays: OperatorArrays,
    speeds: Array,
    depths: Array,
    frequency_wanted: BooleanArray,
) -> tuple[ComplexArray, Array]:
    assemblies = coupling_assemblies(cut, speeds, depths)
    return drivers.element_multipliers(arrays, assemblies, speeds, frequency_wanted)


def _neighbours_together(cut: ElementCut, speeds: Array, depths: Array) -> IntegerArray:
    """Order of the points in which those follow each other that can share work."""
    # at one depth much is shared, at neighbouring speeds most of it
    _, row, count = np.unique(depths, return_inverse=True, return_counts=True)
    rows = np.where(count[row] > 1, depths, 0.0)
    if not varies(cut):
        return np.lexsort((speeds, rows))
    # those of like periods go side by side
    patterns, cycles = periods(cut, speeds)
    return np.lexsort((speeds, rows, cycles, patterns))


def converged_multiplier(
    cut_at: CutAt, speed: float, depth: float, tolerance: float = 2e-5
) -> Multiplier:
    """Dominant multiplier at one point, refined until two resolutions agree.

    Speed in rad/s, depth in m; the tolerance is on |mu|, relative to max(1, |mu|). Where both are
    far beyond 1 the second is taken, whatever its error.
    """
    point = np.array([speed]), np.array([depth])
    cut = cut_at(*RESOLUTION)
    value, error = complex(multipliers(cut, *point)[0]), np.inf
    for finer in FINER:
        cut = cut_at(*finer)
        better = complex(multipliers(cut, *point)[0])
        error = abs(abs(better) - abs(value))
        beyond = min(abs(value), abs(better)) > _BEYOND_DOUBT
        value = better
        if error <= tolerance * max(1.0, abs(value)) or beyond:
            break
    steps = int(drivers.points_of_periods(cut, point[0], depth)[0])
    return Multiplier(value, steps, float(error))


def growth_rate_at(cut: ElementCut, speeds: Array, depths: Array) -> Array:
    """Growth rate at n points per period of the tool, many of which the cut's period may hold.

    Speeds in rad/s, depths in m.
    """
    return growth_rate(multipliers(cut, speeds, depths)) / tool_periods(cut, speeds)


def chatter_frequency(cut: ElementCut, speed: float, depth: float) -> float:
    """Frequency (Hz) at which the motion of the dominant multiplier is largest, at a point."""
    return float(chatter_frequencies(cut, np.array([speed]), np.array([depth]))[0])


def chatter_frequencies(cut: ElementCut, speeds: Array, depths: Array) -> Array:
    """The same (n,) at points of speed, rad/s, and depth, m."""
    return _solved(cut, speeds, depths, np.ones(len(speeds), dtype=np.bool_))[1]


def limit_curve(
    cut: ElementCut,
    speeds: Array,
    depths: Array,
    progress: Progress = no_progress,
    tolerance: float = DEPTH_TOLERANCE,
    stride: int = STRIDE,
) -> LimitCurve:
    """Limits of stability at every spindle speed, by boundary continuation.

    Speeds (n,), rad/s, ascend; changes of stability are searched on the depths (m,), m, all of
    which are evaluated at every `stride` speeds, a power of two; see `boundary_continuation` for
    what may be missed between them. The tolerance of a limit is relative to its depth; progress
    counts speeds.
    """
    evaluated = evaluated_points(cut, speeds)
    growth_rate_here = growth_rate_of(cut, speeds)
    # over the long periods of a varying speed the frequency costs more than a multiplier
    refined = growth_rate_here if varies(cut) else evaluated.growth_rate
    with kept_threads():
        crossings = continued_crossings(
            len(speeds), depths, growth_rate_here, tolerance, stride, progress, refined
        )
        steps = points_of_periods(cut, speeds, depths)
        return limits_at(evaluated.at_limits, speeds, crossings, steps)


def growth_rate_of(cut: ElementCut, speeds: Array) -> GrowthRate:
    """Growth rate per period of the tool at speeds (rad/s), as the search for limits asks."""

    def growth_rate_here(points: IntegerArray, depth: Array) -> Array:
        return growth_rate_at(cut, speeds[points], depth)

    return growth_rate_here


def points_of_periods(cut: ElementCut, speeds: Array, depths: Array) -> IntegerArray:
    """Collocation points (n,) in a period at n speeds (rad/s) and the last of the depths (m)."""
    return drivers.points_of_periods(cut, speeds, float(depths[-1]))


def evaluated_points(cut: ElementCut, speeds: Array) -> EvaluatedPoints:
    """Points near limits at n speeds (rad/s), with multipliers and frequencies."""

    def evaluate(points: IntegerArray, depth: Array) -> tuple[ComplexArray, Array]:
        return _solved(cut, speeds[points], depth, np.ones(len(points), dtype=np.bool_))

    return EvaluatedPoints(evaluate)
