"""Directional matrix of milling and its exact averages in angle and along the helix.

A small motion d of the tool changes the force on it by ``dF = -b H(phi) d``; for one tooth

    H(phi) = -t(phi) n(phi)^T,   n = (sin phi, cos phi, 0),
    t = k_t (-cos phi, sin phi, 0) + k_r (-sin phi, -cos phi, 0) + k_a (0, 0, 1)

(Altintas and Budak 1995, eq. 8; Insperger and Stepan 2011, eq. 5.20). H is tabulated over the
engaged arc with its first and second integral in phi, so that the mean over a time step and over
the lagging edge of a helix is a difference of table values, without slices.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import ArrayLike, NDArray

from cutting.engagement.immersion import Engagement
from cutting.force.law import ForceLaw
from cutting.process_damping.viscous import ViscousProcessDamping

#: below this lag (rad) the edge is taken as straight at half its lag: error of lag^2/24
_STRAIGHT_LAG = 1e-3

_QUADRATURE_NODES, _QUADRATURE_WEIGHTS = np.polynomial.legendre.leggauss(8)

Slope = Callable[[NDArray[np.float64]], NDArray[np.float64]]


class DirectionalTable(NamedTuple):
    """Directional matrix over the engaged arc, projected on r directions of motion.

    Nodes lie at ``entry + arc (1 - cos(pi k/K))/2``: dense at entry and exit, where the slope of
    a size-effect law is steep. The first axis counts the coupling: 0 to displacement and, where
    process damping is present, 1 to velocity (to be divided by the cutting speed).
    """

    entry: float  # rad
    exit: float  # rad
    angle: NDArray[np.float64]  # rad, (K+1,)
    matrix: NDArray[np.float64]  # N/m^2 (displacement) or N/m (velocity), (c, K+1, r, r)
    first_integral: NDArray[np.float64]  # the same times rad, (c, K+1, r, r)
    second_integral: NDArray[np.float64]  # the same times rad^2, (c, K+1, r, r)


def directional_matrix(
    angle: NDArray[np.float64], tangential: ArrayLike, radial: ArrayLike, axial: ArrayLike
) -> NDArray[np.float64]:
    """H(phi) of one tooth, so that dF = -b H d.

    (n, 3, 3) at angles (n,), rad, clockwise from +y, by the slopes of the force per edge length and
    radial motion, N/m^2 (or per velocity), (n,) or one for all.
    """
    force, normal = _force_and_normal(angle, tangential, radial, axial)
    return force[:, :, None] * normal[:, None, :]


def _force_and_normal(
    angle: NDArray[np.float64], tangential: ArrayLike, radial: ArrayLike, axial: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Vectors (n, 3) whose outer product is the directional matrix."""
    s, c = np.sin(angle), np.cos(angle)
    zero = np.zeros_like(s)
    kt, kr, ka = (np.asarray(k, dtype=np.float64) for k in (tangential, radial, axial))
    force = np.stack([kt * c + kr * s, -kt * s + kr * c, zero - ka], -1)
    return force, np.stack([s, c, zero], -1)


def directional_table(
    arc: Engagement,
    law: ForceLaw,
    feed_per_tooth: float,
    directions: NDArray[np.float64],
    damping: ViscousProcessDamping | None = None,
    share: Slope | None = None,
    intervals: int = 1024,
) -> DirectionalTable:
    """Tabulate the directional matrix and its integrals over the engaged arc.

    The slope of the law is taken at the static chip thickness f_t sin(phi), feed in m; directions
    (3, r) are orthonormal columns that span the motion of the tool point; damping adds the coupling
    to velocity, of which a share acts at each angle, all by default.
    """

    def cutting_coupling(angle: NDArray[np.float64]) -> NDArray[np.float64]:
        # the static chip vanishes at phi = 0 and pi, where a size-effect slope has no value
        chip = np.maximum(feed_per_tooth * np.sin(angle), 1e-9 * feed_per_tooth)
        return _projected(angle, law.slope(chip), directions)

    def damping_coupling(angle: NDArray[np.float64]) -> NDArray[np.float64]:
        constants = np.asarray(damping.force_per_radial_velocity)
        acting = np.ones_like(angle) if share is None else share(angle)
        return _projected(angle, np.outer(constants, acting), directions)

    couplings = [cutting_coupling] + ([damping_coupling] if damping is not None else [])
    cosine = np.cos(np.pi * np.arange(intervals + 1) / intervals)
    angle = arc.entry + 0.5 * (arc.exit - arc.entry) * (1.0 - cosine)
    tables = [_integrals(coupling, angle) for coupling in couplings]
    matrix, first, second = (np.stack(part) for part in zip(*tables, strict=True))
    return DirectionalTable(arc.entry, arc.exit, angle, matrix, first, second)


def _projected(
    angle: NDArray[np.float64], slope: NDArray[np.float64], directions: NDArray[np.float64]
) -> NDArray[np.float64]:
    force, normal = (part @ directions for part in _force_and_normal(angle, *slope))
    return force[:, :, None] * normal[:, None, :]


