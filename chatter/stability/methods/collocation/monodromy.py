"""The map of state and earlier motion over one period, by collocation on elements.

On every element in the cut the force is a polynomial through its values at Gauss points; the modes
response to it exactly (`element_response`), and the cut gives it there from the motion now and the
motion when the earlier teeth passed. The error falls faster than any power of the number of
points (spectral elements; Khasawneh and Mann 2011, Int. J. Numer. Meth. Eng. 87, for delays).
Nothing is assumed of the delays: they may be several, change along an edge, with the speed, be
longer than the period or shorter than an element.

Eight points of the stability diagram make one SIMD batch, a point per member; their assemblies must
have the same structure.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.methods.collocation.coupling_structure import AssemblyStructure
from chatter.stability.simd_batch import BATCH_SIZE, load, spread, store


class BatchMonodromy(NamedTuple):
    """M elements, E of them in the cut, S distinct lengths; q = p r values at the Gauss points.

    The state holds (omega x, v) of every mode; the last axis of real arrays holds the batch.
    """

    assembly: AssemblyStructure
    free: Array  # of each mode over a length (S, n, 2, 2, 8)
    motion_of_state: Array  # (S, q, 2n, 8)
    motion_of_force: Array  # (S, q, q, 8)
    state_of_force: Array  # (S, 2n, q, 8)
    factors: Array  # of the matrix that the force solves (E, q, q, 8)
    couple: Array  # force from the state, negative (E, q, 2n, 8)
    block: Array  # of the sources (sources, r, (p + 1) r, 8)
    output: Array  # motion of the tool point from the state, scaled (r, 2n)


@njit(**LEAF_KERNEL)
def _solve(factors, x):
    """Replace x (n, 8) by the solution of the factorised matrix."""
    n = x.shape[0]
    for i in range(1, n):
        total = load(x, i)
        for j in range(i):
            total -= load(factors, (i, j)) * load(x, j)
        store(x, i, total)
    for i in range(n - 1, -1, -1):
        total = load(x, i)
        for j in range(i + 1, n):
            total -= load(factors, (i, j)) * load(x, j)
        store(x, i, total * load(factors, (i, i)))


class BatchScratch(NamedTuple):
    """Scratch of `apply_batch_monodromy`, which leaves the force at all points in `force`."""

    motion: Array  # of all elements (memory + E, q + r, 8)
    force: Array  # (E, q, 8)
    state: Array  # (2n, 8)
    next_state: Array  # (2n, 8)


@njit(**INNER_KERNEL)
def batch_scratch(period):
    """Return scratch for `apply_batch_monodromy`."""
    cuts, values, size, _ = period.couple.shape
    memory = period.assembly.memory
    return BatchScratch(
        np.zeros((memory + cuts, values + period.output.shape[0], BATCH_SIZE)),
        np.empty((cuts, values, BATCH_SIZE)),
        np.empty((size, BATCH_SIZE)),
        np.empty((size, BATCH_SIZE)),
    )  # fmt: skip


@njit(**LEAF_KERNEL)
def _multiply(a, x, first, out):
    """Set out, from its row `first` on, to a (n, m, 8) times x (m, 8)."""
    for i in range(a.shape[0]):
        total = spread(0.0)
        for j in range(a.shape[1]):
            total += load(a, (i, j)) * load(x, j)
        store(out, first + i, total)


@njit(**LEAF_KERNEL)
def _multiply_add(a, x, first, out):
    """Add a (n, m, 8) times x (m, 8) to out, from its row `first` on."""
    for i in range(a.shape[0]):
        total = load(out, first + i)
        for j in range(a.shape[1]):
            total += load(a, (i, j)) * load(x, j)
        store(out, first + i, total)


@njit(**LEAF_KERNEL)
def _copy(source, first, out, start, count):
    """Copy rows (.., 8) from one position to another."""
    for i in range(count):
        store(out, start + i, load(source, first + i))


@njit(**SINGLE_KERNEL)
def _delayed_force(assembly, block, e, motion, force):
    """Set force (q, 8) to what the earlier motion asks for at the points of element e."""
    rank, width = block.shape[1], block.shape[2]
    points = force.shape[0] // rank
    for i in range(points):
        for k in range(rank):
            store(force, i * rank + k, spread(0.0))
        for entry in range(
            assembly.first_source[e * points + i], assembly.first_source[e * points + i + 1]
        ):
            if assembly.source[entry] == e:
                continue
            earlier = motion[assembly.memory + assembly.source[entry]]
            q = assembly.point[entry]
            low, high = (q * rank, (q + 1) * rank) if q >= 0 else (0, width)
            for k in range(rank):
                total = load(force, i * rank + k)
                for j in range(low, high):
                    total += load(block, (entry, k, j)) * load(earlier, j)
                store(force, i * rank + k, total)


@njit(**LEAF_KERNEL)
def _free_motion(free, state, next_state):
    """Set what follows (2n, 8) to the state after free motion, free (n, 2, 2, 8)."""
    for mode in range(free.shape[0]):
        a, b = load(state, 2 * mode), load(state, 2 * mode + 1)
        for row in range(2):
            value = load(free, (mode, row, 0)) * a + load(free, (mode, row, 1)) * b
            store(next_state, 2 * mode + row, value)


@njit(**SINGLE_KERNEL)
def _in_cut(couple, factors, of_state, of_force, to_state, output, state, own, force, next_state):
    """Advance over an element in the cut; force holds what the earlier motion asks for."""
    rank, size = output.shape
    for k in range(rank):
        total = spread(0.0)
        for j in range(size):
            total += output[k, j] * load(state, j)
        store(own, k, total)
    for i in range(force.shape[0]):
        total = load(force, i)
        for j in range(size):
            total -= load(couple, (i, j)) * load(state, j)
        store(force, i, total)
    _solve(factors, force)
    _multiply(of_state, state, rank, own)
    _multiply_add(of_force, force, rank, own)
    _multiply_add(to_state, force, 0, next_state)


@njit(**LEAF_KERNEL)
def apply_batch_monodromy(period, vector, out, scratch):
    """Set out to the image of the vector after one period of a batch.

    Both (2n + memory (p + 1) r, 8): state, then the motion at the points of the last elements in
    the cut, scaled.
    """
    assembly, motion, state = period.assembly, scratch.motion, scratch.state
    size, width = state.shape[0], motion.shape[1]
    cuts = scratch.force.shape[0]
    _copy(vector, 0, state, 0, size)
    for e in range(assembly.memory):
        _copy(vector, size + e * width, motion[e], 0, width)
    for m in range(assembly.cut.shape[0]):
        e, s = assembly.cut[m], assembly.shape[m]
        _free_motion(period.free[s], state, scratch.next_state)
        if e >= 0:
            _delayed_force(assembly, period.block, e, motion, scratch.force[e])
            _in_cut(
                period.couple[e], period.factors[e], period.motion_of_state[s],
                period.motion_of_force[s], period.state_of_force[s], period.output, state,
                motion[assembly.memory + e], scratch.force[e], scratch.next_state,
            )  # fmt: skip
        _copy(scratch.next_state, 0, state, 0, size)
    _copy(state, 0, out, 0, size)
    for e in range(assembly.memory):
        _copy(motion[cuts + e], 0, out, size + e * width, width)
