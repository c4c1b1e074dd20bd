"""Semi-discretization of the milling equation: multipliers, limits, chatter frequencies.

First-order semi-discretization (Insperger and Stepan 2004) as in `period_map`. With the number
of steps left open, every value is extrapolated from two nested resolutions, which raises the
order from two to four.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import sweep
from chatter.stability.arnoldi import dominant_multiplier
from chatter.stability.floquet_multiplier import Multiplier
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import PointMethod, limit_curve_by
from chatter.stability.methods.collocation import drivers
from chatter.stability.methods.semi_discretization.arrays import MillingArrays
from chatter.stability.methods.semi_discretization.monodromy import build_period_map
from chatter.stability.methods.semi_discretization.step_schemes import (
    FirstOrder,
    FullDiscretization,
    SecondOrder,
    ZerothOrder,
)

#: steps per period of the highest relevant mode; the extrapolated error is then near 1e-4
_STEPS_A_PERIOD = 14.0
_FEWEST_STEPS = 40
#: chatter rises above the natural frequency by about this much
_CHATTER_ABOVE_NATURAL = 1.2
#: modes whose resonance peak is below this share of the highest do not set the resolution
_RELEVANT_PEAK = 0.01
_MOST_STEPS = 200_000
Scheme = ZerothOrder | FirstOrder | SecondOrder | FullDiscretization
FIRST_ORDER = FirstOrder()

#: refinements of the steps: plain, or nested ones from which the value is extrapolated
_PLAIN = (1,)
_EXTRAPOLATED = (1, 2)
#: a correction beyond this share means that two multipliers have changed places
_LARGEST_CORRECTION = 0.2


def highest_relevant_frequency(arrays: MillingArrays) -> float:
    """Highest natural frequency (Hz) among modes whose resonance peak matters."""
    w = arrays.natural_frequency
    reach = np.linalg.norm(arrays.shape, axis=1) * np.linalg.norm(arrays.force_gain, axis=1)
    peak = reach / (2.0 * np.maximum(arrays.damping, 1e-6) * w**2)
    return float(w[peak >= _RELEVANT_PEAK * peak.max()].max() / (2.0 * np.pi))


def automatic_steps(arrays: MillingArrays, speeds: NDArray[np.float64]) -> NDArray[np.int64]:
    """Steps a tooth period (n,) that resolve the chatter wave at each speed (rad/s)."""
    period = arrays.tooth_pitch / np.asarray(speeds)
    waves = _CHATTER_ABOVE_NATURAL * highest_relevant_frequency(arrays) * period
    steps = np.maximum(_FEWEST_STEPS, np.ceil(_STEPS_A_PERIOD * waves)).astype(np.int64)
    if steps.max() > _MOST_STEPS:
        slowest = rpm(float(np.min(speeds)))
        raise RunError(
            f"at {slowest:.4g} rpm a tooth period holds {waves.max():.3g} vibrations; that needs "
            f"{steps.max()} steps, more than {_MOST_STEPS}; raise the lowest spindle speed"
        )
    return steps


def _resolution(
    arrays: MillingArrays, speeds: NDArray[np.float64], steps: int | None
) -> tuple[NDArray[np.int64], tuple[int, ...]]:
    """Steps (n,) and refinements: plain where the user fixes the steps, else extrapolated."""
    if steps is None:
        return automatic_steps(arrays, speeds), _EXTRAPOLATED
    return np.full(np.shape(speeds), steps, dtype=np.int64), _PLAIN


def multipliers(
    arrays: MillingArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None = None,
    progress: Progress = no_progress,
    scheme: Scheme = FIRST_ORDER,
) -> NDArray[np.complex128]:
    """Dominant multiplier over one tooth period at every point.

    Parameters
    ----------
    arrays : MillingArrays
    speeds, depths : (n,) array of float
        rad/s and m, point by point.
    steps : int, optional
        Steps a tooth period of plain first-order semi-discretization; by default chosen from
        the natural frequencies, with extrapolation.
    progress : callable, optional
        Called with (done, total).
    scheme : NamedTuple, optional
        Of `step_schemes`.

    Returns
    -------
    (n,) array of complex
        Imaginary part >= 0.
    """
    count, refinements = _resolution(arrays, speeds, steps)
    return _at_points(arrays, speeds, depths, count, refinements, progress, scheme)


def converged_multiplier(
    arrays: MillingArrays, speed: float, depth: float, tolerance: float = 2e-5
) -> Multiplier:
    """Dominant multiplier at one point, refined until its estimated error meets a tolerance.

    Parameters
    ----------
    arrays : MillingArrays
    speed, depth : float
        rad/s, m.
    tolerance : float
        On |mu|, relative to max(1, |mu|).

    Returns
    -------
    Multiplier
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
    """Frequency (Hz) at which the motion of the dominant multiplier is largest.

    A multiplier mu fixes the frequencies (arg mu + 2 pi l)/T only up to the tooth-passing
    frequency; of these the one with the largest amplitude of displacement is what is heard.
    """
    steps = 2 * int(automatic_steps(arrays, np.array([speed]))[0])
    period = build_period_map(arrays, speed, depth, steps, 1, steps)
    value, vector, _ = dominant_multiplier(period)
    real, imag = (
        drivers.motion_over_period(period, np.ascontiguousarray(part))
        for part in (vector.real, vector.imag)
    )
    time = np.concatenate([[0.0], np.cumsum(period.duration)])
    decay = np.exp(-np.log(max(abs(value), 1e-300)) * time / time[-1])
    motion = (real + 1j * imag) * decay[:, None]
    tooth_passing = 1.0 / time[-1]
    highest = 2.0 * arrays.natural_frequency.max() / (2.0 * np.pi)
    harmonic = np.arange(-math.ceil(highest / tooth_passing) - 1, highest / tooth_passing + 2)
    frequency = (np.angle(value) / (2.0 * np.pi) + harmonic) * tooth_passing
    wave = np.exp(-2j * np.pi * frequency[:, None] * time)
    weight = 0.5 * (np.append(period.duration, 0.0) + np.insert(period.duration, 0, 0.0))
    amplitude = np.linalg.norm((wave * weight) @ motion, axis=1)
    return float(abs(frequency[np.argmax(amplitude)]))


