"""Law groups of a machine: controlled drives, constant forces and frictions on the bus.

Each group answers three calls: `drive` puts on forces known at the beginning of a step, `resist`
solves for forces that depend on the motion of the step, `settle` takes the motion into its memory.
A group joins by its table, its kernels and one entry in each list it answers; one that is absent
costs nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types
from numba.extending import overload, register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.control.drive_step import control_step
from dynamics.control.drive_table import TORQUE_INJECTED, ControlTable
from dynamics.friction.laws import Frictions, friction_advance, friction_step
from dynamics.machine.steps import add_held
from dynamics.trajectory.set_points import SetPoints, set_point_at

#: change of a friction force that its neighbours need not hear of: its motion over theirs, and m
_UNHEARD, _UNSEEN = 1e-6, 1e-15
#: sweeps after which frictions that keep one another from rest are solved in the mean form
_SWEEPS_TO_REST = 12


class ControlledDrives(NamedTuple):
    """Drives under control, k of them."""

    control: ControlTable
    port: NDArray[np.int64]  # where torque acts and the encoder measures, (k,)
    scale: NDArray[np.int64]  # port of the direct measuring system, (k,)
    axis: NDArray[np.int64]  # column of the set points, (k,)
    points: SetPoints
    injected: NDArray[np.float64]  # torque of a test per step of a chunk, N m, (n, k)
    torque: NDArray[np.float64]  # of the last step, N m, (k,)


class ConstantForces(NamedTuple):
    """Forces that never change: preloads, weights."""

    port: NDArray[np.int64]
    value: NDArray[np.float64]  # N


@register_jitable(**INLINED)
def drives_drive(group, s, number, row):
    """Torque of every drive from its controller."""
    for k in range(group.port.shape[0]):
        p = group.port[k]
        x_set, v_set, a_set = set_point_at(group.points, group.axis[k], number)
        group.control.state[k, TORQUE_INJECTED] = group.injected[row, k]
        torque = control_step(
            group.control,
            k,
            number,
            x_set,
            v_set,
            a_set,
            s.u_before[p],
            s.v_before[p],
            s.u_before[group.scale[k]],
        )
        group.torque[k] = torque
        s.force[p] += torque


@register_jitable(**INLINED)
def constant_drive(group, s, number, row):  # noqa: ARG001
    """Put the constant forces on."""
    for i in range(group.port.shape[0]):
        s.force[group.port[i]] += group.value[i]


@register_jitable(**INLINED)
def frictions_drive(group, s, number, row):  # noqa: ARG001
    """Put on the forces of the last step, near to those that will be found."""
    group.sweeps[0] = 0
    for i in range(group.force.shape[0]):
        s.force[group.law.port[i]] -= group.force[i]


@register_jitable(**INLINED)
def frictions_resist(group, s):
    """Solve each friction with the others as they are; tell whether any need hear of it.

    In the mean form it is a descent along one force after the other in a convex energy, which
    ends at the joint solution; frictions that are brought to rest may push one another in turns.
    """
    heard = False
    resting = 1.0 if group.sweeps[0] < _SWEEPS_TO_REST else 0.0
    group.sweeps[0] += 1
    for i in range(group.force.shape[0]):
        p = group.law.port[i]
        gx, g = s.moved_by_held[p, p], s.sped_by_held[p, p]
        dx_free = s.u[p] - s.u_before[p] + gx * group.force[i]
        v_free = s.v[p] + g * group.force[i]
        force, motion = friction_step(group.law, i, dx_free, gx, v_free, resting * g, s.step)
        change = force - group.force[i]
        if change != 0.0:
            add_held(s, p, -change)
        group.force[i] = force
        group.beyond[i] = motion - (dx_free - gx * force)
        heard = heard or abs(change) * gx > _UNHEARD * abs(dx_free) + _UNSEEN
    return heard


@register_jitable(**INLINED)
def frictions_settle(group, s):
    """Move the laws with their ports."""
    for i in range(group.force.shape[0]):
        p = group.law.port[i]
        motion = s.u[p] - s.u_before[p] + group.beyond[i]
        friction_advance(group.law, i, motion, s.step)


@register_jitable(**INLINED)
def _never_resists(group, s):  # noqa: ARG001
    return False


@register_jitable(**INLINED)
def _keeps_nothing(group, s):
    pass


#: table -> kernel that puts on forces known at the beginning
DRIVING = {
    ControlledDrives: drives_drive,
    ConstantForces: constant_drive,
    Frictions: frictions_drive,
}
#: table -> kernel that solves for forces that resist the motion
RESISTING = {Frictions: frictions_resist}
#: table -> kernel that takes in the motion of the step
SETTLING = {Frictions: frictions_settle}


def _kernel(kernels, group, otherwise=None):
    if not isinstance(group, types.BaseNamedTuple):
        return None
    return kernels.get(group.instance_class, otherwise)


def drive(group, s, number, row):
    """Put on the forces of a group known at the beginning of the step."""
    DRIVING[type(group)](group, s, number, row)


@overload(drive, jit_options=INLINED)
def _drive(group, s, number, row):  # noqa: ARG001
    return _kernel(DRIVING, group)


def resist(group, s):
    """Solve for the forces of a group that resist the motion; whether others need hear of it."""
    return RESISTING.get(type(group), _never_resists)(group, s)


@overload(resist, jit_options=INLINED)
def _resist(group, s):  # noqa: ARG001
    return _kernel(RESISTING, group, _never_resists)


def settle(group, s):
    """Take the motion of the step into the memory of a group."""
    SETTLING.get(type(group), _keeps_nothing)(group, s)


@overload(settle, jit_options=INLINED)
def _settle(group, s):  # noqa: ARG001
    return _kernel(SETTLING, group, _keeps_nothing)


def all_drive(groups, s, number, row):
    """Let every group drive, in their order."""
    for group in groups:
        drive(group, s, number, row)


@overload(all_drive, jit_options=INLINED)
def _all_drive(groups, s, number, row):  # noqa: ARG001
    if len(groups) == 0:
        return lambda groups, s, number, row: None  # noqa: ARG005

    def rest(groups, s, number, row):
        drive(groups[0], s, number, row)
        all_drive(groups[1:], s, number, row)

    return rest


def all_resist(groups, s):
    """Let every group resist once; whether any force changed that others feel."""
    heard = [resist(group, s) for group in groups]
    return any(heard)


@overload(all_resist, jit_options=INLINED)
def _all_resist(groups, s):  # noqa: ARG001
    if len(groups) == 0:
        return lambda groups, s: False  # noqa: ARG005

    def rest(groups, s):
        first = resist(groups[0], s)
        others = all_resist(groups[1:], s)
        return first or others

    return rest


def all_settle(groups, s):
    """Let every group settle, in their order."""
    for group in groups:
        settle(group, s)


@overload(all_settle, jit_options=INLINED)
def _all_settle(groups, s):  # noqa: ARG001
    if len(groups) == 0:
        return lambda groups, s: None  # noqa: ARG005

    def rest(groups, s):
        settle(groups[0], s)
        all_settle(groups[1:], s)

    return rest
