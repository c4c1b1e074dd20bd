"""Structure that changes as axes travel, stepped on its ports: tables and kernels.

The structure is known at positions of the axes, in the same coordinates (`machine.along_axes`).
Damping and the rows of its ports are interpolated by splines, and so is the logarithm of the
stiffness (log-Euclidean interpolation; Arsigny, Fillard, Pennec and Ayache 2007, SIAM J. Matrix
Anal. Appl. 29:328): in between it is positive too, and compliance and frequencies are as smooth as
the stiffness, while a spline of the stiffness itself would hold a carriage at two places at once.
Exact steps at many positions in between are blended linearly by where the axes are. The state stays
what it is, so that nothing jumps; the blend of stable steps is stable. What the travel of the axes
through a strained structure does to its energy is accounted for.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.machine.description import Machine
from dynamics.machine.steps import StructureSteps, lower_triangle, multiply
from dynamics.matrix_exponential import exact_step
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import StructureError

#: steps after which the structure may follow the axes again, and the shares of the distance between
#: two positions that they must have travelled for it
_STEPS, _SHARES = 16, 32.0
#: of a stiffness, over the largest: resistance of a rigid motion that is rounding
_NO_RESISTANCE = 1e-9


class MachinesAlong(NamedTuple):
    """A machine at a grid of positions of some axes, in the same coordinates."""

    axes: tuple[str, ...]
    positions: tuple[NDArray[np.float64], ...]  # of each axis from the start, ascending, m
    machines: tuple[Machine, ...]  # the last axis varies fastest
    outputs: tuple[Mapping[str, NDArray[np.float64]], ...]  # rows (n,) read, at each position
    #: parts of each distance between two positions, by axis, at whose ends there are exact steps
    parts: tuple[int, ...]

    def machines_along(self, axis: int) -> list[Machine]:
        """Machines along one axis, by its number, with the others where they start."""
        counts = [len(one) for one in self.positions]
        start = np.unravel_index(_start(self), counts)
        numbers = np.arange(len(self.machines)).reshape(counts)
        places = tuple(slice(None) if one == axis else at for one, at in enumerate(start))
        return [self.machines[number] for number in numbers[places]]


class MovingStructure(NamedTuple):
    """Steps of a structure at t positions of its axes, and where the blend of them stands.

    s coordinates, n freedoms, p ports, a axes.
    """

    port: NDArray[np.int64]  # travel of each axis, (a,)
    count: NDArray[np.int64]  # positions of each axis, (a,)
    position: NDArray[np.float64]  # (a, most)
    reach: NDArray[np.float64]  # travel that the structure need not follow, m, (a,)
    travel: NDArray[np.float64]  # of the axes at which the blend stands, m, (a,)
    cell: NDArray[np.int64]  # position before the travel, (a,)
    share: NDArray[np.float64]  # of the one behind it, (a,)
    dense: NDArray[np.float64]  # columns of `StructureSteps` at every position, (t, s, s)
    constant: NDArray[np.float64]  # (t, p, s)
    ramp: NDArray[np.float64]  # (t, p, s)
    displacement: NDArray[np.float64]  # (t, s, p)
    velocity: NDArray[np.float64]  # (t, s, p)
    stiffness: NDArray[np.float64]  # of unit masses, 1/s^2, (t, n, n)
    damping: NDArray[np.float64]  # 1/s, as `lower_triangle`, (t, n, n)
    stiffness_now: NDArray[np.float64]  # (n, n)
    damping_now: NDArray[np.float64]  # as `lower_triangle`, (n, n)
    unit: NDArray[np.float64]  # coordinate per displacement of a freedom, 1/s, (n,)
    strain: NDArray[np.float64]  # displacements of the freedoms, to work in, (n,)
    strained: NDArray[np.float64]  # stiffness times those, (n,)
    work: NDArray[np.float64]  # of the axes on the structure that they travel through, J, (1,)


def moving_structure(
    along: MachinesAlong,
    rows: Sequence[NDArray[np.float64]],
    travel: NDArray[np.int64],
    step: float,
    velocity: NDArray[np.float64] | None = None,
) -> tuple[StructureSteps, MovingStructure]:
    """Return a structure unstrained with its axes at 0, and what lets it follow them.

    Parameters
    ----------
    along : MachinesAlong
    rows : sequence of (p, n) array of float
        Of the ports, at every position.
    travel : (a,) array of int
        Ports that tell where the axes are.
    step : float
        s.
    velocity : (n,) array of float, optional
        Of the freedoms at the start, m/s (rad/s); at rest by default.

    Raises
    ------
    StructureError
        If an axis has fewer than two positions, or 0 is not among them.
    """
    start = _start(along)
    reference = along.machines[start].structure
    modes = undamped_modes(reference)
    count = modes.frequency.size
    omega = 2.0 * np.pi * modes.frequency
    unit = np.where(omega > 0.0, omega, 1.0)
    stiffness, damping = (
        np.array(
            [modes.shapes.T @ getattr(one.structure, what) @ modes.shapes for one in along.machines]
        )
        for what in ("stiffness", "damping")
    )
    shapes = np.array([np.asarray(one) @ modes.shapes for one in rows])
    free = _free(stiffness, omega == 0.0)
    held = np.flatnonzero(~free)
    values, vectors = _principal(stiffness, held)
    # a machine that floats turns as a whole from position to position, and has no logarithm
    resists = bool(np.all(values > 0.0))
    if resists:
        stiffness = _of_values(stiffness, held, np.log(values), vectors)
    positions, (stiffness, damping, shapes) = _refined(along, (stiffness, damping, shapes))
    if resists:
        values, vectors = _principal(stiffness, held)
        stiffness = _of_values(stiffness, held, np.exp(values), vectors)
    along = along._replace(positions=positions)
    start = _start(along)
    tables = [
        _columns(k, c, seen, unit, step)
        for k, c, seen in zip(stiffness, damping, shapes, strict=True)
    ]
    columns = {name: np.ascontiguousarray([table[name] for table in tables]) for name in tables[0]}
    ports = shapes[0].shape[0]
    damping = np.array([lower_triangle(one) for one in damping])
    bus = _bus(columns, start, step, ports)
    if velocity is not None:
        moving = modes.shapes.T @ (reference.mass @ velocity)
        bus.state[count:] = moving
    bus.v[:] = bus.velocity.T @ bus.state
    axes = len(along.axes)
    most = max(len(one) for one in along.positions)
    position = np.full((axes, most), np.inf)
    for axis, one in enumerate(along.positions):
        position[axis, : len(one)] = one
    group = MovingStructure(
        port=np.asarray(travel, dtype=np.int64),
        count=np.array([len(one) for one in along.positions], dtype=np.int64),
        position=position,
        reach=np.array([np.min(np.diff(one)) / _SHARES for one in along.positions]),
        travel=np.zeros(axes),
        cell=np.zeros(axes, dtype=np.int64),
        share=np.zeros(axes),
        **columns,
        stiffness=stiffness,
        damping=damping,
        stiffness_now=stiffness[start].copy(),
        damping_now=damping[start].copy(),
        unit=unit,
        strain=np.zeros(count),
        strained=np.zeros(count),
        work=np.zeros(1),
    )
    return bus, group


def _refined(
    along: MachinesAlong, known: Sequence[NDArray[np.float64]]
) -> tuple[tuple[NDArray[np.float64], ...], list[NDArray[np.float64]]]:
    """Positions with those between them, and what is known at the positions (t, ...) there too."""
    from scipy.interpolate import make_interp_spline

    counts = [len(one) for one in along.positions]
    finer = tuple(
        np.append(np.linspace(one[:-1], one[1:], parts, endpoint=False, axis=1).ravel(), one[-1])
        for one, parts in zip(along.positions, along.parts, strict=True)
    )
    refined = []
    for values in known:
        shape = values.shape[1:]
        grid = values.reshape(*counts, *shape)
        for axis, (one, between) in enumerate(zip(along.positions, finer, strict=True)):
            degree = min(3, len(one) - 1)
            grid = make_interp_spline(one, grid, degree, axis=axis)(between)
        refined.append(np.ascontiguousarray(grid.reshape(-1, *shape)))
    return finer, refined


def _start(along: MachinesAlong) -> int:
    """Number of the machine at the start."""
    number = 0
    for axis, positions in zip(along.axes, along.positions, strict=True):
        if len(positions) < 2 or not np.any(positions == 0.0):
            raise StructureError(
                f'axis "{axis}": positions {positions.tolist()}; two or more are needed, '
                "0 among them"
            )
        number = number * len(positions) + int(np.argmin(np.abs(positions)))
    return number


def _free(stiffness: NDArray[np.float64], rigid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Take the rounding out of what resists motions that nothing resists at any position.

    Axes travel far along them, so that rounding would be a force. Returns which motions they are.
    """
    largest = np.max(np.abs(stiffness), initial=0.0)
    free = np.zeros_like(rigid)
    for mode in np.flatnonzero(rigid):
        if np.max(np.abs(stiffness[:, mode])) <= _NO_RESISTANCE * largest:
            stiffness[:, mode, :] = 0.0
            stiffness[:, :, mode] = 0.0
            free[mode] = True
    return free