def _integrals(
    coupling: Slope, angle: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the function at the nodes, its integral from entry, and the integral of that."""
    width = np.diff(angle)
    rank = coupling(angle[:1]).shape[-1]
    step_first = np.zeros((width.size, rank, rank))
    step_second = np.zeros((width.size, rank, rank))
    for node, weight in zip(_QUADRATURE_NODES, _QUADRATURE_WEIGHTS, strict=True):
        inside = angle[:-1] + 0.5 * (1.0 + node) * width
        value = coupling(inside)
        step_first += (0.5 * weight * width)[:, None, None] * value
        step_second += (0.5 * weight * width * (angle[1:] - inside))[:, None, None] * value
    zero = np.zeros((1, rank, rank))
    first = np.concatenate([zero, np.cumsum(step_first, axis=0)])
    step_second += width[:, None, None] * first[:-1]
    second = np.concatenate([zero, np.cumsum(step_second, axis=0)])
    return coupling(angle), first, second


@register_jitable
def _node_below(table, angle):
    """Index of the interval that holds the angle (inside the arc)."""
    intervals = table.angle.shape[0] - 1
    ratio = (angle - table.entry) / (table.exit - table.entry)
    ratio = min(max(ratio, 0.0), 1.0)
    k = int(math.acos(1.0 - 2.0 * ratio) / math.pi * intervals)
    return min(max(k, 0), intervals - 1)


@register_jitable
def _add_interpolated(table, values, slopes, angle, factor, out):
    """Add factor times a tabulated function (cubic Hermite inside the arc) to out (c, r, r)."""
    k = _node_below(table, angle)
    width = table.angle[k + 1] - table.angle[k]
    t = (angle - table.angle[k]) / width
    left = factor * (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t)
    right = factor * t * t * (3.0 - 2.0 * t)
    left_slope = factor * width * t * (1.0 - t) * (1.0 - t)
    right_slope = -factor * width * t * t * (1.0 - t)
    couplings, _, rank, _ = values.shape
    for c in range(couplings):
        for i in range(rank):
            for j in range(rank):
                out[c, i, j] += (
                    left * values[c, k, i, j]
                    + right * values[c, k + 1, i, j]
                    + left_slope * slopes[c, k, i, j]
                    + right_slope * slopes[c, k + 1, i, j]
                )


@register_jitable
def _add_last(values, factor, out):
    """Add factor times the value at the exit to out (c, r, r)."""
    couplings, nodes, rank, _ = values.shape
    for c in range(couplings):
        for i in range(rank):
            for j in range(rank):
                out[c, i, j] += factor * values[c, nodes - 1, i, j]


@register_jitable
def _add_first_integral(table, angle, factor, out):
    """Add factor times the integral of H from entry to the angle."""
    if angle <= table.entry:
        return
    if angle >= table.exit:
        _add_last(table.first_integral, factor, out)
    else:
        _add_interpolated(table, table.first_integral, table.matrix, angle, factor, out)


@register_jitable
def _add_second_integral(table, angle, factor, out):
    """Add factor times the second integral of H; past the exit it grows with the first."""
    if angle <= table.entry:
        return
    if angle >= table.exit:
        _add_last(table.second_integral, factor, out)
        _add_last(table.first_integral, factor * (angle - table.exit), out)
    else:
        _add_interpolated(table, table.second_integral, table.first_integral, angle, factor, out)


@register_jitable
def mean_directional(table, tooth_pitch, start, end, lag, out):
    """Mean of the directional matrix over a rotation of the tool, summed over its teeth.

    For a uniform tooth pitch, rad, and the tip angle of a tooth at the start and the end of the
    rotation, rad, 0 <= start < end. The top of the edge trails its tip by `lag`, rad, >= 0; the
    mean is also taken over the edge, so that `out` (c, r, r), overwritten, is per length of engaged
    depth.
    """
    out[:] = 0.0
    span = end - start
    # teeth and turns together put an edge at start + l tooth_pitch for every integer l
    first = math.ceil((table.entry - end) / tooth_pitch)
    last = math.floor((table.exit + lag - start) / tooth_pitch)
    for turn in range(first, last + 1):
        head = end + turn * tooth_pitch
        tail = start + turn * tooth_pitch
        if lag < _STRAIGHT_LAG:
            for side in range(2):
                angle = (head if side == 0 else tail) - 0.5 * lag
                factor = (1.0 - 2.0 * side) / span
                _add_first_integral(table, angle, factor, out)
        else:
            for corner in range(4):
                angle = (head if corner % 2 == 0 else tail) - (lag if corner > 1 else 0.0)
                sign = 1.0 if corner in (0, 3) else -1.0
                _add_second_integral(table, angle, sign / (span * lag), out)


def mean_over_revolution(table: DirectionalTable, teeth: int) -> NDArray[np.float64]:
    """Mean of the directional matrix over a revolution, per depth: (c, r, r).

    The zeroth Fourier term of Altintas and Budak 1995, eq. 14; a helix does not change it.
    """
    return table.first_integral[:, -1] * teeth / (2.0 * np.pi)
