"""A cut whose tool axis is inclined: the cut of an upright tool, in the axes of the tool.

Motion and path are turned into the axes of the tool, forces back into those of the cut. The path
has a part along the tool axis there.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.chip.delayed_chip import DelayedCut, delayed_commit, delayed_forces
from cutting.chip.tool_point import InclinedRotation, ToolPoint, tool_point
from cutting.compiled import INLINED


class InclinedCut(NamedTuple):
    """Cut of a tool with an inclined axis."""

    cut: DelayedCut  # in the axes of the tool
    frame: NDArray[np.float64]  # axes of the tool as columns in those of the cut, (3, 3)
    point: ToolPoint  # scratch: the tool point in the axes of the tool


def inclined_cut(cut: DelayedCut, frame: NDArray[np.float64]) -> InclinedCut:
    """Incline a cut that was set up in the axes of the tool, which are the columns of the frame."""
    return InclinedCut(cut, np.ascontiguousarray(frame), tool_point())


@register_jitable(**INLINED)
def _into_tool(frame, along, turned):
    """Turn a vector (3,) of the cut into the axes of the tool."""
    for axis in range(3):
        turned[axis] = (
            frame[0, axis] * along[0] + frame[1, axis] * along[1] + frame[2, axis] * along[2]
        )


@register_jitable(**INLINED)
def _add_out_of_tool(frame, along, total):
    """Add a vector (3, or more) in the axes of the tool to one in those of the cut."""
    for axis in range(3):
        total[axis] += (
            frame[axis, 0] * along[0] + frame[axis, 1] * along[1] + frame[axis, 2] * along[2]
        )


@register_jitable(**INLINED)
def _motion_of_tool(group, point):
    """Take the motion of the tool point into the axes of the tool."""
    own, frame = group.point, group.frame
    _into_tool(frame, point.displacement, own.displacement)
    _into_tool(frame, point.velocity, own.velocity)
    _into_tool(frame, point.displacement_before, own.displacement_before)
    _into_tool(frame, point.velocity_before, own.velocity_before)


@register_jitable(**INLINED)
def _rotation_of_tool(frame, rotation):
    """Rotation with the path of the tool in its own axes."""
    return InclinedRotation(
        rotation.whole,
        rotation.part,
        rotation.sine,
        rotation.cosine,
        rotation.sine_before,
        rotation.cosine_before,
        rotation.whole_before,
        rotation.part_before,
        rotation.advance,
        rotation.speed,
        rotation.step,
        frame[0, 0] * rotation.x + frame[1, 0] * rotation.y,
        frame[0, 1] * rotation.x + frame[1, 1] * rotation.y,
        frame[0, 0] * rotation.x_before + frame[1, 0] * rotation.y_before,
        frame[0, 1] * rotation.x_before + frame[1, 1] * rotation.y_before,
        frame[0, 2] * rotation.x + frame[1, 2] * rotation.y,
        frame[0, 2] * rotation.x_before + frame[1, 2] * rotation.y_before,
    )


@register_jitable(**INLINED)
def _clear(own):
    """Take all forces off the tool point."""
    for axis in range(3):
        own.force[axis] = 0.0
        own.sample[axis] = 0.0
        own.blur[axis] = 0.0
        own.jump[0, axis] = 0.0
        own.jump[1, axis] = 0.0
    own.blur[3] = 0.0
    own.jumped[0] = 0
    own.torque[0] = 0.0
    own.contact[0] = 0.0


@register_jitable(**INLINED)
def inclined_forces(group, rotation, point):
    """Add the cutting force on the tool at the motion of the tool point."""
    own, frame = group.point, group.frame
    _motion_of_tool(group, point)
    _clear(own)
    delayed_forces(group.cut, _rotation_of_tool(frame, rotation), own)
    _add_out_of_tool(frame, own.force, point.force)
    _add_out_of_tool(frame, own.sample, point.sample)
    if own.jumped[0] != 0:
        point.jumped[0] = 1
        _add_out_of_tool(frame, own.blur, point.blur)
        point.blur[3] += own.blur[3]
        for side in range(2):
            for axis in range(3):
                for along in range(3):
                    point.jump[side, axis] += frame[axis, along] * own.jump[side, along]
    point.torque[0] += own.torque[0]
    point.contact[0] += own.contact[0]


@register_jitable(**INLINED)
def inclined_commit(group, rotation, point):
    """Remember the motion of the step in the axes of the tool."""
    _motion_of_tool(group, point)
    delayed_commit(group.cut, _rotation_of_tool(group.frame, rotation), group.point)
