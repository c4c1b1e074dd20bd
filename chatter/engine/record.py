"""What is kept of a run: laws that put on no force and write a row every `stride` steps."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from chatter.engine.presets import KERNEL
from cutting.chip.tool_point import ToolPoint
from cutting.compiled import INLINED

#: columns of the record of a cut
COLUMNS = ("Fx", "Fy", "Fz", "x", "y", "z", "torque")
#: columns of what happens between its rows: means since the row before, less the values at the row,
#: and the largest size of each force since then; zero where the rows tell all
BETWEEN = (
    *("mean Fx", "mean Fy", "mean Fz", "mean torque"),
    *("largest Fx", "largest Fy", "largest Fz"),
)
_LARGEST = 4
#: lines beside a kink change their slope by less than this share from step to step
_STRAIGHT = 0.25
#: most that a round signal gains between two steps
_ROUND = 1.01


class CutRecord(NamedTuple):
    """Record at the tool point."""

    stride: int
    first: int  # step at whose beginning the first row stands
    point: ToolPoint
    rows: NDArray[np.float64]  # see COLUMNS, (rows, columns)
    between: NDArray[np.float64]  # see BETWEEN, (rows, columns)
    #: sum of mean forces, N, and torques, N m, and largest force since the last row, N, (2, 4)
    since: NDArray[np.float64]
    samples: NDArray[np.float64]  # force at the last five steps, the newest first, N, (5, 3)


def cut_record(point: ToolPoint, rows: int, stride: int, first: int) -> CutRecord:
    """Return an empty record at a tool point."""
    kept, between = np.zeros((rows, len(COLUMNS))), np.zeros((rows, len(BETWEEN)))
    return CutRecord(stride, first, point, kept, between, np.zeros((2, 4)), np.zeros((5, 3)))


class PortRecord(NamedTuple):
    """Record of all ports."""

    stride: int
    first: int  # step at whose beginning the first row stands
    displacement: NDArray[np.float64]  # m (rad), (rows, p)
    velocity: NDArray[np.float64]  # m/s, (rows, p)
    force: NDArray[np.float64]  # N (N m), (rows, p)


def port_record(rows: int, ports: int, stride: int, first: int) -> PortRecord:
    """Return an empty record of ports."""
    return PortRecord(stride, first, *(np.empty((rows, ports)) for _ in range(3)))


@register_jitable(**INLINED)
def _row(group, clock):
    """Row of the end of the step; -1 where none is written."""
    end = clock.step + 1 - group.first
    # most runs keep every step, and a division there would be noticed
    if end < 0 or group.stride == 1:
        return max(end, -1)
    return end // group.stride if end % group.stride == 0 else -1


@register_jitable(**INLINED)
def _between_steps(samples, axis, new):
    """Extreme of a signal with a kink between the middle two of six steps; else the fourth.

    The lines through the two before and the two after it meet at the kink. A signal that bends
    beside it as well is round and has no kink.
    """
    older, old = samples[2, axis], samples[1, axis]
    rise, fall = older - samples[3, axis], samples[0, axis] - old
    if rise * fall >= 0.0:
        return old
    share = (old - older - fall) / (rise - fall)
    if not 0.0 < share < 1.0:
        return old
    kink, most = older + share * rise, _ROUND * max(abs(older), abs(old))
    bent = abs(rise - (samples[3, axis] - samples[4, axis])) > _STRAIGHT * abs(rise)
    if bent or abs(new - samples[0, axis] - fall) > _STRAIGHT * abs(fall):
        return min(max(kink, -most), most)
    return kink


@njit(**KERNEL)
def largest_between_steps(force):
    """Largest size (k,) of forces (n, k) at every step, N, kinks between the steps as well."""
    steps, count = force.shape
    largest = np.zeros(count)
    for axis in range(count):
        for i in range(steps):
            largest[axis] = max(largest[axis], abs(force[i, axis]))
        for i in range(5, steps):
            kink = _between_steps(force[i - 5 : i][::-1], axis, force[i, axis])
            largest[axis] = max(largest[axis], abs(kink))
    return largest


@register_jitable(**INLINED)
def _largest(point, axis):
    """Largest size of a force at the end of a step and at both sides of its jumps."""
    now = point.sample[axis]
    before, after = now + point.jump[0, axis], now + point.jump[1, axis]
    return max(abs(now), max(abs(before), abs(after)))


@register_jitable(**INLINED)
def _follow_force(group):
    """Take mean and largest force of a step between rows into account."""
    point, samples = group.point, group.samples
    for axis in range(3):
        now = point.sample[axis]
        group.since[0, axis] += now + point.blur[axis]
        kink = _between_steps(samples, axis, now)
        largest = max(abs(kink), _largest(point, axis))
        group.since[1, axis] = max(group.since[1, axis], largest)
        for k in range(4, 0, -1):
            samples[k, axis] = samples[k - 1, axis]
        samples[0, axis] = now
    group.since[0, 3] += point.torque[0] + point.blur[3]


@register_jitable(**INLINED)
def _write_step(group, row):
    """Write what a step has between its ends, where every step has its row."""
    point = group.point
    for axis in range(3):
        group.between[row, axis] = point.blur[axis]
        group.between[row, _LARGEST + axis] = _largest(point, axis)
    group.between[row, 3] = point.blur[3]


@register_jitable(**INLINED)
def _write_steps(group, row):
    """Write what the steps since the row before have, and begin anew."""
    point, since = group.point, group.since
    for axis in range(3):
        group.between[row, axis] = since[0, axis] / group.stride - point.sample[axis]
        group.between[row, _LARGEST + axis] = since[1, axis]
        since[0, axis] = 0.0
        since[1, axis] = 0.0
    group.between[row, 3] = since[0, 3] / group.stride - point.torque[0]
    since[0, 3] = 0.0


@register_jitable(**INLINED)
def cut_record_commit(group, bus, clock):  # noqa: ARG001
    """Write the tool point at the end of the step."""
    # most runs keep every step: kinks are then found in the rows
    if group.stride > 1 and clock.step + 1 >= group.first:
        _follow_force(group)
    row = _row(group, clock)
    if row < 0:
        return
    for axis in range(3):
        group.rows[row, axis] = group.point.sample[axis]
        group.rows[row, 3 + axis] = group.point.displacement[axis]
    group.rows[row, 6] = group.point.torque[0]
    if group.stride > 1:
        _write_steps(group, row)
    elif group.point.jumped[0] != 0:
        _write_step(group, row)


@register_jitable(**INLINED)
def port_record_commit(group, bus, clock):
    """Write all ports at the end of the step."""
    row = _row(group, clock)
    if row < 0:
        return
    for p in range(bus.u.shape[0]):
        group.displacement[row, p] = bus.u[p]
        group.velocity[row, p] = bus.v[p]
        group.force[row, p] = bus.force[p] + bus.change[p]
