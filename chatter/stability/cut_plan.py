"""What the cut couples over one period: elements, stiffness, dashpots, and the earlier motion.

All places are mean angles (time times the mean speed): at a constant speed the plan depends on the
speed only through the number of elements, so that neighbouring speeds share it. A plan is packed
into whole numbers that tell its structure and real ones that fill it: plans of the same structure
go side by side into the lanes of one map.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import INNER_KERNEL, SINGLE_KERNEL
from chatter.stability.element_layout import (
    element_before,
    element_counts,
    element_layout,
    empty_borders,
    period_borders,
)
from chatter.stability.spindle_turn import (
    angle_at,
    in_mean_angle,
    speed_at,
    spindle_turn,
    time_at,
)
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
#: the order of a quadrature along the edge follows the speed in steps of this power of two
_SPEED_STEP = 0.5
#: whole numbers before the lists of a structure
_HEADER = 5


class PlanStructure(NamedTuple):
    """Structure of a plan: M elements, E of them in the cut, S distinct lengths, p points each."""

    cut: NDArray[np.int64]  # number of each element among those in the cut, or -1 (M,)
    shape: NDArray[np.int64]  # number of the length of each element (M,)
    length_cuts: NDArray[np.int64]  # 1 where an element in the cut has the length (S,)
    first_source: NDArray[np.int64]  # of each point (E p + 1,)
    source: NDArray[np.int64]  # element, counted from the period's first; negative before it
    point: NDArray[np.int64]  # the only one that a source needs of its element, or -1
    memory: int  # elements before the period that are looked back to


class _Sources(NamedTuple):
    """Blocks that take the motion at the points of an earlier element to the force at a point."""

    element: NDArray[np.int64]
    point: NDArray[np.int64]
    block: NDArray[np.float64]  # N/m (sources, r, (p + 1) r)


class _EdgeRule(NamedTuple):
    """Quadrature along the edge."""

    place: NDArray[np.float64]
    weight: NDArray[np.float64]
    longest: float  # element, s
    speed: float  # for which it is made, rad/s


@njit(**INNER_KERNEL)
def resolution_speed(speed):
    """Speed, at most the given one, for which the edges are resolved; rad/s."""
    return 2.0 ** (_SPEED_STEP * math.floor(math.log2(speed) / _SPEED_STEP))


@njit(**INNER_KERNEL)
def _edge_points(rule, pieces, piece, span, turning):
    """Order of the quadrature along a part of a piece."""
    turned = abs(pieces.angle[piece, 1] - pieces.angle[piece, 0]) * span
    bend = abs(pieces.immersion[piece, 1] - pieces.immersion[piece, 0]) * span
    if turned + bend < 1e-9 and pieces.group[piece] >= 0:
        return 1
    if pieces.exponent != 0.0:
        return 16
    shift = abs(pieces.delay[piece, 1] - pieces.delay[piece, 0]) * span
    waves = shift / (rule.speed * turning * rule.longest)
    return min(16, 2 + math.ceil(2.5 * (turned + bend) + 5.0 * waves))


@njit(**INNER_KERNEL)
def _grown(sources):
    """Twice the room for sources."""
    count, rank, width = sources.block.shape
    element, point = np.empty(2 * count, dtype=np.int64), np.empty(2 * count, dtype=np.int64)
    block = np.empty((2 * count, rank, width))
    for i in range(count):
        element[i], point[i] = sources.element[i], sources.point[i]
        for k in range(rank):
            for j in range(width):
                block[i, k, j] = sources.block[i, k, j]
    return _Sources(element, point, block)


@njit(**SINGLE_KERNEL)
def _add_source(points, sources, found, place, stiffness):
    """Add the coupling to the motion at a place in an element to a source."""
    block = sources.block[found]
    rank, count = stiffness.shape[0], points.place.shape[0]
    near, total = -1, 0.0
    for q in range(count):
        distance = place - points.place[q]
        if abs(distance) < _SAME_POINT:
            near = q
        else:
            total += points.barycentric[q] / distance
    for q in range(count):
        share = 1.0 if near == q else 0.0
        if near < 0:
            share = points.barycentric[q] / (place - points.place[q]) / total
        if share != 0.0:
            for i in range(rank):
                for j in range(rank):
                    block[i, q * rank + j] += share * stiffness[i, j]
    # -2: nothing there as yet
    known = sources.point[found]
    sources.point[found] = near if known in (-2, near) else -1


@njit(**SINGLE_KERNEL)
def _source_of(element, sources, first, count):
    """Place of the source of an element among those from `first` on, an empty one if none is."""
    for entry in range(first, count):
        if sources.element[entry] == element:
            return entry
    sources.element[count], sources.point[count] = element, -2
    block = sources.block[count]
    for k in range(block.shape[0]):
        for j in range(block.shape[1]):
            block[k, j] = 0.0
    return count


@njit(**INNER_KERNEL)
def _note(points, layout, turn, sources, first, count, angle, stiffness):
    """Add the coupling to the motion at an earlier spindle angle; returns sources and number."""
    element, place = element_before(layout, time_at(turn, angle))
    if count == sources.element.shape[0]:
        sources = _grown(sources)
    found = _source_of(element, sources, first, count)
    _add_source(points, sources, found, place, stiffness)
    return sources, max(count, found + 1)


@njit(**INNER_KERNEL)
def _couple(
    pieces, rule, basis, points, layout, turn, depth, angle, sources, count, stiffness, dashpot,
    groups, used,
):  # fmt: skip
    """Couplings at one mean angle: fill stiffness and dashpot and append the sources."""
    rank = stiffness.shape[0]
    part, part_dashpot = np.empty((rank, rank)), np.empty((rank, rank))
    _clear(stiffness)
    _clear(dashpot)
    for group in range(used.shape[0]):
        used[group] = 0
        _clear(groups[group])
    first_source = count
    spindle, turning = angle_at(turn, angle), speed_at(turn, angle)
    damped = pieces.damping[1] > 0.0
    speed_factor = 1.0 / (radius_at(pieces, depth) * turning) if damped else 0.0
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        group = pieces.group[piece]
        first, last = first_and_last_turn(pieces, piece, top, spindle)
        for back in range(first, last + 1):
            low, high = engaged_span(pieces, piece, top, spindle, back)
            straight = pieces.angle[piece, 0] == pieces.angle[piece, 1]
            if low >= high and not (straight and low <= high):
                continue
            order = _edge_points(rule, pieces, piece, high - low, turning)
            for q in range(order):
                x, share = rule.place[order, q], rule.weight[order, q]
                if pieces.exponent != 0.0 and order > 1:
                    # towards both ends, where the chip may vanish
                    share *= 30.0 * (x * (1.0 - x)) ** 2
                    x = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
                place = low + x * (high - low)
                weight = share * (high - low) * pieces.length[piece]
                coupling_at(
                    pieces, piece, place, spindle, weight, speed_factor, basis, part, part_dashpot
                )
                _add(part, stiffness)
                if damped:
                    _add(part_dashpot, dashpot)
                if group >= 0:
                    used[group] = 1
                    _add(part, groups[group])
                    continue
                delay = pieces.delay[piece, 0]
                delay += share_of_height(pieces, piece, place) * (
                    pieces.delay[piece, 1] - pieces.delay[piece, 0]
                )
                sources, count = _note(
                    points, layout, turn, sources, first_source, count, spindle - delay, part
                )
    for group in range(used.shape[0]):
        if used[group] == 1:
            angle = spindle - pieces.group_delay[group]
            sources, count = _note(
                points, layout, turn, sources, first_source, count, angle, groups[group]
            )
    return sources, count


@njit(**INNER_KERNEL)
def _clear(a):
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            a[i, j] = 0.0


@njit(**INNER_KERNEL)
def _add(a, b):
    """Add a to b."""
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            b[i, j] += a[i, j]


@njit(**SINGLE_KERNEL)
def cut_plan(cut, turn, layout, speed, depth):
    """Couplings at the points of all elements of a period, packed.

    Parameters
    ----------
    cut : CutArrays
    turn : SpindleTurn
        In mean angle.
    layout : ElementLayout
    speed : float
        `resolution_speed` of the mean spindle speed, rad/s.
    depth : float
        Axial depth, m.

    Returns
    -------
    structure : (i,) array of int
        See `structure_of_plan`.
    numbers : (n,) array of float
        See `numbers_of_plan`.
    """
    points, pieces = cut.points, cut.pieces
    rank, count_a_element = cut.basis.shape[1], points.weight.shape[0]
    cuts = layout.cut_start.shape[0]
    rows = cuts * count_a_element
    sources = _Sources(
        np.empty(rows + 8, dtype=np.int64),
        np.empty(rows + 8, dtype=np.int64),
        np.empty((rows + 8, rank, (count_a_element + 1) * rank)),
    )
    stiffness, dashpot = np.empty((rows, rank, rank)), np.empty((rows, rank, rank))
    groups = np.empty((pieces.group_delay.shape[0], rank, rank))
    used = np.empty(groups.shape[0], dtype=np.int64)
    rule = _EdgeRule(cut.edge_place, cut.edge_weight, cut.resolution.longest, speed)
    first_source = np.zeros(rows + 1, dtype=np.int64)
    count = 0
    for e in range(cuts):
        for i in range(count_a_element):
            row = e * count_a_element + i
            angle = layout.cut_start[e] + points.place[i + 1] * layout.cut_length[e]
            sources, count = _couple(
                pieces, rule, cut.basis, points, layout, turn, depth, angle, sources, count,
                stiffness[row], dashpot[row], groups, used,
            )  # fmt: skip
            first_source[row + 1] = count
    return (
        _packed_structure(layout, first_source, sources, count),
        _packed_numbers(layout, stiffness, dashpot, sources.block[:count]),
    )


@njit(**INNER_KERNEL)
def _put(part, out, at):
    """Copy an array of one axis into another from a place on; returns the next place."""
    for i in range(part.shape[0]):
        out[at + i] = part[i]
    return at + part.shape[0]


@njit(**SINGLE_KERNEL)
def _packed_structure(layout, first_source, sources, count):
    elements, lengths = layout.cut.shape[0], layout.length_cuts.shape[0]
    out = np.empty(
        _HEADER + 2 * elements + lengths + first_source.shape[0] + 2 * count, dtype=np.int64
    )
    out[0], out[1], out[2] = elements, lengths, layout.cut_start.shape[0]
    memory = 0
    for entry in range(count):
        memory = max(memory, -sources.element[entry])
    out[3], out[4] = count, memory
    at = _put(layout.cut, out, _HEADER)
    at = _put(layout.shape, out, at)
    at = _put(layout.length_cuts, out, at)
    at = _put(first_source, out, at)
    at = _put(sources.element[:count], out, at)
    _put(sources.point[:count], out, at)
    return out


@njit(**SINGLE_KERNEL)
def _packed_numbers(layout, stiffness, dashpot, block):
    out = np.empty(
        1 + layout.length.shape[0] + 2 * layout.cut_start.shape[0] + 2 * stiffness.size + block.size
    )
    out[0] = layout.period
    at = _put(layout.length, out, 1)
    at = _put(layout.cut_start, out, at)
    at = _put(layout.cut_length, out, at)
    at = _put(stiffness.reshape(stiffness.size), out, at)
    at = _put(dashpot.reshape(stiffness.size), out, at)
    _put(block.reshape(block.size), out, at)
    return out


@njit(**INNER_KERNEL)
def structure_of_plan(packed):
    """Unpack the structure of a plan.

    Returns
    -------
    PlanStructure
    """
    elements, lengths, count = packed[0], packed[1], packed[3]
    points = packed.shape[0] - _HEADER - 2 * elements - lengths - 2 * count
    a = _HEADER + elements
    b = a + elements
    c = b + lengths
    d = c + points
    e = d + count
    return PlanStructure(
        packed[_HEADER:a], packed[a:b], packed[b:c], packed[c:d], packed[d:e], packed[e:], packed[4]
    )


@njit(**INNER_KERNEL)
def alike(one, other):
    """Tell whether two packed structures are the same: lanes of one map may hold both plans."""
    if one.shape[0] != other.shape[0]:
        return False
    return np.all(one == other)


@njit(**SINGLE_KERNEL)
def plans_of(cut, speeds, depths):
    """Plans of n points; neighbours of equal depth and equal elements share one.

    Parameters
    ----------
    cut : CutArrays
    speeds, depths : (n,) array of float
        rad/s, m.

    Returns
    -------
    structures : list of arrays of int
    numbers : list of arrays of float
    of_point : (n,) array of int
        Place in the lists.
    """
    of_point = np.empty(speeds.shape[0], dtype=np.int64)
    structures = [np.empty(0, dtype=np.int64) for _ in range(0)]
    numbers = [np.empty(0) for _ in range(0)]
    constant = cut.variation.amplitude == 0.0
    counts, speed, borders = np.empty(0, dtype=np.int64), 0.0, empty_borders()
    for i in range(speeds.shape[0]):
        turn = in_mean_angle(spindle_turn(cut.variation, speeds[i], cut.period_angle))
        beside = constant and i > 0 and depths[i] == depths[i - 1]
        if not beside:
            borders = period_borders(cut.pieces, cut.period_angle, turn, depths[i])
        needed = element_counts(cut.resolution, borders, speeds[i], depths[i])
        resolved = resolution_speed(speeds[i])
        if not (beside and speed == resolved and alike(needed, counts)):
            counts, speed = needed, resolved
            layout = element_layout(borders, counts)
            structure, filled = cut_plan(cut, turn, layout, speed, depths[i])
            structures.append(structure)
            numbers.append(filled)
        of_point[i] = len(structures) - 1
    return structures, numbers, of_point
