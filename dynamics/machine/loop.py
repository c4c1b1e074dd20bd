"""One step of a machine: drives, loads, motion, friction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.machine.groups import all_drive, all_resist, all_settle
from dynamics.machine.steps import begin_step, end_step, move

#: sweeps over frictions that push one another; one or two are the rule
_MOST_SWEEPS = 40


class Loads(NamedTuple):
    """Forces on ports over a chunk of steps, linear from row to row."""

    port: NDArray[np.int64]  # (l,)
    force: NDArray[np.float64]  # N, at the ends of steps, (n+1, l)


@register_jitable(**INLINED)
def put_loads(s, loads, row):
    """Put on the loads of a step that leads from a row to the next."""
    for i in range(loads.port.shape[0]):
        s.force[loads.port[i]] += loads.force[row, i]
        s.change[loads.port[i]] += loads.force[row + 1, i] - loads.force[row, i]


@register_jitable(**INLINED)
def machine_step(groups, s, loads, number, row):
    """Move a machine by a step.

    Parameters
    ----------
    groups : tuple of law groups
    s : StructureSteps
    loads : Loads
    number : int
        Of the step since the start, from 0.
    row : int
        Of the step in its chunk, from 0.
    """
    begin_step(s)
    all_drive(groups, s, number, row)
    put_loads(s, loads, row)
    move(s)
    for _ in range(_MOST_SWEEPS):
        if not all_resist(groups, s):
            break
    all_settle(groups, s)
    end_step(s)
