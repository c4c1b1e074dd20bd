"""Compiled loops that Python calls: multipliers of many points, motion of one."""

from __future__ import annotations

import numpy as np
from numba import njit

from chatter.kernels import DRIVER
from chatter.stability.multipliers import dominant_multiplier
from chatter.stability.period_map import advance_step, build_period_map


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
