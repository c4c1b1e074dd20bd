"""Numbers that a machine may have, yet none is likely to: asked about in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from chatter.description.machine.axis import AxisSection
    from chatter.description.machine.bodies import BodySection
    from chatter.description.machine.machine_file import MachineFile


class _Usual(NamedTuple):
    """Range of what is usual, SI, with the unit that it is read in."""

    low: float
    high: float
    unit: str
    factor: float  # of the unit, from SI
    of: str


#: wide: from a micro machine to a gantry of a ship yard
_IN_DRIVE = {
    "lead": _Usual(0.2e-3, 0.2, "mm", 1e3, "ball screws"),
    "motor_inertia": _Usual(1e-8, 5.0, "kg*m^2", 1.0, "motors of feed drives"),
    "screw_inertia": _Usual(0.0, 20.0, "kg*m^2", 1.0, "screws"),
    "nut_stiffness": _Usual(1e6, 1e11, "N/um", 1e-6, "nuts"),
    "bearing_stiffness": _Usual(1e6, 1e11, "N/um", 1e-6, "bearings of screws"),
    "mesh_stiffness": _Usual(1e6, 1e11, "N/um", 1e-6, "racks"),
    "pinion_radius": _Usual(2e-3, 2.0, "mm", 1e3, "pinions"),
    "backlash": _Usual(0.0, 3e-3, "mm", 1e3, "nuts and pinions"),
}
_GAIN = _Usual(0.5, 2e3, "1/s", 1.0, "position loops of feed drives")
_INTEGRAL_TIME = _Usual(0.1e-3, 10.0, "ms", 1e3, "velocity loops")
_TIME_CONSTANT = _Usual(1e-6, 50e-3, "ms", 1e3, "current loops")
_FED_FORWARD = _Usual(0.0, 1.5, "%", 100.0, "feedforwards of velocity")
#: times what an axis moves: inertia fed forward that is none of it
_FAR_ABOVE = 3.0
#: mass over the volume of its block: a frame of tubes is light, tungsten is dense
_DENSITY = _Usual(20.0, 25e3, "kg/m^3", 1.0, "parts of machines")
_STEP = _Usual(0.5e-6, 2e-3, "us", 1e6, "runs of machines in time")


def questions_of_machine(file: MachineFile) -> list[str]:
    """Sentences on values of a machine that are far from what is usual."""
    asked = _question("step", file.step, _STEP)
    for name, body in file.body.items():
        asked += _question_of_density(f"body.{name}.mass", body)
    for name, axis in file.axis.items():
        asked += _questions_of_axis(f"axis.{name}", axis)
        asked += _question_of_inertia_fed_forward(f"axis.{name}", axis, file)
    for name, law in file.friction.items():
        if law.static is not None and law.coulomb is not None and law.static < law.coulomb:
            asked.append(
                f"friction.{name}.static: is {law.static / law.coulomb:.3g} times coulomb meant? "
                "friction is seldom less at the onset of sliding than in motion"
            )
    return asked


def _question_of_inertia_fed_forward(
    path: str, axis: AxisSection, file: MachineFile
) -> Iterator[str]:
    """Ask about more inertia than drive and rigid bodies of the axis have, where all are known."""
    carried = axis.carries or [axis.moving]
    if axis.control is None or axis.drive is None or any(one not in file.body for one in carried):
        return
    drive = axis.drive
    if drive.lead is not None:
        transmission = abs(drive.lead) / (2.0 * np.pi)
    elif drive.pinion_radius is not None:
        transmission = drive.pinion_radius / (drive.gear_ratio or 1.0)
    elif drive.kind == "linear motor":
        transmission = 1.0
    else:
        return
    turning = (drive.motor_inertia or 0.0) + (drive.screw_inertia or 0.0)
    turning += sum(motor.inertia for motor in drive.motors)
    total = turning + transmission**2 * sum(file.body[one].mass for one in carried)
    given = axis.control.feedforward.inertia
    if given > _FAR_ABOVE * total:
        unit = "kg" if drive.kind == "linear motor" else "kg*m^2"
        yield (
            f"{path}.control.feedforward.inertia: is {given:.4g} {unit} meant? the drive and what "
            f"the axis carries have {total:.3g} {unit} at the motor"
        )


def questions_of_positions(file: MachineFile, positions: Mapping[str, float]) -> list[str]:
    """Ask about positions, m, farther than the whole machine is long along the axis.

    Only of axes that state no `travel_limits`: beyond these a position is refused.
    """
    asked = []
    for name, position in positions.items():
        axis = file.axis[name]
        length = _length_along(file, np.asarray(axis.direction))
        if axis.travel_limits is None and abs(position) > length > 0.0:
            asked.append(
                f"axis.{name}.position: is {1e3 * position:.6g} mm meant? along {name} the whole "
                f"machine is {1e3 * length:.4g} mm long; axis.{name}.travel_limits states how far "
                "the axis goes"
            )
    return asked


def _length_along(file: MachineFile, direction: np.ndarray) -> float:
    """Distance, m, along a direction between the outermost places that the file names."""
    places = [np.asarray(axis.at) for axis in file.axis.values() if axis.at is not None]
    places += [np.asarray(point.at) for point in file.point.values()]
    for connector in file.connector.values():
        places += [np.asarray(place) for place in connector.positions or (connector.at,)]
    reach = [float(place @ direction) for place in places]
    for body in file.body.values():
        middle = float(np.asarray(body.centre) @ direction)
        half = 0.5 * float(np.abs(direction) @ np.asarray(body.size or (0.0,) * 3))
        reach += [middle - half, middle + half]
    return max(reach, default=0.0) - min(reach, default=0.0)


def _question_of_density(path: str, body: BodySection) -> list[str]:
    """Ask about a mass that no block of its size has."""
    if body.size is None:
        return []
    length, width, height = body.size
    density = body.mass / (length * width * height)
    if _DENSITY.low <= density <= _DENSITY.high:
        return []
    return [
        f"{path}: is {body.mass:.4g} kg meant? a block of its size would have "
        f"{density:.3g} kg/m^3; {_DENSITY.of} have {_ends(_DENSITY)}"
    ]


def _questions_of_axis(path: str, axis: AxisSection) -> Iterator[str]:
    drive, control = axis.drive, axis.control
    if drive is None:
        return
    for key, usual in _IN_DRIVE.items():
        value = getattr(drive, key)
        if value is not None:
            yield from _question(f"{path}.drive.{key}", abs(value), usual)
    if drive.kind == "spindle" or axis.moving is None:
        return
    if control is None:
        if axis.brake is None:
            yield f"{path}: has neither control nor brake: its motor turns freely"
        return
    position, velocity, current = control.position, control.velocity, control.current
    if position.gain == 0.0:
        yield f"{path}.control.position.gain: is 0 meant? nothing holds the position of the axis"
    else:
        yield from _question(f"{path}.control.position.gain", position.gain, _GAIN)
    fed = f"{path}.control.feedforward.velocity"
    yield from _question(fed, control.feedforward.velocity, _FED_FORWARD)
    if velocity.integral_time is not None:
        at = f"{path}.control.velocity.integral_time"
        yield from _question(at, velocity.integral_time, _INTEGRAL_TIME)
    if current.time_constant is not None:
        at = f"{path}.control.current.time_constant"
        yield from _question(at, current.time_constant, _TIME_CONSTANT)


def _question(name: str, value: float, usual: _Usual) -> list[str]:
    if usual.low <= value <= usual.high:
        return []
    given = f"{value * usual.factor:.5g} {usual.unit}"
    return [f"{name}: is {given} meant? {usual.of} have {_ends(usual)}"]


def _ends(usual: _Usual) -> str:
    low, high = usual.low * usual.factor, usual.high * usual.factor
    return f"{low:.4g} to {high:.4g} {usual.unit}"
