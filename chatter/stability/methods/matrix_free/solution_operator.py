"""An initial function run through one period, and the space that such functions span."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER, KERNEL


@njit(**KERNEL)
def _propagate(plan, function, out, motion, force, free):
    """Run an initial function through one period.

    `motion` (4 N + 1, 2, r) holds the nodes of the period before and of this one; `force` (2, r)
    and `free` (2, 2, r) are scratch.
    """
    steps = plan.kind.shape[0]
    modes, rank = plan.shape.shape
    kept = 2 * steps
    place = 2 * modes
    for node in range(kept):
        for part in range(2):
            for k in range(rank):
                motion[node, part, k] = function[place]
                place += 1
    for i in range(2 * modes):
        out[i] = function[i]
    _note_motion(plan, out, motion[kept])
    for step in range(steps):
        answer = plan.answer[plan.kind[step]]
        for p in range(2):
            for k in range(rank):
                force[p, k] = 0.0
        if plan.engaged[step] == 1:
            _solve_forces(plan, step, answer, out, motion, force, free)
        _advance(plan, answer, out, motion, kept + 2 * step, force)
    place = 2 * modes
    for node in range(kept, 2 * kept):
        for part in range(2):
            for k in range(rank):
                out[place] = motion[node, part, k]
                place += 1


@njit(**KERNEL)
def _note_motion(plan, state, node):
    modes, rank = plan.shape.shape
    for k in range(rank):
        node[0, k], node[1, k] = 0.0, 0.0
    for m in range(modes):
        for k in range(rank):
            node[0, k] += plan.shape[m, k] * state[2 * m]
            node[1, k] += plan.shape_rate[m, k] * state[2 * m + 1]


@njit(**KERNEL)
def _solve_forces(plan, step, answer, state, motion, force, free):
    """Set `force` (2, r) to that at the two Gauss points of a step."""
    modes, rank = plan.shape.shape
    for p in range(2):
        for k in range(rank):
            free[0, p, k], free[1, p, k] = 0.0, 0.0
    for m in range(modes):
        x, v = state[2 * m], state[2 * m + 1]
        for p in range(2):
            at = answer[m, p]
            displacement = at[0, 0] * x + at[0, 1] * v
            velocity = at[1, 0] * x + at[1, 1] * v
            for k in range(rank):
                free[0, p, k] += plan.shape[m, k] * displacement
                free[1, p, k] += plan.shape_rate[m, k] * velocity
    from_motion, from_earlier = plan.from_motion[step], plan.from_earlier[step]
    for row in range(2 * rank):
        total = 0.0
        for part in range(2):
            for p in range(2):
                for k in range(rank):
                    total += from_motion[row, (2 * part + p) * rank + k] * free[part, p, k]
        force[row // rank, row % rank] = total
    for p in range(2):
        for source in range(plan.first_source[2 * step + p], plan.first_source[2 * step + p + 1]):
            low, high = motion[plan.node[source]], motion[plan.node[source] + 1]
            weight, block = plan.weight[source], plan.block[source]
            for j in range(rank):
                earlier = weight[0] * low[0, j] + weight[1] * low[1, j]
                if weight[2] != 0.0 or weight[3] != 0.0:
                    earlier += weight[2] * high[0, j] + weight[3] * high[1, j]
                for i in range(rank):
                    push = block[i, j] * earlier
                    for row in range(2 * rank):
                        force[row // rank, row % rank] += from_earlier[row, p * rank + i] * push


@njit(**KERNEL)
def _advance(plan, answer, state, motion, node, force):
    """Set the state to the end of a step and note the motion at its middle and its end."""
    modes, rank = plan.shape.shape
    for p in range(2):
        for k in range(rank):
            motion[node + 1, p, k], motion[node + 2, p, k] = 0.0, 0.0
    for m in range(modes):
        first, second = 0.0, 0.0
        for k in range(rank):
            first += plan.gain[m, k] * force[0, k]
            second += plan.gain[m, k] * force[1, k]
        x, v = state[2 * m], state[2 * m + 1]
        for p in range(2, 4):
            at = answer[m, p]
            displacement = at[0, 0] * x + at[0, 1] * v + at[0, 2] * first + at[0, 3] * second
            velocity = at[1, 0] * x + at[1, 1] * v + at[1, 2] * first + at[1, 3] * second
            for k in range(rank):
                motion[node + p - 1, 0, k] += plan.shape[m, k] * displacement
                motion[node + p - 1, 1, k] += plan.shape_rate[m, k] * velocity
            if p == 3:
                state[2 * m], state[2 * m + 1] = displacement, velocity


@njit(**KERNEL)
def _scale_to_one(function):
    """Divide a function by its length, which is returned."""
    total = 0.0
    for i in range(function.shape[0]):
        total += function[i] * function[i]
    length = math.sqrt(total)
    for i in range(function.shape[0]):
        function[i] /= max(length, 1e-300)
    return length


@njit(**DRIVER)
def first_function(plan, basis):
    """Set the first row of `basis` to a fixed function, run through one period, of length 1."""
    steps = plan.kind.shape[0]
    modes, rank = plan.shape.shape
    seed = 20261121
    start = np.zeros(basis.shape[1])
    for i in range(2 * modes):
        seed = (1103515245 * seed + 12345) % 2147483648
        start[i] = seed / 1073741824.0 - 1.0
    motion = np.empty((4 * steps + 1, 2, rank))
    _propagate(plan, start, basis[0], motion, np.empty((2, rank)), np.empty((2, 2, rank)))
    _scale_to_one(basis[0])


@njit(**DRIVER)
def extend_space(plan, basis, hessenberg, first, last):
    """Propagate the functions first .. last - 1 and make each image a new function of the basis.

    Parameters
    ----------
    plan : StepPlan
    basis : (k + 1, d) array of float
        Orthonormal initial functions, `first` + 1 of them on entry.
    hessenberg : (k + 1, k) array of float
        The operator in this basis; columns first .. last - 1 are set.
    first, last : int

    Returns
    -------
    int
        Functions whose image is known: less than `last` where the space closes.
    """
    steps = plan.kind.shape[0]
    rank = plan.shape.shape[1]
    motion = np.empty((4 * steps + 1, 2, rank))
    force, free = np.empty((2, rank)), np.empty((2, 2, rank))
    dimension = basis.shape[1]
    for k in range(first, last):
        image = basis[k + 1]
        _propagate(plan, basis[k], image, motion, force, free)
        before = 0.0
        for i in range(dimension):
            before += image[i] * image[i]
        for _ in range(2):
            for j in range(k + 1):
                overlap = 0.0
                for i in range(dimension):
                    overlap += basis[j, i] * image[i]
                hessenberg[j, k] += overlap
                for i in range(dimension):
                    image[i] -= overlap * basis[j, i]
        norm = _scale_to_one(image)
        if norm <= 1e-14 * math.sqrt(before):
            return k + 1
        hessenberg[k + 1, k] = norm
    return last
