"""Matrix-free method: multipliers of any cut from initial functions that are propagated in time.

An initial function is the state of the modes and the motion over the longest delay. It is run
through one period step by step (see `step_assembly`), and the functions that follow one from the
other span the space in which the dominant multiplier is searched: Arnoldi iteration on the solution
operator, as in the implicit subspace iteration of Zatarain and Dombovari 2014, Int. J. Dynam.
Control 2. The steps are those of an integration in time, of order four; nothing is shared with
collocation but the couplings of the edge.
"""

import numpy as np

from chatter.description.arrays import Array, ComplexArray, IntegerArray
from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import sweep
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import (
    PointMethod,
    extrapolated,
    frequency_of_motion,
    growth_rate,
    limit_curve_by,
)
from chatter.stability.methods.matrix_free.drivers import dominant_motion, steps_per_period
from chatter.stability.methods.matrix_free.stepped_cut import CutAt, SteppedCut
from chatter.stability.stability_method import Multiplier

#: steps per wavelength of the fastest vibration
STEPS_PER_WAVELENGTH = 12.0
#: refinements of the steps: plain, or nested ones from which the value is extrapolated
_PLAIN = (1,)
_EXTRAPOLATED = (1, 2)
#: of the error that is removed by extrapolation
_ORDER = 4
#: a correction beyond this share means that two multipliers have changed places
_LARGEST_CORRECTION = 0.05
_MOST_STEPS, _FINEST, _FINEST_SEGMENTS = 100_000, 16, 8
#: limits whose error is estimated
_CHECKED = 12


def multipliers(
    cut: SteppedCut,
    speeds: Array,
    depths: Array,
    progress: Progress = no_progress,
    refinements: tuple[int, ...] = _EXTRAPOLATED,
) -> ComplexArray:
    """Dominant multiplier (n,) over one period at every point, imaginary part >= 0.

    Speeds (n,), rad/s, and depths (n,), m, are point by point. Refinements divide the steps; from
    two the error of fourth order is removed (Richardson). RunError if a period holds too many
    vibrations.
    """
    if len(speeds) == 0:
        return np.empty(0, dtype=np.complex128)

    def at(index: IntegerArray) -> ComplexArray:
        values = [
            np.array([_multiplier(cut, float(speeds[i]), float(depths[i]), r) for i in index])
            for r in refinements
        ]
        if len(values) == 1:
            return values[0]
        coarse, fine = values
        return extrapolated(coarse, fine, _ORDER, _LARGEST_CORRECTION)

    return np.concatenate(sweep(at, len(speeds), progress, points_a_chunk=8))


def _multiplier(cut: SteppedCut, speed: float, depth: float, refinement: int) -> complex:
    _refuse_many_steps(cut, speed, refinement)
    return dominant_motion(cut, speed, depth, STEPS_PER_WAVELENGTH, refinement)[0]


def _steps_per_revolution(cut: SteppedCut, speed: float, refinement: int) -> float:
    return cut.fastest / speed * STEPS_PER_WAVELENGTH * refinement


def _refuse_many_steps(cut: SteppedCut, speed: float, refinement: int) -> None:
    if _steps_per_revolution(cut, speed, refinement) > _MOST_STEPS:
        wavelengths = cut.fastest / speed
        raise RunError(
            f"at {rpm(speed):.4g} rpm a revolution holds {wavelengths:.3g} vibrations, "
            "more than the matrix-free method can step through; raise the lowest spindle speed"
        )


