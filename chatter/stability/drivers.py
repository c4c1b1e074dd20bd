"""Compiled loops that Python calls: multipliers of many points, motion of one."""

from __future__ import annotations

import numpy as np
from numba import njit

from chatter.kernels import DRIVER
from chatter.stability.element_layout import element_layout
from chatter.stability.element_map import build_element_map, force_over_period
from chatter.stability.multipliers import dominant_multiplier
from chatter.stability.period_map import advance_step, build_period_map, period_map_by
from chatter.stability.spindle_turn import spindle_turn


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
def element_multipliers(cut, speeds, depths):
    """Dominant multipliers of n points by collocation.

    Parameters
    ----------
    cut : CutArrays
    speeds, depths : (n,) array of float
        rad/s, m.

    Returns
    -------
    (n,) array of complex
        Imaginary part >= 0.
    """
    out = np.empty(speeds.shape[0], dtype=np.complex128)
    for i in range(speeds.shape[0]):
        period = build_element_map(cut, speeds[i], depths[i])
        out[i], _, _ = dominant_multiplier(period)
    return out


@njit(**DRIVER)
def points_a_period(cut, speed, depth):
    """Collocation points in a period."""
    turn = spindle_turn(cut.variation, speed, cut.period_angle)
    layout = element_layout(cut, turn, depth)
    return layout.cut_start.shape[0] * cut.points.weight.shape[0]


@njit(**DRIVER)
def points_of_periods(cut, speeds, depth):
    """Collocation points in a period (n,) at n speeds."""
    out = np.empty(speeds.shape[0], dtype=np.int64)
    for i in range(speeds.shape[0]):
        out[i] = points_a_period(cut, speeds[i], depth)
    return out


@njit(**DRIVER)
def dominant_force(cut, speed, depth):
    """Force of the dominant motion over a period.

    Returns
    -------
    multiplier : complex
    time : (k,) array of float
        Of the collocation points, s.
    weight : (k,) array of float
        Of the quadrature over time, s.
    force : (k, r) array of complex
    period : float
        s.
    """
    period = build_element_map(cut, speed, depth)
    value, vector, _ = dominant_multiplier(period)
    cuts, values, _ = period.feedback.shape
    rank = cut.shape.shape[1]
    points = values // rank
    force = np.empty((cuts * points, rank), dtype=np.complex128)
    parts = (np.ascontiguousarray(vector.real), np.ascontiguousarray(vector.imag))
    real, imag = force_over_period(period, parts[0]), force_over_period(period, parts[1])
    time, weight = np.empty(cuts * points), np.empty(cuts * points)
    for e in range(cuts):
        for i in range(points):
            row = e * points + i
            length = period.layout.cut_length[e]
            time[row] = period.layout.cut_start[e] + length * cut.points.place[i + 1]
            weight[row] = length * cut.points.weight[i]
            for k in range(rank):
                force[row, k] = complex(real[e, i * rank + k], imag[e, i * rank + k])
    return value, time, weight, force, period.layout.period
