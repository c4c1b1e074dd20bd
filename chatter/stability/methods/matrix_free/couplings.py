"""Couplings of the edge at one time: to the motion there, and to that when earlier teeth passed.

The motion that an earlier tooth had is taken from a cubic (Hermite) through displacement and
velocity at the starts and middles of the steps.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL
from chatter.stability.spindle_rotation import SpindleRotation, angle_at, speed_at, time_at
from cutting.edge_segments.coupling import coupling_at, delay_at, part_below, share_of_height
from cutting.edge_segments.engaged_intervals import (
    MOST_POINTS,
    bounds_of_groups,
    engaged_interval_from,
    graded,
    length_of_interval,
    points_along,
    position_in_interval,
    reach_of_segment,
    revolutions_of_group,
)

#: a segment is in the cut in no more than so many revolutions at once
_TURNS = 4


class Sources(NamedTuple):
    """What couples the force at a time to the motion before it."""

    node: IntegerArray  # earlier of the two (sources,)
    weight: Array  # of displacement and velocity at both (sources, 4)
    block: Array  # force per displacement, N/m (sources, r, r)


class EdgeAtDepth(NamedTuple):
    """Parts of the segments that cut at a depth."""

    top: Array  # part of each segment below the depth (P,)
    reach: Array  # spindle angles, see `reach_of_segment`, rad (P, 4)
    bounds: Array  # of each group, see `bounds_of_groups`, rad (G, 2)
    most: int  # sources of one time


class Present(NamedTuple):
    """Couplings to the motion at the time itself, and room to sum up those of one delay."""

    stiffness: Array  # N/m (r, r)
    dashpot: Array  # N s/m (r, r)
    part: Array  # (r, r)
    part_dashpot: Array  # (r, r)
    of_delay: Array  # N/m (G, r, r)
    used: IntegerArray  # (G,)


class Instant(NamedTuple):
    """A time within a step."""

    rotation: SpindleRotation
    node: Array  # starts and middles of the steps, s (2 N + 1,)
    rate: float  # by which velocities are divided, rad/s
    step: int
    time: float  # s


@njit(**INNER_KERNEL)
def edge_at_depth(cut, depth):
    """Lay out the segments of a cut at a depth (m)."""
    segments = cut.segments
    top, reach = np.empty(segments.bottom.shape[0]), np.empty((segments.bottom.shape[0], 4))
    varying = 0
    for segment in range(top.shape[0]):
        top[segment] = part_below(segments, segment, depth)
        reach_of_segment(segments, top, segment, reach[segment])
        varying += 1 if segments.delay_index[segment] < 0 else 0
    bounds = np.empty((segments.first_of_group.shape[0] - 1, 2))
    bounds_of_groups(segments, reach, bounds)
    most = _TURNS * MOST_POINTS * varying + segments.distinct_delay.shape[0]
    return EdgeAtDepth(top, reach, bounds, most)


@njit(**INNER_KERNEL)
def empty_sources(count, rank):
    """Room for sources."""
    return Sources(
        np.empty(count, dtype=np.int64), np.empty((count, 4)), np.empty((count, rank, rank))
    )


@njit(**INNER_KERNEL)
def with_room(sources, count, more):
    """The sources, of which `count` are there, with room for more."""
    if count + more <= sources.node.shape[0]:
        return sources
    larger = empty_sources(2 * (count + more), sources.block.shape[1])
    for source in range(count):
        larger.node[source] = sources.node[source]
        for i in range(4):
            larger.weight[source, i] = sources.weight[source, i]
        _copy(sources.block[source], larger.block[source])
    return larger


@njit(**INNER_KERNEL)
def nothing_present(rank, distinct):
    """Room for the couplings at a time."""
    return Present(
        np.empty((rank, rank)), np.empty((rank, rank)), np.zeros((rank, rank)),
        np.zeros((rank, rank)), np.empty((distinct, rank, rank)),
        np.empty(distinct, dtype=np.int64),
    )  # fmt: skip


@njit(**LEAF_KERNEL)
def _copy(given, out):
    for i in range(given.shape[0]):
        for j in range(given.shape[1]):
            out[i, j] = given[i, j]


@njit(**LEAF_KERNEL)
def _add(share, given, out):
    for i in range(given.shape[0]):
        for j in range(given.shape[1]):
            out[i, j] += share * given[i, j]


@njit(**LEAF_KERNEL)
def clear(out):
    """Set a matrix to zero."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = 0.0


@njit(**LEAF_KERNEL)
def _hermite(s, length, out):
    """Weights of value and slope at the start, then at the end, of an interval."""
    out[0] = (1.0 + 2.0 * s) * (1.0 - s) ** 2
    out[1] = length * s * (1.0 - s) ** 2
    out[2] = s * s * (3.0 - 2.0 * s)
    out[3] = length * s * s * (s - 1.0)


@njit(**LEAF_KERNEL)
def _node_before(node, time):
    """Last node at or before a time of the period, but for the end of it."""
    low, high = 0, node.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if node[middle] <= time:
            low = middle
        else:
            high = middle
    return low


