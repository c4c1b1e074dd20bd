"""Couplings of the edge at one time: to the motion there, and to that when earlier teeth passed.

The motion that an earlier tooth had is taken from a cubic (Hermite) through displacement and
velocity at the starts and middles of the steps.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.engine.presets import KERNEL, LEAF_KERNEL
from chatter.stability.spindle_rotation import angle_at, speed_at, time_at
from cutting.edge_segments.coupling import coupling_at, part_below, share_of_height
from cutting.edge_segments.engaged_intervals import (
    MOST_POINTS,
    crowd,
    length_of_run,
    place_in_run,
    points_along,
    reach_of_piece,
    run_from,
    turns_of_chain,
)

#: a piece is in the cut in no more than so many turns at once
_TURNS = 4


class Sources(NamedTuple):
    """What couples the force at a time to the motion before it."""

    node: NDArray[np.int64]  # earlier of the two (sources,)
    weight: NDArray[np.float64]  # of displacement and velocity at both (sources, 4)
    block: NDArray[np.float64]  # force per displacement, N/m (sources, r, r)


class EdgeAtDepth(NamedTuple):
    """Parts of the pieces that cut at a depth, and the quadrature along them."""

    top: NDArray[np.float64]  # part of each piece below the depth (P,)
    reach: NDArray[np.float64]  # spindle angles, see `reach_of_piece`, rad (P, 4)
    place: NDArray[np.float64]  # Gauss points on [0, 1], row q for q of them (17, 16)
    weight: NDArray[np.float64]  # (17, 16)
    most: int  # sources of one time


class Present(NamedTuple):
    """Couplings to the motion at the time itself, and room to sum up those of one delay."""

    stiffness: NDArray[np.float64]  # N/m (r, r)
    dashpot: NDArray[np.float64]  # N s/m (r, r)
    part: NDArray[np.float64]  # (r, r)
    part_dashpot: NDArray[np.float64]  # (r, r)
    of_delay: NDArray[np.float64]  # N/m (G, r, r)
    used: NDArray[np.int64]  # (G,)


@njit(**KERNEL)
def edge_at_depth(cut, depth):
    """Lay out the pieces of a cut at a depth (m)."""
    pieces = cut.pieces
    top, reach = np.empty(pieces.bottom.shape[0]), np.empty((pieces.bottom.shape[0], 4))
    varying = 0
    for piece in range(top.shape[0]):
        top[piece] = part_below(pieces, piece, depth)
        reach_of_piece(pieces, top, piece, reach[piece])
        varying += 1 if pieces.group[piece] < 0 else 0
    most = _TURNS * MOST_POINTS * varying + pieces.group_delay.shape[0]
    return EdgeAtDepth(top, reach, cut.edge_place, cut.edge_weight, most)


@njit(**KERNEL)
def empty_sources(count, rank):
    """Room for sources."""
    return Sources(
        np.empty(count, dtype=np.int64), np.empty((count, 4)), np.empty((count, rank, rank))
    )


@njit(**KERNEL)
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


@njit(**KERNEL)
def nothing_present(rank, groups):
    """Room for the couplings at a time."""
    return Present(
        np.empty((rank, rank)), np.empty((rank, rank)), np.zeros((rank, rank)),
        np.zeros((rank, rank)), np.empty((groups, rank, rank)), np.empty(groups, dtype=np.int64),
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
def _add_source(node, step, time, earlier, rate, coupling, sources, count, present):
    """Add the coupling to the motion at an earlier time; returns the number of sources."""
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
            stiffness[i, j] += share * contact[0] * plane
            dashpot[i, j] += share * contact[1] * plane


@njit(**LEAF_KERNEL)
def couple(
    pieces, edge, basis, turn, node, rate, step, time, speed_factor, sources, count, present
):  # fmt: skip
    """Enter the couplings at one time.

    Parameters
    ----------
    pieces : EdgePieces
    edge : EdgeAtDepth
    basis : (3, r) array of float
    turn : SpindleTurn
    node : (2 N + 1,) array of float
        Starts and middles of the steps, s.
    rate : float
        By which velocities are divided, rad/s.
    step : int
        That in which the time lies.
    time : float
        s.
    speed_factor : float
        One over the cutting speed, s/m.
    sources : Sources
        With room for `edge.most` of them beyond `count`.
    count : int
    present : Present
        Stiffness and dashpot are overwritten.

    Returns
    -------
    (float, int)
        Height of edge in the cut, m, and the number of sources.
    """
    clear(present.stiffness)
    clear(present.dashpot)
    for group in range(present.used.shape[0]):
        clear(present.of_delay[group])
        present.used[group] = 0
    spindle = angle_at(turn, time)
    waves = rate / (2.0 * math.pi * speed_at(turn, time))
    engaged = 0.0
    for chain in range(pieces.chain.shape[0] - 1):
        first, last = turns_of_chain(pieces, edge.reach, chain, spindle)
        for back in range(first, last + 1):
            piece, end = pieces.chain[chain], pieces.chain[chain + 1]
            while piece < end:
                final, low, high, change = run_from(
                    pieces, edge.top, edge.reach, piece, end, spindle, back, waves
                )
                if final < piece:
                    piece += 1
                    continue
                engaged += _height(pieces, final, high) - _height(pieces, piece, low)
                count = _couple_run(
                    pieces, edge, basis, turn, node, rate, step, time, speed_factor, sources,
                    count, present, (piece, final, low, high, change), spindle,
                )  # fmt: skip
                piece = final + 1
    for group in range(present.used.shape[0]):
        if present.used[group] == 1:
            earlier = time_at(turn, spindle - pieces.group_delay[group])
            count = _add_source(
                node, step, time, earlier, rate, present.of_delay[group], sources, count, present
            )
    return engaged, count


@njit(**LEAF_KERNEL)
def _height(pieces, piece, place):
    """Height of a place along a piece above the tip, m."""
    return pieces.bottom[piece] + pieces.thickness[piece] * share_of_height(pieces, piece, place)


@njit(**LEAF_KERNEL)
def _couple_run(
    pieces, edge, basis, turn, node, rate, step, time, speed_factor, sources, count, present,
    run, spindle,
):  # fmt: skip
    """Enter the couplings along a run of pieces; returns the number of sources."""
    piece, final, low, high, change = run
    order, ends = points_along(pieces, piece, final, low, high, change, spindle)
    length = length_of_run(pieces, piece, final, low, high)
    at, start = piece, -low * pieces.length[piece]
    for q in range(order):
        x, share = crowd(edge.place[order, q], edge.weight[order, q], ends)
        at, place, start = place_in_run(pieces, at, final, start, x * length)
        coupling_at(
            pieces, at, place, spindle, share * length, speed_factor, basis,
            present.part, present.part_dashpot,
        )  # fmt: skip
        _add(1.0, present.part, present.stiffness)
        if speed_factor > 0.0:
            _add(1.0, present.part_dashpot, present.dashpot)
        group = pieces.group[at]
        if group >= 0:
            present.used[group] = 1
            _add(1.0, present.part, present.of_delay[group])
            continue
        shift = pieces.delay[at, 1] - pieces.delay[at, 0]
        delay = pieces.delay[at, 0] + share_of_height(pieces, at, place) * shift
        earlier = time_at(turn, spindle - delay)
        count = _add_source(node, step, time, earlier, rate, present.part, sources, count, present)
    return count
