"""The map of state and earlier motion over one period, by collocation on elements.

On every element in the cut the force is a polynomial through its values at Gauss points; the modes
answer to it exactly (`element_response`), and the cut gives it there from the motion now and the
motion when the earlier teeth passed. The error falls faster than any power of the number of
points (spectral elements; Khasawneh and Mann 2011, Int. J. Numer. Meth. Eng. 87, for delays).
Nothing is assumed of the delays: they may be several, change along an edge, with the speed, be
longer than the period or shorter than an element.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import KERNEL, SUMMING_KERNEL
from chatter.stability.element_layout import (
    ElementLayout,
    element_before,
    element_layout,
)
from chatter.stability.element_response import mode_response
from chatter.stability.spindle_turn import angle_at, speed_at, spindle_turn, time_at
from cutting.edge_pieces import (
    coupling_at,
    engaged_span,
    first_and_last_turn,
    part_below,
    radius_at,
    share_of_height,
)

#: points closer than this share of an element are the same
_SAME_POINT = 1e-7


class ElementMap(NamedTuple):
    """M elements, E of them in the cut, S distinct lengths; q = p r values at the Gauss points.

    The state holds (omega x, v) of every mode. A source is a block (r, p + 1, r) that takes the
    motion at the points of an earlier element to the force at one point, or, with `point` >= 0,
    the motion at that point alone.
    """

    layout: ElementLayout
    free: NDArray[np.float64]  # of each mode over a length (S, n, 2, 2)
    motion_of_state: NDArray[np.float64]  # (S, q, 2n)
    motion_of_force: NDArray[np.float64]  # (S, q, q)
    state_of_force: NDArray[np.float64]  # (S, 2n, q)
    solution: NDArray[np.float64]  # force from the force of the earlier motion (E, q, q)
    feedback: NDArray[np.float64]  # force from the state, negative (E, q, 2n)
    first_source: NDArray[np.int64]  # of each point (E p + 1,)
    source: NDArray[np.int64]  # element, counted from the period's first; negative before it
    point: NDArray[np.int64]
    block: NDArray[np.float64]  # (sources, r, (p + 1) r)
    output: NDArray[np.float64]  # motion of the tool point from the state, scaled (r, 2n)
    scale: float  # by which all motion is multiplied, 1/s
    memory: int  # elements before the period that are looked back to


class _Sources(NamedTuple):
    first: NDArray[np.int64]
    element: NDArray[np.int64]
    point: NDArray[np.int64]
    block: NDArray[np.float64]


@njit(**SUMMING_KERNEL)
def invert(a, inverse):
    """Set `inverse` to the inverse of a (n, n), which is overwritten; partial pivoting."""
    n = a.shape[0]
    inverse[:, :] = 0.0
    for i in range(n):
        inverse[i, i] = 1.0
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(n):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
                inverse[k, j], inverse[pivot, j] = inverse[pivot, j], inverse[k, j]
        scale = 1.0 / a[k, k]
        for j in range(n):
            a[k, j] *= scale
            inverse[k, j] *= scale
        for i in range(n):
            if i == k:
                continue
            factor = a[i, k]
            if factor == 0.0:
                continue
            for j in range(n):
                a[i, j] -= factor * a[k, j]
                inverse[i, j] -= factor * inverse[k, j]


@njit(**KERNEL)
def _length_response(cut, scale, length, in_cut, damped, free, of_state, of_force, to_state, rates):
    """Fill the matrices of one element length; `rates` are those of the velocity, if damped."""
    modes, rank = cut.shape.shape
    count = cut.points.weight.shape[0]
    rows = 2 * count + 2 if damped else count + 2
    response = np.empty((rows, count + 2))
    rate_of_state, rate_of_force = rates
    of_state[:, :] = 0.0
    of_force[:, :] = 0.0
    rate_of_state[:, :] = 0.0
    rate_of_force[:, :] = 0.0
    for m in range(modes):
        w = cut.natural_frequency[m]
        if not in_cut:
            z = cut.damping[m]
            root = math.sqrt(1.0 - z * z)
            decay = math.exp(-z * w * length)
            c, s = decay * math.cos(root * w * length), decay * math.sin(root * w * length)
            free[m, 0, 0], free[m, 0, 1] = c + z / root * s, s / root
            free[m, 1, 0], free[m, 1, 1] = -s / root, c - z / root * s
            continue
        mode_response(cut.response, m, w * length, response)
        for a in range(2):
            for b in range(2):
                free[m, a, b] = response[count + a, b]
        for l in range(rank):  # noqa: E741
            gain = cut.force_gain[m, l] / w
            for j in range(count):
                column = j * rank + l
                to_state[2 * m, column] = gain * response[count, 2 + j]
                to_state[2 * m + 1, column] = gain * response[count + 1, 2 + j]
            for k in range(rank):
                both = scale * cut.shape[m, k] / w * gain
                if both == 0.0:
                    continue
                for i in range(count):
                    for j in range(count):
                        of_force[i * rank + k, j * rank + l] += both * response[i, 2 + j]
                if damped:
                    both = cut.shape[m, k] * gain
                    for i in range(count):
                        for j in range(count):
                            rate_of_force[i * rank + k, j * rank + l] += (
                                both * response[count + 2 + i, 2 + j]
                            )
        for k in range(rank):
            reach = scale * cut.shape[m, k] / w
            for i in range(count):
                for b in range(2):
                    of_state[i * rank + k, 2 * m + b] = reach * response[i, b]
                    if damped:
                        rate_of_state[i * rank + k, 2 * m + b] = (
                            cut.shape[m, k] * response[count + 2 + i, b]
                        )


@njit(**KERNEL)
def _edge_points(cut, piece, span, speed):
    """Order of the quadrature along a part of a piece."""
    pieces = cut.pieces
    turned = abs(pieces.angle[piece, 1] - pieces.angle[piece, 0]) * span
    bend = abs(pieces.immersion[piece, 1] - pieces.immersion[piece, 0]) * span
    if turned + bend < 1e-9 and pieces.group[piece] >= 0:
        return 1
    if pieces.exponent != 0.0:
        return 16
    shift = abs(pieces.delay[piece, 1] - pieces.delay[piece, 0]) * span / speed
    waves = shift / cut.longest
    return min(16, 2 + math.ceil(2.5 * (turned + bend) + 5.0 * waves))


@njit(**KERNEL)
def _grown(sources, count):
    """Room for more sources."""
    capacity = sources.element.shape[0]
    if count < capacity:
        return sources
    element = np.empty(2 * capacity, dtype=np.int64)
    point = np.empty(2 * capacity, dtype=np.int64)
    block = np.empty((2 * capacity, *sources.block.shape[1:]))
    element[:capacity] = sources.element
    point[:capacity] = sources.point
    block[:capacity] = sources.block
    return _Sources(sources.first, element, point, block)


@njit(**KERNEL)
def _note_source(cut, layout, sources, first, count, time, stiffness, scale):
    """Add the coupling to the motion at an earlier time; returns the sources and their number."""
    element, place = element_before(layout, time)
    points = cut.points.place.shape[0]
    rank = stiffness.shape[0]
    near = -1
    for q in range(points):
        if abs(place - cut.points.place[q]) < _SAME_POINT:
            near = q
    found = -1
    for entry in range(first, count):
        if sources.element[entry] == element and sources.point[entry] == near:
            found = entry
            break
    if found < 0:
        sources = _grown(sources, count)
        found = count
        count += 1
        sources.element[found], sources.point[found] = element, near
        sources.block[found] = 0.0
    block = sources.block[found]
    if near >= 0:
        for i in range(rank):
            for j in range(rank):
                block[i, near * rank + j] += stiffness[i, j] / scale
        return sources, count
    total = 0.0
    for q in range(points):
        total += cut.points.barycentric[q] / (place - cut.points.place[q])
    for q in range(points):
        share = cut.points.barycentric[q] / (place - cut.points.place[q]) / total / scale
        for i in range(rank):
            for j in range(rank):
                block[i, q * rank + j] += share * stiffness[i, j]
    return sources, count


@njit(**KERNEL)
def _couple(cut, layout, turn, depth, speed_factor, time, scale, sources, count, now, work):
    """Couplings at one time: fill `now` (stiffness, dashpot) and append the sources."""
    pieces = cut.pieces
    stiffness, dashpot = now
    part, part_dashpot, groups, used = work
    rank = stiffness.shape[0]
    stiffness[:, :] = 0.0
    dashpot[:, :] = 0.0
    groups[:, :, :] = 0.0
    used[:] = 0
    first_source = count
    spindle = angle_at(turn, time)
    speed = speed_at(turn, time)
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        first, last = first_and_last_turn(pieces, piece, top, spindle)
        for back in range(first, last + 1):
            low, high = engaged_span(pieces, piece, top, spindle, back)
            straight = pieces.angle[piece, 0] == pieces.angle[piece, 1]
            if low >= high and not (straight and low <= high):
                continue
            order = _edge_points(cut, piece, high - low, speed)
            for q in range(order):
                x, share = cut.edge_place[order, q], cut.edge_weight[order, q]
                if pieces.exponent != 0.0 and order > 1:
                    # towards both ends, where the chip may vanish
                    share *= 30.0 * (x * (1.0 - x)) ** 2
                    x = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
                place = low + x * (high - low)
                weight = share * (high - low) * pieces.length[piece]
                coupling_at(
                    pieces, piece, place, spindle, weight, speed_factor, cut.basis,
                    part, part_dashpot,
                )  # fmt: skip
                for i in range(rank):
                    for j in range(rank):
                        stiffness[i, j] += part[i, j]
                if speed_factor > 0.0:
                    for i in range(rank):
                        for j in range(rank):
                            dashpot[i, j] += part_dashpot[i, j]
                group = pieces.group[piece]
                if group >= 0:
                    used[group] = 1
                    for i in range(rank):
                        for j in range(rank):
                            groups[group, i, j] += part[i, j]
                else:
                    delay = pieces.delay[piece, 0]
                    delay += share_of_height(pieces, piece, place) * (
                        pieces.delay[piece, 1] - pieces.delay[piece, 0]
                    )
                    earlier = time_at(turn, spindle - delay)
                    sources, count = _note_source(
                        cut, layout, sources, first_source, count, earlier, part, scale
                    )
    for group in range(used.shape[0]):
        if used[group] == 1:
            earlier = time_at(turn, spindle - pieces.group_delay[group])
            sources, count = _note_source(
                cut, layout, sources, first_source, count, earlier, groups[group], scale
            )
    return sources, count


@njit(**SUMMING_KERNEL)
def build_element_map(cut, speed, depth):
    """Assemble the elements of one period.

    Parameters
    ----------
    cut : CutArrays
    speed : float
        Mean spindle speed, rad/s.
    depth : float
        Axial depth, m.

    Returns
    -------
    ElementMap
    """
    turn = spindle_turn(cut.variation, speed, cut.period_angle)
    layout = element_layout(cut, turn, depth)
    modes, rank = cut.shape.shape
    points = cut.points.weight.shape[0]
    size, values = 2 * modes, points * rank
    shapes, cuts = layout.length.shape[0], layout.cut_start.shape[0]
    damped = cut.pieces.damping[1] > 0.0
    largest = 1e-300
    for m in range(modes):
        for k in range(rank):
            largest = max(largest, abs(cut.shape[m, k]) / cut.natural_frequency[m])
    scale = 1.0 / largest
    free = np.zeros((shapes, modes, 2, 2))
    of_state, of_force = np.zeros((shapes, values, size)), np.zeros((shapes, values, values))
    to_state = np.zeros((shapes, size, values))
    rate_rows = shapes if damped else 1
    rate_of_state = np.zeros((rate_rows, values, size))
    rate_of_force = np.zeros((rate_rows, values, values))
    for s in range(shapes):
        at = s if damped else 0
        _length_response(
            cut, scale, layout.length[s], layout.length_cuts[s] == 1, damped, free[s],
            of_state[s], of_force[s], to_state[s], (rate_of_state[at], rate_of_force[at]),
        )  # fmt: skip
    solution, feedback = np.empty((cuts, values, values)), np.empty((cuts, values, size))
    sources = _Sources(
        np.zeros(cuts * points + 1, dtype=np.int64),
        np.empty(cuts * points + 8, dtype=np.int64),
        np.empty(cuts * points + 8, dtype=np.int64),
        np.empty((cuts * points + 8, rank, (points + 1) * rank)),
    )
    count = 0
    now = (np.empty((rank, rank)), np.empty((rank, rank)))
    work = (
        np.empty((rank, rank)),
        np.empty((rank, rank)),
        np.empty((cut.pieces.group_delay.shape[0], rank, rank)),
        np.empty(cut.pieces.group_delay.shape[0], dtype=np.int64),
    )
    radius = radius_at(cut.pieces, depth)
    output = np.zeros((rank, size))
    for m in range(modes):
        for k in range(rank):
            output[k, 2 * m] = scale * cut.shape[m, k] / cut.natural_frequency[m]
    matrix, couple = np.empty((values, values)), np.empty((values, size))
    for m in range(layout.start.shape[0]):
        e = layout.cut[m]
        if e < 0:
            continue
        s = layout.shape[m]
        matrix[:, :] = 0.0
        couple[:, :] = 0.0
        for i in range(values):
            matrix[i, i] = 1.0
        for i in range(points):
            time = layout.start[m] + cut.points.place[i + 1] * layout.length[s]
            factor = 1.0 / (radius * speed_at(turn, time)) if damped else 0.0
            before = count
            sources, count = _couple(
                cut, layout, turn, depth, factor, time, scale, sources, count, now, work
            )
            sources.first[e * points + i + 1] = count
            for k in range(rank):
                row = i * rank + k
                for l in range(rank):  # noqa: E741
                    column = i * rank + l
                    stiff = now[0][k, l] / scale
                    for j in range(values):
                        matrix[row, j] += stiff * of_force[s, column, j]
                    for j in range(size):
                        couple[row, j] += stiff * of_state[s, column, j]
                    if damped:
                        for j in range(values):
                            matrix[row, j] += now[1][k, l] * rate_of_force[s, column, j]
                        for j in range(size):
                            couple[row, j] += now[1][k, l] * rate_of_state[s, column, j]
            for entry in range(before, count):
                if sources.element[entry] == e:
                    # the earlier motion lies within this very element
                    _own_source(
                        sources.block[entry], i, of_force[s], of_state[s], output, matrix, couple
                    )
                    sources.block[entry] = 0.0
                    sources.element[entry] = e - 1
                    sources.point[entry] = 0
        invert(matrix, solution[e])
        for i in range(values):
            for j in range(size):
                total = 0.0
                for k in range(values):
                    total += solution[e, i, k] * couple[k, j]
                feedback[e, i, j] = total
    memory = 0
    for entry in range(count):
        memory = max(memory, -sources.element[entry])
    return ElementMap(
        layout, free, of_state, of_force, to_state, solution, feedback, sources.first,
        sources.element[:count], sources.point[:count], sources.block[:count], output, scale,
        memory,
    )  # fmt: skip


@njit(**KERNEL)
def _own_source(block, i, of_force, of_state, output, matrix, couple):
    rank = block.shape[0]
    values, size = of_state.shape
    for k in range(rank):
        row = i * rank + k
        for j in range(size):
            for l in range(rank):  # noqa: E741
                couple[row, j] -= block[k, l] * output[l, j]
        for column in range(values):
            weight = block[k, rank + column]
            if weight == 0.0:
                continue
            for j in range(values):
                matrix[row, j] -= weight * of_force[column, j]
            for j in range(size):
                couple[row, j] -= weight * of_state[column, j]


@njit(**KERNEL)
def element_scratch(period):
    """Scratch of `apply_element_map`: motion of all elements, force, delayed force, state."""
    cuts, values, size = period.feedback.shape
    rank = period.output.shape[0]
    return (
        np.empty(((period.memory + cuts), values + rank)),
        np.empty(values),
        np.empty(values),
        np.empty(size),
    )


@njit(**SUMMING_KERNEL)
def _advance(period, m, scratch):
    """Advance state and motion over one element; leaves the force on it in the scratch."""
    motion, force, delayed, state = scratch
    _, values, size = period.feedback.shape
    rank = period.output.shape[0]
    points = values // rank
    width = values + rank
    memory = period.memory
    e, s = period.layout.cut[m], period.layout.shape[m]
    if e >= 0:
        own = motion[memory + e]
        for k in range(rank):
            total = 0.0
            for j in range(size):
                total += period.output[k, j] * state[j]
            own[k] = total
        for i in range(points):
            for k in range(rank):
                delayed[i * rank + k] = 0.0
            first = period.first_source[e * points + i]
            for entry in range(first, period.first_source[e * points + i + 1]):
                earlier = motion[memory + period.source[entry]]
                q = period.point[entry]
                low, high = (q * rank, (q + 1) * rank) if q >= 0 else (0, width)
                for k in range(rank):
                    total = 0.0
                    for j in range(low, high):
                        total += period.block[entry, k, j] * earlier[j]
                    delayed[i * rank + k] += total
        for i in range(values):
            total = 0.0
            for j in range(values):
                total += period.solution[e, i, j] * delayed[j]
            for j in range(size):
                total -= period.feedback[e, i, j] * state[j]
            force[i] = total
        for i in range(values):
            total = 0.0
            for j in range(size):
                total += period.motion_of_state[s, i, j] * state[j]
            for j in range(values):
                total += period.motion_of_force[s, i, j] * force[j]
            own[rank + i] = total
    for mode in range(size // 2):
        a, b = state[2 * mode], state[2 * mode + 1]
        state[2 * mode] = period.free[s, mode, 0, 0] * a + period.free[s, mode, 0, 1] * b
        state[2 * mode + 1] = period.free[s, mode, 1, 0] * a + period.free[s, mode, 1, 1] * b
    if e >= 0:
        for i in range(size):
            total = 0.0
            for j in range(values):
                total += period.state_of_force[s, i, j] * force[j]
            state[i] += total


@njit(**KERNEL)
def _start(period, vector, scratch):
    motion, _, _, state = scratch
    size, width = state.shape[0], motion.shape[1]
    for i in range(size):
        state[i] = vector[i]
    for e in range(period.memory):
        for j in range(width):
            motion[e, j] = vector[size + e * width + j]


@njit(**KERNEL)
def apply_element_map(period, vector, out, scratch):
    """Set out to the image of the vector after one period.

    Parameters
    ----------
    period : ElementMap
    vector, out : (2n + memory (p + 1) r,) array of float
        State, then the motion at the points of the last elements in the cut, scaled.
    scratch : tuple
        As from `element_scratch`.
    """
    _start(period, vector, scratch)
    for m in range(period.layout.start.shape[0]):
        _advance(period, m, scratch)
    motion, _, _, state = scratch
    size, width = state.shape[0], motion.shape[1]
    cuts = period.feedback.shape[0]
    for i in range(size):
        out[i] = state[i]
    for e in range(period.memory):
        for j in range(width):
            out[size + e * width + j] = motion[cuts + e, j]


@njit(**KERNEL)
def force_over_period(period, vector):
    """Force at the points of all elements in the cut, (E, p r), that follows from a vector."""
    scratch = element_scratch(period)
    _start(period, vector, scratch)
    cuts, values, _ = period.feedback.shape
    out = np.empty((cuts, values))
    for m in range(period.layout.start.shape[0]):
        _advance(period, m, scratch)
        if period.layout.cut[m] >= 0:
            out[period.layout.cut[m]] = scratch[1]
    return out