@njit(**LEAF_KERNEL)
def _add_source(now, earlier, coupling, sources, count, present):
    """Add the coupling to the motion at an earlier time; returns the number of sources."""
    node, step, time, rate = now.node, now.step, now.time, now.rate
    kept = node.shape[0] - 1
    weight = sources.weight[count]
    start = node[2 * step]
    if earlier > start:
        # within this very step: a cubic from its start to the point itself, which is solved for
        length = time - start
        _hermite(min(1.0, (earlier - start) / length), length * rate, weight)
        _add(-weight[2], coupling, present.stiffness)
        _add(-weight[3] / rate, coupling, present.dashpot)
        weight[2], weight[3] = 0.0, 0.0
        sources.node[count] = kept + 2 * step
    else:
        first = kept
        if earlier < node[0]:
            earlier = max(node[0], earlier + node[kept] - node[0])
            first = 0
        k = _node_before(node, earlier)
        length = node[k + 1] - node[k]
        _hermite(min(1.0, (earlier - node[k]) / length), length * rate, weight)
        sources.node[count] = first + k
    _copy(coupling, sources.block[count])
    return count + 1


@njit(**LEAF_KERNEL)
def add_contact(basis, contact, share, stiffness, dashpot):
    """Add the contact of tool and work in the plane of the cut, alike in both directions."""
    rank = stiffness.shape[0]
    for i in range(rank):
        for j in range(rank):
            plane = basis[0, i] * basis[0, j] + basis[1, i] * basis[1, j]
            stiffness[i, j] += share * contact.stiffness * plane
            dashpot[i, j] += share * contact.damping * plane


@njit(**LEAF_KERNEL)
def couple(cut, edge, now, speed_factor, sources, count, present):
    """Enter the couplings at one time; returns the height of edge in the cut, m, and the sources.

    `speed_factor` is one over the cutting speed, s/m; `sources` have room for `edge.most` of them
    beyond `count`; stiffness and dashpot of `present` are overwritten.
    """
    segments, rotation = cut.segments, now.rotation
    clear(present.stiffness)
    clear(present.dashpot)
    for number in range(present.used.shape[0]):
        clear(present.of_delay[number])
        present.used[number] = 0
    spindle = angle_at(rotation, now.time)
    wavelengths = now.rate / (2.0 * math.pi * speed_at(rotation, now.time))
    engaged = 0.0
    for group in range(segments.first_of_group.shape[0] - 1):
        first, last = revolutions_of_group(edge.bounds, group, spindle)
        for back in range(first, last + 1):
            segment, end = segments.first_of_group[group], segments.first_of_group[group + 1]
            while segment < end:
                final, low, high, change = engaged_interval_from(
                    segments, edge.top, edge.reach, segment, end, spindle, back, wavelengths
                )
                if final < segment:
                    segment += 1
                    continue
                engaged += _height(segments, final, high) - _height(segments, segment, low)
                interval = segment, final, low, high, change
                count = _couple_interval(
                    cut, now, speed_factor, sources, count, present, interval, spindle
                )
                segment = final + 1
    for number in range(present.used.shape[0]):
        if present.used[number] == 1:
            earlier = time_at(rotation, spindle - segments.distinct_delay[number])
            count = _add_source(now, earlier, present.of_delay[number], sources, count, present)
    return engaged, count


@njit(**LEAF_KERNEL)
def _height(segments, segment, position):
    """Height of a position along a segment above the tip, m."""
    return segments.bottom[segment] + segments.thickness[segment] * share_of_height(
        segments, segment, position
    )


@njit(**LEAF_KERNEL)
def _couple_interval(cut, now, speed_factor, sources, count, present, interval, spindle):
    """Enter the couplings along an engaged interval; returns the number of sources."""
    segments = cut.segments
    segment, final, low, high, change = interval
    held = segments.flank.stiffening * speed_at(now.rotation, now.time)
    order, ends = points_along(segments, segment, final, low, high, change, spindle)
    length = length_of_interval(segments, segment, final, low, high)
    at, start = segment, -low * segments.length[segment]
    for q in range(order):
        x, share = graded(cut.edge_position[order, q], cut.edge_weight[order, q], ends)
        at, position, start = position_in_interval(segments, at, final, start, x * length)
        coupling_at(
            segments, at, position, spindle, share * length, speed_factor, cut.basis,
            present.part, present.part_dashpot,
        )  # fmt: skip
        _add(1.0, present.part, present.stiffness)
        if speed_factor > 0.0:
            _add(1.0, present.part_dashpot, present.dashpot)
            _add(held, present.part_dashpot, present.stiffness)
        number = segments.delay_index[at]
        if number >= 0:
            present.used[number] = 1
            _add(1.0, present.part, present.of_delay[number])
            continue
        earlier = time_at(now.rotation, spindle - delay_at(segments, at, position))
        count = _add_source(now, earlier, present.part, sources, count, present)
    return count