def converged_multiplier(
    cut_at: CutAt, speed: float, depth: float, tolerance: float = 2e-5
) -> Multiplier:
    """Dominant multiplier at one point, its steps halved until the estimated error is small.

    With the steps the edge segments are halved. The estimate is what the extrapolation adds to the
    finer steps, and a third of what the finer segments change: chords of an edge are of second
    order. Speed in rad/s, depth in m; the tolerance is on |mu|, relative to max(1, |mu|).
    """
    refinement, cut = 1, cut_at(1.0)
    coarse = _multiplier(cut, speed, depth, refinement)
    while True:
        before = cut
        if refinement < _FINEST_SEGMENTS:
            cut = cut_at(0.5 / refinement)
        same = _same_segments(cut, before)
        resolved = coarse if same else _multiplier(cut, speed, depth, refinement)
        refinement *= 2
        fine = _multiplier(cut, speed, depth, refinement)
        value = extrapolated(np.array([resolved]), np.array([fine]), _ORDER, _LARGEST_CORRECTION)[0]
        error = abs(abs(value) - abs(fine)) + abs(abs(resolved) - abs(coarse)) / 3.0
        finer = _steps_per_revolution(cut, speed, 2 * refinement)
        finest = refinement >= _FINEST or finer > _MOST_STEPS
        if error <= tolerance * max(1.0, abs(value)) or finest:
            steps = steps_per_period(cut, speed, depth, STEPS_PER_WAVELENGTH, refinement)
            return Multiplier(complex(value), steps, float(error))
        coarse = fine


def chatter_frequency(cut: SteppedCut, speed: float, depth: float) -> float:
    """Chatter frequency (Hz) at a point; see `frequency_of_motion`."""
    _refuse_many_steps(cut, speed, 1)
    value, motion, time = dominant_motion(cut, speed, depth, STEPS_PER_WAVELENGTH, 1)
    span = np.diff(time)
    weight = 0.5 * (span + np.roll(span, 1))
    # the history belongs to a multiplier mu: from one period to the next it grows by it
    elapsed, period = time[:-1] - time[0], float(time[-1] - time[0])
    return frequency_of_motion(value, period, elapsed, motion, weight, cut.arrays.natural_frequency)


def limit_curve(
    cut_at: CutAt, speeds: Array, depths: Array, progress: Progress = no_progress
) -> LimitCurve:
    """Limits of stability at every spindle speed; see `limit_search`.

    `cut_at` gives the cut with edge segments of a relative length; shorter ones only serve to
    estimate the error.
    """
    cut = cut_at(1.0)

    def at(
        index: IntegerArray, depth: Array, refinements: tuple[int, ...], report: Progress
    ) -> ComplexArray:
        return multipliers(cut, speeds[index], depth, report, refinements)

    def frequency(index: int, depth: float) -> float:
        return chatter_frequency(cut, float(speeds[index]), depth)

    max_depth, finer = float(depths[-1]), _EXTRAPOLATED[-1]
    steps = np.array(
        [steps_per_period(cut, float(v), max_depth, STEPS_PER_WAVELENGTH, finer) for v in speeds]
    )
    method = PointMethod(at, _EXTRAPOLATED, frequency)
    limits = limit_curve_by(method, speeds, depths, steps, progress)
    return limits._replace(error=_limit_error(cut, cut_at(0.5), limits))


def _same_segments(cut: SteppedCut, other: SteppedCut) -> bool:
    return cut.arrays.segments.bottom.shape == other.arrays.segments.bottom.shape


def _limit_error(cut: SteppedCut, fine_edges: SteppedCut, limits: LimitCurve) -> float:
    """Largest relative shift of some limits, see `converged_multiplier`.

    By what the extrapolation adds to the finer steps, and by shorter edge segments.
    """
    found = np.flatnonzero(np.isfinite(limits.critical_depth))
    picked = found[:: max(1, found.size // _CHECKED)]
    if not picked.size:
        return 0.0
    speed, depth = limits.spindle_speed[picked], limits.critical_depth[picked]
    at = growth_rate(multipliers(cut, speed, depth))
    finer = growth_rate(multipliers(cut, speed, depth, refinements=_EXTRAPOLATED[1:]))
    off = np.abs(at - finer)
    if not _same_segments(cut, fine_edges):
        # all of it: the limits are those of the longer segments
        coarse, other = (
            growth_rate(multipliers(c, speed, depth, refinements=_PLAIN)) for c in (cut, fine_edges)
        )
        off += np.abs(coarse - other) * 4.0 / 3.0
    slope = (growth_rate(multipliers(cut, speed, 1.001 * depth)) - at) / (1e-3 * depth)
    return float(np.max(off / np.maximum(np.abs(slope) * depth, 1e-300)))
