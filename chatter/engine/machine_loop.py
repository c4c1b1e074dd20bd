"""The time loop of a machine, compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.engine.presets import TIME_LOOP
from dynamics.machine.loop import machine_step


class Record(NamedTuple):
    """What is kept of a run, a row every `stride` steps, of the ports chosen."""

    stride: int
    port: NDArray[np.int64]  # (c,)
    displacement: NDArray[np.float64]  # at the end of a step, m, (rows, c)
    velocity: NDArray[np.float64]  # m/s, (rows, c)
    force: NDArray[np.float64]  # at the end of a step, N, (rows, c)


@njit(**TIME_LOOP)
def run(groups, steps, loads, record, first, furthest):
    """Run a machine over a chunk of steps.

    Parameters
    ----------
    groups : tuple of law groups
    steps : StructureSteps
    loads : Loads
        Rows 0 .. n.
    record : Record
        Overwritten; step i of the run goes to row i / stride, counted from the chunk's first.
    first : int
        Steps done before.
    furthest : float
        Displacement of any port at which the run ends, m (rad).

    Returns
    -------
    int
        Steps done; fewer than n where the machine runs away.
    """
    count = loads.force.shape[0] - 1
    row = 0
    for i in range(count):
        machine_step(groups, steps, loads, first + i, i)
        if (first + i + 1) % record.stride == 0:
            for c in range(record.port.shape[0]):
                p = record.port[c]
                record.displacement[row, c] = steps.u[p]
                record.velocity[row, c] = steps.v[p]
                record.force[row, c] = steps.force[p] + steps.change[p]
            row += 1
        # not below: also true of what is not a number
        for p in range(steps.u.shape[0]):
            if not abs(steps.u[p]) <= furthest:
                return i + 1
    return count


@njit(**TIME_LOOP)
def advance(groups, steps, loads, first, count):
    """Run a machine over steps from a number on, without record; row 0 of loads and injection."""
    for i in range(count):
        machine_step(groups, steps, loads, first + i, 0)
