"""The time loop of machine and cut together, compiled.

The machine moves the tool against the workpiece; the cut answers by a force on both and a torque
on the spindle, predicted with the force at the beginning of a step and corrected once with that
at its end, as in the loop of the cut alone. Frictions are solved last, at the corrected motion.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from chatter.engine.dispatch import all_act
from chatter.engine.dispatch import all_settle as all_settle_cut
from chatter.engine.presets import TIME_LOOP
from cutting.chip.tool_point import Turn
from cutting.compiled import INLINED
from dynamics.machine.groups import all_drive, all_resist, all_settle
from dynamics.machine.steps import add_change, begin_step, end_step, move

_MOST_SWEEPS = 40


class ToolSide(NamedTuple):
    """Where the cut meets the machine, and the motion that is asked of the tool.

    The nominal motion is what the chip takes for the path; the rest is displacement.
    """

    port: NDArray[np.int64]  # of the tool against the workpiece along x, y, z of the cut, (3,)
    spindle: NDArray[np.int64]  # of the turning tool against the workpiece, (1,); () if prescribed
    origin: NDArray[np.float64]  # displacement of the ports where the cut begins, m, (3,)
    feed: NDArray[np.float64]  # of the nominal path, m/s, (3,)
    carried: NDArray[np.float64]  # by the axes; what they do not carry is prescribed, m/s, (3,)
    speed: float  # nominal, rad/s
    angle: float  # of the spindle where the cut begins, rad
    bins: int  # of a turn
    force: NDArray[np.float64]  # on the tool at the end of the last step, N, (3,): state
    torque: NDArray[np.float64]  # against the turning, N m, (1,): state


class CoupledRecord(NamedTuple):
    """What is kept of a run, a row every `stride` steps."""

    stride: int
    cut: NDArray[np.float64]  # force, displacement, torque, angle, speed of the spindle, (rows, 9)
    port: NDArray[np.int64]  # further ports of the machine, (c,)
    displacement: NDArray[np.float64]  # (rows, c)
    force: NDArray[np.float64]  # held on them, (rows, c)


@register_jitable(**INLINED)
def _place(tool, time, angle):
    """Whole and part of the bin of a spindle angle; prescribed where there is no spindle."""
    turned = angle - tool.angle
    if tool.spindle.shape[0] == 0:
        turned = tool.speed * time
    place = turned * tool.bins / (2.0 * math.pi)
    whole = math.floor(place)
    return int(whole) % tool.bins, place - whole, place


@register_jitable(**INLINED)
def _turn(tool, s, step_number):
    """Turn of the spindle over a step, from the beginning to the end of the machine's motion."""
    before, now = step_number * s.step, (step_number + 1) * s.step
    angle_before = angle = speed = 0.0
    if tool.spindle.shape[0] > 0:
        p = tool.spindle[0]
        angle_before, angle, speed = s.u_before[p], s.u[p], s.v[p]
    else:
        speed = tool.speed
    whole_before, part_before, place_before = _place(tool, before, angle_before)
    whole, part, place = _place(tool, now, angle)
    turned = 2.0 * math.pi / tool.bins
    now_angle, angle_then = (whole + part) * turned, (whole_before + part_before) * turned
    return Turn(
        whole,
        part,
        math.sin(now_angle),
        math.cos(now_angle),
        math.sin(angle_then),
        math.cos(angle_then),
        whole_before,
        part_before,
        place - place_before,
        speed,
        s.step,
        tool.feed[0] * now,
        tool.feed[1] * now,
        tool.feed[0] * before,
        tool.feed[1] * before,
    )


@register_jitable(**INLINED)
def _take_motion(tool, s, point, step_number):
    """Displacement of the tool from its nominal motion at both ends of the step."""
    before, now = step_number * s.step, (step_number + 1) * s.step
    for axis in range(3):
        p, origin, feed = tool.port[axis], tool.origin[axis], tool.carried[axis]
        point.displacement_before[axis] = s.u_before[p] - origin - feed * before
        point.velocity_before[axis] = s.v_before[p] - feed
        point.displacement[axis] = s.u[p] - origin - feed * now
        point.velocity[axis] = s.v[p] - feed


