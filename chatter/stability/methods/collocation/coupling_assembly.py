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

from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.methods.collocation.coupling_structure import (
    alike,
    packed_numbers,
    packed_plans,
    packed_structure,
)
from chatter.stability.methods.collocation.element_borders import empty_borders, period_borders
from chatter.stability.methods.collocation.element_layout import (
    element_before,
    element_counts,
    element_layout,
    speed_step,
)
from chatter.stability.spindle_rotation import (
    STEADY_TURN,
    angle_at,
    in_mean_angle,
    speed_at,
    spindle_turn,
    time_at,
)
from cutting.edge_segments.coupling import coupling_at, part_below, radius_at, share_of_height
from cutting.edge_segments.engaged_intervals import (
    crowd,
    length_of_run,
    place_in_run,
    points_along,
    reach_of_piece,
    run_from,
    turns_of_chain,
)

#: points closer than this share of an element are the same
_SAME_POINT = 1e-7
#: the order of a quadrature along the edge follows the speed in steps of this power of two
_SPEED_STEP = 0.5


class _Sources(NamedTuple):
    """Blocks that take the motion at the points of an earlier element to the force at a point."""

    element: NDArray[np.int64]
    point: NDArray[np.int64]
    block: NDArray[np.float64]  # N/m (sources, r, (p + 1) r)
    share: NDArray[np.float64]  # of each point of an element in a place (p + 1,), scratch


class _EdgeRule(NamedTuple):
    """Quadrature along the edge."""

    place: NDArray[np.float64]
    weight: NDArray[np.float64]
    longest: float  # element, s
    speed: float  # for which it is made, rad/s


