"""The map of state and earlier motion over one period, by collocation on elements.

On every element in the cut the force is a polynomial through its values at Gauss points; the modes
answer to it exactly (`element_response`), and the cut gives it there from the motion now and the
motion when the earlier teeth passed. The error falls faster than any power of the number of
points (spectral elements; Khasawneh and Mann 2011, Int. J. Numer. Meth. Eng. 87, for delays).
Nothing is assumed of the delays: they may be several, change along an edge, with the speed, be
longer than the period or shorter than an element.

Eight points of the stability diagram make one map, a point a lane; their plans must be alike.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import KERNEL
from chatter.lanes import LANES, load, spread, store
from chatter.stability.element_response import free_response, mode_response


class ElementMap(NamedTuple):
    """M elements, E of them in the cut, S distinct lengths; q = p r values at the Gauss points.

    The state holds (omega x, v) of every mode; the last axis of real arrays holds the lanes.
    """

    cut: NDArray[np.int64]  # number of each element among those in the cut, or -1 (M,)
    shape: NDArray[np.int64]  # number of the length of each element (M,)
    free: NDArray[np.float64]  # of each mode over a length (S, n, 2, 2, 8)
    motion_of_state: NDArray[np.float64]  # (S, q, 2n, 8)
    motion_of_force: NDArray[np.float64]  # (S, q, q, 8)
    state_of_force: NDArray[np.float64]  # (S, 2n, q, 8)
    lower: NDArray[np.float64]  # factors of the matrix that the force solves (E, q, q, 8)
    couple: NDArray[np.float64]  # force from the state, negative (E, q, 2n, 8)
    first_source: NDArray[np.int64]  # of each point (E p + 1,)
    source: NDArray[np.int64]  # as in `CutPlan`
    point: NDArray[np.int64]
    block: NDArray[np.float64]  # (sources, r, (p + 1) r, 8)
    output: NDArray[np.float64]  # motion of the tool point from the state, scaled (r, 2n)
    memory: int  # elements before the period that are looked back to


class _Rates(NamedTuple):
    """Velocity at the Gauss points, which dashpots feel."""

    of_state: NDArray[np.float64]  # (S, q, 2n, 8)
    of_force: NDArray[np.float64]  # (S, q, q, 8)


@njit(**KERNEL)
def motion_scale(cut):
    """Factor on all motion that makes it as large as the state, 1/s."""
    largest = 1e-300
    for m in range(cut.shape.shape[0]):
        for k in range(cut.shape.shape[1]):
            largest = max(largest, abs(cut.shape[m, k]) / cut.natural_frequency[m])
    return 1.0 / largest


@njit(**KERNEL)
def _add_response(response, row, factor, k, l, of_force):  # noqa: E741
    """Add the response to the force in direction l, seen in direction k, from a row on."""
    points = response.shape[1] - 2
    rank = of_force.shape[0] // points
    for i in range(points):
        for j in range(points):
            at = (i * rank + k, j * rank + l)
            store(of_force, at, load(of_force, at) + factor * load(response, (row + i, 2 + j)))


@njit(**KERNEL)
def _mode_over_length(cut, m, scale, response, free, period, s, rates):
    """Enter what mode m does over the element length s."""
    rank, points = cut.shape.shape[1], cut.points.weight.shape[0]
    w = cut.natural_frequency[m]
    damped = rates.of_state.shape[0] > 0
    for a in range(2):
        for b in range(2):
            store(free, (m, a, b), load(response, (points + a, b)))
    for l in range(rank):  # noqa: E741
        gain = cut.force_gain[m, l] / w
        for j in range(points):
            for a in range(2):
                value = gain * load(response, (points + a, 2 + j))
                store(period.state_of_force[s], (2 * m + a, j * rank + l), value)
        for k in range(rank):
            factor = cut.shape[m, k] * gain
            if factor == 0.0:
                continue
            _add_response(response, 0, scale / w * factor, k, l, period.motion_of_force[s])
            if damped:
                _add_response(response, points + 2, factor, k, l, rates.of_force[s])
    for k in range(rank):
        for i in range(points):
            for b in range(2):
                at = (i * rank + k, 2 * m + b)
                reach = scale / w * cut.shape[m, k]
                store(period.motion_of_state[s], at, reach * load(response, (i, b)))
                if damped:
                    rate = cut.shape[m, k] * load(response, (points + 2 + i, b))
                    store(rates.of_state[s], at, rate)


@njit(**KERNEL)
def _fill_lengths(cut, plans, members, speeds, scale, period, rates):
    """Enter what all modes do over every distinct length of an element."""
    points = cut.points.weight.shape[0]
    layout = plans[members[0]].layout
    rows = 2 * points + 2 if rates.of_state.shape[0] > 0 else points + 2
    response, place = np.empty((rows, points + 2, LANES)), np.empty((1, LANES))
    period.motion_of_force[:] = 0.0
    rates.of_force[:] = 0.0
    for s in range(layout.length.shape[0]):
        for m in range(cut.shape.shape[0]):
            w = cut.natural_frequency[m]
            for lane in range(LANES):
                place[0, lane] = w * plans[members[lane]].layout.length[s] / speeds[lane]
            if layout.length_cuts[s] == 0:
                free_response(cut.damping[m], place, period.free[s, m])
                continue
            mode_response(cut.response, m, place, response)
            _mode_over_length(cut, m, scale, response, period.free[s], period, s, rates)


@njit(**KERNEL)
def _add_row(matrix, row, factor, other, column):
    """Add factor times a row of another matrix to a row of one."""
    for j in range(matrix.shape[1]):
        value = load(matrix, (row, j)) + factor * load(other, (column, j))
        store(matrix, (row, j), value)


@njit(**KERNEL)
def _enter_cut(now, at, s, row, period, rates, matrix, couple):
    """Enter the cut at one point: stiffness and dashpot now, from row `row` of the element on."""
    stiffness, dashpot = now
    rank = stiffness.shape[1]
    for k in range(rank):
        for l in range(rank):  # noqa: E741
            stiff = load(stiffness, (at, k, l))
            _add_row(matrix, row + k, stiff, period.motion_of_force[s], row + l)
            _add_row(couple, row + k, stiff, period.motion_of_state[s], row + l)
            if rates.of_state.shape[0] > 0:
                rate = load(dashpot, (at, k, l))
                _add_row(matrix, row + k, rate, rates.of_force[s], row + l)
                _add_row(couple, row + k, rate, rates.of_state[s], row + l)


@njit(**KERNEL)
def _enter_own(block, row, s, period, matrix, couple):
    """Enter a source that lies within the very element."""
    rank, width = block.shape[0], block.shape[1]
    for k in range(rank):
        for l in range(rank):  # noqa: E741
            start = load(block, (k, l))
            for j in range(couple.shape[1]):
                value = load(couple, (row + k, j)) - start * period.output[l, j]
                store(couple, (row + k, j), value)
        for column in range(width - rank):
            weight = -1.0 * load(block, (k, rank + column))
            _add_row(matrix, row + k, weight, period.motion_of_force[s], column)
            _add_row(couple, row + k, weight, period.motion_of_state[s], column)


@njit(**KERNEL)
def _factorise(a):
    """Replace a (n, n, 8) by its factors; the diagonal of the upper one is inverted.

    No pivoting: the matrix is one plus a response to earlier forces alone, so that its leading
    parts are those of shorter elements.
    """
    n = a.shape[0]
    for k in range(n):
        pivot = 1.0 / load(a, (k, k))
        store(a, (k, k), pivot)
        for i in range(k + 1, n):
            factor = load(a, (i, k)) * pivot
            store(a, (i, k), factor)
            for j in range(k + 1, n):
                store(a, (i, j), load(a, (i, j)) - factor * load(a, (k, j)))


@njit(**KERNEL)
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


@njit(**KERNEL)
def _couplings_in_lanes(plans, members, speeds, scale):
    """Stiffness and dashpot (E p, r, r, 8) and blocks of the sources, scaled."""
    first = plans[members[0]]
    stiffness, dashpot = np.empty((*first.stiffness.shape, LANES)), np.empty((*first.stiffness.shape, LANES))
    block = np.empty((*first.block.shape, LANES))
    for lane in range(LANES):
        plan = plans[members[lane]]
        stiffness[..., lane] = plan.stiffness / scale
        dashpot[..., lane] = plan.dashpot / speeds[lane]
        block[..., lane] = plan.block / scale
    return (stiffness, dashpot), block


@njit(**KERNEL)
def build_element_map(cut, plans, members, speeds):
    """Assemble the elements of one period.

    Parameters
    ----------
    cut : CutArrays
    plans : list of CutPlan
    members : (8,) array of int
        Plan of every lane; all alike.
    speeds : (8,) array of float
        Mean spindle speed of every lane, rad/s.

    Returns
    -------
    ElementMap
    """
    modes, rank = cut.shape.shape
    points = cut.points.weight.shape[0]
    size, values = 2 * modes, points * rank
    plan = plans[members[0]]
    shapes, cuts = plan.layout.length.shape[0], plan.layout.cut_start.shape[0]
    scale = motion_scale(cut)
    now, block = _couplings_in_lanes(plans, members, speeds, scale)
    output = np.zeros((rank, size))
    for m in range(modes):
        for k in range(rank):
            output[k, 2 * m] = scale * cut.shape[m, k] / cut.natural_frequency[m]
    period = ElementMap(
        plan.layout.cut, plan.layout.shape, np.empty((shapes, modes, 2, 2, LANES)),
        np.empty((shapes, values, size, LANES)), np.empty((shapes, values, values, LANES)),
        np.empty((shapes, size, values, LANES)), np.zeros((cuts, values, values, LANES)),
        np.zeros((cuts, values, size, LANES)), plan.first_source, plan.source, plan.point, block,
        output, plan.memory,
    )  # fmt: skip
    rated = shapes if cut.pieces.damping[1] > 0.0 else 0
    rates = _Rates(
        np.empty((rated, values, size, LANES)), np.empty((rated, values, values, LANES))
    )
    _fill_lengths(cut, plans, members, speeds, scale, period, rates)
    for m in range(period.cut.shape[0]):
        e, s = period.cut[m], period.shape[m]
        if e < 0:
            continue
        matrix, couple = period.lower[e], period.couple[e]
        for i in range(values):
            store(matrix, (i, i), spread(1.0))
        for i in range(points):
            at = e * points + i
            _enter_cut(now, at, s, i * rank, period, rates, matrix, couple)
            for entry in range(period.first_source[at], period.first_source[at + 1]):
                if period.source[entry] == e:
                    _enter_own(block[entry], i * rank, s, period, matrix, couple)
        _factorise(matrix)
    return period


@njit(**KERNEL)
def element_scratch(period):
    """Scratch of `apply_element_map`: motion of all elements, force, state."""
    cuts, values, size, _ = period.couple.shape
    rank = period.output.shape[0]
    return (
        np.zeros((period.memory + cuts, values + rank, LANES)),
        np.empty((values, LANES)),
        np.empty((size, LANES)),
        np.empty((size, LANES)),
    )


@njit(**KERNEL)
def _multiply(a, x, first, out):
    """Set out, from its row `first` on, to a (n, m, 8) times x (m, 8)."""
    for i in range(a.shape[0]):
        total = spread(0.0)
        for j in range(a.shape[1]):
            total += load(a, (i, j)) * load(x, j)
        store(out, first + i, total)


@njit(**KERNEL)
def _multiply_add(a, x, first, out):
    """Add a (n, m, 8) times x (m, 8) to out, from its row `first` on."""
    for i in range(a.shape[0]):
        total = load(out, first + i)
        for j in range(a.shape[1]):
            total += load(a, (i, j)) * load(x, j)
        store(out, first + i, total)


@njit(**KERNEL)
def _delayed_force(period, e, motion, force):
    """Set force to what the earlier motion asks for at the points of element e."""
    rank, values = period.output.shape[0], force.shape[0]
    width = values + rank
    points = values // rank
    for i in range(points):
        for k in range(rank):
            store(force, i * rank + k, spread(0.0))
        first, last = period.first_source[e * points + i], period.first_source[e * points + i + 1]
        for entry in range(first, last):
            if period.source[entry] == e:
                continue
            earlier = motion[period.memory + period.source[entry]]
            q = period.point[entry]
            low, high = (q * rank, (q + 1) * rank) if q >= 0 else (0, width)
            for k in range(rank):
                total = load(force, i * rank + k)
                for j in range(low, high):
                    total += load(period.block, (entry, k, j)) * load(earlier, j)
                store(force, i * rank + k, total)


@njit(**KERNEL)
def _advance(period, m, scratch):
    """Advance state and motion over one element; leaves the force on it in the scratch."""
    motion, force, state, following = scratch
    _, values, size, _ = period.couple.shape
    rank = period.output.shape[0]
    e, s = period.cut[m], period.shape[m]
    for mode in range(size // 2):
        free = period.free[s, mode]
        a, b = load(state, 2 * mode), load(state, 2 * mode + 1)
        store(following, 2 * mode, load(free, (0, 0)) * a + load(free, (0, 1)) * b)
        store(following, 2 * mode + 1, load(free, (1, 0)) * a + load(free, (1, 1)) * b)
    if e >= 0:
        own = motion[period.memory + e]
        for k in range(rank):
            total = spread(0.0)
            for j in range(size):
                total += period.output[k, j] * load(state, j)
            store(own, k, total)
        _delayed_force(period, e, motion, force)
        for i in range(values):
            total = load(force, i)
            for j in range(size):
                total -= load(period.couple, (e, i, j)) * load(state, j)
            store(force, i, total)
        _solve(period.lower[e], force)
        _multiply(period.motion_of_state[s], state, rank, own)
        _multiply_add(period.motion_of_force[s], force, rank, own)
        _multiply_add(period.state_of_force[s], force, 0, following)
    state[:, :] = following


@njit(**KERNEL)
def _start(period, vector, scratch):
    motion, _, state, _ = scratch
    size, width = state.shape[0], motion.shape[1]
    state[:, :] = vector[:size]
    for e in range(period.memory):
        motion[e] = vector[size + e * width : size + (e + 1) * width]


@njit(**KERNEL)
def apply_element_map(period, vector, out, scratch):
    """Set out to the image of the vector after one period.

    Parameters
    ----------
    period : ElementMap
    vector, out : (2n + memory (p + 1) r, 8) array of float
        State, then the motion at the points of the last elements in the cut, scaled.
    scratch : tuple
        As from `element_scratch`.
    """
    _start(period, vector, scratch)
    for m in range(period.cut.shape[0]):
        _advance(period, m, scratch)
    motion, _, state, _ = scratch
    size, width = state.shape[0], motion.shape[1]
    cuts = period.couple.shape[0]
    out[:size] = state
    for e in range(period.memory):
        out[size + e * width : size + (e + 1) * width] = motion[cuts + e]


@njit(**KERNEL)
def force_over_period(period, vector, force):
    """Set force (E, q, 8) to that at the points of all elements that follows from a vector."""
    scratch = element_scratch(period)
    _start(period, vector, scratch)
    for m in range(period.cut.shape[0]):
        _advance(period, m, scratch)
        if period.cut[m] >= 0:
            force[period.cut[m]] = scratch[1]
