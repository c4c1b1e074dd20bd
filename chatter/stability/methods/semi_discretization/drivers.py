"""Compiled loops that Python calls: multipliers of many points, motion of one."""

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER
from chatter.stability.arnoldi import dominant_eigenpair
from chatter.stability.methods.semi_discretization.monodromy import (
    LARGEST_SPACE,
    RESIDUAL,
    advance_step,
    build_monodromy,
    first_check,
    record_motion,
    start_vector,
)


@njit(**DRIVER)
def multipliers_at(scheme, arrays, speeds, depths, steps, refinement):
    """Dominant multipliers (n,), imaginary part >= 0, at n speeds (rad/s) and depths (m).

    `steps` (n,) a tooth period; every step in the cut is divided by `refinement`.
    """
    out = np.empty(speeds.shape[0], dtype=np.complex128)
    for i in range(speeds.shape[0]):
        # free motion is one exact step
        period = build_monodromy(
            scheme, arrays, speeds[i], depths[i], steps[i], refinement, np.int64(1)
        )
        out[i], _, _ = dominant_eigenpair(
            period, start_vector(period), first_check(period), RESIDUAL, LARGEST_SPACE
        )
    return out


@njit(**DRIVER)
def dominant_motion(scheme, arrays, speed, depth, steps):
    """Dominant multiplier at a point, motion that belongs to it, and durations of the steps.

    The motion (steps + 1, r), m, is that of the tool point at the borders of the steps; durations
    (steps,) are in s.
    """
    period = build_monodromy(scheme, arrays, speed, depth, steps, np.int64(1), steps)
    value, vector, _ = dominant_eigenpair(
        period, start_vector(period), first_check(period), RESIDUAL, LARGEST_SPACE
    )
    real = _motion_over_period(period, vector.real.copy())
    return value, real + 1j * _motion_over_period(period, vector.imag.copy()), period.duration


@njit(**DRIVER)
def _motion_over_period(period, vector):
    """Motion of the tool point (steps + 1, r), m; the vector holds that of the last period."""
    steps, size, rank = period.from_left.shape
    motion = np.zeros((steps + 1, rank))
    state, next_state = vector[:size].copy(), np.empty(size)
    for s in range(steps + 1):
        record_motion(period.output, state, motion[s])
        if s < steps:
            advance_step(period, s, vector, state, next_state)
    return motion
