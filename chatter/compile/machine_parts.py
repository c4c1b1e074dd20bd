"""From a machine file, at positions of its axes, to the parts of a machine and the machine."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeVar

import numpy as np

from chatter.description.errors import InputError
from chatter.description.machine.bodies import SIX
from chatter.description.machine.compose import Composition
from chatter.description.machine.errors_by_key import machine_errors
from chatter.description.machine.friction import FrictionSection
from chatter.description.machine.imported import ImportedSection
from chatter.description.machine.machine_file import MachineFile
from chatter.io.matrices import imported_model
from dynamics.machine.description import (
    Condition,
    FrictionAt,
    Machine,
    MachineAxis,
    MachineParts,
    ModeDamping,
    machine,
)
from dynamics.reduction.imported_part import ImportedPart, reduced_part
from dynamics.structure.bodies import Connector, Point
from dynamics.structure.imported import tied_structure
from dynamics.structure.spring_coupling import Coupling, Term
from dynamics.structure.surface_constraint import InterpolatedPoint, RigidSurface

#: what a section of a machine file is made into
Made = TypeVar("Made")


def assembled_machine(
    file: MachineFile,
    conditions: Mapping[str, Condition] | None = None,
    positions: Mapping[str, float | str] | None = None,
    in_cut: bool = False,
) -> Machine:
    """Assemble the machine of a file.

    Parameters
    ----------
    file : MachineFile
    conditions : mapping of str to {"control", "brake", "free"}, optional
        What holds each driven axis; control where it has one by default, else nothing.
    positions, in_cut
        As for `machine_parts`.

    Raises
    ------
    InputError
        If the machine makes no sense: parts that nothing holds, an axis that is not there, a
        nut off its screw.
    """
    parts = machine_parts(file, positions, in_cut)
    for name, condition in (conditions or {}).items():
        if condition == "brake" and name in file.axis and file.axis[name].brake is None:
            raise InputError(
                f"{file.name}: axis.{name}.brake: is missing; the axis is to be held by it"
            )
    with machine_errors(file.name):
        return machine(parts, conditions)


def machine_parts(
    file: MachineFile, positions: Mapping[str, float | str] | None = None, in_cut: bool = False
) -> MachineParts:
    """Everything a machine is made of, at positions of its axes.

    What an axis carries is shifted along it: bodies, beams, imported parts, points, places
    where drives push, and connectors whose first part it carries.

    Parameters
    ----------
    file : MachineFile
    positions : mapping of str to float or str, optional
        m, or a quantity such as "120 mm"; where the file has the axis by default.
    in_cut : bool
        Whether tool and workpiece touch: with the couplings of [contact].

    Raises
    ------
    InputError
        If there is no such axis, a position is none, or the machine makes no sense there.
    """
    if in_cut and file.contact is None:
        raise InputError(f"{file.name}: [contact] is missing; the machine is to be in the cut")
    composition = Composition(file, file.positions(positions or {}))
    made = {key: _made(file, key, make) for key, make in composition.makers()}
    of = {
        kind: [made[f"{kind}.{name}"] for name in getattr(file, kind)]
        for kind in ("body", "beam", "connector")
    }
    connectors = [one for several in of["connector"] for one in several]
    bearings = [one for beam in of["beam"] for one in beam.connectors]
    axes = {
        name: _made(file, f"axis.{name}", partial(_axis, composition, name))
        for name, axis in file.axis.items()
        if axis.drive is not None
    }
    imported = [
        _imported_part(file, name).shifted(composition.shift(name)) for name in file.imported
    ]
    return MachineParts(
        bodies=[*of["body"], *imported],
        connectors=connectors,
        points=_points(composition),
        beams=of["beam"],
        couplings=_contact(composition) if in_cut else (),
        axes=list(axes.values()),
        frictions=[
            one
            for name, friction in file.friction.items()
            for one in _made(
                file,
                f"friction.{name}",
                partial(_frictions, composition, name, friction, axes, [*connectors, *bearings]),
            )
        ],
        damping_ratio=file.damping_ratio,
        mode_damping=[ModeDamping(band.from_, band.to, band.ratio) for band in file.mode_damping],
        allowed_rigid_motions=file.allowed_rigid_motions,
        highest_frequency=file.highest_frequency,
    )


def machine_points(
    file: MachineFile, positions: Mapping[str, float | str] | None = None
) -> list[Point]:
    """Points of a machine at positions of its axes, as `machine_parts` has them."""
    return _points(Composition(file, file.positions(positions or {})))


def _points(composition: Composition) -> list[Point]:
    return [
        point.part(name, composition.shift(point.on))
        for name, point in composition.file.point.items()
    ]


def _made(file: MachineFile, key: str, make: Callable[[], Made]) -> Made:
    with machine_errors(file.name, key):
        return make()


def _imported_part(file: MachineFile, name: str) -> ImportedPart:
    """Imported part at position 0, read and reduced once."""
    key, section = f"imported.{name}", file.imported[name]
    return file.once(key, partial(_made, file, key, partial(_reduced, section, name)))


def _reduced(section: ImportedSection, name: str) -> ImportedPart:
    bare, nodes = imported_model(
        *(section.mass, section.stiffness, section.damping, section.nodes),
        names=section.names.given,
        units=section.units.model_units,
        total_mass=section.total_mass,
    )
    rigid = [
        RigidSurface(point, one.at, one.chosen(point, nodes))
        for point, one in section.point.items()
        if one.kind == "rigid"
    ]
    interpolated = [
        InterpolatedPoint(point, one.at, one.chosen(point, nodes), one.weights)
        for point, one in section.point.items()
        if one.kind == "interpolating"
    ]
    whole = tied_structure(bare, nodes, rigid, interpolated)
    positions = {point: one.at for point, one in section.point.items()}
    return reduced_part(name, whole, positions, section.rail, section.highest_frequency)


def _axis(composition: Composition, name: str) -> MachineAxis:
    axis = composition.file.axis[name]
    driven = composition.file.once(f"axis.{name}.driven", axis.driven)
    return axis.axis(composition.geometry(name), composition.shift(axis.driven_part), driven)


def _contact(composition: Composition) -> list[Coupling]:
    contact = composition.file.contact
    ends = [
        (composition.file.point[name], weight) for name, weight in composition.file.contact_ends
    ]
    return [
        Coupling(
            f"contact {direction}",
            [
                Term(
                    point.on,
                    weight * np.eye(6)[SIX.index(direction)],
                    np.asarray(point.at) + composition.shift(point.on),
                )
                for point, weight in ends
            ],
            contact.stiffness,
            contact.damping,
        )
        for direction in contact.directions
    ]


def _frictions(
    composition: Composition,
    name: str,
    friction: FrictionSection,
    axes: Mapping[str, MachineAxis],
    connectors: list[Connector],
) -> list[FrictionAt]:
    law, target = composition.file.once(f"friction.{name}", friction.spec), friction.on
    if target.mode is not None:
        return [FrictionAt(name, law, mode=target.mode - 1)]
    if target.axis is not None:
        return [FrictionAt(name, law, _travel(composition, target.axis, target.at))]
    if target.motor is not None:
        driven = axes[target.motor]
        motions = [motor.angle for motor in driven.drive.parts(driven.geometry).motors]
    else:
        direction = SIX.index(target.direction)
        wanted = _connector_names(composition.file, target.connector)
        motions = [_relative(one, direction) for one in connectors if one.name in wanted]
    if len(motions) == 1:
        return [FrictionAt(name, law, motions[0])]
    return [FrictionAt(f"{name}[{number}]", law, terms) for number, terms in enumerate(motions)]


def _travel(composition: Composition, name: str, at: tuple[float, ...] | None) -> tuple[Term, ...]:
    axis, geometry = composition.file.axis[name], composition.geometry(name)
    if axis.drive is not None and axis.drive.is_rotary:
        return geometry.turning(geometry.moving), geometry.turning(geometry.carrying, -1.0)
    position = None if at is None else np.asarray(at) + composition.shift(axis.driven_part)
    return geometry.travel(position)


def _connector_names(file: MachineFile, name: str) -> list[str]:
    """Names, in the assembly, of the connectors that a friction's target stands for."""
    if name in file.connector:
        return file.connector[name].names(name)
    return [name.replace(".", ": ", 1)]


def _relative(connector: Connector, direction: int) -> tuple[Term, Term]:
    """Motion of the first against the second part along or about one of the connector's axes."""
    along = np.zeros(6)
    along[3 * (direction // 3) :][:3] = np.asarray(connector.axes)[direction % 3]
    return (
        Term(connector.first, along, connector.at),
        Term(connector.second, -along, connector.at),
    )
