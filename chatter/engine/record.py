"""What is kept of a run: laws that put on no force and write a row every `stride` steps."""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.chip.tool_point import ToolPoint
from cutting.compiled import INLINED

#: columns of the record of a cut
COLUMNS = ("Fx", "Fy", "Fz", "x", "y", "z", "torque")


class CutRecord(NamedTuple):
    """Record at the tool point."""

    stride: int
    first: int  # step at whose beginning the first row stands
    point: ToolPoint
    rows: NDArray[np.float64]  # see COLUMNS, (rows, columns)


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
def cut_record_commit(group, bus, clock):  # noqa: ARG001
    """Write the tool point at the end of the step."""
    row = _row(group, clock)
    if row < 0:
        return
    for axis in range(3):
        group.rows[row, axis] = group.point.sample[axis]
        group.rows[row, 3 + axis] = group.point.displacement[axis]
    group.rows[row, 6] = group.point.torque[0]


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
