"""Compiled loops that Python calls: multipliers of many points, and points of a period."""

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER
from chatter.stability.methods.collocation.batch_multipliers import dominant_pairs
from chatter.stability.methods.collocation.chatter_frequency import chatter_frequencies_of
from chatter.stability.methods.collocation.coupling_structure import same_structure, structure_at
from chatter.stability.methods.collocation.element_assembly import build_batch_monodromy
from chatter.stability.methods.collocation.element_borders import period_borders
from chatter.stability.methods.collocation.element_layout import element_counts, element_layout
from chatter.stability.simd_batch import BATCH_SIZE
from chatter.stability.spindle_rotation import in_mean_angle, spindle_rotation_at


@njit(**DRIVER)
def element_multipliers(arrays, assemblies, speeds, frequency_wanted):
    """Dominant multipliers of n points by collocation.

    Points whose assemblies have the same structure are treated together in a SIMD batch; what comes
    out for a point does not depend on which others it is treated with.

    Speeds (n,) are in rad/s; `frequency_wanted` (n,) marks the points at which the chatter
    frequency is wanted. Multipliers (n,) have an imaginary part >= 0; frequencies (n,) are in Hz,
    nan where not wanted.
    """
    n = speeds.shape[0]
    multiplier = np.empty(n, dtype=np.complex128)
    frequency = np.full(n, np.nan)
    done = np.zeros(n, dtype=np.bool_)
    batch, batch_points = np.empty(BATCH_SIZE, dtype=np.int64), np.empty(BATCH_SIZE, dtype=np.int64)
    workspace = np.empty(0)
    batch_speeds, with_frequency = np.empty((1, BATCH_SIZE)), np.empty(BATCH_SIZE)
    for first in range(n):
        if done[first]:
            continue
        count = 0
        structure = structure_at(assemblies, first)
        for i in range(first, n):
            if count == BATCH_SIZE:
                break
            same = assemblies.of_point[i] == assemblies.of_point[first]
            if not done[i] and (same or same_structure(structure_at(assemblies, i), structure)):
                batch[count] = i
                done[i] = True
                count += 1
        wanted = False
        for member in range(BATCH_SIZE):
            # members that are left over do what the first does
            point = batch[member] if member < count else first
            batch_points[member], batch_speeds[0, member] = point, speeds[point]
            wanted |= frequency_wanted[point]
        period, workspace = build_batch_monodromy(
            arrays, assemblies, batch_points, batch_speeds, workspace
        )
        found = dominant_pairs(period, arrays.residual)
        if wanted:
            chatter_frequencies_of(
                arrays, assemblies, batch_points, batch_speeds, period, found, with_frequency
            )
        for member in range(count):
            multiplier[batch[member]] = found.value[member]
            if frequency_wanted[batch[member]]:
                frequency[batch[member]] = with_frequency[member]
    return multiplier, frequency


@njit(**DRIVER)
def points_of_periods(cut, speeds, depth):
    """Collocation points in a period (n,) at n speeds."""
    arrays, out = cut.arrays, np.empty(speeds.shape[0], dtype=np.int64)
    period = arrays.period_angle
    borders = period_borders(arrays.segments, period, depth)
    for i in range(speeds.shape[0]):
        rotation = spindle_rotation_at(arrays.variation, arrays.fit, speeds[i], period)
        rotation = in_mean_angle(rotation, period)
        counts = element_counts(cut, borders, rotation, speeds[i], depth)
        layout = element_layout(borders, counts, rotation, period)
        out[i] = layout.cut_start.shape[0] * cut.points.weight.shape[0]
    return out
