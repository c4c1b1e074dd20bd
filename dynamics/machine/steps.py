"""Exact step of a linear structure under forces on ports: table and kernels.

Ports are the bus: every law reads displacement and velocity of a port and puts a force on it.
Forces are constant over a step (drives, friction), or vary linearly over it (loads, the cut). The
state is a block of coordinates and pairs.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.machine.blocks import blocks
from dynamics.matrix_exponential import exact_step
from dynamics.structure.linear_structure import LinearStructure

#: size from which a matrix is multiplied by eight rows at a time
_BLOCKED = 16
#: exact steps kept, of as many structures
_KEPT_STEPS = 8


class StructureSteps(NamedTuple):
    """Structure on its ports, and its state; s coordinates, r of them dense, b pairs."""

    step: float  # s
    dense: NDArray[np.float64]  # transition of the dense coordinates, transposed, (r, r)
    pairs: NDArray[np.float64]  # transition of the pairs, entries 11, 12, 21, 22, (4, b)
    constant: NDArray[np.float64]  # state per constant force, (p, s)
    ramp: NDArray[np.float64]  # state per change of a force over the step, (p, s)
    displacement: NDArray[np.float64]  # of the ports, transposed, (s, p)
    velocity: NDArray[np.float64]  # (s, p)
    #: coordinates that displacements are read from, the first ones, and first one of velocities
    displaced: int
    moving: int
    step_compliance: NDArray[np.float64]  # displacements per constant force on a row's port, (p, p)
    step_mobility: NDArray[np.float64]  # velocities, (p, p)
    ramp_compliance: NDArray[np.float64]  # the same per change of a force, (p, p)
    ramp_mobility: NDArray[np.float64]  # (p, p)
    state: NDArray[np.float64]  # (s,)
    after: NDArray[np.float64]  # state at the end of the step, (s,)
    force: NDArray[np.float64]  # held over the step, (p,)
    change: NDArray[np.float64]  # of forces over the step, (p,)
    next_force: NDArray[np.float64]  # at the end of the step: the next begins with it, (p,)
    u_before: NDArray[np.float64]  # displacement of the ports at its beginning, (p,)
    v_before: NDArray[np.float64]
    u: NDArray[np.float64]  # at its end, (p,)
    v: NDArray[np.float64]
    halted: NDArray[np.int64]  # 1 where a law has left its range, (1,)


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
    rate = np.ascontiguousarray(split.rate)
    transition, first, second = _over_step(rate.tobytes(), len(rate), split.dense, step)
    pairs = range(split.dense, len(split.rate), 2)
    entries = [(0, 0), (0, 1), (1, 0), (1, 1)]
    columns = {
        "dense": transition[: split.dense, : split.dense].T,
        "pairs": np.array(
            [[transition[start + i, start + j] for start in pairs] for i, j in entries]
        ).reshape(4, -1),
        "constant": (first @ split.entry).T,
        "ramp": (second @ split.entry).T,
        "displacement": split.displacement.T,
        "velocity": split.velocity.T,
    }
    answers = {
        f"{force}_{kind}": columns[way] @ columns[motion]
        for force, way in (("step", "constant"), ("ramp", "ramp"))
        for kind, motion in (("compliance", "displacement"), ("mobility", "velocity"))
    }
    fixed = {name: np.ascontiguousarray(part) for name, part in {**columns, **answers}.items()}
    for column in fixed.values():
        column.flags.writeable = False
    signals = ("force", "change", "next_force", "u_before", "v_before", "u", "v")
    steps = StructureSteps(
        step=step,
        **fixed,
        displaced=len(split.rate),
        moving=0,
        state=np.zeros(len(split.rate)),
        after=np.zeros(len(split.rate)),
        **{name: np.zeros(split.entry.shape[1]) for name in signals},
        halted=np.zeros(1, dtype=np.int64),
    )
    if velocity is not None:
        steps.state[:] = split.start @ velocity
    steps.v[:] = split.velocity @ steps.state
    return steps


@lru_cache(_KEPT_STEPS)
def _over_step(
    content: bytes, size: int, dense: int, step: float
) -> tuple[NDArray, NDArray, NDArray]:
    """Transition, and state per held and per growing force, from exponentials of the blocks.

    The rates (size, size) are given as bytes: a search asks for the same structure many times.
    """
    rate = np.frombuffer(content).reshape(size, size)
    results = tuple(np.zeros((size, size)) for _ in range(3))
    starts = [(0, dense)] if dense else []
    starts += [(start, 2) for start in range(dense, size, 2)]
    for start, width in starts:
        part = slice(start, start + width)
        over = exact_step(rate[part, part], np.eye(width), step)
        for result, block in zip(results, over, strict=True):
            result[part, part] = block
    for result in results:
        result.flags.writeable = False
    return results


@register_jitable(**INLINED)
def begin_step(bus):
    """Take the end of the last step as the beginning of this one, with the forces left by it."""
    for p in range(bus.u.shape[0]):
        bus.u_before[p] = bus.u[p]
        bus.v_before[p] = bus.v[p]
        bus.force[p] = bus.next_force[p]
        bus.change[p] = 0.0


@register_jitable(**INLINED)
def multiply(matrix, values, product, size):
    """Product of a matrix (size, size), given transposed, with values; row by row.

    Eight rows at a time where there are many: sums are loaded and stored an eighth as often.
    """
    for i in range(size):
        product[i] = 0.0
    whole = size - size % 8 if size >= _BLOCKED else 0
    for j in range(0, whole, 8):
        a, b, c, d = values[j], values[j + 1], values[j + 2], values[j + 3]
        e, f, g, h = values[j + 4], values[j + 5], values[j + 6], values[j + 7]
        for i in range(size):
            first = matrix[j, i] * a + matrix[j + 1, i] * b
            first += matrix[j + 2, i] * c + matrix[j + 3, i] * d
            second = matrix[j + 4, i] * e + matrix[j + 5, i] * f
            product[i] += first + (second + (matrix[j + 6, i] * g + matrix[j + 7, i] * h))
    for j in range(whole, size):
        value = values[j]
        for i in range(size):
            product[i] += matrix[j, i] * value


def lower_triangle(damping: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lower triangle that dissipates as a symmetric damping does, with half of the entries."""
    return np.tril(damping) + np.tril(damping, -1)


