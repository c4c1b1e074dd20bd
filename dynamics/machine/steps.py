"""Exact step of a linear structure under forces on ports: table and kernels.

Ports are the bus: every law reads displacement and velocity of a port and puts a force on it.
Forces are held over a step (drives, friction), or vary linearly over it (loads, the cut).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.machine.blocks import blocks
from dynamics.matrix_exponential import exact_step
from dynamics.structure.linear_structure import LinearStructure


class StructureSteps(NamedTuple):
    """Structure on its ports, and its state; s coordinates, r of them dense, b pairs."""

    step: float  # s
    dense: NDArray[np.float64]  # transition of the dense coordinates, transposed, (r, r)
    pairs: NDArray[np.float64]  # transition of the pairs, entries 11, 12, 21, 22, (4, b)
    held: NDArray[np.float64]  # state per force held, (p, s)
    ramp: NDArray[np.float64]  # state per change of a force over the step, (p, s)
    displacement: NDArray[np.float64]  # of the ports, transposed, (s, p)
    velocity: NDArray[np.float64]  # (s, p)
    moved_by_held: NDArray[np.float64]  # displacements per force held on a row's port, (p, p)
    sped_by_held: NDArray[np.float64]  # velocities, (p, p)
    moved_by_ramp: NDArray[np.float64]  # (p, p)
    sped_by_ramp: NDArray[np.float64]  # (p, p)
    state: NDArray[np.float64]  # (s,)
    after: NDArray[np.float64]  # state at the end of the step, (s,)
    force: NDArray[np.float64]  # held over the step, (p,)
    change: NDArray[np.float64]  # of forces over the step, (p,)
    u_before: NDArray[np.float64]  # displacement of the ports at its beginning, (p,)
    v_before: NDArray[np.float64]
    u: NDArray[np.float64]  # at its end, (p,)
    v: NDArray[np.float64]


def structure_steps(
    structure: LinearStructure,
    ports: NDArray[np.float64],
    step: float,
    velocity: NDArray[np.float64] | None = None,
) -> StructureSteps:
    """Return a structure unstrained, with its exact transition over a step of time, s.

    Parameters
    ----------
    structure : LinearStructure
    ports : (p, n) array of float
        Rows, as from `LinearStructure.port`.
    step : float
        s.
    velocity : (n,) array of float, optional
        Of the freedoms at the start, m/s (rad/s); at rest by default.
    """
    split = blocks(structure, np.asarray(ports, dtype=np.float64).reshape(-1, structure.size))
    count = split.entry.shape[1]
    transition, first, second = _over_step(split.rate, split.dense, step)
    held, ramp = first @ split.entry, second @ split.entry
    pairs = range(split.dense, len(split.rate), 2)
    entries = [(0, 0), (0, 1), (1, 0), (1, 1)]
    columns = {
        "dense": np.ascontiguousarray(transition[: split.dense, : split.dense].T),
        "pairs": np.array(
            [[transition[start + i, start + j] for start in pairs] for i, j in entries]
        ).reshape(4, -1),
        "held": np.ascontiguousarray(held.T),
        "ramp": np.ascontiguousarray(ramp.T),
        "displacement": np.ascontiguousarray(split.displacement.T),
        "velocity": np.ascontiguousarray(split.velocity.T),
        "moved_by_held": np.ascontiguousarray((split.displacement @ held).T),
        "sped_by_held": np.ascontiguousarray((split.velocity @ held).T),
        "moved_by_ramp": np.ascontiguousarray((split.displacement @ ramp).T),
        "sped_by_ramp": np.ascontiguousarray((split.velocity @ ramp).T),
    }
    for column in columns.values():
        column.flags.writeable = False
    state = np.zeros(len(split.rate)) if velocity is None else split.start @ velocity
    steps = StructureSteps(
        step=step,
        **columns,
        state=state,
        after=np.zeros(len(state)),
        **{name: np.zeros(count) for name in StructureSteps._fields[-6:]},
    )
    steps.v[:] = split.velocity @ state
    return steps


def _over_step(
    rate: NDArray[np.float64], dense: int, step: float
) -> tuple[NDArray, NDArray, NDArray]:
    """Transition, and state per held and per growing force, from exponentials of the blocks."""
    size = len(rate)
    results = tuple(np.zeros((size, size)) for _ in range(3))
    starts = [(0, dense)] if dense else []
    starts += [(start, 2) for start in range(dense, size, 2)]
    for start, width in starts:
        part = slice(start, start + width)
        over = exact_step(rate[part, part], np.eye(width), step)
        for result, block in zip(results, over, strict=True):
            result[part, part] = block
    return results


@register_jitable(**INLINED)
def begin_step(s):
    """Take the end of the last step as the beginning of this one, with no forces."""
    for p in range(s.u.shape[0]):
        s.u_before[p] = s.u[p]
        s.v_before[p] = s.v[p]
        s.force[p] = 0.0
        s.change[p] = 0.0


@register_jitable(**INLINED)
def move(s):
    """Motion over the step under the forces gathered so far."""
    r = s.dense.shape[0]
    for i in range(s.after.shape[0]):
        s.after[i] = 0.0
    for j in range(r):
        z = s.state[j]
        for i in range(r):
            s.after[i] += s.dense[j, i] * z
    for k in range(s.pairs.shape[1]):
        x, y = s.state[r + 2 * k], s.state[r + 2 * k + 1]
        s.after[r + 2 * k] = s.pairs[0, k] * x + s.pairs[1, k] * y
        s.after[r + 2 * k + 1] = s.pairs[2, k] * x + s.pairs[3, k] * y
    for p in range(s.force.shape[0]):
        if s.force[p] != 0.0:
            for i in range(s.after.shape[0]):
                s.after[i] += s.held[p, i] * s.force[p]
        if s.change[p] != 0.0:
            for i in range(s.after.shape[0]):
                s.after[i] += s.ramp[p, i] * s.change[p]
    for p in range(s.u.shape[0]):
        s.u[p] = 0.0
        s.v[p] = 0.0
    for i in range(s.after.shape[0]):
        z = s.after[i]
        for p in range(s.u.shape[0]):
            s.u[p] += s.displacement[i, p] * z
            s.v[p] += s.velocity[i, p] * z


@register_jitable(**INLINED)
def _answer(s, p, force, state, displacement, velocity):
    """Add what a force on a port does to state and ports over the step."""
    for i in range(s.after.shape[0]):
        s.after[i] += state[p, i] * force
    for q in range(s.u.shape[0]):
        s.u[q] += displacement[p, q] * force
        s.v[q] += velocity[p, q] * force


@register_jitable(**INLINED)
def add_held(s, p, force):
    """Add a force held over the step, after `move`."""
    s.force[p] += force
    _answer(s, p, force, s.held, s.moved_by_held, s.sped_by_held)


@register_jitable(**INLINED)
def add_change(s, p, change):
    """Add a change of a force over the step, after `move`."""
    s.change[p] += change
    _answer(s, p, change, s.ramp, s.moved_by_ramp, s.sped_by_ramp)


@register_jitable(**INLINED)
def end_step(s):
    """Take the state at the end of the step."""
    for i in range(s.state.shape[0]):
        s.state[i] = s.after[i]
