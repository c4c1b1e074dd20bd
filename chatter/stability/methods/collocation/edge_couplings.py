"""What the edges in the cut couple at a spindle angle, to the motion now and to earlier motion."""

from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import INLINED_LEAF_KERNEL, INNER_KERNEL, LEAF_KERNEL
from chatter.stability.methods.collocation.element_layout import element_before
from chatter.stability.spindle_rotation import angle_at, speed_at, time_at, time_near
from cutting.edge_segments.coupling import coupling_at, delay_at
from cutting.edge_segments.engaged_intervals import (
    engaged_interval_from,
    graded,
    length_of_interval,
    points_along,
    position_in_interval,
    revolutions_of_group,
)

#: points closer than this share of an element are the same
_SAME_POINT = 1e-7
#: element of the earlier motion where it has not been looked for
_UNKNOWN = np.iinfo(np.int64).min


class Sources(NamedTuple):
    """Blocks that take the motion at the points of an earlier element to the force at a point."""

    element: IntegerArray
    point: IntegerArray
    block: Array  # N/m (sources, r, (p + 1) r)
    share: Array  # of each point of an element in a position (p + 1,), scratch


class Edge(NamedTuple):
    """Edge segments down to a depth, and the quadrature along them."""

    tops: Array  # part of each segment below the depth (P,)
    reach: Array  # spindle angles, see `reach_of_segment`, rad (P, 4)
    bounds: Array  # of each group, see `bounds_of_groups`, rad (G, 2)
    elements: float  # that pass while the tool turns by a radian at the mean speed
    speed_factor: float  # one over the radius where there are dashpots, else 0, 1/m


class Positions(NamedTuple):
    """Where the spindle stands at the points of a layout, and where it stood a delay before."""

    angle: Array  # of the spindle, rad (N,)
    speed: Array  # over the mean speed (N,)
    span_share: Array  # of each Gauss point of the span in a point (N, p)
    earlier_element: IntegerArray  # that it stood in over each distinct delay (N, G)
    earlier_point: IntegerArray  # the only point of it that counts, or -1 (N, G)
    earlier_share: Array  # of each point of it (N, G, p + 1)


class SpindleState(NamedTuple):
    """Where the spindle stands."""

    angle: float  # rad
    speed: float  # over the mean speed
    elements: float  # that pass while it turns by a radian, by which the quadrature is chosen


class Couplings(NamedTuple):
    """Couplings at a number of points, and scratch for one of them."""

    stiffness: Array  # N/m (points, r, r)
    dashpot: Array  # N s/m times the mean speed (points, r, r)
    of_delay: Array  # of each distinct delay, last of a single point (G + 1, r, r)
    part: Array  # (r, r)
    part_dashpot: Array  # (r, r)


@njit(**INNER_KERNEL)
def positions_of(cut, layout, rotation):
    """Positions of a layout; earlier ones are found when they are asked for."""
    points, delays = cut.points, cut.arrays.segments.distinct_delay.shape[0]
    count = points.weight.shape[0]
    rows = layout.cut_start.shape[0] * count
    positions = Positions(
        np.empty(rows), np.empty(rows), np.empty((rows, count)),
        np.full((rows, delays), _UNKNOWN), np.empty((rows, delays), dtype=np.int64),
        np.empty((rows, delays, count + 1)),
    )  # fmt: skip
    _stand(points, layout, rotation, positions)
    return positions


@njit(**LEAF_KERNEL)
def _stand(points, layout, rotation, positions):
    """Fill in where the spindle stands at the points of a layout."""
    count = positions.span_share.shape[1]
    gauss = points.position[1:]
    for row in range(positions.angle.shape[0]):
        e, i = row // count, row % count
        time = layout.cut_start[e] + gauss[i] * layout.cut_length[e]
        angle = angle_at(rotation, time)
        positions.angle[row], positions.speed[row] = angle, speed_at(rotation, time)
        if rotation.amplitude > 0.0 and layout.span[e] >= 0:
            in_span = (angle - layout.cut_angle[e]) / layout.span_length[layout.span[e]]
            shares_of_points(gauss, points.gauss_weight, in_span, positions.span_share[row])


@njit(**INNER_KERNEL)
def empty_positions():
    """Positions before there are any."""
    whole = np.empty((0, 0), dtype=np.int64)
    return Positions(
        np.empty(0), np.empty(0), np.empty((0, 0)), whole, whole, np.empty((0, 0, 0))
    )  # fmt: skip


@njit(**INNER_KERNEL)
def empty_couplings(points, delays, rank):
    """Couplings that are zero as yet."""
    return Couplings(
        np.zeros((points, rank, rank)), np.zeros((points, rank, rank)),
        np.empty((delays + 1, rank, rank)), np.empty((rank, rank)), np.zeros((rank, rank)),
    )  # fmt: skip


