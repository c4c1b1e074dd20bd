"""Couplings over one period of the tool, by spindle angle, for every period of a varying speed.

At the same spindle angle the edges couple the same in every period of the tool, whatever the speed,
but for dashpots, which are as one over the speed. Within an element all is smooth, and the points
of a period, even in time, are all but those of every other in angle: couplings are interpolated
from the Gauss points that the angle is cut by.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array
from chatter.engine.presets import INLINED_LEAF_KERNEL, INNER_KERNEL, LEAF_KERNEL
from chatter.stability.methods.collocation.edge_couplings import (
    SpindleState,
    couple_delays,
    couple_edges,
    empty_couplings,
)


class ToolPeriodCouplings(NamedTuple):
    """Couplings at the p Gauss points of the Q spans of a period of the tool in the cut."""

    stiffness: Array  # without what dashpots add, N/m (Q p, r, r)
    dashpot: Array  # N s/m times the speed (Q p, r, r)
    of_delay: Array  # of each distinct delay (Q p, G, r, r)


@njit(**INNER_KERNEL)
def tool_period_couplings(cut, edge, layout, rotation, sources):
    """Couplings of one period of the tool; no delay may vary along the edge.

    The quadrature along the edge is that of the slowest speed.
    """
    points, rank = cut.points, cut.arrays.basis.shape[1]
    count, delays = points.weight.shape[0], cut.arrays.segments.distinct_delay.shape[0]
    rows = layout.span_start.shape[0] * count
    couplings = empty_couplings(rows, delays, rank)
    of_delay = np.empty((rows, delays, rank, rank))
    elements = edge.elements / (1.0 - rotation.amplitude)
    held = cut.arrays.segments.flank.stiffening
    for row in range(rows):
        span, i = row // count, row % count
        angle = layout.span_start[span] + points.position[i + 1] * layout.span_length[span]
        state = SpindleState(angle, 1.0, elements)
        couple_edges(cut, edge, layout, rotation, state, row, np.int64(0), sources, couplings)
        for i in range(rank):
            for j in range(rank):
                couplings.stiffness[row, i, j] -= held * couplings.dashpot[row, i, j]
                for delay in range(delays):
                    of_delay[row, delay, i, j] = couplings.of_delay[delay, i, j]
    return ToolPeriodCouplings(couplings.stiffness, couplings.dashpot, of_delay)


@njit(**INLINED_LEAF_KERNEL)
def _couple_in_span(held, of_period, span, share, speed, row, couplings):
    """Enter what the edges couple at a position in a span, by the share of its points (p,).

    `speed` is that of the spindle there, over the mean speed.
    """
    count = share.shape[0]
    _, delays, rank, _ = of_period.of_delay.shape
    first, slowness = span * count, 1.0 / speed
    for i in range(rank):
        for j in range(rank):
            stiffness, dashpot = 0.0, 0.0
            for q in range(count):
                stiffness += share[q] * of_period.stiffness[first + q, i, j]
                dashpot += share[q] * of_period.dashpot[first + q, i, j]
            couplings.stiffness[row, i, j] = stiffness + held * slowness * dashpot
            couplings.dashpot[row, i, j] = slowness * dashpot
            for delay in range(delays):
                earlier = 0.0
                for q in range(count):
                    earlier += share[q] * of_period.of_delay[first + q, delay, i, j]
                couplings.of_delay[delay, i, j] = earlier


@njit(**LEAF_KERNEL)
def couple_tool_periods(
    cut, edge, layout, rotation, positions, of_period, first_source, sources, couplings
):
    """Enter couplings and sources at all points; `first_source` (N + 1,) is that of each.

    There is room for a source of each delay at every point.
    """
    per_element, held = cut.points.weight.shape[0], cut.arrays.segments.flank.stiffening
    for row in range(positions.angle.shape[0]):
        first, span = first_source[row], layout.span[row // per_element]
        speed = positions.speed[row]
        if span >= 0:
            share = positions.span_share[row]
            _couple_in_span(held, of_period, span, share, speed, row, couplings)
        else:
            state = SpindleState(positions.angle[row], speed, edge.elements / speed)
            couple_edges(cut, edge, layout, rotation, state, row, first, sources, couplings)
        first_source[row + 1] = couple_delays(
            cut, layout, rotation, positions, row, first, first, sources, couplings.of_delay
        )
