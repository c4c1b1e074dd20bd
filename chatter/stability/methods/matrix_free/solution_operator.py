"""Solution operator: an initial function run through one period."""

from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array
from chatter.engine.presets import INNER_KERNEL
from chatter.stability.arnoldi import register_operator
from chatter.stability.methods.matrix_free.step_assembly import StepAssembly


class PropagationScratch(NamedTuple):
    """Scratch of `propagate`; N steps."""

    motion: Array  # of the nodes of the period before and of this one (4 N + 1, 2, r)
    force: Array  # (2, r)
    free: Array  # (2, 2, r)


@njit(**INNER_KERNEL)
def propagation_scratch(assembly):
    """Return scratch for `propagate`."""
    steps, rank = assembly.kind.shape[0], assembly.shape.shape[1]
    return PropagationScratch(
        np.empty((4 * steps + 1, 2, rank)), np.empty((2, rank)), np.empty((2, 2, rank))
    )


@njit(**INNER_KERNEL)
def propagate(assembly, function, out, scratch):
    """Run an initial function through one period.

    It and `out` (2 n + 4 N r,): state, then displacement and velocity at the nodes of the period
    before.
    """
    motion, force, free = scratch
    steps = assembly.kind.shape[0]
    modes, rank = assembly.shape.shape
    kept = 2 * steps
    position = 2 * modes
    for node in range(kept):
        for part in range(2):
            for k in range(rank):
                motion[node, part, k] = function[position]
                position += 1
    for i in range(2 * modes):
        out[i] = function[i]
    _set_motion(assembly, out, motion[kept])
    for step in range(steps):
        response = assembly.response[assembly.kind[step]]
        for p in range(2):
            for k in range(rank):
                force[p, k] = 0.0
        if assembly.engaged[step] == 1:
            _solve_forces(assembly, step, response, out, motion, force, free)
        _advance(assembly, response, out, motion, kept + 2 * step, force)
    position = 2 * modes
    for node in range(kept, 2 * kept):
        for part in range(2):
            for k in range(rank):
                out[position] = motion[node, part, k]
                position += 1


@njit(**INNER_KERNEL)
def _set_motion(assembly, state, node):
    modes, rank = assembly.shape.shape
    for k in range(rank):
        node[0, k], node[1, k] = 0.0, 0.0
    for m in range(modes):
        for k in range(rank):
            node[0, k] += assembly.shape[m, k] * state[2 * m]
            node[1, k] += assembly.shape_rate[m, k] * state[2 * m + 1]


@njit(**INNER_KERNEL)
def _solve_forces(assembly, step, response, state, motion, force, free):
    """Set `force` (2, r) to that at the two Gauss points of a step."""
    modes, rank = assembly.shape.shape
    for p in range(2):
        for k in range(rank):
            free[0, p, k], free[1, p, k] = 0.0, 0.0
    for m in range(modes):
        x, v = state[2 * m], state[2 * m + 1]
        for p in range(2):
            at = response[m, p]
            displacement = at[0, 0] * x + at[0, 1] * v
            velocity = at[1, 0] * x + at[1, 1] * v
            for k in range(rank):
                free[0, p, k] += assembly.shape[m, k] * displacement
                free[1, p, k] += assembly.shape_rate[m, k] * velocity
    from_motion, from_earlier = assembly.from_motion[step], assembly.from_earlier[step]
    for row in range(2 * rank):
        total = 0.0
        for part in range(2):
            for p in range(2):
                for k in range(rank):
                    total += from_motion[row, (2 * part + p) * rank + k] * free[part, p, k]
        force[row // rank, row % rank] = total
    for p in range(2):
        for source in range(
            assembly.first_source[2 * step + p], assembly.first_source[2 * step + p + 1]
        ):
            low, high = motion[assembly.node[source]], motion[assembly.node[source] + 1]
            weight, block = assembly.weight[source], assembly.block[source]
            for j in range(rank):
                earlier = weight[0] * low[0, j] + weight[1] * low[1, j]
                if weight[2] != 0.0 or weight[3] != 0.0:
                    earlier += weight[2] * high[0, j] + weight[3] * high[1, j]
                for i in range(rank):
                    push = block[i, j] * earlier
                    for row in range(2 * rank):
                        force[row // rank, row % rank] += from_earlier[row, p * rank + i] * push


@njit(**INNER_KERNEL)
def _advance(assembly, response, state, motion, node, force):
    """Set the state to the end of a step and note the motion at its middle and its end."""
    modes, rank = assembly.shape.shape
    for p in range(2):
        for k in range(rank):
            motion[node + 1, p, k], motion[node + 2, p, k] = 0.0, 0.0
    for m in range(modes):
        first, second = 0.0, 0.0
        for k in range(rank):
            first += assembly.gain[m, k] * force[0, k]
            second += assembly.gain[m, k] * force[1, k]
        x, v = state[2 * m], state[2 * m + 1]
        for p in range(2, 4):
            at = response[m, p]
            displacement = at[0, 0] * x + at[0, 1] * v + at[0, 2] * first + at[0, 3] * second
            velocity = at[1, 0] * x + at[1, 1] * v + at[1, 2] * first + at[1, 3] * second
            for k in range(rank):
                motion[node + p - 1, 0, k] += assembly.shape[m, k] * displacement
                motion[node + p - 1, 1, k] += assembly.shape_rate[m, k] * velocity
            if p == 3:
                state[2 * m], state[2 * m + 1] = displacement, velocity


@njit(**INNER_KERNEL)
def initial_function(assembly):
    """A fixed pseudo-random state with no motion before."""
    steps = assembly.kind.shape[0]
    modes, rank = assembly.shape.shape
    seed = 20261121
    start = np.zeros(2 * modes + 4 * steps * rank)
    for i in range(2 * modes):
        seed = (1103515245 * seed + 12345) % 2147483648
        start[i] = seed / 1073741824.0 - 1.0
    return start


register_operator(StepAssembly, propagation_scratch, propagate)
