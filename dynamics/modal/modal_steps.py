"""Exact discrete step of a modal model under a force that varies linearly within the step.

Each mode is a damped oscillator; its transition over a step is the matrix exponential of the
oscillator together with the force and its rate (first-order hold; Franklin, Powell and Workman
1998, section 6.3.2). The step is exact whatever its size, so that only the force limits accuracy.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.modal.modes import Mode

#: of a matrix whose rows sum up to one: the last term is below rounding
_TAYLOR_TERMS = 20


class ModalSteps(NamedTuple):
    """n modes and their state; displacement of the tool point against the workpiece."""

    shape: NDArray[np.float64]  # motion of the tool point per modal displacement, (n, 3)
    mass: NDArray[np.float64]  # kg, (n,)
    stiffness: NDArray[np.float64]  # N/m, (n,)
    damping: NDArray[np.float64]  # N s/m, (n,)
    transition: NDArray[np.float64]  # (n, 2, 2)
    held: NDArray[np.float64]  # by a constant modal force, per N, (n, 2)
    ramp: NDArray[np.float64]  # by the change of the force over the step, per N, (n, 2)
    state: NDArray[np.float64]  # modal displacement m and velocity m/s, (n, 2)
    force: NDArray[np.float64]  # modal force at the last step, N, (n,)
    energy: NDArray[np.float64]  # work done and energy dissipated since the start, J, (2,)
    step: float  # s


def modal_steps(modes: Sequence[Mode], step: float) -> ModalSteps:
    """Return modes at rest with their exact transition over a step of time, s.

    Notes
    -----
    The force acts on the tool and, reversed, on the workpiece; the relative displacement counts
    a workpiece mode backwards too, so that both sides add up alike.
    """
    count = len(modes)
    mass = np.array([mode.mass for mode in modes], dtype=np.float64)
    stiffness = np.array([mode.stiffness for mode in modes], dtype=np.float64)
    damping = np.array(
        [2.0 * mode.damping * mode.mass * mode.natural_frequency for mode in modes],
        dtype=np.float64,
    )
    natural = np.array([mode.natural_frequency for mode in modes], dtype=np.float64)
    over = _transition(natural * step, 0.5 * damping / (mass * natural))
    # velocities are divided by the natural frequency there, and forces by the stiffness
    unit = np.stack([np.ones(count), natural], axis=1)
    per_force = unit / stiffness[:, None]
    directions = [mode.direction for mode in modes]
    return ModalSteps(
        shape=np.array(directions, dtype=np.float64).reshape(count, 3),
        mass=mass,
        stiffness=stiffness,
        damping=damping,
        transition=over[:, :2, :2] * unit[:, :, None] / unit[:, None, :],
        held=over[:, :2, 2] * per_force,
        ramp=over[:, :2, 3] * per_force,
        state=np.zeros((count, 2)),
        force=np.zeros(count),
        energy=np.zeros(2),
        step=step,
    )


def _transition(turn: NDArray[np.float64], damping: NDArray[np.float64]) -> NDArray[np.float64]:
    """Exponential (n, 4, 4) of oscillators that turn by an angle (rad) in a step.

    Rows and columns are displacement, velocity over natural frequency, force and change of the
    force, both over stiffness. In these units no entry is larger than the turn or one, so that a
    Taylor series with halving of the step keeps all digits however small the step is.
    """
    generator = np.zeros((turn.size, 4, 4))
    generator[:, 0, 1] = generator[:, 1, 2] = turn
    generator[:, 1, 0] = -turn
    generator[:, 1, 1] = -2.0 * damping * turn
    generator[:, 2, 3] = 1.0
    largest = np.abs(generator).sum(axis=2).max(initial=1.0)
    halvings = max(0, math.ceil(math.log2(largest)))
    generator /= 2.0**halvings
    term = np.broadcast_to(np.eye(4), generator.shape)
    total = term.copy()
    for order in range(1, _TAYLOR_TERMS):
        term = np.einsum("nij,njk->nik", term, generator) / order
        total += term
    for _ in range(halvings):
        total = np.einsum("nij,njk->nik", total, total)
    return total


@register_jitable(**INLINED)
def take_force(modes, point):
    """Take the force at the tool point as the one with which the next step begins."""
    for i in range(modes.mass.shape[0]):
        modes.force[i] = 0.0
        for axis in range(3):
            modes.force[i] += modes.shape[i, axis] * point.force[axis]


@register_jitable(**INLINED)
def predict(modes, state_before, point):
    """Step with the force held; publish the predicted motion of the tool point.

    Parameters
    ----------
    modes : ModalSteps
        Its state becomes the predicted one.
    state_before : (n, 2) array of float
        Overwritten with the state at the start of the step.
    point
        Has displacement and velocity, (3,) arrays, overwritten.
    """
    for axis in range(3):
        point.displacement[axis] = 0.0
        point.velocity[axis] = 0.0
    for i in range(modes.mass.shape[0]):
        q, v, f = modes.state[i, 0], modes.state[i, 1], modes.force[i]
        a = modes.transition
        state_before[i, 0], state_before[i, 1] = q, v
        q1 = a[i, 0, 0] * q + a[i, 0, 1] * v + modes.held[i, 0] * f
        v1 = a[i, 1, 0] * q + a[i, 1, 1] * v + modes.held[i, 1] * f
        modes.state[i, 0], modes.state[i, 1] = q1, v1
        for axis in range(3):
            point.displacement[axis] += modes.shape[i, axis] * q1
            point.velocity[axis] += modes.shape[i, axis] * v1


@register_jitable(**INLINED)
def correct(modes, state_before, point):
    """Let the force vary linearly to its new value; publish the motion and account the energy.

    Parameters
    ----------
    modes : ModalSteps
        Its state is the predicted one and becomes the corrected one.
    state_before : (n, 2) array of float
        State at the start of the step.
    point
        Has force, displacement and velocity, (3,) arrays; the latter two are overwritten.
    """
    for axis in range(3):
        point.displacement[axis] = 0.0
        point.velocity[axis] = 0.0
    h = modes.step
    for i in range(modes.mass.shape[0]):
        f1 = 0.0
        for axis in range(3):
            f1 += modes.shape[i, axis] * point.force[axis]
        f0 = modes.force[i]
        modes.force[i] = f1
        modes.state[i, 0] += modes.ramp[i, 0] * (f1 - f0)
        modes.state[i, 1] += modes.ramp[i, 1] * (f1 - f0)
        q0, v0 = state_before[i, 0], state_before[i, 1]
        q1, v1 = modes.state[i, 0], modes.state[i, 1]
        # mean displacement and square of velocity by Hermite quadrature, of fourth order
        mean = 0.5 * (q0 + q1) + h / 12.0 * (v0 - v1)
        a0 = (f0 - modes.damping[i] * v0 - modes.stiffness[i] * q0) / modes.mass[i]
        a1 = (f1 - modes.damping[i] * v1 - modes.stiffness[i] * q1) / modes.mass[i]
        modes.energy[0] += f1 * q1 - f0 * q0 - (f1 - f0) * mean
        modes.energy[1] += modes.damping[i] * (
            0.5 * h * (v0 * v0 + v1 * v1) + h * h / 6.0 * (v0 * a0 - v1 * a1)
        )
        for axis in range(3):
            point.displacement[axis] += modes.shape[i, axis] * q1
            point.velocity[axis] += modes.shape[i, axis] * v1


def stored_energy(modes: ModalSteps) -> float:
    """Kinetic and elastic energy of the modes now, J."""
    q, v = modes.state[:, 0], modes.state[:, 1]
    # a run that was left early may end far out
    with np.errstate(over="ignore", invalid="ignore"):
        return float(0.5 * np.sum(modes.stiffness * q * q + modes.mass * v * v))