@njit(**INNER_KERNEL)
def empty_sources(count, rank, width):
    """Room for sources."""
    whole = np.empty(count, dtype=np.int64)
    return Sources(
        whole, np.empty(count, dtype=np.int64), np.empty((count, rank, width)),
        np.empty(width // rank),
    )  # fmt: skip


@njit(**INNER_KERNEL)
def grown(sources, least):
    """Sources with room for `least` of them, twice the room where there is less."""
    count, rank, width = sources.block.shape
    if least <= count:
        return sources
    larger = empty_sources(max(2 * count, least), rank, width)
    for i in range(count):
        larger.element[i], larger.point[i] = sources.element[i], sources.point[i]
        for k in range(rank):
            for j in range(width):
                larger.block[i, k, j] = sources.block[i, k, j]
    return larger


@njit(**INLINED_LEAF_KERNEL)
def shares_of_points(points, weight, position, share):
    """Set share (m,) to the Lagrange polynomials through m points at a position.

    `weight` (m,) are their barycentric weights. Returns the point that the position is, or -1.
    """
    near, total = -1, 0.0
    for q in range(share.shape[0]):
        distance = position - points[q]
        if abs(distance) < _SAME_POINT:
            near = q
            distance = _SAME_POINT
        share[q] = weight[q] / distance
        total += share[q]
    for q in range(share.shape[0]):
        share[q] /= total
        if near >= 0:
            share[q] = 1.0 if near == q else 0.0
    return near


@njit(**INLINED_LEAF_KERNEL)
def _add_source(sources, first, count, element, near, share, coupling):
    """Add a coupling (r, r) to the motion in an element to its source, of those from the first on.

    `share` (p + 1,) is that of each point of the element, `near` the only one, or -1. Returns the
    number of sources.
    """
    rank = coupling.shape[0]
    at = count
    for entry in range(first, count):
        if sources.element[entry] == element:
            at = entry
            break
    if at < count:
        for q in range(share.shape[0]):
            for i in range(rank):
                for j in range(rank):
                    sources.block[at, i, q * rank + j] += share[q] * coupling[i, j]
        sources.point[at] = near if sources.point[at] == near else -1
        return count
    for i in range(rank):
        for q in range(share.shape[0]):
            for j in range(rank):
                sources.block[at, i, q * rank + j] = share[q] * coupling[i, j]
    sources.element[at], sources.point[at] = element, near
    return count + 1


@njit(**LEAF_KERNEL)
def couple_edges(cut, edge, layout, rotation, state, row, first_source, sources, couplings):
    """Enter what the edges couple at a `SpindleState`, to earlier motion as far as delays vary.

    What they couple over the distinct delays is left in `couplings.of_delay`. Returns the number of
    sources.
    """
    segments, basis, points = cut.arrays.segments, cut.arrays.basis, cut.points
    stiffness, dashpot, of_delay = couplings.stiffness, couplings.dashpot, couplings.of_delay
    part, part_dashpot = couplings.part, couplings.part_dashpot
    rank = basis.shape[1]
    used, held = of_delay.shape[0] - 1, segments.flank.stiffening
    for delay in range(used):
        for i in range(rank):
            for j in range(rank):
                of_delay[delay, i, j] = 0.0
    count, spindle = first_source, state.angle
    for group in range(segments.first_of_group.shape[0] - 1):
        first, last = revolutions_of_group(edge.bounds, group, spindle)
        for back in range(first, last + 1):
            segment, end = segments.first_of_group[group], segments.first_of_group[group + 1]
            while segment < end:
                final, low, high, change = engaged_interval_from(
                    segments, edge.tops, edge.reach, segment, end, spindle, back, state.elements
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
                        edge.speed_factor / state.speed, basis, part, part_dashpot,
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
                        element, position = element_before(layout, earlier)
                        near = shares_of_points(
                            points.position, points.barycentric, position, sources.share
                        )
                        count = _add_source(
                            sources, first_source, count, element, near, sources.share,
                            of_delay[used],
                        )  # fmt: skip
                segment = final + 1
    return count


@njit(**LEAF_KERNEL)
def _find_earlier(cut, layout, rotation, positions, row, delay):
    """Find the element and the position in it of the earlier motion at a row over a delay."""
    back, count = cut.arrays.segments.distinct_delay[delay], positions.span_share.shape[1]
    e, i = row // count, row % count
    now = layout.cut_start[e] + cut.points.position[i + 1] * layout.cut_length[e]
    # from the row alone: what is found does not depend on the order of the rows
    near_it = now - back / positions.speed[row]
    time = time_near(rotation, positions.angle[row] - back, near_it)
    element, position = element_before(layout, time)
    share = positions.earlier_share[row, delay]
    near = shares_of_points(cut.points.position, cut.points.barycentric, position, share)
    # at a varying speed it would make structures differ
    positions.earlier_point[row, delay] = near if rotation.amplitude == 0.0 else -1
    positions.earlier_element[row, delay] = element


@njit(**LEAF_KERNEL)
def couple_delays(cut, layout, rotation, positions, row, first, count, sources, of_delay):
    """Enter what is coupled over the distinct delays at a row; returns the number of sources."""
    rank = of_delay.shape[1]
    for delay in range(of_delay.shape[0] - 1):
        filled = False
        for i in range(rank):
            for j in range(rank):
                filled |= of_delay[delay, i, j] != 0.0
        if filled:
            if positions.earlier_element[row, delay] == _UNKNOWN:
                _find_earlier(cut, layout, rotation, positions, row, delay)
            count = _add_source(
                sources, first, count, positions.earlier_element[row, delay],
                positions.earlier_point[row, delay], positions.earlier_share[row, delay],
                of_delay[delay],
            )  # fmt: skip
    return count


@njit(**LEAF_KERNEL)
def couple_row(cut, edge, layout, rotation, positions, row, first_source, sources, couplings):
    """Enter couplings and sources at a point; `first_source` (N + 1,) is that of each point."""
    first, speed = first_source[row], positions.speed[row]
    state = SpindleState(positions.angle[row], speed, edge.elements / speed)
    count = couple_edges(cut, edge, layout, rotation, state, row, first, sources, couplings)
    first_source[row + 1] = couple_delays(
        cut, layout, rotation, positions, row, first, count, sources, couplings.of_delay
    )
