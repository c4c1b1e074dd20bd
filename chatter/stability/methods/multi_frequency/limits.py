"""Limits over spindle speed by the multi-frequency solution."""

from collections.abc import Callable

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import each
from chatter.stability.crossings import find_crossings
from chatter.stability.cut_arrays import CutArrays
from chatter.stability.limit_curve import LimitCurve, limits_at
from chatter.stability.methods.multi_frequency.determinant import (
    FINEST_STEP,
    FrequencyResponse,
    chatter_frequency,
    unstable_roots,
)
from chatter.stability.methods.multi_frequency.harmonics import Harmonics, harmonics_at

#: harmonics reach this far beyond the highest resonance
_REACH = 4.0
_FEWEST, _MOST = 3, 60
#: or no less than this far where so many are not enough: limits are then good to 0.2 %
_LEAST_REACH = 1.0
#: the receptance changes by no more than this share of itself from one frequency to the next; what
#: it is below the other share of its peak does not count
_LARGEST_CHANGE, _BELOW_PEAK = 0.5, 0.02
#: a limit is found when its bracket is this small, relative to the depth
_DEPTH_TOLERANCE = 1e-4
#: of the frequency of the period: a root so close to half of it is a flip
_FLIP = 1e-3


def harmonic_counts(highest: float, period_angle: float, speeds: Array) -> IntegerArray:
    """Harmonics on either side (n,) that reach beyond the highest resonance (rad/s).

    RunError is raised if they cannot at a speed.
    """
    base = 2.0 * np.pi / period_angle * np.asarray(speeds)
    slowest = float(base.min())
    if _LEAST_REACH * highest > _MOST * slowest:
        raise RunError(
            f"at {rpm(float(np.min(speeds))):.4g} rpm the cut repeats itself "
            f"{slowest / (2.0 * np.pi):.3g} times a second and modes reach up to "
            f"{highest / (2.0 * np.pi):.4g} Hz; the {_MOST} harmonics of the multi-frequency "
            'solution do not: raise the lowest spindle speed, or take "collocation"'
        )
    return np.clip(np.ceil(_REACH * highest / base), _FEWEST, _MOST).astype(np.int64)


def _changing_lines(response: FrequencyResponse) -> Array:
    """Lines, rad/s, between which the receptance changes by no more than a share of itself."""
    flat = response.receptance.reshape(response.omega.size, -1)
    size = np.linalg.norm(flat, axis=1)
    counted = np.maximum(np.minimum(size[1:], size[:-1]), _BELOW_PEAK * size.max())
    change = np.linalg.norm(np.diff(flat, axis=0), axis=1) / (_LARGEST_CHANGE * counted)
    passed = np.floor(np.append(0.0, np.cumsum(change)))
    return response.omega[np.flatnonzero(np.diff(passed) > 0.0)]


def frequency_marks(lines: Array, base: float) -> Array:
    """Frequencies w in 0 .. base/2, ascending, at which some w + l base is one of the lines.

    A resonance far narrower than the base would else be stepped over: the determinant turns there
    and back.
    """
    folded = np.sort(np.abs(lines - base * np.round(lines / base)))
    return folded[np.append(True, np.diff(folded) > FINEST_STEP * base)] if folded.size else folded


def limit_curve(
    cut_at: Callable[[float], CutArrays],
    response: FrequencyResponse,
    speeds: Array,
    depths: Array,
    progress: Progress = no_progress,
) -> LimitCurve:
    """Limits of stability at every spindle speed (rad/s), searched on a grid of depths (m).

    `cut_at` gives the cut for a depth, m, at a constant speed; of its modes only the highest
    frequency is used. `progress` is
    called with (done, total) depths of the grid. RunError is raised if the harmonics do not reach
    up to the highest mode; see `harmonic_counts`.
    """
    cut = cut_at(float(depths[-1]))
    counts = harmonic_counts(cut.fastest, cut.period_angle, speeds)
    orders = 2 * int(counts.max()) + 1
    base = 2.0 * np.pi / cut.period_angle * speeds
    lines = _changing_lines(response)
    marks = [frequency_marks(lines, float(b)) for b in base]

    def at_one_depth(depth: float) -> Harmonics:
        return harmonics_at(cut_at(depth), depth, orders)

    def at(speed: int, harmonics: Harmonics) -> tuple:
        # the coefficients of the orders that this speed needs
        count = int(counts[speed])
        own = _up_to(harmonics, 2 * count + 1)
        return response, own, speeds[speed], base[speed], count, marks[speed]

    def side(speed: int, harmonics: Harmonics) -> float:
        return 1.0 if unstable_roots(*at(speed, harmonics)) > 0 else -1.0

    def at_depth(row: int) -> list[float]:
        harmonics = at_one_depth(float(depths[row]))
        return [side(speed, harmonics) for speed in range(len(speeds))]

    # the coefficients of one depth at a time: a tool of many delays has a good many of them
    grid = np.array(each(at_depth, len(depths), progress)).T

    def sides(index: IntegerArray, depth: Array) -> Array:
        def at(point: int) -> float:
            if depth[point] == 0.0:
                return -1.0
            return side(int(index[point]), at_one_depth(float(depth[point])))

        return np.array(each(at, len(index), points_a_chunk=4))

    def at_limits(index: IntegerArray, depth: Array) -> tuple[list[str], Array]:
        found = [
            chatter_frequency(*at(int(i), at_one_depth(float(d))))
            for i, d in zip(index, depth, strict=True)
        ]
        kinds = ["flip" if share > 0.5 - _FLIP else "hopf" for _, share in found]
        return kinds, np.array([omega for omega, _ in found]) / (2.0 * np.pi)

    crossings = find_crossings(grid, depths, sides, _DEPTH_TOLERANCE)
    return limits_at(at_limits, speeds, crossings, counts)


def _up_to(harmonics: Harmonics, orders: int) -> Harmonics:
    """Coefficients of orders -K .. K alone."""
    middle = (harmonics.dashpot.shape[0] - 1) // 2
    kept = slice(middle - orders, middle + orders + 1)
    return Harmonics(
        harmonics.delay,
        np.ascontiguousarray(harmonics.stiffness[:, kept]),
        np.ascontiguousarray(harmonics.dashpot[kept]),
        harmonics.stiffening,
    )
