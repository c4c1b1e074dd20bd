"""Structure given by modes: a pair of coordinates a mode, stepped exactly, and its energy.

Each mode is a damped oscillator; its transition over a step is the matrix exponential of the
oscillator together with the force and its rate (first-order hold; Franklin, Powell and Workman
1998, section 6.3.2). The step is exact whatever its size, so that only the force limits accuracy.
"""

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
_DIRECTIONS = 3


class ModalSteps(NamedTuple):
    """n modes on p ports, and their state: the tool point along x, y, z, then modes that rub.

    For a few modes on a few ports this takes two thirds of the time of the general table
    (`machine.steps.StructureSteps`), which the loop would notice.
    """

    step: float  # s
    shape: NDArray[np.float64]  # motion of the tool point per modal displacement, (n, 3)
    rubbing: NDArray[np.int64]  # mode of each port behind those of the tool, (p - 3,)
    transition: NDArray[np.float64]  # entries 11, 12, 21, 22, (n, 4)
    constant: NDArray[np.float64]  # state per constant modal force, (n, 2)
    ramp: NDArray[np.float64]  # per change of the force over the step, (n, 2)
    step_compliance: NDArray[np.float64]  # displacements per constant force on a row's port, (p, p)
    step_mobility: NDArray[np.float64]  # velocities, (p, p)
    state: NDArray[np.float64]  # modal displacement, m, and velocity, m/s, in turns, (2 n,)
    after: NDArray[np.float64]  # at the end of the step, (2 n,)
    force: NDArray[np.float64]  # the following as those of `StructureSteps`, (p,)
    change: NDArray[np.float64]
    next_force: NDArray[np.float64]
    u_before: NDArray[np.float64]
    v_before: NDArray[np.float64]
    u: NDArray[np.float64]
    v: NDArray[np.float64]
    halted: NDArray[np.int64]  # (1,)


