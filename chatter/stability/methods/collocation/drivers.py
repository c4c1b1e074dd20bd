"""Compiled loops that Python calls: multipliers of many points, motion of one."""

from __future__ import annotations

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER
from chatter.stability.arnoldi import dominant_multiplier
from chatter.stability.methods.collocation.batch_multipliers import dominant_pairs
from chatter.stability.methods.collocation.chatter_frequency import heard_frequencies
from chatter.stability.methods.collocation.coupling_assembly import plans_of
from chatter.stability.methods.collocation.coupling_structure import alike, structure_at
from chatter.stability.methods.collocation.element_assembly import build_element_map
from chatter.stability.methods.collocation.element_borders import period_borders
from chatter.stability.methods.collocation.element_layout import element_counts, element_layout
from chatter.stability.methods.semi_discretization.monodromy import (
    advance_step,
    build_period_map,
    period_map_by,
)
from chatter.stability.simd_batch import LANES
from chatter.stability.spindle_rotation import in_mean_angle, spindle_turn


@njit(**DRIVER)
def multipliers_at(arrays, speeds, depths, steps, refinement):
    """Dominant multipliers of n points.

    Parameters
    ----------
    arrays : MillingArrays
    speeds, depths : (n,) array of float
        rad/s, m.
    steps : (n,) array of int
        Steps a tooth period.
    refinement : int
        Every step in the cut is divided by this.

    Returns
    -------
    (n,) array of complex
        Imaginary part >= 0.
    """
    out = np.empty(speeds.shape[0], dtype=np.complex128)
    for i in range(speeds.shape[0]):
        # free motion is one exact step
        period = build_period_map(arrays, speeds[i], depths[i], steps[i], refinement, np.int64(1))
        out[i], _, _ = dominant_multiplier(period)
    return out


@njit(**DRIVER)
def multipliers_by(scheme, arrays, speeds, depths, steps, refinement):
    """Dominant multipliers of n points by another scheme; otherwise as `multipliers_at`."""
    out = np.empty(speeds.shape[0], dtype=np.complex128)
    for i in range(speeds.shape[0]):
        period = period_map_by(
            scheme, arrays, speeds[i], depths[i], steps[i], refinement, np.int64(1)
        )
        out[i], _, _ = dominant_multiplier(period)
    return out


@njit(**DRIVER)
def motion_over_period(period, vector):
    """Motion of the tool point over one tooth period.

    Parameters
    ----------
    period : PeriodMap
    vector : (2n + nodes r,) array of float
        State at the start and motion during the last period.

    Returns
    -------
    (steps + 1, r) array of float
        m, at the borders of the steps.
    """
    steps, size, rank = period.from_left.shape
    motion = np.zeros((steps + 1, rank))
    state, following = vector[:size].copy(), np.empty(size)
    for s in range(steps + 1):
        for k in range(rank):
            for j in range(size):
                motion[s, k] += period.output[k, j] * state[j]
        if s < steps:
            advance_step(period, s, vector, state, following)
    return motion


@njit(**DRIVER)
def cut_plans(cut, speeds, depths):
    """What the cut couples at n points.

    Parameters
    ----------
    cut : CutArrays
    speeds, depths : (n,) array of float
        rad/s, m. Neighbours of the same depth cost less.

    Returns
    -------
    Plans
    """
    return plans_of(cut, speeds, depths)


@njit(**DRIVER)
def element_multipliers(arrays, plans, speeds, listened):
    """Dominant multipliers of n points by collocation.

    Points whose plans are alike are treated together, in lanes; what comes out for a point does not
    depend on which others it is treated with.

    Parameters
    ----------
    arrays : MapArrays
    plans : Plans
        Of the points.
    speeds : (n,) array of float
        rad/s.
    listened : (n,) array of bool
        Points at which the chatter frequency is wanted.

    Returns
    -------
    multiplier : (n,) array of complex
        Imaginary part >= 0.
    frequency : (n,) array of float
        Hz, nan where it was not wanted.
    """
    n = speeds.shape[0]
    multiplier = np.empty(n, dtype=np.complex128)
    frequency = np.full(n, np.nan)
    done = np.zeros(n, dtype=np.bool_)
    lanes, members = np.empty(LANES, dtype=np.int64), np.empty(LANES, dtype=np.int64)
    lane_speeds, heard = np.empty((1, LANES)), np.empty(LANES)
    for first in range(n):
        if done[first]:
            continue
        count = 0
        structure = structure_at(plans, first)
        for i in range(first, n):
            if count == LANES:
                break
            same = plans.of_point[i] == plans.of_point[first]
            if not done[i] and (same or alike(structure_at(plans, i), structure)):
                lanes[count] = i
                done[i] = True
                count += 1
        wanted = False
        for lane in range(LANES):
            # lanes that are left over do what the first does
            point = lanes[lane] if lane < count else first
            members[lane], lane_speeds[0, lane] = point, speeds[point]
            wanted |= listened[point]
        period = build_element_map(arrays, plans, members, lane_speeds)
        found = dominant_pairs(period, arrays.residual)
        if wanted:
            heard_frequencies(arrays, plans, members, lane_speeds, period, found, heard)
        for lane in range(count):
            multiplier[lanes[lane]] = found.value[lane]
            if listened[lanes[lane]]:
                frequency[lanes[lane]] = heard[lane]
    return multiplier, frequency


@njit(**DRIVER)
def points_of_periods(cut, speeds, depth):
    """Collocation points in a period (n,) at n speeds."""
    out, period = np.empty(speeds.shape[0], dtype=np.int64), cut.period_angle
    borders = period_borders(cut.pieces, period, depth)
    for i in range(speeds.shape[0]):
        turn = in_mean_angle(spindle_turn(cut.variation, speeds[i], period))
        counts = element_counts(cut.resolution, borders, turn, period, speeds[i], depth)
        layout = element_layout(borders, counts, turn, period)
        out[i] = layout.cut_start.shape[0] * cut.points.weight.shape[0]
    return out