@register_jitable(**INLINED)
def _clear(point):
    for axis in range(3):
        point.force[axis] = 0.0
        point.sample[axis] = 0.0
    point.torque[0] = 0.0
    point.contact[0] = 0.0


@register_jitable(**INLINED)
def coupled_step(cut, machine, s, tool, point, number, step_number, row):
    """Move machine and cut by a step.

    Parameters
    ----------
    cut, machine : tuples of law groups
    s : StructureSteps
    tool : ToolSide
    point : ToolPoint
    number : int
        Of the step since the machine started.
    step_number : int
        Since the cut began; -1 for the step before, at the end of which the cut takes hold of the
        machine.
    row : int
        In the chunk.
    """
    moves = step_number >= 0
    if moves:
        begin_step(s)
        all_drive(machine, s, number, row)
        for axis in range(3):
            s.force[tool.port[axis]] += tool.force[axis]
        if tool.spindle.shape[0] > 0:
            s.force[tool.spindle[0]] -= tool.torque[0]
        move(s)
    _take_motion(tool, s, point, step_number)
    _clear(point)
    all_act(cut, _turn(tool, s, step_number), point)
    if moves:
        for axis in range(3):
            add_change(s, tool.port[axis], point.force[axis] - tool.force[axis])
        if tool.spindle.shape[0] > 0:
            add_change(s, tool.spindle[0], tool.torque[0] - point.torque[0])
        for _ in range(_MOST_SWEEPS):
            if not all_resist(machine, s):
                break
        all_settle(machine, s)
    for axis in range(3):
        tool.force[axis] = point.force[axis]
    tool.torque[0] = point.torque[0]
    _take_motion(tool, s, point, step_number)
    turn = _turn(tool, s, step_number)
    all_settle_cut(cut, turn, point)
    if moves:
        end_step(s)
    return turn


@register_jitable(**INLINED)
def _keep(record, row, s, tool, point, turn, step_number):
    for axis in range(3):
        record.cut[row, axis] = point.sample[axis]
        record.cut[row, 3 + axis] = point.displacement[axis]
    record.cut[row, 6] = point.torque[0]
    angle = tool.speed * (step_number + 1) * s.step
    if tool.spindle.shape[0] > 0:
        angle = s.u[tool.spindle[0]] - tool.angle
    record.cut[row, 7] = angle
    record.cut[row, 8] = turn.speed
    for c in range(record.port.shape[0]):
        record.displacement[row, c] = s.u[record.port[c]]
        record.force[row, c] = s.force[record.port[c]]


@njit(**TIME_LOOP)
def run_coupled(cut, machine, s, tool, point, record, first, done, count, furthest):
    """Run machine and cut over a chunk of steps.

    Parameters
    ----------
    cut, machine : tuples of law groups
    s : StructureSteps
    tool : ToolSide
    point : ToolPoint
    record : CoupledRecord
        Rows of the whole run.
    first : int
        Steps of the machine before the cut began.
    done : int
        Steps since; -1 at first.
    count : int
        Steps to do.
    furthest : float
        Displacement at which the model is left, m.

    Returns
    -------
    int
        Steps done; fewer than asked where the displacement became too large.
    """
    for i in range(count):
        step_number = done + i
        turn = coupled_step(cut, machine, s, tool, point, first + step_number, step_number, 0)
        reach = 0.0
        for axis in range(3):
            reach = max(reach, abs(point.displacement[axis]))
        # not above: also true of what is not a number
        if not reach <= furthest or (step_number >= 0 and not turn.advance > 0.0):
            return i
        if step_number >= 0 and (step_number + 1) % record.stride == 0:
            row = (step_number + 1) // record.stride - 1
            _keep(record, row, s, tool, point, turn, step_number)
    return count
