"""What the cut couples over one period: elements, stiffness, dashpots, and the earlier motion.

All positions are mean angles (time times the mean speed): at a constant speed the assembly depends
on the speed only through the number of elements, so that neighbouring speeds share it. A assembly
is packed into whole numbers that give its structure and real ones that fill it: assemblies of the
same structure go side by side into one SIMD batch.
"""

import math

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER, INNER_KERNEL
from chatter.stability.methods.collocation.coupling_structure import (
    counted_assemblies,
    empty_assemblies,
    packed_behind,
    same_structure,
)
from chatter.stability.methods.collocation.edge_couplings import (
    Edge,
    couple_row,
    empty_couplings,
    empty_positions,
    empty_sources,
    grown,
    positions_of,
)
from chatter.stability.methods.collocation.element_borders import (
    empty_borders,
    period_borders,
    same_borders,
)
from chatter.stability.methods.collocation.element_layout import (
    element_counts,
    element_layout,
    speed_step,
)
from chatter.stability.methods.collocation.tool_period_couplings import (
    couple_tool_periods,
    tool_period_couplings,
)
from chatter.stability.spindle_rotation import STEADY_ROTATION, in_mean_angle, spindle_rotation_at
from cutting.edge_segments.coupling import part_below, radius_at
from cutting.edge_segments.engaged_intervals import bounds_of_groups, reach_of_segment
from cutting.process_damping.linear_flank import inverse_radius

#: the order of a quadrature along the edge follows the speed in steps of this power of two, where
#: delays vary along it
_SPEED_STEP = 0.5


@njit(**INNER_KERNEL)
def _edge_down_to(cut, speed, depth):
    """Edges down to a depth, and the largest angle of a delay that varies along them, or 0."""
    segments = cut.arrays.segments
    tops, reach = np.empty(segments.bottom.shape[0]), np.empty((segments.bottom.shape[0], 4))
    longest = 0.0
    for segment in range(tops.shape[0]):
        tops[segment] = part_below(segments, segment, depth)
        reach_of_segment(segments, tops, segment, reach[segment])
        if tops[segment] > 0.0 and segments.delay_index[segment] < 0:
            longest = max(longest, max(segments.delay[segment, 0], segments.delay[segment, 1]))
    bounds = np.empty((segments.first_of_group.shape[0] - 1, 2))
    bounds_of_groups(segments, reach, bounds)
    factor = inverse_radius(segments.flank, radius_at(segments, depth))
    return Edge(tops, reach, bounds, 1.0 / (speed * cut.longest), factor), longest


@njit(**INNER_KERNEL)
def assemble_couplings(cut, rotation, layout, positions, speed, depth, scratch):
    """Couplings at the points of all elements of a period.

    The rotation is in mean angle, the `Positions` are those of the layout, the speed is the
    `speed_step` of the mean spindle speed, rad/s, or inf where no delay varies along the edge, the
    depth axial, m. Returned are the `Couplings`,
    the first source (E p + 1,) of each point, and the `Sources`, for which the scratch is used.
    """
    delays, rank = cut.arrays.segments.distinct_delay.shape[0], cut.arrays.basis.shape[1]
    rows = positions.angle.shape[0]
    edge, longest = _edge_down_to(cut, speed, depth)
    sources = scratch
    couplings = empty_couplings(rows, delays, rank)
    first_source = np.zeros(rows + 1, dtype=np.int64)
    if rotation.amplitude > 0.0 and longest == 0.0:
        sources = grown(sources, rows * delays)
        of_period = tool_period_couplings(cut, edge, layout, rotation, sources)
        couple_tool_periods(
            cut, edge, layout, rotation, positions, of_period, first_source, sources, couplings
        )
    else:
        # a delay that varies along the edge reaches into no more elements than are that far back
        most = delays
        if longest > 0.0:
            most += layout.cut_start.shape[0] * (2 + math.ceil(2.0 * longest / layout.period))
        for row in range(rows):
            sources = grown(sources, first_source[row] + most)
            couple_row(
                cut, edge, layout, rotation, positions, row, first_source, sources, couplings
            )
    if rotation.amplitude > 0.0:
        # what falls on a point by chance would make structures differ
        sources.point[:] = -1
    return couplings, first_source, sources


@njit(**DRIVER)
def coupling_assemblies(cut, speeds, depths):
    """Coupling assemblies of n points of speed (rad/s) and depth (m).

    Neighbours of equal depth, equal periods and equal elements share one; at a varying speed
    neighbours of equal periods and equal elements share all positions.
    """
    arrays = cut.arrays
    # as a literal it would be compiled for apart
    assemblies, count = empty_assemblies(speeds.shape[0]), np.int64(0)
    constant = arrays.variation.amplitude == 0.0
    rotation, period = STEADY_ROTATION, arrays.period_angle
    counts, speed, borders = np.empty(0, dtype=np.int64), 0.0, empty_borders()
    rank, per_element = arrays.basis.shape[1], cut.points.weight.shape[0]
    varying = np.any(arrays.segments.delay_index < 0)
    positions, sources = empty_positions(), empty_sources(1, rank, (per_element + 1) * rank)
    for i in range(speeds.shape[0]):
        patterns, cycles = rotation.patterns, rotation.cycles
        if not constant:
            rotation = spindle_rotation_at(arrays.variation, arrays.fit, speeds[i], period)
            rotation = in_mean_angle(rotation, period)
        same_depth = i > 0 and depths[i] == depths[i - 1]
        kept = same_depth
        if not same_depth:
            before = borders
            borders = period_borders(arrays.segments, period, depths[i])
            kept = not constant and same_borders(borders, before)
        needed = element_counts(cut, borders, rotation, speeds[i], depths[i])
        resolved = speed_step(speeds[i], _SPEED_STEP) if varying else math.inf
        kept = kept and speed == resolved and same_structure(needed, counts)
        kept = kept and rotation.patterns == patterns and rotation.cycles == cycles
        if not kept:
            counts, speed = needed, resolved
            layout = element_layout(borders, counts, rotation, period)
            positions = positions_of(cut, layout, rotation)
        if not (kept and same_depth):
            couplings, first_source, sources = assemble_couplings(
                cut, rotation, layout, positions, speed, depths[i], sources
            )
            assemblies = packed_behind(assemblies, count, layout, couplings, first_source, sources)
            count += 1
        assemblies.of_point[i] = count - 1
    return counted_assemblies(assemblies, count)
