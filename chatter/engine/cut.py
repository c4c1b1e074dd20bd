"""The cut as a law on the ports of a structure: tool against workpiece, and the spindle.

The structure moves the tool against the workpiece; the laws at the tool point answer by a force on
both and a torque on the spindle, evaluated at the motion predicted with the forces at the beginning
of the step. What the chip takes for the path of the tool is its nominal motion; the rest is
displacement.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.chip.delayed_chip import DelayedCut, delayed_commit, delayed_forces
from cutting.chip.discrete_chip import DiscreteCut, discrete_commit, discrete_forces
from cutting.chip.inclined_chip import InclinedCut, inclined_commit, inclined_forces
from cutting.chip.tool_point import Rotation, ToolPoint, TurningRotation, tool_point
from cutting.compiled import INLINED, by_table, for_each
from cutting.force.force_factor import ForceFactor, factor_commit, factor_forces
from cutting.process_damping.contact import ToolContact, contact_commit, contact_forces

#: table -> kernels of its forces and its commit, called with rotation and tool point
LAWS_AT_TOOL = {
    DelayedCut: (delayed_forces, delayed_commit),
    InclinedCut: (inclined_forces, inclined_commit),
    DiscreteCut: (discrete_forces, discrete_commit),
    ForceFactor: (factor_forces, factor_commit),
    ToolContact: (contact_forces, contact_commit),
}
_forces_at_tool = for_each(by_table({table: kernels[0] for table, kernels in LAWS_AT_TOOL.items()}))
_commit_at_tool = for_each(by_table({table: kernels[1] for table, kernels in LAWS_AT_TOOL.items()}))


class PrescribedPath(NamedTuple):
    """Path of the tool axis and force ramp over a chunk of n steps, at their ends."""

    x: NDArray[np.float64]  # m, (n+1,)
    y: NDArray[np.float64]  # m, (n+1,)
    share: NDArray[np.float64]  # of the cutting force that the structure feels, (n+1,)


class TurningPath(NamedTuple):
    """Path of the tool axis whose direction turns; the fields of `PrescribedPath`, and that."""

    x: NDArray[np.float64]  # m, (n+1,)
    y: NDArray[np.float64]  # m, (n+1,)
    share: NDArray[np.float64]  # of the cutting force that the structure feels, (n+1,)
    heading: NDArray[np.float64]  # of the feed from +x towards +y, bins of a revolution, (n+1,)


class PrescribedSpindle(NamedTuple):
    """Rotation of the spindle over a chunk of n steps, at their ends."""

    whole: NDArray[np.int64]  # bin of the spindle, (n+1,)
    part: NDArray[np.float64]  # fraction of the bin, (n+1,)
    sine: NDArray[np.float64]  # of its angle, (n+1,)
    cosine: NDArray[np.float64]  # (n+1,)
    advance: NDArray[np.float64]  # bins from one end to the next, (n,)
    speed: NDArray[np.float64]  # rad/s, (n+1,)


class SpindleOnPort(NamedTuple):
    """Spindle that the structure turns, against the torque of the cut."""

    port: int  # rotation of the tool against the workpiece, positive as it turns
    angle: float  # of the port where the cut begins, rad
    bins: int  # of a revolution


class ToolOnModes(NamedTuple):
    """Tool whose motion is that of the first ports, one an axis, and lies in the same arrays.

    It spares a copy in each step, which a cut on a few modes would notice.
    """

    ports: int = 3


class ToolOnPorts(NamedTuple):
    """Tool against the workpiece on any ports, fed by the structure."""

    port: NDArray[np.int64]  # along x, y, z of the cut, (3,)
    origin: NDArray[np.float64]  # displacement of the ports where the cut begins, m, (3,)
    carried: NDArray[np.float64]  # feed of the tool by the structure, m/s, (3,)


class ToolAlongPath(NamedTuple):
    """Tool against the workpiece on any ports, moved by the structure along a path."""

    port: NDArray[np.int64]  # along x, y, z of the cut, (3,)
    origin: NDArray[np.float64]  # displacement of the ports where the cut begins, m, (3,)
    travel: NDArray[np.float64]  # of the path that the structure makes, at ends of steps, m, (n, 3)
    velocity: NDArray[np.float64]  # of it, m/s, (n, 3)


class CutOnPorts(NamedTuple):
    """Cut between tool and workpiece, which ports of a structure move."""

    laws: tuple  # at the tool point
    spindle: PrescribedSpindle | SpindleOnPort
    path: PrescribedPath | TurningPath
    point: ToolPoint
    tool: ToolOnModes | ToolOnPorts | ToolAlongPath
    furthest: float  # displacement beyond which the model of the cut no longer holds, m


def tool_point_on_modes(bus) -> ToolPoint:
    """Return a tool point in the arrays of the first three ports of a structure."""
    motion = (signal[:3] for signal in (bus.u, bus.v, bus.u_before, bus.v_before))
    return tool_point()._replace(**dict(zip(ToolPoint._fields[:4], motion, strict=True)))


@register_jitable(**INLINED)
def _prescribed_rotation(spindle, path, bus, clock):
    """Rotation over the step as prescribed."""
    i, now = clock.row, clock.row + 1
    return Rotation(
        spindle.whole[now],
        spindle.part[now],
        spindle.sine[now],
        spindle.cosine[now],
        spindle.sine[i],
        spindle.cosine[i],
        spindle.whole[i],
        spindle.part[i],
        spindle.advance[i],
        spindle.speed[now],
        bus.step,
        path.x[now],
        path.y[now],
        path.x[i],
        path.y[i],
    )


@register_jitable(**INLINED)
def _bin_of(spindle, angle):
    """Whole and part of the bin of an angle of the port, and both since the start."""
    position = (angle - spindle.angle) * spindle.bins / (2.0 * math.pi)
    whole = math.floor(position)
    return int(whole) % spindle.bins, position - whole, position


@register_jitable(**INLINED)
def _rotation_of_port(spindle, path, bus, clock):
    """Rotation over the step as the structure turns the spindle."""
    i, now, p = clock.row, clock.row + 1, spindle.port
    whole_before, part_before, position_before = _bin_of(spindle, bus.u_before[p])
    whole, part, position = _bin_of(spindle, bus.u[p])
    angle = 2.0 * math.pi / spindle.bins
    angle_before, angle_now = (whole_before + part_before) * angle, (whole + part) * angle
    return Rotation(
        whole,
        part,
        math.sin(angle_now),
        math.cos(angle_now),
        math.sin(angle_before),
        math.cos(angle_before),
        whole_before,
        part_before,
        position - position_before,
        bus.v[p],
        bus.step,
        path.x[now],
        path.y[now],
        path.x[i],
        path.y[i],
    )


@register_jitable(**INLINED)
def _straight(path, rotation, clock):  # noqa: ARG001
    """Rotation on a path along x."""
    return rotation


@register_jitable(**INLINED)
def _turning(path, rotation, clock):
    """Rotation on a path that turns."""
    return TurningRotation(
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
        rotation.x,
        rotation.y,
        rotation.x_before,
        rotation.y_before,
        path.heading[clock.row + 1],
    )


@register_jitable(**INLINED)
def _no_torque(spindle, point, bus):
    """Put on nothing: a prescribed spindle turns whatever the torque."""


@register_jitable(**INLINED)
def _torque(spindle, point, bus):
    """Let the torque of the cut grow to its new value over the step."""
    bus.change[spindle.port] -= point.torque[0] + bus.next_force[spindle.port]


@register_jitable(**INLINED)
def _leave_torque(spindle, point, bus):
    """Leave the torque for the next step to begin with."""
    bus.next_force[spindle.port] = -point.torque[0]


_rotation_of = by_table({PrescribedSpindle: _prescribed_rotation, SpindleOnPort: _rotation_of_port})
_on_path = by_table({PrescribedPath: _straight, TurningPath: _turning})
_put_torque = by_table({PrescribedSpindle: _no_torque, SpindleOnPort: _torque})
_commit_torque = by_table({PrescribedSpindle: _no_torque, SpindleOnPort: _leave_torque})


@register_jitable(**INLINED)
def _shared(tool, point, bus, clock):
    """Take nothing: the motion of the ports is that of the tool point."""


@register_jitable(**INLINED)
def _motion_of_ports(tool, point, bus, clock):
    """Displacement of the tool from its nominal motion at both ends of the step."""
    before, now = clock.step * bus.step, (clock.step + 1) * bus.step
    for axis in range(3):
        p, origin, feed = tool.port[axis], tool.origin[axis], tool.carried[axis]
        point.displacement_before[axis] = bus.u_before[p] - origin - feed * before
        point.velocity_before[axis] = bus.v_before[p] - feed
        point.displacement[axis] = bus.u[p] - origin - feed * now
        point.velocity[axis] = bus.v[p] - feed


@register_jitable(**INLINED)
def _motion_from_path(tool, point, bus, clock):
    """Displacement of the tool from its path at both ends of the step."""
    i, now = clock.row, clock.row + 1
    for axis in range(3):
        p, origin = tool.port[axis], tool.origin[axis]
        point.displacement_before[axis] = bus.u_before[p] - origin - tool.travel[i, axis]
        point.velocity_before[axis] = bus.v_before[p] - tool.velocity[i, axis]
        point.displacement[axis] = bus.u[p] - origin - tool.travel[now, axis]
        point.velocity[axis] = bus.v[p] - tool.velocity[now, axis]


@register_jitable(**INLINED)
def _port_of_mode(tool, axis):  # noqa: ARG001
    """Port of an axis."""
    return axis


@register_jitable(**INLINED)
def _port(tool, axis):
    """Port of an axis."""
    return tool.port[axis]


_take_motion = by_table(
    {ToolOnModes: _shared, ToolOnPorts: _motion_of_ports, ToolAlongPath: _motion_from_path}
)
_port_of = by_table({ToolOnModes: _port_of_mode, ToolOnPorts: _port, ToolAlongPath: _port})


@register_jitable(**INLINED)
def _clear(point):
    """Take all forces off the tool point."""
    for axis in range(3):
        point.force[axis] = 0.0
        point.sample[axis] = 0.0
    # most steps have no jump
    if point.jumped[0] != 0:
        point.jumped[0] = 0
        for axis in range(3):
            point.blur[axis] = 0.0
            point.jump[0, axis] = 0.0
            point.jump[1, axis] = 0.0
        point.blur[3] = 0.0
    point.torque[0] = 0.0
    point.contact[0] = 0.0


@register_jitable(**INLINED)
def cut_forces(cut, bus, clock):
    """Evaluate the cut at the predicted motion; its force grows to that over the step."""
    point = cut.point
    _take_motion(cut.tool, point, bus, clock)
    _clear(point)
    rotation = _rotation_of(cut.spindle, cut.path, bus, clock)
    _forces_at_tool(cut.laws, _on_path(cut.path, rotation, clock), point)
    share = cut.path.share[clock.row + 1]
    for axis in range(3):
        p = _port_of(cut.tool, axis)
        point.force[axis] *= share
        bus.change[p] += point.force[axis] - bus.next_force[p]
    _put_torque(cut.spindle, point, bus)


@register_jitable(**INLINED)
def cut_commit(cut, bus, clock):
    """Take the corrected motion into the memory of the laws; halt where it is too large."""
    point = cut.point
    _take_motion(cut.tool, point, bus, clock)
    rotation = _rotation_of(cut.spindle, cut.path, bus, clock)
    reach = 0.0
    for axis in range(3):
        reach = max(reach, abs(point.displacement[axis]))
    # not above: also true of what is not a number
    if not reach <= cut.furthest or (clock.step >= 0 and not rotation.advance > 0.0):
        bus.halted[0] = 1
        return
    _commit_at_tool(cut.laws, _on_path(cut.path, rotation, clock), point)
    for axis in range(3):
        bus.next_force[_port_of(cut.tool, axis)] = point.force[axis]
    _commit_torque(cut.spindle, point, bus)
