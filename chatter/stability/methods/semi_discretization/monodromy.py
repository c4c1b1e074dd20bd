"""First-order semi-discretization of one tooth period.

The delayed motion is interpolated linearly over a step, the periodic coefficients are averaged
exactly over it, and the resulting constant-coefficient equation is solved exactly
(Insperger and Stepan 2004, Int. J. Numer. Meth. Eng. 61, first-order method). Steps end at every
entry and exit of tip and top of the edge, so that no step straddles a jump; where no tooth cuts,
the free motion is one exact step and no delayed motion is stored.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import INNER_KERNEL, SUMMING_KERNEL
from chatter.stability.arnoldi import register_operator
from chatter.stability.methods.semi_discretization.first_order_step import first_order_step
from chatter.stability.methods.semi_discretization.step_schemes import (
    CONSTANT,
    PARABOLA,
    FirstOrder,
    OtherScheme,
    fully_discretized,
    semi_discretized,
)
from cutting.force.directional_coefficients import mean_directional

#: residual of the dominant eigenpair, relative to its magnitude, at which its search stops
RESIDUAL = 1e-8
#: dimension of the space beyond the state at the first check of convergence; the largest
_FIRST_CHECK, LARGEST_SPACE = 5, 240
#: intervals shorter than this share of a tooth period are joined to their neighbour
_SMALLEST_INTERVAL = 1e-9


class Monodromy(NamedTuple):
    """The map of state and delayed motion over one tooth period, step by step.

    The state holds ``(omega x, v)`` of every mode, so that its norm is that of velocity. Delayed
    motion is kept at `nodes` nodes, those that bound a step in the cut. A step leads from node
    ``left`` to ``left + 1``; a free step has ``left = -1``.
    """

    transition: Array  # (steps, 2n, 2n)
    from_left: Array  # of the delayed motion at the left node, (steps, 2n, r)
    from_right: Array  # at the right node, (steps, 2n, r)
    left: IntegerArray  # (steps,)
    duration: Array  # s, (steps,)
    output: Array  # motion of the tool point from the state, (r, 2n)
    nodes: int
    further: IntegerArray  # third node of a parabola (steps,); empty where there is none
    from_further: Array  # (steps, 2n, r)


@njit(**INNER_KERNEL)
def interval_borders(arrays, lag):
    """Angles in one tooth pitch at which an edge enters or leaves, ascending, both ends included.

    (k + 1,), rad; ``borders[-1] = borders[0] + tooth_pitch``.
    """
    pitch = arrays.tooth_pitch
    entry, leave = arrays.table.entry, arrays.table.exit
    angles = np.array([entry, leave, entry + lag, leave + lag])
    for i in range(4):
        angles[i] -= pitch * math.floor(angles[i] / pitch)
    angles.sort()
    borders = np.empty(5)
    count = 0
    for i in range(4):
        if count == 0 or angles[i] - borders[count - 1] > _SMALLEST_INTERVAL * pitch:
            borders[count] = angles[i]
            count += 1
    # the last one may be the first one, a pitch later
    if count > 1 and borders[0] + pitch - borders[count - 1] <= _SMALLEST_INTERVAL * pitch:
        count -= 1
    borders[count] = borders[0] + pitch
    return borders[: count + 1]


@njit(**INNER_KERNEL)
def _is_engaged(arrays, angle, lag):
    """True where some part of an edge is in the cut when a tooth tip is at the angle."""
    pitch = arrays.tooth_pitch
    turn = math.ceil((arrays.table.entry - angle) / pitch)
    return angle + turn * pitch < arrays.table.exit + lag


@njit(**INNER_KERNEL)
def _free_transition(arrays, duration, out):
    """Exact free motion of every mode over a duration, written into out (2n, 2n)."""
    out[:, :] = 0.0
    for i in range(arrays.natural_frequency.shape[0]):
        w, z = arrays.natural_frequency[i], arrays.damping[i]
        damped = w * math.sqrt(1.0 - z * z)
        decay = math.exp(-z * w * duration)
        c = decay * math.cos(damped * duration)
        s = decay * math.sin(damped * duration)
        a, b = z * w / damped, w / damped
        out[2 * i, 2 * i] = c + a * s
        out[2 * i, 2 * i + 1] = b * s
        out[2 * i + 1, 2 * i] = -b * s
        out[2 * i + 1, 2 * i + 1] = c - a * s


@njit(**INNER_KERNEL)
def _set_responses(transition, from_left, from_right, found, at_left, at_right):
    transition[:, :] = found
    from_left[:, :] = at_left
    from_right[:, :] = at_right


@njit(**INNER_KERNEL)
def _first_order_step(scheme, arrays, stiffness, dashpot, duration, transition, left, right, work):  # noqa: ARG001
    first_order_step(arrays, stiffness, dashpot, duration, transition, left, right, work)


@njit(**INNER_KERNEL)
def _other_step(scheme, arrays, stiffness, dashpot, duration, transition, left, right, work):
    if scheme.number == CONSTANT:
        found, constant, _, _ = semi_discretized(arrays, stiffness, dashpot, duration)
        _set_responses(transition, left, right, found, 0.5 * constant, 0.5 * constant)
    elif scheme.number == PARABOLA:
        found, constant, ramp, square = semi_discretized(arrays, stiffness, dashpot, duration)
        _set_responses(transition, left, right, found, constant - ramp, ramp)
        # what a parabola that vanishes at both ends, (s/h)^2 - s/h, adds
        work[4][:, : ramp.shape[1]] = square - ramp
    else:
        found, at_left, at_right = fully_discretized(arrays, stiffness, dashpot, duration)
        _set_responses(transition, left, right, found, at_left, at_right)


_STEPS = {FirstOrder: _first_order_step, OtherScheme: _other_step}


def take_step(scheme, arrays, stiffness, dashpot, duration, transition, left, right, work):
    """Discretize a step by the scheme."""
    _STEPS[type(scheme)](
        scheme, arrays, stiffness, dashpot, duration, transition, left, right, work
    )


@overload(take_step)
def _take_step(scheme, arrays, stiffness, dashpot, duration, transition, left, right, work):  # noqa: ARG001
    if not isinstance(scheme, types.BaseNamedTuple) or scheme.instance_class not in _STEPS:
        return None
    step = _STEPS[scheme.instance_class]

    def stepped(scheme, arrays, stiffness, dashpot, duration, transition, left, right, work):
        step(scheme, arrays, stiffness, dashpot, duration, transition, left, right, work)

    return stepped


@njit(**INNER_KERNEL)
def _bend(excess, from_left, from_right, from_further, before):
    """Turn the line over a step into a parabola through a node a step further on, or before.

    `excess` (2n, r) is what (s/h)^2 - s/h makes; the parabola adds half the second difference.
    """
    from_further[:, :] = 0.5 * excess
    if before:
        from_left[:, :] -= excess
        from_right[:, :] += 0.5 * excess
    else:
        from_left[:, :] += 0.5 * excess
        from_right[:, :] -= excess


@njit(**INNER_KERNEL)
def _interval_steps(arrays, borders, lag, steps, refinement, free_steps):
    """Number of steps of each interval, negative where no tooth cuts."""
    counts = np.empty(borders.shape[0] - 1, dtype=np.int64)
    for i in range(counts.shape[0]):
        share = (borders[i + 1] - borders[i]) / arrays.tooth_pitch
        if _is_engaged(arrays, 0.5 * (borders[i] + borders[i + 1]), lag):
            counts[i] = refinement * max(1, math.ceil(share * steps - 1e-6))
        else:
            counts[i] = -max(1, math.ceil(share * free_steps - 1e-6))
    return counts


@njit(**INNER_KERNEL)
def build_monodromy(scheme, arrays, speed, depth, steps, refinement, free_steps):
    """Assemble the steps of one tooth period as a `Monodromy`, by a scheme of `step_schemes`.

    Spindle speed in rad/s, axial depth in m. Of the steps per tooth period an interval of
    engagement gets its share, rounded up; every step in the cut is divided by `refinement`, for
    extrapolation on nested steps. `free_steps` is the same as `steps` where no tooth cuts; 1
    suffices but for a picture of the motion.
    """
    modes, rank = arrays.shape.shape
    size = 2 * modes
    lag = depth * arrays.lag_per_depth
    borders = interval_borders(arrays, lag)
    counts = _interval_steps(arrays, borders, lag, steps, refinement, free_steps)
    total = np.abs(counts).sum()
    transition = np.zeros((total, size, size))
    from_left = np.zeros((total, size, rank))
    from_right = np.zeros((total, size, rank))
    left = np.full(total, -1, dtype=np.int64)
    thirds = total * scheme.third_nodes
    further = np.zeros(thirds, dtype=np.int64)
    from_further = np.zeros((thirds, size, rank))
    duration = np.empty(total)
    work = (
        np.empty((size, size + rank)),
        np.empty((size, size + rank)),
        np.empty((2, rank)),
        np.empty(rank),
        np.empty((size, size)),
        np.empty((size, rank)),
        np.empty((size, rank)),
    )
    couplings = arrays.table.matrix.shape[0]
    mean = np.empty((couplings, rank, rank))
    stiffness = np.zeros((rank, rank))
    dashpot = np.zeros((rank, rank))
    cutting_speed = arrays.radius * speed
    step, nodes = 0, 0
    for i in range(counts.shape[0]):
        count = abs(counts[i])
        width = (borders[i + 1] - borders[i]) / count
        if counts[i] > 0 and (i == 0 or counts[i - 1] < 0):
            nodes += 1
        for k in range(count):
            duration[step] = width / speed
            if counts[i] < 0:
                _free_transition(arrays, duration[step], transition[step])
            else:
                start = borders[i] + k * width
                mean_directional(arrays.table, arrays.tooth_pitch, start, start + width, lag, mean)
                stiffness[:, :] = depth * mean[0]
                if couplings > 1:
                    dashpot[:, :] = depth / cutting_speed * mean[1]
                take_step(
                    scheme,
                    arrays,
                    stiffness,
                    dashpot,
                    duration[step],
                    transition[step],
                    from_left[step],
                    from_right[step],
                    work,
                )
                left[step] = nodes - 1
                if thirds > 0 and count > 1:
                    # the last step of an interval has no node beyond it of the same length
                    before = k == count - 1
                    further[step] = nodes - 2 if before else nodes + 1
                    _bend(
                        work[4][:, :rank],
                        from_left[step],
                        from_right[step],
                        from_further[step],
                        before,
                    )
                nodes += 1
            step += 1
    output = np.zeros((rank, size))
    for i in range(modes):
        for k in range(rank):
            output[k, 2 * i] = arrays.shape[i, k] / arrays.natural_frequency[i]
    return Monodromy(
        transition, from_left, from_right, left, duration, output, nodes, further, from_further
    )


@njit(**INNER_KERNEL)
def record_motion(output, state, motion):
    """Set motion (r,) to that of the tool point."""
    rank, size = output.shape
    for k in range(rank):
        total = 0.0
        for j in range(size):
            total += output[k, j] * state[j]
        motion[k] = total


@njit(**SUMMING_KERNEL)
def advance_step(period, step, vector, state, next_state):
    """Advance the state over one step; vector holds the motion of the last period after 2n."""
    _, size, rank = period.from_left.shape
    for i in range(size):
        total = 0.0
        for j in range(size):
            total += period.transition[step, i, j] * state[j]
        next_state[i] = total
    if period.left[step] >= 0:
        base = size + period.left[step] * rank
        for i in range(size):
            for k in range(rank):
                next_state[i] += (
                    period.from_left[step, i, k] * vector[base + k]
                    + period.from_right[step, i, k] * vector[base + rank + k]
                )
        if period.further.shape[0] > 0:
            third = size + period.further[step] * rank
            for i in range(size):
                for k in range(rank):
                    next_state[i] += period.from_further[step, i, k] * vector[third + k]
    state[:] = next_state


@njit(**INNER_KERNEL)
def monodromy_scratch(period):
    """Scratch arrays of `apply_monodromy`."""
    size = period.from_left.shape[1]
    return np.empty(size), np.empty(size)


@njit(**INNER_KERNEL)
def apply_monodromy(period, vector, out, scratch):
    """Set out to the image of the vector after one tooth period.

    Vectors (2n + nodes r,) hold the state, then the motion at the nodes during the last period.
    """
    state, next_state = scratch
    steps, size, rank = period.from_left.shape
    state[:] = vector[:size]
    for s in range(steps):
        base = size + period.left[s] * rank
        if period.left[s] >= 0:
            record_motion(period.output, state, out[base : base + rank])
        advance_step(period, s, vector, state, next_state)
        if period.left[s] >= 0:
            record_motion(period.output, state, out[base + rank : base + 2 * rank])
    out[:size] = state


@njit(**INNER_KERNEL)
def first_check(period):
    """Dimension of the space at which its dominant eigenpair is first searched."""
    # weakly damped modes keep as many multipliers near the unit circle as there are states
    return _FIRST_CHECK + period.output.shape[1]


@njit(**INNER_KERNEL)
def start_vector(period):
    """A fixed pseudo-random state and delayed motion."""
    _, size, rank = period.from_left.shape
    start = np.empty(size + period.nodes * rank)
    seed = 12345
    for i in range(start.shape[0]):
        seed = (1103515245 * seed + 12345) % 2147483648
        start[i] = seed / 1073741824.0 - 1.0
    scale = 0.0
    for i in range(size):
        scale += abs(period.output[0, i])
    # motion is smaller than the state by the size of the output matrix
    start[size:] *= scale / size
    return start


register_operator(Monodromy, monodromy_scratch, apply_monodromy)
