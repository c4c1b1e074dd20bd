"""The time loop: structure, law groups and record, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from chatter.engine.dispatch import all_act, all_settle
from chatter.engine.presets import TIME_LOOP
from cutting.chip.tool_point import Turn
from cutting.compiled import INLINED
from dynamics.modal.modal_friction import hold, resist
from dynamics.modal.modal_steps import correct, predict, take_force

#: columns of the record
COLUMNS = ("Fx", "Fy", "Fz", "x", "y", "z", "torque")


class Prescribed(NamedTuple):
    """Turn of the spindle and path of the tool axis over a chunk of steps, one row each.

    The first row is the last step of the chunk before.
    """

    whole: NDArray[np.int64]  # bin of the spindle, (n+1,)
    part: NDArray[np.float64]  # fraction of the bin, (n+1,)
    advance: NDArray[np.float64]  # bins from row to row, (n,)
    speed: NDArray[np.float64]  # rad/s, (n+1,)
    x: NDArray[np.float64]  # m, (n+1,)
    y: NDArray[np.float64]  # m, (n+1,)
    grip: NDArray[np.float64]  # share of the cutting force that the structure feels, (n+1,)


class Record(NamedTuple):
    """What is kept of a run."""

    stride: int  # steps from row to row
    rows: NDArray[np.float64]  # (rows, columns)


@register_jitable(**INLINED)
def _turn(prescribed, i, before, advance, angle, step):
    """Turn of the spindle at a row, with the row before it."""
    whole, part = prescribed.whole[i], prescribed.part[i]
    spindle = (whole + part) * angle
    spindle_before = (prescribed.whole[before] + prescribed.part[before]) * angle
    return Turn(
        whole,
        part,
        math.sin(spindle),
        math.cos(spindle),
        math.sin(spindle_before),
        math.cos(spindle_before),
        prescribed.whole[before],
        prescribed.part[before],
        advance,
        prescribed.speed[i],
        step,
        prescribed.x[i],
        prescribed.y[i],
        prescribed.x[before],
        prescribed.y[before],
    )


@register_jitable(**INLINED)
def _clear(point):
    """Take all forces off the tool point."""
    for axis in range(3):
        point.force[axis] = 0.0
        point.sample[axis] = 0.0
    point.torque[0] = 0.0
    point.contact[0] = 0.0


@register_jitable(**INLINED)
def _keep(record, row, point):
    """Write the tool point into a row of the record."""
    for axis in range(3):
        record.rows[row, axis] = point.sample[axis]
        record.rows[row, 3 + axis] = point.displacement[axis]
    record.rows[row, 6] = point.torque[0]


@njit(**TIME_LOOP)
def run(groups, modes, frictions, point, prescribed, record, scratch, first, furthest, bins):
    """Integrate a chunk of steps.

    Parameters
    ----------
    groups : tuple of law groups
    modes : ModalSteps
    frictions : tuple of Frictions
        On modes; empty where there are none.
    point : ToolPoint
    prescribed : Prescribed
        Rows 0 .. n; step i leads from row i-1 to row i.
    record : Record
    scratch : (modes, 2) array of float
        Overwritten.
    first : int
        Number of the step that row 0 stands for; step 0 is the start, where nothing has moved
        yet and the cut takes hold of the structure.
    furthest : float
        Displacement at which the model is left, m.
    bins : int
        Of a turn of the spindle.

    Returns
    -------
    int
        Steps done; fewer than n where the displacement became too large.
    """
    count = prescribed.whole.shape[0] - 1
    angle = 2.0 * math.pi / bins
    for i in range(1, count + 1):
        turn = _turn(prescribed, i, i - 1, prescribed.advance[i - 1], angle, modes.step)
        for axis in range(3):
            point.displacement_before[axis] = point.displacement[axis]
            point.velocity_before[axis] = point.velocity[axis]
        _clear(point)
        if first + i > 0:
            predict(modes, scratch, point)
            hold(frictions, modes, point)
        all_act(groups, turn, point)
        for axis in range(3):
            point.force[axis] *= prescribed.grip[i]
        if first + i > 0:
            correct(modes, scratch, point)
            resist(frictions, modes, scratch, point)
        else:
            take_force(modes, point)
        reach = max(
            abs(point.displacement[0]), abs(point.displacement[1]), abs(point.displacement[2])
        )
        if not reach <= furthest:
            return i - 1
        all_settle(groups, turn, point)
        if (first + i) % record.stride == 0:
            _keep(record, (first + i) // record.stride, point)
    return count