def limit_curve(
    arrays: MillingArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None = None,
    progress: Progress = no_progress,
    scheme: Scheme = FIRST_ORDER,
) -> LimitCurve:
    """Limits of stability at every spindle speed.

    Parameters
    ----------
    arrays : MillingArrays
    speeds : (n,) array of float
        rad/s.
    depths : (m,) array of float
        m, ascending, > 0: net on which changes of stability are looked for; an unstable or
        stable stretch that fits between two of its depths is not seen.
    steps : int, optional
        As in `multipliers`.
    progress : callable, optional
        Called with (done, total) points of the net.

    Returns
    -------
    LimitCurve
    """
    count, refinements = _resolution(arrays, speeds, steps)

    def refined(
        index: NDArray[np.int64], depth: NDArray[np.float64], report: Progress
    ) -> NDArray[np.complex128]:
        return _at_points(arrays, speeds[index], depth, count[index], refinements, report, scheme)

    def plain(
        index: NDArray[np.int64], depth: NDArray[np.float64], report: Progress
    ) -> NDArray[np.complex128]:
        return _at_points(arrays, speeds[index], depth, count[index], _PLAIN, report, scheme)

    def heard(
        index: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        def some(places: NDArray[np.int64]) -> list[float]:
            return [chatter_frequency(arrays, float(speeds[index[i]]), depth[i]) for i in places]

        parts = sweep(some, len(index), points_a_chunk=8)
        frequencies = np.array([value for part in parts for value in part])
        return refined(index, depth, no_progress), frequencies

    method = PointMethod(plain, refined if len(refinements) > 1 else plain, heard)
    return limit_curve_by(method, speeds, depths, count, progress)


def _at_points(
    arrays: MillingArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: NDArray[np.int64],
    refinements: tuple[int, ...],
    progress: Progress = no_progress,
    scheme: Scheme = FIRST_ORDER,
) -> NDArray[np.complex128]:
    """Dominant multipliers (n,) at n points, in parallel threads.

    From two refinements the second-order error is removed (Richardson).
    """
    if len(speeds) == 0:
        return np.empty(0, dtype=np.complex128)

    def chunk(index: NDArray[np.int64]) -> NDArray[np.complex128]:
        points = speeds[index], depths[index], steps[index]
        if scheme is FIRST_ORDER:
            values = [drivers.multipliers_at(arrays, *points, r) for r in refinements]
        else:
            values = [drivers.multipliers_by(scheme, arrays, *points, r) for r in refinements]
        return values[0] if len(values) == 1 else _extrapolated(*values, refinements)

    return np.concatenate(sweep(chunk, len(speeds), progress))


def _extrapolated(
    coarse: NDArray[np.complex128], fine: NDArray[np.complex128], refinements: tuple[int, ...]
) -> NDArray[np.complex128]:
    ratio = (refinements[1] / refinements[0]) ** 2
    correction = (fine - coarse) / (ratio - 1.0)
    correction[np.abs(correction) > _LARGEST_CORRECTION * np.abs(fine)] = 0.0
    value = fine + correction
    return value.real + 1j * np.abs(value.imag)