@register_jitable(**INLINED)
def multiply_lower(matrix, values, product, size):
    """Product of a lower triangle (size, size), given not transposed, from the left: values L.

    Row by row, four at a time.
    """
    for i in range(size):
        product[i] = 0.0
    whole = size - size % 4
    for j in range(0, whole, 4):
        a, b, c, d = values[j], values[j + 1], values[j + 2], values[j + 3]
        for i in range(j + 4):
            first = matrix[j, i] * a + matrix[j + 1, i] * b
            product[i] += first + (matrix[j + 2, i] * c + matrix[j + 3, i] * d)
    for j in range(whole, size):
        value = values[j]
        for i in range(j + 1):
            product[i] += matrix[j, i] * value


@register_jitable(**INLINED)
def predict_structure(bus):
    """Motion over the step with all forces held."""
    r = bus.dense.shape[0]
    multiply(bus.dense, bus.state, bus.after, r)
    for k in range(bus.pairs.shape[1]):
        x, y = bus.state[r + 2 * k], bus.state[r + 2 * k + 1]
        bus.after[r + 2 * k] = bus.pairs[0, k] * x + bus.pairs[1, k] * y
        bus.after[r + 2 * k + 1] = bus.pairs[2, k] * x + bus.pairs[3, k] * y
    for p in range(bus.force.shape[0]):
        if bus.force[p] != 0.0:
            for i in range(bus.after.shape[0]):
                bus.after[i] += bus.constant[p, i] * bus.force[p]
    for p in range(bus.u.shape[0]):
        bus.u[p] = 0.0
        bus.v[p] = 0.0
    for i in range(bus.displaced):
        z = bus.after[i]
        for p in range(bus.u.shape[0]):
            bus.u[p] += bus.displacement[i, p] * z
    for i in range(bus.moving, bus.after.shape[0]):
        z = bus.after[i]
        for p in range(bus.u.shape[0]):
            bus.v[p] += bus.velocity[i, p] * z


@register_jitable(**INLINED)
def _answer(bus, p, force, state, displacement, velocity):
    """Add what a force on a port does to state and ports over the step."""
    for i in range(bus.after.shape[0]):
        bus.after[i] += state[p, i] * force
    for q in range(bus.u.shape[0]):
        bus.u[q] += displacement[p, q] * force
        bus.v[q] += velocity[p, q] * force


@register_jitable(**INLINED)
def correct_structure(bus):
    """Let the forces vary linearly over the step by their changes."""
    for p in range(bus.change.shape[0]):
        if bus.change[p] != 0.0:
            _answer(bus, p, bus.change[p], bus.ramp, bus.ramp_compliance, bus.ramp_mobility)


@register_jitable(**INLINED)
def add_force_on_structure(bus, p, force):
    """Add a force held over the step, after it was predicted."""
    bus.force[p] += force
    _answer(bus, p, force, bus.constant, bus.step_compliance, bus.step_mobility)


@register_jitable(**INLINED)
def end_step(bus):
    """Take the state at the end of the step."""
    for i in range(bus.state.shape[0]):
        bus.state[i] = bus.after[i]
