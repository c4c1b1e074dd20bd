"""What the cut couples over one period: elements, stiffness, dashpots, and the earlier motion.

All positions are mean angles (time times the mean speed): at a constant speed the assembly depends
on the speed only through the number of elements, so that neighbouring speeds share it. A assembly
is packed into whole numbers that give its structure and real ones that fill it: assemblies of the
same structure go side by side into one SIMD batch.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import DRIVER, INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.methods.collocation.coupling_structure import (
    packed_assemblies,
    packed_numbers,
    packed_structure,
    same_structure,
)
from chatter.stability.methods.collocation.element_borders import empty_borders, period_borders
from chatter.stability.methods.collocation.element_layout import (
    element_before,
    element_counts,
    element_layout,
    speed_step,
)
from chatter.stability.spindle_rotation import (
    STEADY_ROTATION,
    angle_at,
    in_mean_angle,
    speed_at,
    spindle_rotation_at,
    time_at,
)
from cutting.edge_segments.coupling import coupling_at, delay_at, part_below, radius_at
from cutting.edge_segments.engaged_intervals import (
    engaged_interval_from,
    graded,
    length_of_interval,
    points_along,
    position_in_interval,
    reach_of_segment,
    revolutions_of_group,
)
from cutting.process_damping.linear_flank import inverse_radius

#: points closer than this share of an element are the same
_SAME_POINT = 1e-7
#: the order of a quadrature along the edge follows the speed in steps of this power of two
_SPEED_STEP = 0.5


class _Sources(NamedTuple):
    """Blocks that take the motion at the points of an earlier element to the force at a point."""

    element: IntegerArray
    point: IntegerArray
    block: Array  # N/m (sources, r, (p + 1) r)
    share: Array  # of each point of an element in a position (p + 1,), scratch


class _Edge(NamedTuple):
    """Edge segments down to a depth, and the quadrature along them."""

    tops: Array  # part of each segment below the depth (P,)
    reach: Array  # spindle angles, see `reach_of_segment`, rad (P, 4)
    elements: float  # that pass while the tool turns by a radian at the mean speed
    speed_factor: float  # one over the radius where there are dashpots, else 0, 1/m


class _Couplings(NamedTuple):
    """Couplings at all points of a period, and scratch for one of them."""

    stiffness: Array  # N/m (E p, r, r)
    dashpot: Array  # N s/m times the mean speed (E p, r, r)
    of_delay: Array  # of each distinct delay, last of a single point (G + 1, r, r)
    part: Array  # (r, r)
    part_dashpot: Array  # (r, r)


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
def _add_source(points, sources, at, position, couplings, which):
    """Add a coupling to the motion at a position in an element to a source."""
    rank, count = couplings.shape[1], points.position.shape[0]
    near, total = -1, 0.0
    for q in range(count):
        distance = position - points.position[q]
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
def _add_delayed(points, layout, angle, sources, first, count, couplings, which):
    """Add a coupling to the motion at an earlier mean angle; returns the number of sources."""
    element, position = element_before(layout, angle)
    found = count
    for entry in range(first, count):
        if sources.element[entry] == element:
            found = entry
            break
    if found == count:
        _begin_source(sources, found, element)
    _add_source(points, sources, found, position, couplings, which)
    return max(count, found + 1)


@njit(**LEAF_KERNEL)
def _couple(cut, edge, layout, rotation, angle, row, first_source, sources, couplings):
    """Enter the couplings at one mean angle; returns the number of sources."""
    segments, basis, points = cut.arrays.segments, cut.arrays.basis, cut.points
    stiffness, dashpot, of_delay = couplings.stiffness, couplings.dashpot, couplings.of_delay
    part, part_dashpot = couplings.part, couplings.part_dashpot
    rank = basis.shape[1]
    used, held = of_delay.shape[0] - 1, segments.flank.stiffening
    for delay in range(used):
        for i in range(rank):
            for j in range(rank):
                of_delay[delay, i, j] = 0.0
    count = first_source
    spindle, turning = angle_at(rotation, angle), speed_at(rotation, angle)
    elements = edge.elements / turning
    for group in range(segments.first_of_group.shape[0] - 1):
        first, last = revolutions_of_group(segments, edge.reach, group, spindle)
        for back in range(first, last + 1):
            segment, end = segments.first_of_group[group], segments.first_of_group[group + 1]
            while segment < end:
                final, low, high, change = engaged_interval_from(
                    segments, edge.tops, edge.reach, segment, end, spindle, back, elements
                )
                if final < segment:
                    segment += 1
                    continue
                order, ends = points_along(segments, segment, final, low, high, change, spindle)
                length = length_of_interval(segments, segment, final, low, high)
                at, start = segment, -low * segments.length[segment]
                for q in range(order):
                    x, share = graded(
                        cut.arrays.edge_position[order, q], cut.arrays.edge_weight[order, q], ends
                    )
                    at, position, start = position_in_interval(
                        segments, at, final, start, x * length
                    )
                    coupling_at(
                        segments, at, position, spindle, share * length,
                        edge.speed_factor / turning, basis, part, part_dashpot,
                    )  # fmt: skip
                    delay = segments.delay_index[at]
                    into = delay if delay >= 0 else used
                    for i in range(rank):
                        for j in range(rank):
                            stiffness[row, i, j] += part[i, j] + held * part_dashpot[i, j]
                            dashpot[row, i, j] += part_dashpot[i, j]
                            of_delay[into, i, j] = part[i, j] + (
                                of_delay[into, i, j] if delay >= 0 else 0.0
                            )
                    if delay < 0:
                        earlier = time_at(rotation, spindle - delay_at(segments, at, position))
                        count = _add_delayed(
                            points, layout, earlier, sources, first_source, count, of_delay, used
                        )
                segment = final + 1
    for delay in range(used):
        filled = False
        for i in range(rank):
            for j in range(rank):
                filled |= of_delay[delay, i, j] != 0.0
        if filled:
            earlier = time_at(rotation, spindle - segments.distinct_delay[delay])
            count = _add_delayed(
                points, layout, earlier, sources, first_source, count, of_delay, delay
            )
    return count


@njit(**SINGLE_KERNEL)
def assemble_couplings(cut, rotation, layout, speed, depth):
    """Couplings at the points of all elements of a period, packed.

    The rotation is in mean angle, the speed the `speed_step` of the mean spindle speed, rad/s, the
    depth axial, m. Returned are the structure (i,) of `packed_structure`, and the numbers (n,):
    period, lengths (S,), starts and lengths of the elements in the cut (E,), rad; stiffness (E p,
    r, r), dashpots (E p, r, r) times the mean speed, blocks of the sources, N/m.
    """
    points, segments, rank = cut.points, cut.arrays.segments, cut.arrays.basis.shape[1]
    per_element = points.weight.shape[0]
    cuts = layout.cut_start.shape[0]
    rows = cuts * per_element
    tops, reach = np.empty(segments.bottom.shape[0]), np.empty((segments.bottom.shape[0], 4))
    longest = 0.0
    for segment in range(tops.shape[0]):
        tops[segment] = part_below(segments, segment, depth)
        reach_of_segment(segments, tops, segment, reach[segment])
        if tops[segment] > 0.0 and segments.delay_index[segment] < 0:
            longest = max(longest, max(segments.delay[segment, 0], segments.delay[segment, 1]))
    # a delay that varies along the edge reaches into no more elements than there are that far back
    most = segments.distinct_delay.shape[0]
    if longest > 0.0:
        most += cuts * (2 + math.ceil(2.0 * longest / layout.period))
    sources = _empty_sources(rows + most, rank, (per_element + 1) * rank)
    couplings = _Couplings(
        np.zeros((rows, rank, rank)), np.zeros((rows, rank, rank)),
        np.empty((segments.distinct_delay.shape[0] + 1, rank, rank)),
        np.empty((rank, rank)), np.zeros((rank, rank)),
    )  # fmt: skip
    edge = _Edge(
        tops, reach, 1.0 / (speed * cut.longest),
        inverse_radius(segments.flank, radius_at(segments, depth)),
    )  # fmt: skip
    first_source = np.zeros(rows + 1, dtype=np.int64)
    for row in range(rows):
        e, i = row // per_element, row % per_element
        angle = layout.cut_start[e] + points.position[i + 1] * layout.cut_length[e]
        count = first_source[row]
        if count + most > sources.element.shape[0]:
            sources = _grown(sources)
        first_source[row + 1] = _couple(
            cut, edge, layout, rotation, angle, row, count, sources, couplings
        )
    if rotation.amplitude > 0.0:
        # what falls on a point by chance would make structures differ
        sources.point[:] = -1
    return (
        packed_structure(layout, first_source, sources.element, sources.point),
        packed_numbers(
            layout, couplings.stiffness, couplings.dashpot, sources.block, first_source[rows]
        ),
    )


@njit(**DRIVER)
def coupling_assemblies(cut, speeds, depths):
    """Coupling assemblies of n points of speed (rad/s) and depth (m).

    Neighbours of equal depth and equal elements share one.
    """
    arrays = cut.arrays
    of_point = np.empty(speeds.shape[0], dtype=np.int64)
    structures = [np.empty(0, dtype=np.int64) for _ in range(0)]
    numbers = [np.empty(0) for _ in range(0)]
    constant = arrays.variation.amplitude == 0.0
    rotation, period = STEADY_ROTATION, arrays.period_angle
    counts, speed, borders = np.empty(0, dtype=np.int64), 0.0, empty_borders()
    for i in range(speeds.shape[0]):
        if not constant:
            rotation = in_mean_angle(
                spindle_rotation_at(arrays.variation, arrays.fit, speeds[i], period)
            )
        beside = constant and i > 0 and depths[i] == depths[i - 1]
        if not beside:
            borders = period_borders(arrays.segments, period, depths[i])
        needed = element_counts(cut, borders, rotation, speeds[i], depths[i])
        resolved = speed_step(speeds[i], _SPEED_STEP)
        if not (beside and speed == resolved and same_structure(needed, counts)):
            counts, speed = needed, resolved
            layout = element_layout(borders, counts, rotation, period)
            structure, filled = assemble_couplings(cut, rotation, layout, speed, depths[i])
            structures.append(structure)
            numbers.append(filled)
        of_point[i] = len(structures) - 1
    return packed_assemblies(structures, numbers, of_point)
