"""What is kept of a run: laws that put on no force and write a row every `stride` steps."""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.chip.tool_point import ToolPoint
from cutting.compiled import INLINED

#: columns of the record of a cut; means and the largest size of each force are those since the row
#: before
COLUMNS = (
    *("Fx", "Fy", "Fz", "x", "y", "z", "torque"),
    *("mean Fx", "mean Fy", "mean Fz", "largest Fx", "largest Fy", "largest Fz"),
    "mean torque",
)
_MEAN, _LARGEST, _MEAN_TORQUE = 7, 10, 13
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
    #: sum of mean forces, N, and torques, N m, and largest force since the last row, N, (2, 4)
    since: NDArray[np.float64]
    samples: NDArray[np.float64]  # force at the last five steps, the newest first, N, (5, 3)


def cut_record(point: ToolPoint, rows: int, stride: int, first: int) -> CutRecord:
    """Return an empty record at a tool point."""
    return CutRecord(
        stride, first, point, np.zeros((rows, len(COLUMNS))), np.zeros((2, 4)), np.zeros((5, 3))
    )


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


@register_jitable(**INLINED)
def _follow_force(group):
    """Take mean and largest force of the step into account."""
    point, samples = group.point, group.samples
    for axis in range(3):
        now = point.sample[axis]
        group.since[0, axis] += now + point.blur[axis]
        kink = _between_steps(samples, axis, now)
        before, after = now + point.jump[0, axis], now + point.jump[1, axis]
        largest = max(max(abs(now), abs(kink)), max(abs(before), abs(after)))
        group.since[1, axis] = max(group.since[1, axis], largest)
        for k in range(4, 0, -1):
            samples[k, axis] = samples[k - 1, axis]
        samples[0, axis] = now
    group.since[0, 3] += point.torque[0] + point.blur[3]


@register_jitable(**INLINED)
def cut_record_commit(group, bus, clock):  # noqa: ARG001
    """Write the tool point at the end of the step."""
    if clock.step + 1 < group.first:
        return
    _follow_force(group)
    row = _row(group, clock)
    if row < 0:
        return
    for axis in range(3):
        group.rows[row, axis] = group.point.sample[axis]
        group.rows[row, 3 + axis] = group.point.displacement[axis]
        group.rows[row, _MEAN + axis] = group.since[0, axis] / group.stride
        group.rows[row, _LARGEST + axis] = group.since[1, axis]
        group.since[0, axis] = 0.0
        group.since[1, axis] = 0.0
    group.rows[row, 6] = group.point.torque[0]
    group.rows[row, _MEAN_TORQUE] = group.since[0, 3] / group.stride
    group.since[0, 3] = 0.0


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