def _principal(
    matrices: NDArray[np.float64], held: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Eigenvalues (t, m) and eigenvectors (t, m, m) over the motions that something resists."""
    return np.linalg.eigh(matrices[:, held[:, None], held])


def _of_values(
    matrices: NDArray[np.float64],
    held: NDArray[np.int64],
    values: NDArray[np.float64],
    vectors: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Matrices (t, n, n) of other eigenvalues over those motions, of zeros elsewhere."""
    changed = np.zeros_like(matrices)
    over = (vectors * values[:, None, :]) @ vectors.transpose(0, 2, 1)
    changed[:, held[:, None], held] = over
    return changed


def _columns(
    stiffness: NDArray[np.float64],
    damping: NDArray[np.float64],
    shapes: NDArray[np.float64],
    unit: NDArray[np.float64],
    step: float,
) -> dict[str, NDArray[np.float64]]:
    """Columns of the steps at one position; coordinates are displacements times `unit`, rates."""
    count = unit.size
    rate = np.zeros((2 * count, 2 * count))
    rate[:count, count:] = np.diag(unit)
    rate[count:, :count] = -stiffness / unit
    rate[count:, count:] = -damping
    nothing = np.zeros_like(shapes)
    over = exact_step(rate, np.vstack([nothing.T, shapes.T]), step)
    return {
        "dense": over.transition.T,
        "constant": over.constant.T,
        "ramp": over.ramp.T,
        "displacement": np.hstack([shapes / unit, nothing]).T,
        "velocity": np.hstack([nothing, shapes]).T,
    }


def _bus(
    columns: Mapping[str, NDArray[np.float64]], start: int, step: float, ports: int
) -> StructureSteps:
    """Table whose columns are overwritten as the structure follows its axes."""
    now = {name: column[start].copy() for name, column in columns.items()}
    size = len(now["dense"])
    answers = {
        f"{force}_{kind}": now[way] @ now[motion]
        for force, way in (("step", "constant"), ("ramp", "ramp"))
        for kind, motion in (("compliance", "displacement"), ("mobility", "velocity"))
    }
    signals = ("force", "change", "next_force", "u_before", "v_before", "u", "v")
    return StructureSteps(
        step=step,
        pairs=np.zeros((4, 0)),
        **now,
        **answers,
        displaced=size // 2,
        moving=size // 2,
        state=np.zeros(size),
        after=np.zeros(size),
        **{name: np.zeros(ports) for name in signals},
        halted=np.zeros(1, dtype=np.int64),
    )


@register_jitable(**INLINED)
def _travel(group, bus, a):
    """Where an axis is in the middle of the steps before the structure may follow it again, m."""
    p = group.port[a]
    return bus.u_before[p] + 0.5 * _STEPS * bus.step * bus.v_before[p]


@register_jitable(**INLINED)
def _locate(group, bus):
    """Find the positions beside every axis, and the share of the one behind."""
    for a in range(group.port.shape[0]):
        group.travel[a] = _travel(group, bus, a)
        last = group.count[a] - 1
        travelled = min(max(group.travel[a], group.position[a, 0]), group.position[a, last])
        cell = 0
        while cell < last - 1 and travelled >= group.position[a, cell + 1]:
            cell += 1
        before, behind = group.position[a, cell], group.position[a, cell + 1]
        group.cell[a] = cell
        group.share[a] = (travelled - before) / (behind - before)


@register_jitable(**INLINED)
def _corner(group, number):
    """Table of a corner of the cell that the axes are in, and its weight."""
    table, weight = 0, 1.0
    for a in range(group.port.shape[0]):
        behind = (number >> a) & 1
        table = table * group.count[a] + group.cell[a] + behind
        weight *= group.share[a] if behind == 1 else 1.0 - group.share[a]
    return table, weight


@register_jitable(**INLINED)
def _blend(into, tables, table, weight, first):
    """Add a table by its weight to what is blended; the first one begins it."""
    for i in range(into.shape[0]):
        for j in range(into.shape[1]):
            added = weight * tables[table, i, j]
            into[i, j] = added if first else into[i, j] + added


@register_jitable(**INLINED)
def _strain_energy(group, state):
    """Strain energy of the state, J."""
    n = group.unit.shape[0]
    for i in range(n):
        group.strain[i] = state[i] / group.unit[i]
    multiply(group.stiffness_now, group.strain, group.strained, n)
    energy = 0.0
    for i in range(n):
        energy += 0.5 * group.strained[i] * group.strain[i]
    return energy


@register_jitable(**INLINED)
def _answer(answer, way, motion, first, end):
    """Motion of ports per force on ports; the coordinates that take part in it begin and end."""
    for p in range(answer.shape[0]):
        for q in range(answer.shape[1]):
            answer[p, q] = 0.0
        for i in range(first, end):
            moved = way[p, i]
            for q in range(answer.shape[1]):
                answer[p, q] += moved * motion[i, q]


@register_jitable(**INLINED)
def _publish(bus):
    """Motion of the ports where the step begins."""
    for p in range(bus.u_before.shape[0]):
        u, v = 0.0, 0.0
        for i in range(bus.displaced):
            u += bus.displacement[i, p] * bus.state[i]
        for i in range(bus.moving, bus.state.shape[0]):
            v += bus.velocity[i, p] * bus.state[i]
        bus.u_before[p], bus.v_before[p] = u, v


@register_jitable(**INLINED)
def _follow(group, bus):
    """Blend the steps anew where the axes are now."""
    _locate(group, bus)
    strained = _strain_energy(group, bus.state)
    for number in range(1 << group.port.shape[0]):
        table, weight = _corner(group, number)
        first = number == 0
        if weight == 0.0 and not first:
            continue
        _blend(bus.dense, group.dense, table, weight, first)
        _blend(bus.constant, group.constant, table, weight, first)
        _blend(bus.ramp, group.ramp, table, weight, first)
        _blend(bus.displacement, group.displacement, table, weight, first)
        _blend(bus.velocity, group.velocity, table, weight, first)
        _blend(group.stiffness_now, group.stiffness, table, weight, first)
        _blend(group.damping_now, group.damping, table, weight, first)
    n = group.unit.shape[0]
    _answer(bus.step_compliance, bus.constant, bus.displacement, 0, n)
    _answer(bus.step_mobility, bus.constant, bus.velocity, n, 2 * n)
    _answer(bus.ramp_compliance, bus.ramp, bus.displacement, 0, n)
    _answer(bus.ramp_mobility, bus.ramp, bus.velocity, n, 2 * n)
    group.work[0] += _strain_energy(group, bus.state) - strained
    _publish(bus)


@register_jitable(**INLINED)
def moving_forces(group, bus, clock):
    """Let the structure follow its axes, before anything else in a step; it puts on no force."""
    if clock.number % _STEPS != 0:
        return
    travelled = False
    for a in range(group.port.shape[0]):
        if abs(_travel(group, bus, a) - group.travel[a]) > group.reach[a]:
            travelled = True
    if travelled:
        _follow(group, bus)
