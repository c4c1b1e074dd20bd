"""Checks across sections of a machine file: names that are nowhere, values of the other kind."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from chatter.description.machine.fields import name_problems
from chatter.description.machine.frequency_response import parse_tested_point
from chatter.description.path import Step, field_at, join_path
from chatter.description.quantities import EitherQuantityField
from chatter.description.wording import nearest
from dynamics.structure.bodies import GROUND

if TYPE_CHECKING:
    from chatter.description.machine.machine_file import MachineFile

Problem = tuple[str, str]
#: sections of named tables that are no parts
_JOINING = ("connector", "point", "axis", "friction")


def reference_problems(file: MachineFile) -> list[Problem]:
    """Tell names of parts, points, axes and connectors that are nowhere."""
    problems = name_problems(
        {
            **{key: getattr(file, key) for key in (*file.PARTS, *_JOINING)},
            **{f"imported.{name}.point": one.point for name, one in file.imported.items()},
        }
    )
    named = [name for kind in file.PARTS for name in getattr(file, kind)]
    for name in sorted({name for name in named if named.count(name) > 1}):
        problems.append(("", f'"{name}" is the name of two parts; names must differ'))
    for key, name, known in _references(file):
        if name not in known:
            there = nearest(name, known) if known else "there are none"
            problems.append((key, f'there is no {_what(key)} "{name}"; {there}'))
    return problems + _travel_problems(file) + _rotor_problems(file)


def _what(key: str) -> str:
    """What the name at a path stands for."""
    last = key.rsplit(".", 1)[-1]
    if last in ("tool_point", "workpiece"):
        return "point"
    if last == "motor":
        return "driven axis"
    return last if last in ("axis", "connector", "beam") else "part"


def _references(file: MachineFile) -> Iterator[tuple[str, str, Sequence[str]]]:
    """Path, name and what may stand there, of every name that a section refers to."""
    parts = file.part_names
    for name, connector in file.connector.items():
        for index, part in enumerate(connector.between):
            yield f"connector.{name}.between[{index}]", part, parts
    for name, point in file.point.items():
        yield f"point.{name}.on", point.on, parts
    for name, beam in file.beam.items():
        for index, bearing in enumerate(beam.bearings):
            yield f"beam.{name}.bearings[{index}].on", bearing.on, parts
    for name, axis in file.axis.items():
        for key in ("moving", "carrying"):
            if getattr(axis, key) is not None:
                yield f"axis.{name}.{key}", getattr(axis, key), parts
        for index, part in enumerate(axis.carries or ()):
            yield f"axis.{name}.carries[{index}]", part, parts
        if axis.drive is not None and axis.drive.beam is not None:
            yield f"axis.{name}.drive.beam", axis.drive.beam, tuple(file.beam)
    for key in ("tool_point", "workpiece"):
        if getattr(file, key) is not None:
            yield key, getattr(file, key), tuple(file.point)
    yield from _friction_references(file)


def _friction_references(file: MachineFile) -> Iterator[tuple[str, str, Sequence[str]]]:
    driven = tuple(name for name, axis in file.axis.items() if axis.drive is not None)
    bearings = [f"{name}.{one.name}" for name, beam in file.beam.items() for one in beam.bearings]
    references = {
        "axis": tuple(file.axis),
        "motor": driven,
        "connector": (*file.connector, *bearings),
    }
    for name, friction in file.friction.items():
        for key, known in references.items():
            given = getattr(friction.on, key)
            if given is not None:
                yield f"friction.{name}.on.{key}", given, known


def _rotor_problems(file: MachineFile) -> list[Problem]:
    """Tell frictions on the travel of a spindle that is only a rotor."""
    rotors = {
        name
        for name, axis in file.axis.items()
        if axis.drive is not None and axis.drive.kind == "spindle"
    }
    return [
        (f"friction.{name}.on.axis", f'"{friction.on.axis}" is a rotor; write on = {{ motor }}')
        for name, friction in file.friction.items()
        if friction.on.axis in rotors
    ]


def _travel_problems(file: MachineFile) -> list[Problem]:
    """Tell parts that an axis would leave behind, and axes that move the ground."""
    problems = []
    for name, axis in file.axis.items():
        travelling = axis.travelling
        if not travelling:
            continue
        if GROUND in (*travelling, axis.moving):
            problems.append((f"axis.{name}", f'"{GROUND}" does not move'))
        if axis.moving not in travelling:
            problems.append((f"axis.{name}.carries", f'lacks "{axis.moving}", which it moves'))
        if axis.carrying in travelling:
            problems.append(
                (f"axis.{name}.carries", f'has "{axis.carrying}", which the axis moves against')
            )
        for other, on_it in file.axis.items():
            left = on_it.moving is not None and on_it.moving not in travelling
            if other != name and on_it.carrying in travelling and left:
                text = f'has "{on_it.carrying}", but not "{on_it.moving}" that axis {other} carries'
                problems.append((f"axis.{name}.carries", text))
    return problems


def dimension_problems(file: MachineFile, data: Mapping[str, Any]) -> list[Problem]:
    """Tell quantities of a rotation along a travel, and the other way round.

    By what the file says, before units were read.
    """
    problems = []
    for name, axis in file.axis.items():
        if axis.drive is None:
            continue
        where = ("axis", name)
        own = data["axis"][name]
        for key in ("brake", "control"):
            problems += _of_the_other_kind(
                type(file), (*where, key), own.get(key), axis.drive.motor_is_linear
            )
        # the only keys of the axis' travel and not of its motor
        for section, key in (("position", "velocity_limit"), ("measuring", "scale_resolution")):
            steps = (*where, "control", section, key)
            problems = [one for one in problems if one[0] != join_path(steps)]
            given = own.get("control", {}).get(section, {}).get(key)
            problems += _of_the_other_kind(type(file), steps, given, not axis.drive.is_rotary)
    for name, friction in file.friction.items():
        straight = is_straight(file, friction.on)
        problems += _of_the_other_kind(
            type(file), ("friction", name), data["friction"][name], straight
        )
    for name, test in file.frf.items():
        tested = parse_tested_point(test.excite)
        # a torque belongs to a motor that turns, or about an axis of a point
        straight = not (tested.direction or "").startswith("r")
        if tested.motor is not None:
            drive = file.axis[tested.motor].drive if tested.motor in file.axis else None
            straight = drive is not None and drive.motor_is_linear
        level = data["frf"][name].get("level")
        problems += _of_the_other_kind(type(file), ("frf", name, "level"), level, straight)
    return problems


def is_straight(file: MachineFile, target: Any) -> bool:
    """Whether the motion of a friction is a displacement."""
    if target.motor is not None:
        return file.axis[target.motor].drive.motor_is_linear
    if target.axis is not None:
        drive = file.axis[target.axis].drive
        return drive is None or not drive.is_rotary
    return target.direction is None or not target.direction.startswith("r")


#: of the dimensions that an either-field has, those of a rotation
_TURNING = {
    "rotational_stiffness",
    "rotational_damping",
    "torque",
    "angular_speed",
    "moment_of_inertia",
    "angle",
    "torque_constant",
    "back_emf",
    "inverse_angular_speed",
    "inverse_angle",
}


def _of_the_other_kind(
    model: type, steps: tuple[Step, ...], given: Any, straight: bool
) -> list[Problem]:
    """Tell texts below a path whose dimension is that of the other kind of motion."""
    if isinstance(given, Mapping):
        entries: Iterable = given.items()
    elif isinstance(given, list):
        entries = enumerate(given)
    elif isinstance(given, str):
        field = field_at(model, steps)
        if not isinstance(field, EitherQuantityField):
            return []
        of = next(one for one in (field.dimension, *field.others) if (one in _TURNING) != straight)
        try:
            field.of(of).read(given)
        except ValueError as error:
            return [(join_path(steps), str(error))]
        return []
    else:
        return []
    return [
        problem
        for step, value in entries
        for problem in _of_the_other_kind(model, (*steps, step), value, straight)
    ]
