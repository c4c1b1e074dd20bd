"""Exact step in the cut with averaged coefficients and a delayed motion linear in time.

Insperger and Stepan 2004, Int. J. Numer. Meth. Eng. 61, first-order method.
"""

import math

from numba import njit

from chatter.engine.presets import INNER_KERNEL


@njit(**INNER_KERNEL)
def _multiply_generator(arrays, stiffness, dashpot, x, motion, force, out):
    """Set out = A x for the state equation in the cut; x and out have shape (2n, m)."""
    modes, rank = arrays.shape.shape
    columns = x.shape[1]
    for j in range(columns):
        for k in range(rank):
            motion[0, k] = 0.0
            motion[1, k] = 0.0
        for i in range(modes):
            position = x[2 * i, j] / arrays.natural_frequency[i]
            for k in range(rank):
                motion[0, k] += arrays.shape[i, k] * position
                motion[1, k] += arrays.shape[i, k] * x[2 * i + 1, j]
        for k in range(rank):
            force[k] = 0.0
            for m in range(rank):
                present = stiffness[k, m] + arrays.stiffening * dashpot[k, m]
                force[k] -= present * motion[0, m] + dashpot[k, m] * motion[1, m]
        for i in range(modes):
            w = arrays.natural_frequency[i]
            out[2 * i, j] = w * x[2 * i + 1, j]
            rate = -w * x[2 * i, j] - 2.0 * arrays.damping[i] * w * x[2 * i + 1, j]
            for k in range(rank):
                rate += arrays.force_gain[i, k] * force[k]
            out[2 * i + 1, j] = rate


@njit(**INNER_KERNEL)
def _generator_norm(arrays, stiffness, dashpot):
    """Upper bound of the norm of the generator, 1/s."""
    free, gain_0, gain_1, reach = 0.0, 0.0, 0.0, 0.0
    modes, rank = arrays.shape.shape
    for i in range(modes):
        w = arrays.natural_frequency[i]
        free = max(free, w * (1.0 + 2.0 * arrays.damping[i]))
        for k in range(rank):
            reach += arrays.force_gain[i, k] ** 2
            gain_0 += (arrays.shape[i, k] / w) ** 2
            gain_1 += arrays.shape[i, k] ** 2
    size_0, size_1 = 0.0, 0.0
    for k in range(rank):
        for m in range(rank):
            size_0 += (stiffness[k, m] + arrays.stiffening * dashpot[k, m]) ** 2
            size_1 += dashpot[k, m] ** 2
    return free + math.sqrt(reach * size_0 * gain_0) + math.sqrt(reach * size_1 * gain_1)


@njit(**INNER_KERNEL)
def first_order_step(arrays, stiffness, dashpot, duration, transition, from_left, from_right, work):
    """Exact step with constant coefficients and a delayed motion linear in time.

    Taylor series of exp(A h), h phi_1(A h) B and h^2 phi_2(A h) B on a fraction of the step,
    then doubling (Al-Mohy and Higham 2011 for the choice of fraction).
    """
    size, rank = from_left.shape
    bound = _generator_norm(arrays, stiffness, dashpot) * duration
    doublings = max(0, math.ceil(math.log2(max(bound, 1e-300))))
    h = duration / 2.0**doublings
    term, following, motion, force, product, constant, ramp = work
    # columns 0..2n-1 of term carry the identity, the last r the input matrix
    term[:, :] = 0.0
    for i in range(size):
        term[i, i] = 1.0
    for i in range(size // 2):
        for k in range(rank):
            total = 0.0
            for m in range(rank):
                total += arrays.force_gain[i, m] * stiffness[m, k]
            term[2 * i + 1, size + k] = total
    transition[:, :] = term[:, :size]
    for i in range(size):
        for k in range(rank):
            constant[i, k] = h * term[i, size + k]
            ramp[i, k] = 0.5 * h * h * term[i, size + k]
    for order in range(1, 30):
        _multiply_generator(arrays, stiffness, dashpot, term, motion, force, following)
        factor = h / order
        largest = 0.0
        for i in range(size):
            for j in range(size + rank):
                term[i, j] = factor * following[i, j]
            for j in range(size):
                transition[i, j] += term[i, j]
                largest = max(largest, abs(term[i, j]))
            for k in range(rank):
                constant[i, k] += h / (order + 1) * term[i, size + k]
                ramp[i, k] += h * h / ((order + 1) * (order + 2)) * term[i, size + k]
        if largest < 1e-17:
            break
    for _ in range(doublings):
        for i in range(size):
            for k in range(rank):
                moved, moved_ramp = 0.0, 0.0
                for j in range(size):
                    moved += transition[i, j] * constant[j, k]
                    moved_ramp += transition[i, j] * ramp[j, k]
                from_left[i, k] = moved
                from_right[i, k] = moved_ramp
        for i in range(size):
            for k in range(rank):
                ramp[i, k] += from_right[i, k] + h * constant[i, k]
                constant[i, k] += from_left[i, k]
        for i in range(size):
            for j in range(size):
                total = 0.0
                for k in range(size):
                    total += transition[i, k] * transition[k, j]
                product[i, j] = total
        transition[:, :] = product
        h *= 2.0
    for i in range(size):
        for k in range(rank):
            from_right[i, k] = ramp[i, k] / duration
            from_left[i, k] = constant[i, k] - from_right[i, k]
