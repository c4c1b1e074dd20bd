"""What the cut couples over one period: elements, stiffness, dashpots, and the earlier motion.

All places are mean angles (time times the mean speed): at a constant speed the plan depends on the
speed only through the number of elements, so that neighbouring speeds share it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import KERNEL
from chatter.stability.element_layout import (
    ElementLayout,
    element_before,
    element_counts,
    element_layout,
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


class CutPlan(NamedTuple):
    """M elements, E of them in the cut, p points on each, r directions of motion.

    A source is a block (r, (p + 1) r) that takes the motion at the points of an earlier element to
    the force at one point, or, with `point` >= 0, the motion at that point alone.
    """

    layout: ElementLayout
    stiffness: NDArray[np.float64]  # N/m (E p, r, r)
    dashpot: NDArray[np.float64]  # times the mean speed, N/m (E p, r, r)
    first_source: NDArray[np.int64]  # of each point (E p + 1,)
    source: NDArray[np.int64]  # element, counted from the period's first; negative before it
    point: NDArray[np.int64]
    block: NDArray[np.float64]  # N/m (sources, r, (p + 1) r)
    memory: int  # elements before the period that are looked back to


class _Sources(NamedTuple):
    element: NDArray[np.int64]
    point: NDArray[np.int64]
    block: NDArray[np.float64]


@njit(**KERNEL)
def resolution_speed(speed):
    """Speed, at most the given one, for which the edges are resolved; rad/s."""
    return 2.0 ** (_SPEED_STEP * math.floor(math.log2(speed) / _SPEED_STEP))


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
    return _Sources(element, point, block)


@njit(**KERNEL)
def _note_source(cut, layout, sources, first, count, angle, stiffness):
    """Add the coupling to the motion at an earlier place; returns the sources and their number."""
    element, place = element_before(layout, angle)
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
                block[i, near * rank + j] += stiffness[i, j]
        return sources, count
    total = 0.0
    for q in range(points):
        total += cut.points.barycentric[q] / (place - cut.points.place[q])
    for q in range(points):
        share = cut.points.barycentric[q] / (place - cut.points.place[q]) / total
        for i in range(rank):
            for j in range(rank):
                block[i, q * rank + j] += share * stiffness[i, j]
    return sources, count


@njit(**KERNEL)
def _couple(cut, layout, turn, depth, speed, angle, sources, count, stiffness, dashpot, work):
    """Couplings at one mean angle: fill stiffness and dashpot and append the sources."""
    pieces = cut.pieces
    part, part_dashpot, groups, used = work
    rank = stiffness.shape[0]
    stiffness[:, :] = 0.0
    dashpot[:, :] = 0.0
    groups[:, :, :] = 0.0
    used[:] = 0
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
            order = _edge_points(cut, piece, high - low, speed * turning)
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
                        if damped:
                            dashpot[i, j] += part_dashpot[i, j]
                        if group >= 0:
                            groups[group, i, j] += part[i, j]
                if group >= 0:
                    used[group] = 1
                    continue
                delay = pieces.delay[piece, 0]
                delay += share_of_height(pieces, piece, place) * (
                    pieces.delay[piece, 1] - pieces.delay[piece, 0]
                )
                earlier = time_at(turn, spindle - delay)
                sources, count = _note_source(
                    cut, layout, sources, first_source, count, earlier, part
                )
    for group in range(used.shape[0]):
        if used[group] == 1:
            earlier = time_at(turn, spindle - pieces.group_delay[group])
            sources, count = _note_source(
                cut, layout, sources, first_source, count, earlier, groups[group]
            )
    return sources, count


@njit(**KERNEL)
def cut_plan(cut, turn, layout, speed, depth):
    """Couplings at the points of all elements of a period.

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
    CutPlan
    """
    rank = cut.shape.shape[1]
    points, cuts = cut.points.weight.shape[0], layout.cut_start.shape[0]
    sources = _Sources(
        np.empty(cuts * points + 8, dtype=np.int64),
        np.empty(cuts * points + 8, dtype=np.int64),
        np.empty((cuts * points + 8, rank, (points + 1) * rank)),
    )
    stiffness, dashpot = np.empty((cuts * points, rank, rank)), np.empty((cuts * points, rank, rank))
    groups = cut.pieces.group_delay.shape[0]
    work = (
        np.empty((rank, rank)),
        np.zeros((rank, rank)),
        np.empty((groups, rank, rank)),
        np.empty(groups, dtype=np.int64),
    )
    first_source = np.zeros(cuts * points + 1, dtype=np.int64)
    count = 0
    for e in range(cuts):
        for i in range(points):
            row = e * points + i
            angle = layout.cut_start[e] + cut.points.place[i + 1] * layout.cut_length[e]
            sources, count = _couple(
                cut, layout, turn, depth, speed, angle, sources, count,
                stiffness[row], dashpot[row], work,
            )  # fmt: skip
            first_source[row + 1] = count
    memory = 0
    for entry in range(count):
        memory = max(memory, -sources.element[entry])
    return CutPlan(
        layout, stiffness, dashpot, first_source, sources.element[:count], sources.point[:count],
        sources.block[:count], memory,
    )  # fmt: skip


@njit(**KERNEL)
def _same(a, b):
    """Tell whether two arrays of whole numbers are the same."""
    if a.shape[0] != b.shape[0]:
        return False
    for i in range(a.shape[0]):
        if a[i] != b[i]:
            return False
    return True


@njit(**KERNEL)
def alike(one, other):
    """Tell whether two plans differ in nothing but numbers: lanes of one map may hold them."""
    return (
        _same(one.layout.cut, other.layout.cut)
        and _same(one.layout.shape, other.layout.shape)
        and _same(one.layout.length_cuts, other.layout.length_cuts)
        and _same(one.first_source, other.first_source)
        and _same(one.source, other.source)
        and _same(one.point, other.point)
    )


@njit(**KERNEL)
def plans_of(cut, speeds, depths):
    """Plans of n points; neighbours of equal depth and equal elements share one.

    Parameters
    ----------
    cut : CutArrays
    speeds, depths : (n,) array of float
        rad/s, m.

    Returns
    -------
    plans : list of CutPlan
    of_point : (n,) array of int
        Place in the list.
    """
    of_point = np.zeros(speeds.shape[0], dtype=np.int64)
    turn = in_mean_angle(spindle_turn(cut.variation, speeds[0], cut.period_angle))
    borders = period_borders(cut, turn, depths[0])
    counts = element_counts(cut, borders, speeds[0], depths[0])
    speed = resolution_speed(speeds[0])
    plans = [cut_plan(cut, turn, element_layout(borders, counts), speed, depths[0])]
    constant = cut.variation.amplitude == 0.0
    for i in range(1, speeds.shape[0]):
        beside = constant and depths[i] == depths[i - 1]
        if not beside:
            turn = in_mean_angle(spindle_turn(cut.variation, speeds[i], cut.period_angle))
            borders = period_borders(cut, turn, depths[i])
        needed = element_counts(cut, borders, speeds[i], depths[i])
        same = beside and speed == resolution_speed(speeds[i]) and _same(needed, counts)
        if not same:
            counts, speed = needed, resolution_speed(speeds[i])
            plans.append(cut_plan(cut, turn, element_layout(borders, counts), speed, depths[i]))
        of_point[i] = len(plans) - 1
    return plans, of_point
