"""Dominant Floquet multipliers of eight points at once, by Arnoldi iteration on their map.

The map is never formed as a matrix. Each member is evaluated by itself and keeps the first value
that has converged, so that it does not depend on its neighbours.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, ComplexArray, IntegerArray
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.hessenberg import dominant_pair
from chatter.stability.methods.collocation.monodromy import apply_batch_monodromy, batch_scratch
from chatter.stability.simd_batch import BATCH_SIZE, load, spread, store

#: dimension of the Krylov space beyond the state at the first check, and how it grows
_FIRST_CHECK = 3
_GROWTH = 1.3
#: over a period of so many elements a check costs far less than another vector
_MANY_ELEMENTS = 60
_LARGEST_SPACE = 240
#: norms above this are not the root of a sum of squares
_SQUARES_BELOW = 1e150
#: multiplier of a motion that grows beyond all numbers within a period
_BEYOND_NUMBERS = 1e300


class DominantPairs(NamedTuple):
    """Multipliers of largest magnitude of eight points, imaginary part >= 0, and their vectors."""

    value: ComplexArray  # (8,)
    basis: Array  # (K + 1, D, 8)
    coordinates: ComplexArray  # of the vector in the basis (8, K)
    used: IntegerArray  # of the basis (8,)


@njit(**SINGLE_KERNEL)
def _start_vectors(period, out, scratch):
    """A fixed pseudo-random vector in all members, smoothed by one pass through the map."""
    start = np.empty(out.shape)
    seed = 12345
    size = period.output.shape[1]
    scale = 0.0
    for j in range(size):
        scale += abs(period.output[0, j])
    for i in range(start.shape[0]):
        seed = (1103515245 * seed + 12345) % 2147483648
        # motion is smaller than the state by the size of the output matrix
        factor = 1.0 if i < size else scale / size
        store(start, i, spread(factor * (seed / 1073741824.0 - 1.0)))
    apply_batch_monodromy(period, start, out, scratch)


@njit(**LEAF_KERNEL)
def _norms(vector, out):
    """Set out (1, 8) to the norms of vectors (D, 8)."""
    total = spread(0.0)
    for i in range(vector.shape[0]):
        total += load(vector, i) * load(vector, i)
    store(out, 0, total)
    for member in range(BATCH_SIZE):
        out[0, member] = math.sqrt(out[0, member])
        if not out[0, member] < _SQUARES_BELOW:
            # the squares are too large to be summed up
            largest = 0.0
            for i in range(vector.shape[0]):
                largest = max(largest, abs(vector[i, member]))
            squares = 0.0
            for i in range(vector.shape[0]):
                squares += (vector[i, member] / largest) ** 2
            out[0, member] = largest * math.sqrt(squares)


@njit(**INNER_KERNEL)
def _divide(vector, norm):
    """Divide vectors (D, 8) by their norms (1, 8); nothing stays nothing."""
    factor = np.empty((1, BATCH_SIZE))
    for member in range(BATCH_SIZE):
        factor[0, member] = 1.0 / norm[0, member] if norm[0, member] > 0.0 else 0.0
    by = load(factor, 0)
    for i in range(vector.shape[0]):
        store(vector, i, load(vector, i) * by)


@njit(**SINGLE_KERNEL)
def _orthogonalise(basis, k, hessenberg):
    """Take the first k + 1 vectors out of the next one, twice, and note how much of each."""
    vector = basis[k + 1]
    for _ in range(2):
        for j in range(k + 1):
            overlap = spread(0.0)
            for i in range(vector.shape[0]):
                overlap += load(basis, (j, i)) * load(vector, i)
            store(hessenberg, (j, k), load(hessenberg, (j, k)) + overlap)
            for i in range(vector.shape[0]):
                store(vector, i, load(vector, i) - overlap * load(basis, (j, i)))


@njit(**SINGLE_KERNEL)
def dominant_pairs(period, tolerance):
    """Multiplier of largest magnitude of every member of a `BatchMonodromy`.

    `tolerance` is the residual of the eigenpair, relative to its magnitude, at which a member is
    done.
    """
    _, values, size, _ = period.couple.shape
    dimension = size + period.assembly.memory * (values + period.output.shape[0])
    scratch = batch_scratch(period)
    largest = min(dimension, _LARGEST_SPACE)
    basis = np.empty((largest + 1, dimension, BATCH_SIZE))
    hessenberg = np.zeros((largest + 1, largest, BATCH_SIZE))
    found = DominantPairs(
        np.zeros(BATCH_SIZE, dtype=np.complex128), basis,
        np.zeros((BATCH_SIZE, largest), dtype=np.complex128), np.zeros(BATCH_SIZE, dtype=np.int64),
    )  # fmt: skip
    _start_vectors(period, basis[0], scratch)
    norm, before = np.empty((1, BATCH_SIZE)), np.empty((1, BATCH_SIZE))
    _norms(basis[0], norm)
    for member in range(BATCH_SIZE):
        if not norm[0, member] < np.inf:
            found.value[member], found.used[member] = _BEYOND_NUMBERS, 1
    _divide(basis[0], norm)
    # weakly damped modes keep as many multipliers near the unit circle as there are states
    check_at = min(_FIRST_CHECK + size, largest)
    growth_rate = _GROWTH
    if period.assembly.cut.shape[0] > _MANY_ELEMENTS:
        check_at, growth_rate = min(2, largest), 1.0
    for k in range(largest):
        apply_batch_monodromy(period, basis[k], basis[k + 1], scratch)
        _norms(basis[k + 1], before)
        _orthogonalise(basis, k, hessenberg)
        _norms(basis[k + 1], norm)
        store(hessenberg, (k + 1, k), load(norm, 0))
        regular = k + 1 in (check_at, largest)
        if regular:
            check_at = min(largest, max(check_at + 1, math.ceil(check_at * growth_rate)))
        if _check_members(
            hessenberg, k + 1, largest, regular, norm[0], before[0], tolerance, found
        ):
            break
        _divide(basis[k + 1], norm)
    return found


@njit(**SINGLE_KERNEL)
def _check_members(hessenberg, used, largest, regular, norm, before, tolerance, found):
    """Keep the members that have converged; return whether all have."""
    done = True
    for member in range(BATCH_SIZE):
        if found.used[member] > 0:
            continue
        invariant = norm[member] <= 1e-14 * before[member]
        if not (regular or invariant):
            done = False
            continue
        if before[member] == 0.0:
            found.used[member] = used
            continue
        if not before[member] < np.inf:
            found.value[member], found.used[member] = _BEYOND_NUMBERS, used
            continue
        small = np.empty((used, used))
        # products of what is that large would leave the range of numbers
        scale = before[member] if before[member] > _SQUARES_BELOW**0.5 else 1.0
        for i in range(used):
            for j in range(used):
                small[i, j] = hessenberg[i, j, member] / scale
        value, coordinates = dominant_pair(small)
        value *= scale
        residual = norm[member] * abs(coordinates[used - 1]) / max(abs(value), 1e-300)
        if residual < tolerance or invariant or used == largest:
            found.value[member], found.used[member] = value, used
            for j in range(used):
                found.coordinates[member, j] = coordinates[j]
        else:
            done = False
    return done
