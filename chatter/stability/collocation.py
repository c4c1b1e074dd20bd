"""Collocation on elements: multipliers, limits and chatter frequencies of any cut.

See `element_map`. Unlike semi-discretization it takes any pitch, helix, edge, runout and variation
of the spindle speed, and converges spectrally.
"""

from __future__ import annotations

import math
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
#: harmonics looked at for the chatter frequency, beyond the highest mode by this factor
_HIGHEST = 2.0

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
    parts = sweep(
        lambda index: drivers.element_multipliers(cut, speeds[index], depths[index]),
        len(speeds),
        progress,
    )
    return np.concatenate(parts)


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
    steps = int(drivers.points_a_period(cut, speed, depth))
    return Multiplier(value, steps, float(error))


def chatter_frequency(cut: CutArrays, speed: float, depth: float) -> float:
    """Frequency (Hz) at which the motion of the dominant multiplier is largest.

    The force of the dominant motion, taken apart into exp((sigma + i omega_l) t) over the period,
    drives the structure at each omega_l; the frequency with the largest displacement is heard.
    """
    value, time, weight, force, period = drivers.dominant_force(cut, speed, depth)
    base = np.log(complex(value) if value != 0.0 else 1e-300) / period
    highest = _HIGHEST * float(cut.natural_frequency.max())
    line = 2.0 * np.pi / period
    harmonic = np.arange(-math.ceil(highest / line) - 1, math.ceil(highest / line) + 2)
    s = base + 1j * line * harmonic
    spectrum = np.exp(-np.outer(s, time)) @ (weight[:, None] * force)
    w, zeta = cut.natural_frequency, cut.damping
    modal = (spectrum @ cut.force_gain.T) / (s[:, None] ** 2 + 2.0 * zeta * w * s[:, None] + w**2)
    amplitude = np.linalg.norm(modal @ cut.shape, axis=1)
    return float(abs(s[np.argmax(amplitude)].imag)) / (2.0 * np.pi)


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