@njit(**INNER_KERNEL)
def _empty_sources(count, rank, width):
    """Room for sources."""
    whole = np.empty(count, dtype=np.int64)
    return _Sources(
        whole, np.empty(count, dtype=np.int64), np.empty((count, rank, width)),
        np.empty(width // rank),
    )  # fmt: skip


@njit(**INNER_KERNEL)
def _grown(sources):
    """Twice the room for sources."""
    count, rank, width = sources.block.shape
    larger = _empty_sources(2 * count, rank, width)
    for i in range(count):
        larger.element[i], larger.point[i] = sources.element[i], sources.point[i]
        for k in range(rank):
            for j in range(width):
                larger.block[i, k, j] = sources.block[i, k, j]
    return larger


@njit(**SINGLE_KERNEL)
def _begin_source(sources, at, element):
    """Make an empty source of an element."""
    sources.element[at], sources.point[at] = element, -2
    for k in range(sources.block.shape[1]):
        for j in range(sources.block.shape[2]):
            sources.block[at, k, j] = 0.0


@njit(**SINGLE_KERNEL)
def _add_source(points, sources, at, place, couplings, which):
    """Add a coupling to the motion at a place in an element to a source."""
    rank, count = couplings.shape[1], points.place.shape[0]
    near, total = -1, 0.0
    for q in range(count):
        distance = place - points.place[q]
        if abs(distance) < _SAME_POINT:
            near = q
            distance = _SAME_POINT
        sources.share[q] = points.barycentric[q] / distance
        total += sources.share[q]
    for q in range(count):
        share = sources.share[q] / total
        if near >= 0:
            share = 1.0 if near == q else 0.0
        for i in range(rank):
            for j in range(rank):
                sources.block[at, i, q * rank + j] += share * couplings[which, i, j]
    # -2: nothing there as yet
    known = sources.point[at]
    sources.point[at] = near if known in (-2, near) else -1


@njit(**LEAF_KERNEL)
def _note(points, layout, angle, sources, first, count, couplings, which):
    """Add a coupling to the motion at an earlier mean angle; returns the number of sources."""
    element, place = element_before(layout, angle)
    found = count
    for entry in range(first, count):
        if sources.element[entry] == element:
            found = entry
            break
    if found == count:
        _begin_source(sources, found, element)
    _add_source(points, sources, found, place, couplings, which)
    return max(count, found + 1)


@njit(**LEAF_KERNEL)
def _couple(
    pieces, tops, reach, rule, basis, points, layout, turn, speed_factor, angle, sources,
    first_source, row, stiffness, dashpot, groups, part, part_dashpot,
):  # fmt: skip
    """Enter the couplings at one mean angle; returns the number of sources."""
    rank = basis.shape[1]
    used = groups.shape[0] - 1
    for group in range(used):
        for i in range(rank):
            for j in range(rank):
                groups[group, i, j] = 0.0
    count = first_source
    spindle, turning = angle_at(turn, angle), speed_at(turn, angle)
    elements = 1.0 / (rule.speed * turning * rule.longest)
    for chain in range(pieces.chain.shape[0] - 1):
        first, last = turns_of_chain(pieces, reach, chain, spindle)
        for back in range(first, last + 1):
            piece, end = pieces.chain[chain], pieces.chain[chain + 1]
            while piece < end:
                final, low, high, change = run_from(
                    pieces, tops, reach, piece, end, spindle, back, elements
                )
                if final < piece:
                    piece += 1
                    continue
                order, ends = points_along(pieces, piece, final, low, high, change, spindle)
                length = length_of_run(pieces, piece, final, low, high)
                at, start = piece, -low * pieces.length[piece]
                for q in range(order):
                    x, share = crowd(rule.place[order, q], rule.weight[order, q], ends)
                    at, place, start = place_in_run(pieces, at, final, start, x * length)
                    coupling_at(
                        pieces, at, place, spindle, share * length, speed_factor / turning, basis,
                        part, part_dashpot,
                    )  # fmt: skip
                    # the last of the groups is that of the single point
                    group = pieces.group[at]
                    into = group if group >= 0 else used
                    for i in range(rank):
                        for j in range(rank):
                            stiffness[row, i, j] += part[i, j]
                            dashpot[row, i, j] += part_dashpot[i, j]
                            groups[into, i, j] = part[i, j] + (
                                groups[into, i, j] if group >= 0 else 0.0
                            )
                    if group < 0:
                        shift = pieces.delay[at, 1] - pieces.delay[at, 0]
                        delay = pieces.delay[at, 0] + share_of_height(pieces, at, place) * shift
                        earlier = time_at(turn, spindle - delay)
                        count = _note(
                            points, layout, earlier, sources, first_source, count, groups, used
                        )
                piece = final + 1
    for group in range(used):
        filled = False
        for i in range(rank):
            for j in range(rank):
                filled |= groups[group, i, j] != 0.0
        if filled:
            earlier = time_at(turn, spindle - pieces.group_delay[group])
            count = _note(points, layout, earlier, sources, first_source, count, groups, group)
    return count


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
        `speed_step` of the mean spindle speed, rad/s.
    depth : float
        Axial depth, m.

    Returns
    -------
    structure : (i,) array of int
        See `plan_structure`.
    numbers : (n,) array of float
        Period, lengths (S,), starts and lengths of the elements in the cut (E,), rad; stiffness
        (E p, r, r), dashpots (E p, r, r) times the mean speed, blocks of the sources, N/m.
    """
    points, pieces, basis = cut.points, cut.pieces, cut.basis
    rank, count_a_element = basis.shape[1], points.weight.shape[0]
    cuts = layout.cut_start.shape[0]
    rows = cuts * count_a_element
    tops = np.empty(pieces.bottom.shape[0])
    longest = 0.0
    for piece in range(tops.shape[0]):
        tops[piece] = part_below(pieces, piece, depth)
        if tops[piece] > 0.0 and pieces.group[piece] < 0:
            longest = max(longest, max(pieces.delay[piece, 0], pieces.delay[piece, 1]))
    # a delay that varies along the edge reaches into no more elements than there are that far back
    most = pieces.group_delay.shape[0]
    if longest > 0.0:
        most += cuts * (2 + math.ceil(2.0 * longest / layout.period))
    reach = np.empty((tops.shape[0], 4))
    for piece in range(tops.shape[0]):
        reach_of_piece(pieces, tops, piece, reach[piece])
    sources = _empty_sources(rows + most, rank, (count_a_element + 1) * rank)
    stiffness, dashpot = np.zeros((rows, rank, rank)), np.zeros((rows, rank, rank))
    groups = np.empty((pieces.group_delay.shape[0] + 1, rank, rank))
    part, part_dashpot = np.empty((rank, rank)), np.zeros((rank, rank))
    rule = _EdgeRule(cut.edge_place, cut.edge_weight, cut.resolution.longest, speed)
    damped = pieces.damping[1] > 0.0
    speed_factor = 1.0 / radius_at(pieces, depth) if damped else 0.0
    first_source = np.zeros(rows + 1, dtype=np.int64)
    for row in range(rows):
        e, i = row // count_a_element, row % count_a_element
        angle = layout.cut_start[e] + points.place[i + 1] * layout.cut_length[e]
        count = first_source[row]
        if count + most > sources.element.shape[0]:
            sources = _grown(sources)
        first_source[row + 1] = _couple(
            pieces, tops, reach, rule, basis, points, layout, turn, speed_factor, angle, sources,
            count, row, stiffness, dashpot, groups, part, part_dashpot,
        )  # fmt: skip
    if turn.amplitude > 0.0:
        # what falls on a point by chance would make structures differ
        sources.point[:] = -1
    return (
        packed_structure(layout, first_source, sources.element, sources.point),
        packed_numbers(layout, stiffness, dashpot, sources.block, first_source[rows]),
    )


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
    Plans
    """
    of_point = np.empty(speeds.shape[0], dtype=np.int64)
    structures = [np.empty(0, dtype=np.int64) for _ in range(0)]
    numbers = [np.empty(0) for _ in range(0)]
    constant = cut.variation.amplitude == 0.0
    turn, period = STEADY_TURN, cut.period_angle
    counts, speed, borders = np.empty(0, dtype=np.int64), 0.0, empty_borders()
    for i in range(speeds.shape[0]):
        if not constant:
            turn = in_mean_angle(spindle_turn(cut.variation, speeds[i], period))
        beside = constant and i > 0 and depths[i] == depths[i - 1]
        if not beside:
            borders = period_borders(cut.pieces, period, depths[i])
        needed = element_counts(cut.resolution, borders, turn, period, speeds[i], depths[i])
        resolved = speed_step(speeds[i], _SPEED_STEP)
        if not (beside and speed == resolved and alike(needed, counts)):
            counts, speed = needed, resolved
            layout = element_layout(borders, counts, turn, period)
            structure, filled = cut_plan(cut, turn, layout, speed, depths[i])
            structures.append(structure)
            numbers.append(filled)
        of_point[i] = len(structures) - 1
    return packed_plans(structures, numbers, of_point)
