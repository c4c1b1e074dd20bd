"""Semi-discretization of the milling equation: multipliers, limits, chatter frequencies.

First-order semi-discretization (Insperger and Stepan 2004) as in `period_map`. With the number
of steps left open, every value is extrapolated from two nested resolutions, which raises the
order from two to four.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.errors import RunError
from chatter.stability import limit_kernels
from chatter.stability.arrays import MillingArrays
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.sweep import Progress, no_progress, sweep

#: steps per period of the highest relevant mode; the extrapolated error is then near 1e-4
_STEPS_A_PERIOD = 14.0
_FEWEST_STEPS = 40
#: chatter rises above the natural frequency by about this much
_CHATTER_ABOVE_NATURAL = 1.2
#: modes whose resonance peak is below this share of the highest do not set the resolution
_RELEVANT_PEAK = 0.01
_MOST_STEPS = 200_000
#: |Im| below this share of |mu| is a real multiplier
_REAL_SHARE = 1e-6

_PLAIN = np.array([1])
_EXTRAPOLATED = np.array([1, 2])


class Multiplier(NamedTuple):
    """Dominant Floquet multiplier over one tooth period."""

    value: complex
    steps: int  # steps a tooth period of the finest resolution
    error: float  # estimated error of |value|


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
        slowest = float(np.min(speeds)) * 30.0 / math.pi
        raise RunError(
            f"at {slowest:.4g} rpm a tooth period holds {waves.max():.3g} vibrations; that needs "
            f"{steps.max()} steps, more than {_MOST_STEPS}; raise the lowest spindle speed"
        )
    return steps


def _resolution(
    arrays: MillingArrays, speeds: NDArray[np.float64], steps: int | None
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    if steps is None:
        return automatic_steps(arrays, speeds), _EXTRAPOLATED
    return np.full(np.shape(speeds), steps, dtype=np.int64), _PLAIN


def multipliers(
    arrays: MillingArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None = None,
    progress: Progress = no_progress,
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

    Returns
    -------
    (n,) array of complex
        Imaginary part >= 0.
    """
    count, refinements = _resolution(arrays, speeds, steps)

    def chunk(index: NDArray[np.int64]) -> NDArray[np.complex128]:
        return limit_kernels.multipliers_at(
            arrays, speeds[index], depths[index], count[index], refinements
        )

    return np.concatenate(sweep(chunk, len(speeds), progress, points_a_chunk=256))


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
    steps = int(automatic_steps(arrays, point[0])[0])
    value, error = _extrapolated(arrays, point, steps), np.inf
    while 4 * steps <= _MOST_STEPS:
        steps *= 2
        finer = _extrapolated(arrays, point, steps)
        # a fourth-order error falls by 16; the difference bounds the finer one generously
        error = abs(abs(finer) - abs(value))
        value = finer
        if error <= tolerance * max(1.0, abs(value)):
            break
    return Multiplier(value, 2 * steps, float(error))


def _extrapolated(
    arrays: MillingArrays, point: tuple[NDArray[np.float64], NDArray[np.float64]], steps: int
) -> complex:
    count = np.array([steps])
    return complex(limit_kernels.multipliers_at(arrays, *point, count, _EXTRAPOLATED)[0])


def bifurcation_kind(multiplier: complex) -> str:
    """``"flip"`` where the multiplier is real and negative, else ``"hopf"``."""
    is_real = abs(multiplier.imag) <= _REAL_SHARE * abs(multiplier)
    return "flip" if is_real and multiplier.real < 0.0 else "hopf"


def chatter_frequency(arrays: MillingArrays, speed: float, depth: float) -> float:
    """Frequency (Hz) at which the motion of the dominant multiplier is largest.

    A multiplier mu fixes the frequencies (arg mu + 2 pi l)/T only up to the tooth-passing
    frequency; of these the one with the largest amplitude of displacement is what is heard.
    """
    steps = int(automatic_steps(arrays, np.array([speed]))[0])
    tooth_passing = speed / arrays.tooth_pitch
    harmonics = math.ceil(2.0 * arrays.natural_frequency.max() / (2.0 * np.pi) / tooth_passing) + 2
    _, frequency, amplitude = limit_kernels.motion_harmonics(
        arrays, speed, depth, 2 * steps, harmonics
    )
    return float(abs(frequency[np.argmax(amplitude)]))


def limit_curve(
    arrays: MillingArrays,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None = None,
    progress: Progress = no_progress,
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
        Called with (done, total) speeds.

    Returns
    -------
    LimitCurve
    """
    count, refinements = _resolution(arrays, speeds, steps)

    def chunk(index: NDArray[np.int64]) -> list[tuple[NDArray[np.float64], float, str]]:
        found, crossing = limit_kernels.crossings_along_depth(
            arrays, speeds[index], depths, count[index], refinements
        )
        rows = []
        for i, speed in enumerate(speeds[index]):
            depths_here = crossing[i, : found[i]].copy()
            frequency, kind = np.nan, "none"
            if found[i]:
                frequency = chatter_frequency(arrays, float(speed), float(depths_here[0]))
                point = np.array([speed]), depths_here[:1], count[index[i : i + 1]]
                kind = bifurcation_kind(
                    complex(limit_kernels.multipliers_at(arrays, *point, refinements)[0])
                )
            rows.append((depths_here, frequency, kind))
        return rows

    rows = [row for part in sweep(chunk, len(speeds), progress, points_a_chunk=4) for row in part]
    return LimitCurve(
        spindle_speed=speeds,
        critical_depth=np.array([row[0][0] if row[0].size else np.inf for row in rows]),
        chatter_frequency=np.array([row[1] for row in rows]),
        bifurcation=tuple(row[2] for row in rows),
        crossings=tuple(row[0] for row in rows),
        steps=count,
    )
