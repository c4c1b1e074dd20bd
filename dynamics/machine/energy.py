"""Energy of a machine over a run: work of all forces by what puts them on, dissipated, stored.

Every force acts through a port, so that the work of drives, frictions and loads is that of their
ports. The balance closes where the sum of the works is what dampers took and the structure stores.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.machine.blocks import blocks
from dynamics.machine.moving_structure import MovingStructure
from dynamics.machine.steps import StructureSteps, lower_triangle, multiply_lower
from dynamics.structure.linear_structure import LinearStructure

#: what puts forces on ports -> 1 where its work is put in, -1 where it is taken
SOURCES: Mapping[str, float] = {
    "drives": 1.0,
    "preloads": 1.0,
    "loads": 1.0,
    "friction": -1.0,
    "backlash": -1.0,
}


class EnergyAccount(NamedTuple):
    """Account of the energy of a structure; it puts on no force.

    d coordinates tell displacements, m of them, from one on, velocities; p ports.
    """

    unit: NDArray[np.float64]  # coordinate per displacement, (d,)
    stiffness: NDArray[np.float64]  # of those displacements, as it is now, (d, d)
    mass: NDArray[np.float64]  # of the velocities, (m, m)
    damping: NDArray[np.float64]  # of them, as `lower_triangle`, (m, m)
    first: int  # coordinate of the first velocity
    resisted: NDArray[np.float64]  # that damping times velocity at the end of the step, (m,)
    power: NDArray[np.float64]  # dissipated at the end of the last step, W, (1,)
    dissipated: NDArray[np.float64]  # since the start, J, (1,)
    work: NDArray[np.float64]  # of the force on each port since the start, J, (p,)
    source: NDArray[np.int64]  # of each port's force: number in `SOURCES`, (p,)
    travel: NDArray[np.float64]  # work of the axes on the structure, J, (1,)
    at_start: tuple[float, float]  # kinetic and elastic energy, J


def account_of_moving(
    group: MovingStructure, bus: StructureSteps, sources: Sequence[int]
) -> EnergyAccount:
    """Return the account of a structure that follows its axes, at its start."""
    count = group.unit.size
    account = EnergyAccount(
        group.unit,
        group.stiffness_now,
        np.eye(count),
        group.damping_now,
        count,
        np.zeros(count),
        np.zeros(1),
        np.zeros(1),
        np.zeros(bus.u.size),
        np.array(sources, dtype=np.int64),
        group.work,
        (0.0, 0.0),
    )
    return _started(account, bus)


def account_of_structure(
    structure: LinearStructure, bus: StructureSteps, sources: Sequence[int]
) -> EnergyAccount:
    """Return the account of a structure that stays as it is, stepped by `structure_steps`."""
    split = blocks(structure, np.eye(structure.size))
    moved, moving = split.displacement, split.velocity
    size = len(split.rate)
    account = EnergyAccount(
        np.ones(size),
        moved.T @ structure.stiffness @ moved,
        moving.T @ structure.mass @ moving,
        lower_triangle(moving.T @ structure.damping @ moving),
        0,
        np.zeros(size),
        np.zeros(1),
        np.zeros(1),
        np.zeros(bus.u.size),
        np.array(sources, dtype=np.int64),
        np.zeros(1),
        (0.0, 0.0),
    )
    return _started(account, bus)


def _started(account: EnergyAccount, bus: StructureSteps) -> EnergyAccount:
    velocity = _velocity(account, bus)
    account.power[0] = velocity @ account.damping @ velocity
    return account._replace(at_start=_stored(account, bus))


def _velocity(account: EnergyAccount, bus: StructureSteps) -> NDArray[np.float64]:
    return bus.state[account.first : account.first + len(account.mass)]


def _stored(account: EnergyAccount, bus: StructureSteps) -> tuple[float, float]:
    """Kinetic and elastic energy now, J."""
    q, v = bus.state[: account.unit.size] / account.unit, _velocity(account, bus)
    # a run that was left early may end far out
    with np.errstate(over="ignore", invalid="ignore"):
        return float(0.5 * v @ account.mass @ v), float(0.5 * q @ account.stiffness @ q)


def energy_of(account: EnergyAccount, bus: StructureSteps) -> dict[str, float]:
    """Energy since the start, J.

    `work` of all forces and `travel` of the axes through the strained structure are `dissipated` in
    dampers and `stored` in addition, which is `kinetic` and `elastic`. The work is that of
    `drives`, `preloads` and `loads`, less what `friction` and `backlash` (opening springs that the
    structure holds closed) took; those that did no work are left out.
    """
    works = {
        name: sign * float(account.work[account.source == number].sum())
        for number, (name, sign) in enumerate(SOURCES.items())
        if np.any(account.work[account.source == number])
    }
    kinetic, elastic = (
        now - before for now, before in zip(_stored(account, bus), account.at_start, strict=True)
    )
    return {
        "work": float(account.work.sum()),
        **works,
        "travel": float(account.travel[0]),
        "dissipated": float(account.dissipated[0]),
        "stored": kinetic + elastic,
        "kinetic": kinetic,
        "elastic": elastic,
    }


@register_jitable(**INLINED)
def energy_commit(group, bus, clock):  # noqa: ARG001
    """Add work and dissipation of the step.

    The work is exact but for the mean of a displacement, which is by Hermite quadrature; the
    dissipation by the trapezoidal rule, whose errors within a vibration cancel.
    """
    h, m = bus.step, group.resisted.shape[0]
    for p in range(bus.u.shape[0]):
        if bus.force[p] != 0.0 or bus.change[p] != 0.0:
            u0, u1 = bus.u_before[p], bus.u[p]
            mean = 0.5 * (u0 + u1) + h / 12.0 * (bus.v_before[p] - bus.v[p])
            group.work[p] += bus.force[p] * (u1 - u0) + bus.change[p] * (u1 - mean)
    multiply_lower(group.damping, bus.after[group.first :], group.resisted, m)
    power = 0.0
    for i in range(m):
        power += bus.after[group.first + i] * group.resisted[i]
    group.dissipated[0] += 0.5 * h * (group.power[0] + power)
    group.power[0] = power
