"""Compiled loop that Python calls: multipliers of many points, motion at the last."""

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER, INNER_KERNEL
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
def multipliers_at(scheme, arrays, speeds, depths, steps, refinement, free_steps):
    """Dominant multipliers at n points, motion at the last of them, and durations of its steps.

    Speeds (n,) in rad/s, depths (n,) in m; `steps` (n,) a tooth period, of which every one in the
    cut is divided by `refinement`. A free motion is solved exactly, by `free_steps` (n,): 1 but
    where its motion is wanted. The multipliers (n,) have an imaginary part >= 0; the motion
    (m + 1, r), m, is that of the tool point at the borders of m steps; durations (m,) are in s.
    """
    count, rank = speeds.shape[0], arrays.shape.shape[1]
    out = np.empty(count, dtype=np.complex128)
    motion, duration = np.empty((0, rank), dtype=np.complex128), np.empty(0)
    for i in range(count):
        period = build_monodromy(
            scheme, arrays, speeds[i], depths[i], steps[i], refinement, free_steps[i]
        )
        out[i], vector, _ = dominant_eigenpair(
            period, start_vector(period), first_check(period), RESIDUAL, LARGEST_SPACE
        )
        if i == count - 1:
            real = _motion_over_period(period, vector.real.copy())
            motion = real + 1j * _motion_over_period(period, vector.imag.copy())
            duration = period.duration
    return out, motion, duration


@njit(**INNER_KERNEL)
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
