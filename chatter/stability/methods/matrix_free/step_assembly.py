"""What one step after the other does to the motion of a cut, laid out for a speed and a depth.

The force at the Gauss points of a step follows from the motion there, which is solved for, and from
the motion when the earlier teeth passed. Order four in the length of the steps.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import INNER_KERNEL
from chatter.stability.methods.matrix_free.couplings import (
    Instant,
    add_contact,
    clear,
    couple,
    edge_at_depth,
    empty_sources,
    nothing_present,
    with_room,
)
from chatter.stability.methods.matrix_free.modal_response import (
    POSITIONS,
    graded_response,
    mode_response,
)
from chatter.stability.methods.matrix_free.steps import period_steps, step_time
from chatter.stability.spindle_rotation import speed_at, spindle_rotation_at
from cutting.edge_segments.coupling import radius_at
from cutting.process_damping.linear_flank import inverse_radius

#: step lengths closer than this share are the same
_SAME_LENGTH = 1e-9


class StepAssembly(NamedTuple):
    """N steps of S kinds; node 2 k is the start of step k, node 2 k + 1 its middle.

    Nodes count on from those of the period before, 0 .. 2 N - 1, to those of this one. A node holds
    the displacement and the velocity over `rate` in r directions; the state (x, x'/omega) of every
    mode.
    """

    time: Array  # of the nodes of this period, and its end, s (2 N + 1,)
    kind: IntegerArray  # number of the kind of a step (N,)
    response: Array  # of every mode, see `mode_response` (S, n, 4, 2, 4)
    engaged: IntegerArray  # 1 in the cut (N,)
    from_motion: Array  # force at the Gauss points from free motion (N, 2r, 4r)
    from_earlier: Array  # and from the force of the earlier motion (N, 2r, 2r)
    first_source: IntegerArray  # of each Gauss point (2 N + 1,)
    node: IntegerArray  # earlier of the two of a source (sources,)
    weight: Array  # of displacement and velocity at both nodes (sources, 4)
    block: Array  # force per displacement, N/m (sources, r, r)
    shape: Array  # displacement per modal coordinate (n, r)
    shape_rate: Array  # velocity over `rate` per x'/omega (n, r)
    gain: Array  # modal acceleration per force, 1/kg (n, r)
    rate: float  # rad/s


@njit(**INNER_KERNEL)
def _kinds(steps):
    """Steps that are the first of their kind, and the kind of each; plain ones of a length."""
    count = steps.power.shape[0]
    first, kind = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    found, plain = 0, -1
    for k in range(count):
        alike = False
        if steps.power[k] == 1.0:
            known = steps.span[first[plain]] if plain >= 0 else -1.0
            alike = abs(known - steps.span[k]) <= _SAME_LENGTH * steps.span[k]
        if not alike:
            first[found] = k
            plain = found if steps.power[k] == 1.0 else plain
            found += 1
        kind[k] = plain if alike else found - 1
    return first[:found], kind


@njit(**INNER_KERNEL)
def _responses(cut, steps, first):
    """Answers of all modes over the steps of each kind (S, n, 4, 2, 4)."""
    modes = cut.natural_frequency.shape[0]
    response = np.empty((first.shape[0], modes, 4, 2, 4))
    rule = cut.edge_position, cut.edge_weight
    for s in range(first.shape[0]):
        k = first[s]
        for m in range(modes):
            frequency, damping = cut.natural_frequency[m], cut.damping[m]
            if steps.power[k] == 1.0:
                mode_response(frequency, damping, steps.span[k], response[s, m])
            else:
                graded = steps.span[k], steps.power[k], steps.low[k], steps.high[k]
                graded_response(frequency, damping, rule, graded, response[s, m])
    return response


@njit(**INNER_KERNEL)
def _reach_of_force(cut, response, displacement, velocity):
    """Displacement and velocity at both Gauss points from the forces there (2r, 2r)."""
    modes, rank = cut.shape.shape
    clear(displacement)
    clear(velocity)
    for m in range(modes):
        for p in range(2):
            for q in range(2):
                x, v = response[m, p, 0, 2 + q], response[m, p, 1, 2 + q] * cut.natural_frequency[m]
                for k in range(rank):
                    for l in range(rank):  # noqa: E741
                        both = cut.shape[m, k] * cut.force_gain[m, l]
                        displacement[p * rank + k, q * rank + l] += both * x
                        velocity[p * rank + k, q * rank + l] += both * v


@njit(**INNER_KERNEL)
def _eliminate(system, first, second):
    """Solve for two right-hand sides in their position; `system` is overwritten. Pivots by rows."""
    n = system.shape[0]
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(system[i, k]) > abs(system[pivot, k]):
                pivot = i
        for part in (system, first, second):
            for j in range(part.shape[1]):
                part[k, j], part[pivot, j] = part[pivot, j], part[k, j]
        scale = 1.0 / system[k, k]
        for part in (system, first, second):
            for j in range(part.shape[1]):
                part[k, j] *= scale
        for i in range(n):
            factor = system[i, k]
            if i == k or factor == 0.0:
                continue
            for part in (system, first, second):
                for j in range(part.shape[1]):
                    part[i, j] -= factor * part[k, j]


@njit(**INNER_KERNEL)
def assemble_steps(stepped, speed, depth, steps_per_wavelength, refinement):
    """Lay out the steps of one period at a mean spindle speed (rad/s) and an axial depth (m).

    See `period_steps` for the other parameters.
    """
    cut, rate = stepped.arrays, stepped.fastest
    rotation = spindle_rotation_at(cut.variation, cut.fit, speed, cut.period_angle)
    steps = period_steps(stepped, rotation, depth, steps_per_wavelength, refinement)
    count = steps.power.shape[0]
    modes, rank = cut.shape.shape
    first, kind = _kinds(steps)
    response = _responses(cut, steps, first)
    engaged = np.zeros(count, dtype=np.int64)
    from_motion = np.zeros((count, 2 * rank, 4 * rank))
    from_earlier = np.zeros((count, 2 * rank, 2 * rank))
    edge = edge_at_depth(cut, depth)
    groups = cut.segments.distinct_delay.shape[0]
    first_source = np.zeros(2 * count + 1, dtype=np.int64)
    sources = empty_sources(2 * count * (groups + 1) + edge.most, rank)
    present = nothing_present(rank, groups)
    reach, reach_rate = np.empty((2 * rank, 2 * rank)), np.empty((2 * rank, 2 * rank))
    system = np.empty((2 * rank, 2 * rank))
    inverse = inverse_radius(cut.segments.flank, radius_at(cut.segments, depth))
    held = stepped.contact.stiffness > 0.0 or stepped.contact.damping > 0.0
    for k in range(count):
        clear(system)
        for i in range(2 * rank):
            system[i, i], from_earlier[k, i, i] = 1.0, 1.0
        _reach_of_force(cut, response[kind[k]], reach, reach_rate)
        for p in range(2):
            at = first_source[2 * k + p]
            sources = with_room(sources, at, edge.most)
            time = step_time(steps, k, POSITIONS[p])
            now = Instant(rotation, steps.node, rate, k, time)
            speed_factor = inverse / speed_at(rotation, time)
            height, first_source[2 * k + p + 1] = couple(
                cut, edge, now, speed_factor, sources, at, present
            )
            if height > 0.0:
                engaged[k] = 1
            if held:
                share = min(1.0, height / depth / stepped.contact.full_share)
                add_contact(cut.basis, stepped.contact, share, present.stiffness, present.dashpot)
            _enter(present, p, rate, reach, reach_rate, from_motion[k], system)
        if engaged[k] == 1:
            _eliminate(system, from_motion[k], from_earlier[k])
    total = first_source[2 * count]
    return StepAssembly(
        steps.node, kind, response, engaged, from_motion, from_earlier, first_source,
        sources.node[:total], sources.weight[:total], sources.block[:total],
        cut.shape, cut.shape * (cut.natural_frequency / rate).reshape(modes, 1),
        cut.force_gain, rate,
    )  # fmt: skip


@njit(**INNER_KERNEL)
def _enter(present, p, rate, reach, reach_rate, from_motion, system):
    """Enter the couplings at one Gauss point into the equations of a step."""
    rank = present.stiffness.shape[0]
    for i in range(rank):
        row = p * rank + i
        for j in range(rank):
            at = p * rank + j
            stiffness, dashpot = present.stiffness[i, j], present.dashpot[i, j]
            from_motion[row, at] = -stiffness
            from_motion[row, 2 * rank + at] = -dashpot * rate
            for column in range(2 * rank):
                system[row, column] += stiffness * reach[at, column]
                system[row, column] += dashpot * reach_rate[at, column]