def modal_structure(modes: Sequence[Mode], step: float, rubbing: Sequence[int] = ()) -> ModalSteps:
    """Return modes at rest on ports.

    Modal displacements of the modes that rub are ports too; step in s. The force acts on the tool
    and, reversed, on the workpiece; the relative displacement counts a workpiece mode backwards
    too, so that both sides add up alike.
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
    indices = np.array(rubbing, dtype=np.int64)
    ports = np.vstack([shape.T, np.eye(count)[indices]])
    constant = over[:, :2, 2] * per_force
    fixed = {
        "shape": shape,
        "rubbing": indices,
        "transition": (over[:, :2, :2] * unit[:, :, None] / unit[:, None, :]).reshape(count, 4),
        "constant": constant,
        "ramp": over[:, :2, 3] * per_force,
        "step_compliance": (ports * constant[:, 0]) @ ports.T,
        "step_mobility": (ports * constant[:, 1]) @ ports.T,
    }
    for column in fixed.values():
        column.flags.writeable = False
    signals = ("force", "change", "next_force", "u_before", "v_before", "u", "v")
    return ModalSteps(
        step=step,
        **fixed,
        state=np.zeros(2 * count),
        after=np.zeros(2 * count),
        **{name: np.zeros(len(ports)) for name in signals},
        halted=np.zeros(1, dtype=np.int64),
    )


@register_jitable(**INLINED)
def _publish(bus):
    """Motion of the ports at the end of the step."""
    ux = uy = uz = vx = vy = vz = 0.0
    for i in range(bus.shape.shape[0]):
        q, w = bus.after[2 * i], bus.after[2 * i + 1]
        x, y, z = bus.shape[i, 0], bus.shape[i, 1], bus.shape[i, 2]
        ux, uy, uz = ux + x * q, uy + y * q, uz + z * q
        vx, vy, vz = vx + x * w, vy + y * w, vz + z * w
    bus.u[0], bus.u[1], bus.u[2] = ux, uy, uz
    bus.v[0], bus.v[1], bus.v[2] = vx, vy, vz
    for k in range(bus.rubbing.shape[0]):
        i = bus.rubbing[k]
        bus.u[_DIRECTIONS + k], bus.v[_DIRECTIONS + k] = bus.after[2 * i], bus.after[2 * i + 1]


@register_jitable(**INLINED)
def predict_modes(bus):
    """Motion over the step with all forces constant."""
    fx, fy, fz = bus.force[0], bus.force[1], bus.force[2]
    for i in range(bus.shape.shape[0]):
        q, w = bus.state[2 * i], bus.state[2 * i + 1]
        f = bus.shape[i, 0] * fx + bus.shape[i, 1] * fy + bus.shape[i, 2] * fz
        a = bus.transition
        bus.after[2 * i] = a[i, 0] * q + a[i, 1] * w + bus.constant[i, 0] * f
        bus.after[2 * i + 1] = a[i, 2] * q + a[i, 3] * w + bus.constant[i, 1] * f
    for k in range(bus.rubbing.shape[0]):
        i, f = bus.rubbing[k], bus.force[_DIRECTIONS + k]
        bus.after[2 * i] += bus.constant[i, 0] * f
        bus.after[2 * i + 1] += bus.constant[i, 1] * f
    _publish(bus)


@register_jitable(**INLINED)
def correct_modes(bus):
    """Let the forces at the tool point vary linearly over the step by their changes."""
    fx, fy, fz = bus.change[0], bus.change[1], bus.change[2]
    for i in range(bus.shape.shape[0]):
        f = bus.shape[i, 0] * fx + bus.shape[i, 1] * fy + bus.shape[i, 2] * fz
        bus.after[2 * i] += bus.ramp[i, 0] * f
        bus.after[2 * i + 1] += bus.ramp[i, 1] * f
    _publish(bus)


@register_jitable(**INLINED)
def add_force_on_mode(bus, p, force):
    """Add a constant force on a mode that rubs, after it was predicted."""
    bus.force[p] += force
    i = bus.rubbing[p - _DIRECTIONS]
    q, w = bus.constant[i, 0] * force, bus.constant[i, 1] * force
    bus.after[2 * i] += q
    bus.after[2 * i + 1] += w
    for axis in range(_DIRECTIONS):
        bus.u[axis] += bus.shape[i, axis] * q
        bus.v[axis] += bus.shape[i, axis] * w
    bus.u[p] += q
    bus.v[p] += w


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
    x0, y0, z0 = bus.force[0], bus.force[1], bus.force[2]
    x1, y1, z1 = x0 + bus.change[0], y0 + bus.change[1], z0 + bus.change[2]
    work = dissipated = 0.0
    for i in range(group.mass.shape[0]):
        x, y, z = group.shape[i, 0], group.shape[i, 1], group.shape[i, 2]
        f0, f1 = x * x0 + y * y0 + z * z0, x * x1 + y * y1 + z * z1
        q0, v0 = bus.state[2 * i], bus.state[2 * i + 1]
        q1, v1 = bus.after[2 * i], bus.after[2 * i + 1]
        # mean displacement and square of velocity by Hermite quadrature, of fourth order
        mean = 0.5 * (q0 + q1) + h / 12.0 * (v0 - v1)
        p0 = f0 - group.damping[i] * v0 - group.stiffness[i] * q0
        p1 = f1 - group.damping[i] * v1 - group.stiffness[i] * q1
        work += f1 * q1 - f0 * q0 - (f1 - f0) * mean
        dissipated += group.damping[i] * (
            0.5 * h * (v0 * v0 + v1 * v1) + h * h / 6.0 * (v0 * p0 - v1 * p1) / group.mass[i]
        )
    group.energy[0] += work
    group.energy[1] += dissipated


def stored_energy(account: ModalEnergy, bus: ModalSteps) -> float:
    """Kinetic and elastic energy of the modes now, J."""
    q, v = bus.state[0::2], bus.state[1::2]
    # a run that was left early may end far out
    with np.errstate(over="ignore", invalid="ignore"):
        return float(0.5 * np.sum(account.stiffness * q * q + account.mass * v * v))
