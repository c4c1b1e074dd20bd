"""What a mode makes, over a time element, of its state at the start and of the force on it.

On an element of length h the force is the polynomial through its values at p Gauss points; the
response of a mode to that, and to its state, is exact. In natural units (omega x, v, and force per
mass over omega) it depends on omega h and the damping ratio alone, and is tabulated over omega h as
a Chebyshev series once a mode, so that any element costs a short sum.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy
from numba import njit
from numpy.typing import NDArray

from chatter.description.arrays import Array
from chatter.engine.presets import INNER_KERNEL
from chatter.stability.simd_batch import load, spread, store

#: series hold up to at least that omega h, and up to that times a power of two by this step
_LEAST_REACH, _STEP = 1e-3, 0.125
#: order of a quadrature from which on a dense eigenvalue problem for its points costs seconds
_DENSE = 300


class ElementPoints(NamedTuple):
    """Points of an element on [0, 1]: its start, then p Gauss points."""

    position: Array  # (p+1,)
    weight: Array  # of the Gauss quadrature (p,)
    barycentric: Array  # weights of the polynomial through all points (p+1,)
    gauss_weight: Array  # of that through the Gauss points alone (p,)


class ResponseTable(NamedTuple):
    """Chebyshev coefficients of the response of n modes over omega h.

    Rows: omega x at the points, omega x and v at the end, v at the points; columns: omega x and v
    at the start, then force per mass and omega at the points.
    """

    coefficient: Array  # (n, K, 2p + 2, p + 2)
    furthest: Array  # omega h up to which the series holds (n,)


@lru_cache(maxsize=32)
def element_points(count: int) -> ElementPoints:
    """Return the start and `count` Gauss points of an element."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    position = np.concatenate([[0.0], 0.5 * (nodes + 1.0)])
    difference = 4.0 * (position[:, None] - position[None, :])
    np.fill_diagonal(difference, 1.0)
    barycentric = 1.0 / np.prod(difference, axis=1)
    return ElementPoints(position, 0.5 * weights, barycentric, barycentric[1:] * position[1:])


def _through_gauss_points(nodes: Array, at: Array) -> NDArray:
    """Lagrange polynomials (len(at), p) through the Gauss points alone."""
    values = np.ones((at.size, nodes.size))
    for j in range(nodes.size):
        for k in range(nodes.size):
            if k != j:
                values[:, j] *= (at - nodes[k]) / (nodes[j] - nodes[k])
    return values


@lru_cache(maxsize=64)
def _pushes_before(count: int, order: int) -> list[tuple[float, NDArray, NDArray]]:
    """Gauss points and end of an element: position, those before it (n,), force there (n, p)."""
    nodes = element_points(count).position[1:]
    rule = np.polynomial.legendre.leggauss if order < _DENSE else scipy.special.roots_legendre
    inside, weight = rule(order)
    inside, weight = 0.5 * (inside + 1.0), 0.5 * weight
    return [
        (end, end * inside, _through_gauss_points(nodes, end * inside) * (end * weight)[:, None])
        for end in [*nodes.tolist(), 1.0]
    ]


def _responses(x: Array, ratio: float, count: int) -> Array:
    """Response (len(x), 2p + 2, p + 2) of one mode at omega h = x, of p points."""
    damped = math.sqrt(1.0 - ratio * ratio)
    out = np.zeros((x.size, 2 * count + 2, count + 2))
    rows = np.append(np.arange(count), count)
    velocity_rows = np.append(count + 2 + np.arange(count), count + 1)
    ends = _pushes_before(count, count + 10 + math.ceil(0.6 * float(np.max(x))))
    for (end, before, force), row, velocity_row in zip(ends, rows, velocity_rows, strict=True):
        decay = np.exp(-ratio * x * end)
        c, s = np.cos(damped * x * end), np.sin(damped * x * end)
        out[:, row, 0] = decay * (c + ratio / damped * s)
        out[:, row, 1] = decay * s / damped
        out[:, velocity_row, 0] = -decay * s / damped
        out[:, velocity_row, 1] = decay * (c - ratio / damped * s)
        # what is left at `end` of a push at each position before it
        span = x[:, None] * (end - before)[None, :]
        fading = np.exp(-ratio * span)
        sine = fading * np.sin(damped * span) / damped
        out[:, row, 2:] = x[:, None] * (sine @ force)
        speed = fading * np.cos(damped * span) - ratio * sine
        out[:, velocity_row, 2:] = x[:, None] * (speed @ force)
    return out


@lru_cache(maxsize=128)
def _coefficients(ratio: float, reach: float, terms: int, count: int) -> Array:
    """Chebyshev coefficients (terms, 2p + 2, p + 2) of the response of one mode up to a reach."""
    # Chebyshev points of the first kind; the series follows from the cosine sums
    angle = math.pi * (np.arange(terms) + 0.5) / terms
    cosines = np.cos(np.outer(np.arange(terms), angle)) * (2.0 / terms)
    cosines[0] *= 0.5
    values = _responses(0.5 * reach * (1.0 + np.cos(angle)), ratio, count)
    return np.tensordot(cosines, values, axes=1)


def response_table(
    natural_frequency: Array, damping: Array, points: ElementPoints, longest: float
) -> ResponseTable:
    """Tabulate the response of every mode for elements up to a length, s.

    Natural frequencies (n,) in rad/s, damping ratios (n,).
    """
    reach = np.maximum(natural_frequency * longest, _LEAST_REACH)
    # in steps, so that like structures share their series
    furthest = _LEAST_REACH * 2.0 ** (np.ceil(np.log2(reach / _LEAST_REACH) / _STEP) * _STEP)
    terms = 16 + math.ceil(0.62 * float(furthest.max()))
    count = points.weight.size
    tables = [
        _coefficients(float(ratio), float(own), terms, count)
        for own, ratio in zip(furthest, damping, strict=True)
    ]
    return ResponseTable(np.stack(tables), furthest)


@njit(**INNER_KERNEL)
def mode_response(coefficient, furthest, x, out):
    """Set out (rows, p + 2, 8) to the first rows of the response of a mode at omega h = x (1, 8).

    `coefficient` and `furthest` are those of the mode in the `ResponseTable`.
    """
    t = (2.0 / furthest) * load(x, 0) - 1.0
    before, now = spread(1.0), t
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            store(out, (i, j), coefficient[0, i, j] + t * coefficient[1, i, j])
    for k in range(2, coefficient.shape[0]):
        before, now = now, 2.0 * t * now - before
        for i in range(out.shape[0]):
            for j in range(out.shape[1]):
                store(out, (i, j), load(out, (i, j)) + now * coefficient[k, i, j])


@njit(**INNER_KERNEL)
def free_response(ratio, x, out):
    """Set out (2, 2, 8) to what a mode without force makes of its state over omega h = x (1, 8)."""
    root = math.sqrt(1.0 - ratio * ratio)
    for member in range(x.shape[1]):
        decay = math.exp(-ratio * x[0, member])
        c, s = decay * math.cos(root * x[0, member]), decay * math.sin(root * x[0, member])
        out[0, 0, member], out[0, 1, member] = c + ratio / root * s, s / root
        out[1, 0, member], out[1, 1, member] = -s / root, c - ratio / root * s
