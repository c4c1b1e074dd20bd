"""Law groups of a machine: controlled drives, constant forces, loads, frictions and backlashes.

A group is a table and two kernels: `forces` puts its forces on the ports of the bus, `commit` takes
the motion of the step into its memory. Drives, constant forces and loads are known at the beginning
of a step; frictions and backlashes are solved for together with its motion.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED, for_each
from dynamics.control.drive_step import control_step
from dynamics.control.drive_table import TORQUE_INJECTED, ControlTable
from dynamics.drive.backlash import BacklashTable, opening_step, stiffness_at
from dynamics.friction.laws import Frictions, friction_advance, friction_step
from dynamics.machine.ports import add_constant_force
from dynamics.trajectory.set_points import SetPoints, set_point_at

#: change of a friction force that its neighbours need not hear of: its motion over theirs, and m
_UNHEARD, _UNSEEN = 1e-6, 1e-15
#: sweeps over frictions that push one another, one or two are the rule; and those after which
#: frictions that keep one another from rest are solved in the mean form
_MOST_SWEEPS, _SWEEPS_TO_REST = 40, 12


class ControlledDrives(NamedTuple):
    """Drives under control, k of them."""

    control: ControlTable
    port: NDArray[np.int64]  # where torque acts and the encoder measures, (k,)
    scale: NDArray[np.int64]  # port of the direct measuring system, (k,)
    axis: NDArray[np.int64]  # column of the set points, (k,)
    points: SetPoints
    injected: NDArray[np.float64]  # torque of a test in every step, then the last, N m, (n, k)
    torque: NDArray[np.float64]  # of the last step, N m, (k,)


class ConstantForces(NamedTuple):
    """Forces that never change: preloads, weights."""

    port: NDArray[np.int64]
    value: NDArray[np.float64]  # N


class Loads(NamedTuple):
    """Forces on ports, linear from step to step."""

    port: NDArray[np.int64]  # (l,)
    force: NDArray[np.float64]  # N, at the ends of the steps of a run, (n+1, l)


class FrictionsOnPorts(NamedTuple):
    """All frictions and backlashes of a structure, which feel one another through it."""

    by_law: tuple[Frictions, ...]
    backlashes: tuple[BacklashTable, ...]  # one, or none
    together: int  # 1 where the force of one moves the port of another
    sweep: NDArray[np.int64]  # number of the sweep, and whether any force changed in it, (2,)
    work: NDArray[np.float64]  # that they have taken since the start, J, (1,)


def frictions_on_ports(
    groups: tuple[Frictions, ...],
    step_compliance: NDArray[np.float64],
    backlashes: tuple[BacklashTable, ...] = (),
) -> FrictionsOnPorts:
    """Return frictions at rest, and backlashes, on the ports of a structure."""
    ports = np.concatenate([*(group.law.port for group in groups), *(b.port for b in backlashes)])
    answers = step_compliance[np.ix_(ports, ports)]
    together = int(np.any(answers != np.diag(np.diag(answers))))
    sweep = np.zeros(2, dtype=np.int64)
    return FrictionsOnPorts(groups, backlashes, together, sweep, np.zeros(1))


@register_jitable(**INLINED)
def nothing(group, bus, clock):
    """Put on no force, or remember nothing."""


@register_jitable(**INLINED)
def drive_forces(group, bus, clock):
    """Torque of every drive from its controller."""
    row = min(clock.number, group.injected.shape[0] - 1)
    for k in range(group.port.shape[0]):
        p = group.port[k]
        x_set, v_set, a_set = set_point_at(group.points, group.axis[k], clock.number)
        group.control.state[k, TORQUE_INJECTED] = group.injected[row, k]
        torque = control_step(
            group.control,
            k,
            clock.number,
            x_set,
            v_set,
            a_set,
            bus.u_before[p],
            bus.v_before[p],
            bus.u_before[group.scale[k]],
        )
        group.torque[k] = torque
        bus.force[p] += torque


@register_jitable(**INLINED)
def constant_forces(group, bus, clock):  # noqa: ARG001
    """Put the constant forces on."""
    for i in range(group.port.shape[0]):
        bus.force[group.port[i]] += group.value[i]


@register_jitable(**INLINED)
def load_forces(group, bus, clock):
    """Put on the loads at the beginning of the step, and their change over it."""
    for i in range(group.port.shape[0]):
        now = group.force[clock.number, i]
        bus.force[group.port[i]] += now
        bus.change[group.port[i]] += group.force[clock.number + 1, i] - now


@register_jitable(**INLINED)
def _solve_each(frictions, group, bus):
    """Solve each friction of a law with the others as they are.

    In the mean form it is a descent along one force after the other in a convex energy, which
    ends at the joint solution; frictions that are brought to rest may push one another in turns.
    """
    resting = 1.0 if group.sweep[0] < _SWEEPS_TO_REST else 0.0
    for i in range(frictions.force.shape[0]):
        p = frictions.law.port[i]
        gx, g = bus.step_compliance[p, p], bus.step_mobility[p, p]
        dx_free = bus.u[p] - bus.u_before[p] + gx * frictions.force[i]
        v_free = bus.v[p] + g * frictions.force[i]
        force, motion = friction_step(frictions.law, i, dx_free, gx, v_free, resting * g, bus.step)
        change = force - frictions.force[i]
        if change != 0.0:
            add_constant_force(bus, p, -change)
        frictions.force[i] = force
        frictions.beyond[i] = motion - (dx_free - gx * force)
        if abs(change) * gx > _UNHEARD * abs(dx_free) + _UNSEEN:
            group.sweep[1] = group.together


@register_jitable(**INLINED)
def _commit_each(frictions, group, bus):
    """Move the laws with their ports, and leave their forces for the next step to begin with."""
    for i in range(frictions.force.shape[0]):
        p = frictions.law.port[i]
        motion = bus.u[p] - bus.u_before[p]
        group.work[0] += frictions.force[i] * motion
        friction_advance(frictions.law, i, motion + frictions.beyond[i], bus.step)
        bus.next_force[p] = -frictions.force[i]


@register_jitable(**INLINED)
def _follow_axes(backlashes, group, bus):  # noqa: ARG001
    """Take the stiffness of the springs from where their axes are."""
    for i in range(backlashes.port.shape[0]):
        if backlashes.travel[i] >= 0:
            travel = bus.u_before[backlashes.travel[i]]
            backlashes.stiffness[i] = stiffness_at(backlashes, i, travel)


@register_jitable(**INLINED)
def _open_each(backlashes, group, bus):
    """Solve each backlash with all other forces as they are."""
    for i in range(backlashes.port.shape[0]):
        p = backlashes.port[i]
        gx, held = bus.step_compliance[p, p], backlashes.force[i]
        free = bus.u[p] - bus.u_before[p] - gx * held
        force = opening_step(backlashes, i, bus.u_before[p], free, gx, bus.step)
        if force != held:
            add_constant_force(bus, p, force - held)
            backlashes.force[i] = force
            if abs(force - held) * gx > _UNHEARD * abs(free) + _UNSEEN:
                group.sweep[1] = group.together


@register_jitable(**INLINED)
def _hold_each(backlashes, group, bus):  # noqa: ARG001
    """Leave the forces of backlashes for the next step to begin with."""
    for i in range(backlashes.port.shape[0]):
        bus.next_force[backlashes.port[i]] = backlashes.force[i]


_solve_all = for_each(_solve_each)
_commit_all = for_each(_commit_each)
_follow_all = for_each(_follow_axes)
_open_all = for_each(_open_each)
_hold_all = for_each(_hold_each)


@register_jitable(**INLINED)
def friction_forces(group, bus, clock):  # noqa: ARG001
    """Solve for all of them, from those of the last step, in sweeps until none need another."""
    _follow_all(group.backlashes, group, bus)
    for sweep in range(_MOST_SWEEPS):
        group.sweep[0], group.sweep[1] = sweep, 0
        _open_all(group.backlashes, group, bus)
        _solve_all(group.by_law, group, bus)
        if group.sweep[1] == 0:
            break


@register_jitable(**INLINED)
def friction_commit(group, bus, clock):  # noqa: ARG001
    """Move all frictions with their ports, and keep the forces of backlashes."""
    _commit_all(group.by_law, group, bus)
    _hold_all(group.backlashes, group, bus)
