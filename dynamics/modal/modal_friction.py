"""Frictions on modal coordinates, held over a step beside the forces at the tool point.

Modes do not feel each other's friction, so that each is solved alone, with the exact response of
its mode; see `friction.implicit`.
"""

from __future__ import annotations

from numba.extending import overload, register_jitable

from dynamics.compiled import INLINED
from dynamics.friction.laws import friction_advance, friction_step


@register_jitable(**INLINED)
def _push(modes, point, i, force):
    """Add what a force held over the step moves a mode by."""
    modes.state[i, 0] += modes.held[i, 0] * force
    modes.state[i, 1] += modes.held[i, 1] * force
    for axis in range(3):
        point.displacement[axis] += modes.shape[i, axis] * modes.held[i, 0] * force
        point.velocity[axis] += modes.shape[i, axis] * modes.held[i, 1] * force


@register_jitable(**INLINED)
def _hold(group, modes, point):
    for k in range(group.force.shape[0]):
        _push(modes, point, group.law.port[k], -group.force[k])


@register_jitable(**INLINED)
def _resist(group, modes, state_before, point):
    for k in range(group.force.shape[0]):
        i = group.law.port[k]
        gx, g, before = modes.held[i, 0], modes.held[i, 1], group.force[k]
        dx_free = modes.state[i, 0] - state_before[i, 0] + gx * before
        v_free = modes.state[i, 1] + g * before
        force, motion = friction_step(group.law, k, dx_free, gx, v_free, g, modes.step)
        _push(modes, point, i, before - force)
        group.force[k] = force
        modes.energy[1] += force * (dx_free - gx * force)
        friction_advance(group.law, k, motion, modes.step)


def hold(frictions, modes, point):
    """Let the frictions of the step before act on the predicted motion.

    Parameters
    ----------
    frictions : tuple of friction.laws.Frictions
        Their ports are numbers of modes.
    modes : ModalSteps
    point
        Has displacement and velocity, (3,) arrays.
    """
    for group in frictions:
        _hold(group, modes, point)


@overload(hold, jit_options=INLINED)
def _hold_all(frictions, modes, point):  # noqa: ARG001
    if len(frictions) == 0:
        return lambda frictions, modes, point: None  # noqa: ARG005

    def rest(frictions, modes, point):
        _hold(frictions[0], modes, point)
        hold(frictions[1:], modes, point)

    return rest


def resist(frictions, modes, state_before, point):
    """Solve for the frictions of the step, given the motion corrected for all other forces.

    Parameters
    ----------
    frictions : tuple of friction.laws.Frictions
    modes : ModalSteps
    state_before : (n, 2) array of float
        State at the start of the step.
    point
        Has displacement and velocity, (3,) arrays.
    """
    for group in frictions:
        _resist(group, modes, state_before, point)


@overload(resist, jit_options=INLINED)
def _resist_all(frictions, modes, state_before, point):  # noqa: ARG001
    if len(frictions) == 0:
        return lambda frictions, modes, state_before, point: None  # noqa: ARG005

    def rest(frictions, modes, state_before, point):
        _resist(frictions[0], modes, state_before, point)
        resist(frictions[1:], modes, state_before, point)

    return rest
