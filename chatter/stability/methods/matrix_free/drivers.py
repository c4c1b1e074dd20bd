"""Compiled code that Python calls: dominant multiplier and motion of a point, number of steps."""

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER
from chatter.stability.arnoldi import dominant_eigenpair
from chatter.stability.methods.matrix_free.solution_operator import initial_function
from chatter.stability.methods.matrix_free.step_assembly import assemble_steps
from chatter.stability.methods.matrix_free.steps import period_steps
from chatter.stability.spindle_rotation import spindle_rotation_at

#: residual of the dominant eigenpair, relative to its magnitude, at which the iteration stops
_RESIDUAL = 1e-9
#: functions beyond the states at the first check of convergence, and the most
_FIRST_CHECK, _MOST_FUNCTIONS = 6, 320


@njit(**DRIVER)
def dominant_motion(cut, speed, depth, steps_per_wavelength, refinement):
    """Dominant multiplier over one period and the motion that belongs to it.

    Speed in rad/s, depth in m; see `period_steps` for the others. The multiplier has an imaginary
    part >= 0; the motion (2 N, r) is the displacement of the tool point at the nodes of a period,
    the time (2 N + 1,) that of the nodes and of the end, s.
    """
    assembly = assemble_steps(cut, speed, depth, steps_per_wavelength, refinement)
    modes, rank = assembly.shape.shape
    nodes = 2 * assembly.kind.shape[0]
    start = initial_function(assembly)
    value, vector, _ = dominant_eigenpair(
        assembly, start, 2 * modes + _FIRST_CHECK, _RESIDUAL, _MOST_FUNCTIONS
    )
    motion = np.empty((nodes, rank), dtype=np.complex128)
    for node in range(nodes):
        for k in range(rank):
            motion[node, k] = vector[2 * modes + 2 * rank * node + k]
    return value, motion, assembly.time


@njit(**DRIVER)
def steps_per_period(cut, speed, depth, steps_per_wavelength, refinement):
    """Steps in a period; see `dominant_motion` for the parameters."""
    arrays = cut.arrays
    rotation = spindle_rotation_at(arrays.variation, arrays.fit, speed, arrays.period_angle)
    return period_steps(cut, rotation, depth, steps_per_wavelength, refinement).power.shape[0]
