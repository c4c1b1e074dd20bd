"""Structure given by modes: a pair of coordinates a mode, stepped exactly, and its energy.

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
from dynamics.machine.steps import StructureSteps, steps_of
from dynamics.modal.modes import Mode

#: of a matrix whose rows sum up to one: the last term is below rounding
_TAYLOR_TERMS = 20
_DIRECTIONS = 3


def modal_structure(
    modes: Sequence[Mode], step: float, rubbing: Sequence[int] = ()
) -> StructureSteps:
    """Return modes at rest on ports: the tool point along x, y, z, then modes that rub.

    Parameters
    ----------
    modes : sequence of Mode
        Their velocity is the second coordinate of each pair.
    step : float
        s.
    rubbing : sequence of int
        Modes whose modal displacement is a port.

    Notes
    -----
    The force acts on the tool and, reversed, on the workpiece; the relative displacement counts
    a workpiece mode backwards too, so that both sides add up alike.
    """
    count = len(modes)
    stiffness = np.array([mode.stiffness for mode in modes], dtype=np.float64)
    natural = np.array([mode.natural_frequency for mode in modes], dtype=np.float64)
    ratio = np.array([mode.damping for mode in modes], dtype=np.float64)
    over = _transition(natural * step, ratio)
    # velocities are divided by the natural frequency there, and forces by the stiffness
    unit = np.stack([np.ones(count), natural], axis=1)
    per_force = unit / stiffness[:, None]
    shape = np.array([mode.direction for mode in modes], dtype=np.float64).reshape(count, 3)
    ports = np.vstack([shape.T, np.eye(count)[np.array(rubbing, dtype=np.int64)]])
    motion = np.zeros((2, 2 * count, len(ports)))
    motion[0, 0::2], motion[1, 1::2] = ports.T, ports.T
    size = len(ports), 2 * count
    return steps_of(
        step,
        {
            "dense": np.zeros((0, 0)),
            "pairs": (over[:, :2, :2] * unit[:, :, None] / unit[:, None, :]).reshape(count, 4).T,
            "held": (ports[:, :, None] * (over[:, :2, 2] * per_force)).reshape(size),
            "ramp": (ports[:, :, None] * (over[:, :2, 3] * per_force)).reshape(size),
            "displacement": motion[0],
            "velocity": motion[1],
        },
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


class ModalEnergy(NamedTuple):
    """Account of the energy of n modes under forces at the tool point; it puts on none itself.

    It comes before the frictions, which account for their own work.
    """

    shape: NDArray[np.float64]  # motion of the tool point per modal displacement, (n, 3)
    mass: NDArray[np.float64]  # kg, (n,)
    stiffness: NDArray[np.float64]  # N/m, (n,)
    damping: NDArray[np.float64]  # N s/m, (n,)
    energy: NDArray[np.float64]  # work done and energy dissipated since the start, J, (2,)


def modal_energy(modes: Sequence[Mode]) -> ModalEnergy:
    """Return the account of modes at rest."""
    return ModalEnergy(
        np.array([mode.direction for mode in modes], dtype=np.float64).reshape(-1, _DIRECTIONS),
        np.array([mode.mass for mode in modes], dtype=np.float64),
        np.array([mode.stiffness for mode in modes], dtype=np.float64),
        np.array(
            [2.0 * mode.damping * mode.mass * mode.natural_frequency for mode in modes],
            dtype=np.float64,
        ),
        np.zeros(2),
    )


@register_jitable(**INLINED)
def modal_energy_forces(group, bus, clock):  # noqa: ARG001
    """Add work and dissipation of the step, whose motion is corrected."""
    h = bus.step
    for i in range(group.mass.shape[0]):
        f0 = f1 = 0.0
        for axis in range(_DIRECTIONS):
            f0 += group.shape[i, axis] * bus.force[axis]
            f1 += group.shape[i, axis] * (bus.force[axis] + bus.change[axis])
        q0, v0 = bus.state[2 * i], bus.state[2 * i + 1]
        q1, v1 = bus.after[2 * i], bus.after[2 * i + 1]
        # mean displacement and square of velocity by Hermite quadrature, of fourth order
        mean = 0.5 * (q0 + q1) + h / 12.0 * (v0 - v1)
        a0 = (f0 - group.damping[i] * v0 - group.stiffness[i] * q0) / group.mass[i]
        a1 = (f1 - group.damping[i] * v1 - group.stiffness[i] * q1) / group.mass[i]
        group.energy[0] += f1 * q1 - f0 * q0 - (f1 - f0) * mean
        group.energy[1] += group.damping[i] * (
            0.5 * h * (v0 * v0 + v1 * v1) + h * h / 6.0 * (v0 * a0 - v1 * a1)
        )


def stored_energy(account: ModalEnergy, bus: StructureSteps) -> float:
    """Kinetic and elastic energy of the modes now, J."""
    q, v = bus.state[0::2], bus.state[1::2]
    # a run that was left early may end far out
    with np.errstate(over="ignore", invalid="ignore"):
        return float(0.5 * np.sum(account.stiffness * q * q + account.mass * v * v))
