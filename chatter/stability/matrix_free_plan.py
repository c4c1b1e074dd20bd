"""What one step after the other does to the motion of a cut, laid out for a speed and a depth.

The force at the Gauss points of a step follows from the motion there, which is solved for, and from
the motion when the earlier teeth passed: a cubic (Hermite) through displacement and velocity at the
ends and middles of the steps of the last period. Order four in the length of the steps.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import KERNEL
from chatter.stability.matrix_free_steps import PLACES, mode_answer, period_steps
from chatter.stability.spindle_turn import angle_at, speed_at, spindle_turn, time_at
from cutting.edge_coupling import (
    coupling_at,
    engaged_span,
    first_and_last_turn,
    part_below,
    radius_at,
    share_of_height,
)
from cutting.edge_runs import change_along, crowd, points_along

#: step lengths closer than this share are the same
_SAME_LENGTH = 1e-9


class StepPlan(NamedTuple):
    """N steps of S distinct lengths; node 2 k is the start of step k, node 2 k + 1 its middle.

    Nodes count on from those of the period before, 0 .. 2 N - 1, to those of this one. A node holds
    the displacement and the velocity over `rate` in r directions; the state (x, x'/omega) of every
    mode.
    """

    border: NDArray[np.float64]  # s (N + 1,)
    length_of: NDArray[np.int64]  # number of the length of a step (N,)
    answer: NDArray[np.float64]  # of every mode, see `mode_answer` (S, n, 4, 2, 4)
    engaged: NDArray[np.int64]  # 1 in the cut (N,)
    from_motion: NDArray[np.float64]  # force at the Gauss points from free motion (N, 2r, 4r)
    from_earlier: NDArray[np.float64]  # and from the force of the earlier motion (N, 2r, 2r)
    first_source: NDArray[np.int64]  # of each Gauss point (2 N + 1,)
    node: NDArray[np.int64]  # earlier of the two of a source (sources,)
    weight: NDArray[np.float64]  # of displacement and velocity at both nodes (sources, 4)
    block: NDArray[np.float64]  # force per displacement, N/m (sources, r, r)
    shape: NDArray[np.float64]  # displacement per modal coordinate (n, r)
    shape_rate: NDArray[np.float64]  # velocity over `rate` per x'/omega (n, r)
    gain: NDArray[np.float64]  # modal acceleration per force, 1/kg (n, r)
    rate: float  # rad/s


class _Sources(NamedTuple):
    node: NDArray[np.int64]
    weight: NDArray[np.float64]
    block: NDArray[np.float64]


@njit(**KERNEL)
def _room_for_one(sources, count):
    capacity = sources.node.shape[0]
    if count < capacity:
        return sources
    rank = sources.block.shape[1]
    node = np.empty(2 * capacity, dtype=np.int64)
    weight, block = np.empty((2 * capacity, 4)), np.empty((2 * capacity, rank, rank))
    for source in range(capacity):
        node[source] = sources.node[source]
        for i in range(4):
            weight[source, i] = sources.weight[source, i]
        _copy(sources.block[source], block[source])
    return _Sources(node, weight, block)


@njit(**KERNEL)
def _copy(given, out):
    for i in range(given.shape[0]):
        for j in range(given.shape[1]):
            out[i, j] = given[i, j]


@njit(**KERNEL)
def _add(share, given, out):
    for i in range(given.shape[0]):
        for j in range(given.shape[1]):
            out[i, j] += share * given[i, j]


@njit(**KERNEL)
def _clear(out):
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = 0.0


@njit(**KERNEL)
def _hermite(s, length, out):
    """Weights of value and slope at the start, then at the end, of an interval."""
    out[0] = (1.0 + 2.0 * s) * (1.0 - s) ** 2
    out[1] = length * s * (1.0 - s) ** 2
    out[2] = s * s * (3.0 - 2.0 * s)
    out[3] = length * s * s * (s - 1.0)


@njit(**KERNEL)
def _step_at(border, time):
    """Step that holds a time of the period."""
    low, high = 0, border.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if border[middle] <= time:
            low = middle
        else:
            high = middle
    return low


@njit(**KERNEL)
def _add_source(border, step, time, earlier, rate, coupling, sources, count, now):
    """Add the coupling to the motion at an earlier time; returns the sources and their number."""
    steps = border.shape[0] - 1
    stiffness, dashpot = now
    sources = _room_for_one(sources, count)
    weight = sources.weight[count]
    start = border[step]
    if earlier > start:
        # within this very step: a cubic from its start to the point itself, which is solved for
        length = time - start
        _hermite(min(1.0, (earlier - start) / length), length * rate, weight)
        _add(-weight[2], coupling, stiffness)
        _add(-weight[3] / rate, coupling, dashpot)
        weight[2], weight[3] = 0.0, 0.0
        sources.node[count] = 2 * (steps + step)
    else:
        node = 2 * steps
        if earlier < border[0]:
            earlier = max(border[0], earlier + border[steps] - border[0])
            node = 0
        k = _step_at(border, earlier)
        half = 0.5 * (border[k + 1] - border[k])
        s = min(2.0, max(0.0, (earlier - border[k]) / half))
        node += 2 * k
        if s > 1.0:
            s -= 1.0
            node += 1
        _hermite(s, half * rate, weight)
        sources.node[count] = node
    _copy(coupling, sources.block[count])
    return sources, count + 1


@njit(**KERNEL)
def _add_contact(cut, share, stiffness, dashpot):
    """Add the contact of tool and work in the plane of the cut, alike in both directions."""
    rank = stiffness.shape[0]
    for i in range(rank):
        for j in range(rank):
            plane = cut.basis[0, i] * cut.basis[0, j] + cut.basis[1, i] * cut.basis[1, j]
            stiffness[i, j] += share * cut.contact[0] * plane
            dashpot[i, j] += share * cut.contact[1] * plane


@njit(**KERNEL)
def _couple(cut, turn, depth, border, step, time, speed_factor, rate, sources, count, now, work):
    """Couplings at one time: fill `now` (stiffness, dashpot) and append the sources."""
    pieces = cut.pieces
    stiffness, dashpot = now
    part, part_dashpot, of_delay, used = work
    _clear(stiffness)
    _clear(dashpot)
    for group in range(used.shape[0]):
        _clear(of_delay[group])
        used[group] = 0
    spindle, speed = angle_at(turn, time), speed_at(turn, time)
    engaged, in_contact = 0, 0.0
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        first, last = first_and_last_turn(pieces, piece, top, spindle)
        for back in range(first, last + 1):
            low, high = engaged_span(pieces, piece, top, spindle, back)
            if low >= high:
                continue
            engaged = 1
            in_contact += pieces.thickness[piece] * (
                share_of_height(pieces, piece, high) - share_of_height(pieces, piece, low)
            )
            waves = cut.fastest / (2.0 * math.pi * speed)
            extent = change_along(pieces, piece, waves) * (high - low)
            points, ends = points_along(pieces, piece, piece, low, high, extent, spindle)
            for q in range(points):
                x, share = crowd(cut.edge_place[points, q], cut.edge_weight[points, q], ends)
                place = low + x * (high - low)
                length = share * (high - low) * pieces.length[piece]
                coupling_at(
                    pieces, piece, place, spindle, length, speed_factor, cut.basis,
                    part, part_dashpot,
                )  # fmt: skip
                _add(1.0, part, stiffness)
                if speed_factor > 0.0:
                    _add(1.0, part_dashpot, dashpot)
                group = pieces.group[piece]
                if group >= 0:
                    used[group] = 1
                    _add(1.0, part, of_delay[group])
                    continue
                change = pieces.delay[piece, 1] - pieces.delay[piece, 0]
                delay = pieces.delay[piece, 0]
                delay += share_of_height(pieces, piece, place) * change
                earlier = time_at(turn, spindle - delay)
                sources, count = _add_source(
                    border, step, time, earlier, rate, part, sources, count, now
                )
    if cut.contact[0] > 0.0 or cut.contact[1] > 0.0:
        _add_contact(cut, min(1.0, in_contact / depth / cut.contact[2]), stiffness, dashpot)
    for group in range(used.shape[0]):
        if used[group] == 1:
            earlier = time_at(turn, spindle - pieces.group_delay[group])
            sources, count = _add_source(
                border, step, time, earlier, rate, of_delay[group], sources, count, now
            )
    return engaged, sources, count


@njit(**KERNEL)
def _reach_of_force(cut, answer, displacement, velocity):
    """Displacement and velocity at both Gauss points from the forces there (2r, 2r)."""
    modes, rank = cut.shape.shape
    _clear(displacement)
    _clear(velocity)
    for m in range(modes):
        for p in range(2):
            for q in range(2):
                x, v = answer[m, p, 0, 2 + q], answer[m, p, 1, 2 + q] * cut.natural_frequency[m]
                for k in range(rank):
                    for l in range(rank):  # noqa: E741
                        both = cut.shape[m, k] * cut.force_gain[m, l]
                        displacement[p * rank + k, q * rank + l] += both * x
                        velocity[p * rank + k, q * rank + l] += both * v


@njit(**KERNEL)
def _eliminate(system, first, second):
    """Solve for two right-hand sides in their place; `system` is overwritten. Pivots by rows."""
    n = system.shape[0]
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(system[i, k]) > abs(system[pivot, k]):
                pivot = i
        for part in (system, first, second):
            for j in range(part.shape[1]):
                part[k, j], part[pivot, j] = part[pivot, j], part[k, j]
        scale = 1.0 / system[k, k]
        for part in (system, first, second):
            for j in range(part.shape[1]):
                part[k, j] *= scale
        for i in range(n):
            factor = system[i, k]
            if i == k or factor == 0.0:
                continue
            for part in (system, first, second):
                for j in range(part.shape[1]):
                    part[i, j] -= factor * part[k, j]


@njit(**KERNEL)
def _lengths(border):
    """Distinct lengths among neighbouring steps, and which of them each step has."""
    steps = border.shape[0] - 1
    length, which = np.empty(steps), np.empty(steps, dtype=np.int64)
    count = 0
    for k in range(steps):
        own = border[k + 1] - border[k]
        if count == 0 or abs(length[count - 1] - own) > _SAME_LENGTH * own:
            length[count] = own
            count += 1
        which[k] = count - 1
    return length[:count], which


@njit(**KERNEL)
def step_plan(cut, speed, depth, steps_a_wave, refinement):
    """Lay out the steps of one period.

    Parameters
    ----------
    cut : SteppedCut
    speed : float
        Mean spindle speed, rad/s.
    depth : float
        Axial depth, m.
    steps_a_wave : float
    refinement : int
        See `period_steps`.

    Returns
    -------
    StepPlan
    """
    turn = spindle_turn(cut.variation, speed, cut.period_angle)
    border = period_steps(cut, turn, depth, steps_a_wave, refinement)
    steps = border.shape[0] - 1
    modes, rank = cut.shape.shape
    length, which = _lengths(border)
    answer = np.empty((length.shape[0], modes, 4, 2, 4))
    for s in range(length.shape[0]):
        for m in range(modes):
            mode_answer(cut.natural_frequency[m], cut.damping[m], length[s], answer[s, m])
    engaged = np.zeros(steps, dtype=np.int64)
    from_motion = np.zeros((steps, 2 * rank, 4 * rank))
    from_earlier = np.zeros((steps, 2 * rank, 2 * rank))
    groups = cut.pieces.group_delay.shape[0]
    first = np.zeros(2 * steps + 1, dtype=np.int64)
    room = 2 * steps * (groups + 1)
    sources = _Sources(
        np.empty(room, dtype=np.int64), np.empty((room, 4)), np.empty((room, rank, rank))
    )
    now = np.empty((rank, rank)), np.empty((rank, rank))
    work = (
        np.empty((rank, rank)), np.empty((rank, rank)),
        np.empty((groups, rank, rank)), np.empty(groups, dtype=np.int64),
    )  # fmt: skip
    reach, reach_rate = np.empty((2 * rank, 2 * rank)), np.empty((2 * rank, 2 * rank))
    system = np.empty((2 * rank, 2 * rank))
    count = 0
    damped = cut.pieces.damping[1] > 0.0
    radius = radius_at(cut.pieces, depth)
    for k in range(steps):
        _clear(system)
        for i in range(2 * rank):
            system[i, i], from_earlier[k, i, i] = 1.0, 1.0
        _reach_of_force(cut, answer[which[k]], reach, reach_rate)
        span = border[k + 1] - border[k]
        for p in range(2):
            time = border[k] + PLACES[p] * span
            factor = 1.0 / (speed_at(turn, time) * radius) if damped else 0.0
            found, sources, count = _couple(
                cut, turn, depth, border, k, time, factor, cut.fastest, sources, count, now, work
            )
            engaged[k] = max(engaged[k], found)
            first[2 * k + p + 1] = count
            stiffness, dashpot = now
            for i in range(rank):
                row = p * rank + i
                for j in range(rank):
                    at = p * rank + j
                    from_motion[k, row, at] = -stiffness[i, j]
                    from_motion[k, row, 2 * rank + at] = -dashpot[i, j] * cut.fastest
                    for column in range(2 * rank):
                        system[row, column] += stiffness[i, j] * reach[at, column]
                        system[row, column] += dashpot[i, j] * reach_rate[at, column]
        if engaged[k] == 1:
            _eliminate(system, from_motion[k], from_earlier[k])
    return StepPlan(
        border, which, answer, engaged, from_motion, from_earlier, first,
        sources.node[:count], sources.weight[:count], sources.block[:count],
        cut.shape, cut.shape * (cut.natural_frequency / cut.fastest).reshape(modes, 1),
        cut.force_gain, cut.fastest,
    )  # fmt: skip
