"""Semi-discretization of the milling equation: multipliers, limits, chatter frequencies.

First-order semi-discretization (Insperger and Stepan 2004) as in `monodromy`. With the number
of steps left open, every value is extrapolated from two nested resolutions, which raises the
order from two to four.
"""

import numpy as np

from chatter.description.arrays import Array, ComplexArray, IntegerArray
from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import sweep
from chatter.stability.cut_arrays import CHATTER_ABOVE_NATURAL, relevant_frequency
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import (
    PointMethod,
    extrapolated,
    frequency_of_motion,
    limit_curve_by,
)
from chatter.stability.methods.semi_discretization import drivers
from chatter.stability.methods.semi_discretization.arrays import MillingArrays
from chatter.stability.methods.semi_discretization.step_schemes import FIRST_ORDER, Scheme
from chatter.stability.stability_method import Multiplier

#: steps per period of the highest relevant mode; the extrapolated error is then near 1e-4
_STEPS_PER_PERIOD = 14.0
_FEWEST_STEPS = 40
_MOST_STEPS = 200_000

#: refinements of the steps: plain, or nested ones from which the value is extrapolated
_PLAIN = (1,)
_EXTRAPOLATED = (1, 2)
#: a correction beyond this share means that two multipliers have changed places
_LARGEST_CORRECTION = 0.2
#: of the error that is removed by extrapolation
_ORDER = 2


def automatic_steps(arrays: MillingArrays, speeds: Array) -> IntegerArray:
    """Steps per tooth period (n,) that resolve the chatter wavelength at each speed (rad/s)."""
    period = arrays.tooth_pitch / np.asarray(speeds)
    fastest = CHATTER_ABOVE_NATURAL * relevant_frequency(*arrays[:4])
    wavelengths = fastest / (2.0 * np.pi) * period
    steps = np.maximum(_FEWEST_STEPS, np.ceil(_STEPS_PER_PERIOD * wavelengths)).astype(np.int64)
    if steps.max() > _MOST_STEPS:
        slowest = rpm(float(np.min(speeds)))
        raise RunError(
            f"at {slowest:.4g} rpm a tooth period holds {wavelengths.max():.3g} vibrations; that "
            f"needs {steps.max()} steps, more than {_MOST_STEPS}; raise the lowest spindle speed"
        )
    return steps


def _resolution(
    arrays: MillingArrays, speeds: Array, steps: int | None
) -> tuple[IntegerArray, tuple[int, ...]]:
    """Steps (n,) and refinements: plain where the user fixes the steps, else extrapolated."""
    if steps is None:
        return automatic_steps(arrays, speeds), _EXTRAPOLATED
    return np.full(np.shape(speeds), steps, dtype=np.int64), _PLAIN


def multipliers(
    arrays: MillingArrays,
    speeds: Array,
    depths: Array,
    steps: int | None = None,
    progress: Progress = no_progress,
    scheme: Scheme = FIRST_ORDER,
) -> ComplexArray:
    """Dominant multiplier (n,) over one tooth period at every point, imaginary part >= 0.

    Speeds (n,), rad/s, and depths (n,), m, are point by point. Steps per tooth period are those of
    plain first-order semi-discretization; by default chosen from the natural frequencies, with
    extrapolation. The scheme is one of `step_schemes`.
    """
    count, refinements = _resolution(arrays, speeds, steps)
    return _at_points(arrays, speeds, depths, count, refinements, progress, scheme)


def converged_multiplier(
    arrays: MillingArrays, speed: float, depth: float, tolerance: float = 2e-5
) -> Multiplier:
    """Dominant multiplier at one point, refined until its estimated error meets a tolerance.

    Speed in rad/s, depth in m; the tolerance is on |mu|, relative to max(1, |mu|).
    """
    point = np.array([speed]), np.array([depth])
    # the first value is there to be compared with: it may be coarser than what is needed
    steps = np.maximum(_FEWEST_STEPS, automatic_steps(arrays, point[0]) // 2)
    value, error = complex(_at_points(arrays, *point, steps, _EXTRAPOLATED)[0]), np.inf
    while 4 * steps[0] <= _MOST_STEPS:
        steps = 2 * steps
        finer = complex(_at_points(arrays, *point, steps, _EXTRAPOLATED)[0])
        # a fourth-order error falls by 16; the difference bounds the finer one generously
        error = abs(abs(finer) - abs(value))
        value = finer
        if error <= tolerance * max(1.0, abs(value)):
            break
    return Multiplier(value, 2 * int(steps[0]), float(error))


def chatter_frequency(arrays: MillingArrays, speed: float, depth: float) -> float:
    """Chatter frequency (Hz) at a point; see `frequency_of_motion`."""
    point = np.array([speed]), np.array([depth])
    steps = 2 * automatic_steps(arrays, point[0])
    value, motion, duration = drivers.multipliers_at(FIRST_ORDER, arrays, *point, steps, 1, steps)
    time = np.concatenate([[0.0], np.cumsum(duration)])
    weight = 0.5 * (np.append(duration, 0.0) + np.insert(duration, 0, 0.0))
    return frequency_of_motion(
        complex(value[0]), float(time[-1]), time, motion, weight, arrays.natural_frequency
    )


def limit_curve(
    arrays: MillingArrays,
    speeds: Array,
    depths: Array,
    steps: int | None = None,
    progress: Progress = no_progress,
    scheme: Scheme = FIRST_ORDER,
) -> LimitCurve:
    """Limits of stability at every spindle speed (rad/s), searched on a grid of depths (m).

    See `limit_curve_by`; `steps` and `scheme` are as in `multipliers`.
    """
    count, refinements = _resolution(arrays, speeds, steps)

    def at(
        index: IntegerArray, depth: Array, refinements: tuple[int, ...], report: Progress
    ) -> ComplexArray:
        return _at_points(arrays, speeds[index], depth, count[index], refinements, report, scheme)

    def frequency(index: int, depth: float) -> float:
        return chatter_frequency(arrays, float(speeds[index]), depth)

    method = PointMethod(at, refinements, frequency)
    return limit_curve_by(method, speeds, depths, count, progress)


def _at_points(
    arrays: MillingArrays,
    speeds: Array,
    depths: Array,
    steps: IntegerArray,
    refinements: tuple[int, ...],
    progress: Progress = no_progress,
    scheme: Scheme = FIRST_ORDER,
) -> ComplexArray:
    """Dominant multipliers (n,) at n points, in parallel threads.

    From two refinements the second-order error is removed (Richardson).
    """
    if len(speeds) == 0:
        return np.empty(0, dtype=np.complex128)

    def chunk(index: IntegerArray) -> ComplexArray:
        points = speeds[index], depths[index], steps[index]
        once = np.ones_like(index)
        values = [drivers.multipliers_at(scheme, arrays, *points, r, once)[0] for r in refinements]
        if len(values) == 1:
            return values[0]
        coarse, fine = values
        return extrapolated(coarse, fine, _ORDER, _LARGEST_CORRECTION)

    return np.concatenate(sweep(chunk, len(speeds), progress))
