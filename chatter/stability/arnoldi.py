"""Dominant Floquet multiplier of a period map, by Arnoldi iteration without forming its matrix."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from chatter.engine.presets import KERNEL, SUMMING_KERNEL
from chatter.stability.hessenberg import dominant_pair
from chatter.stability.methods.semi_discretization.monodromy import apply_period_map, period_scratch

#: residual of the dominant eigenpair, relative to its magnitude, at which the iteration stops
_TOLERANCE = 1e-8
#: dimension of the Krylov space beyond the state at the first look, and how it grows
_FIRST_LOOK = 5
_GROWTH = 1.3
_LARGEST_SPACE = 240


@njit(**KERNEL)
def _start_vector(period, out, scratch):
    """A fixed pseudo-random vector, smoothed by one pass through the map."""
    start = np.empty(out.shape[0])
    seed = 12345
    for i in range(start.shape[0]):
        seed = (1103515245 * seed + 12345) % 2147483648
        start[i] = seed / 1073741824.0 - 1.0
    scale = 0.0
    size = period.output.shape[1]
    for i in range(size):
        scale += abs(period.output[0, i])
    # motion is smaller than the state by the size of the output matrix
    start[size:] *= scale / size
    apply_period_map(period, start, out, scratch)


@njit(**SUMMING_KERNEL)
def dominant_multiplier(period):
    """Multiplier of largest magnitude and its vector.

    Parameters
    ----------
    period : PeriodMap

    Returns
    -------
    multiplier : complex
        Imaginary part >= 0.
    vector : array of complex
        State and earlier motion.
    residual : float
        Norm of the eigenpair's residual over the multiplier's magnitude.
    """
    size = period.output.shape[1]
    _, _, rank = period.from_left.shape
    dimension = size + period.nodes * rank
    scratch = period_scratch(period)
    largest = min(dimension, _LARGEST_SPACE)
    basis = np.empty((largest + 1, dimension))
    hessenberg = np.zeros((largest + 1, largest))
    _start_vector(period, basis[0], scratch)
    # delayed motion enters the inner product with the weight of the state
    norm = math.sqrt((basis[0] ** 2).sum())
    multiplier = complex(0.0, 0.0)
    if norm == 0.0:
        return multiplier, np.zeros(dimension, dtype=np.complex128), 0.0
    basis[0] /= norm
    # weakly damped modes keep as many multipliers near the unit circle as there are states
    look = min(_FIRST_LOOK + size, largest)
    residual = np.inf
    coordinates = np.ones(1, dtype=np.complex128)
    used = 0
    for k in range(largest):
        apply_period_map(period, basis[k], basis[k + 1], scratch)
        before = math.sqrt((basis[k + 1] ** 2).sum())
        for _ in range(2):
            for j in range(k + 1):
                overlap = 0.0
                for i in range(dimension):
                    overlap += basis[j, i] * basis[k + 1, i]
                hessenberg[j, k] += overlap
                for i in range(dimension):
                    basis[k + 1, i] -= overlap * basis[j, i]
        norm = math.sqrt((basis[k + 1] ** 2).sum())
        used = k + 1
        invariant = norm <= 1e-14 * before
        hessenberg[k + 1, k] = norm
        if used in (look, largest) or invariant:
            multiplier, coordinates = dominant_pair(hessenberg[:used, :used].copy())
            residual = norm * abs(coordinates[used - 1]) / max(abs(multiplier), 1e-300)
            look = min(largest, math.ceil(look * _GROWTH))
            if residual < _TOLERANCE or invariant:
                break
        basis[k + 1] /= norm
    vector = np.zeros(dimension, dtype=np.complex128)
    for j in range(used):
        for i in range(dimension):
            vector[i] += coordinates[j] * basis[j, i]
    return multiplier, vector, residual
