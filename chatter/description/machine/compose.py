"""From the sections of a machine file, at positions of its axes, to the parts of a machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.description.machine.bodies import SIX
from chatter.description.machine.errors_by_key import telling
from chatter.description.machine.friction import FrictionSection
from dynamics.drive.parts import DrivenAxis
from dynamics.machine.description import FrictionAt, MachineAxis, MachineParts
from dynamics.structure.bodies import Connector
from dynamics.structure.spring_coupling import Coupling, Term

if TYPE_CHECKING:
    from chatter.description.machine.machine_file import MachineFile


class Composition:
    """A machine file at positions of its axes.

    Parameters
    ----------
    file : MachineFile
    positions : mapping of str to float
        Of axes that are not where the file says, m.
    """

    def __init__(self, file: MachineFile, positions: Mapping[str, float]) -> None:
        self.file = file
        self.positions = {
            name: positions.get(name, axis.position) for name, axis in file.axis.items()
        }

    def shift(self, part: str) -> NDArray[np.float64]:
        """Displacement (3,) of a part by all axes that carry it, m."""
        moved = np.zeros(3)
        for name, axis in self.file.axis.items():
            if part in axis.travelling:
                moved += self.positions[name] * np.asarray(axis.direction)
        return moved

    def makers(self) -> Iterator[tuple[str, Callable[[], object]]]:
        """Path of every section that can be wrong by itself, and what makes its part."""
        file = self.file
        for kind in ("body", "beam"):
            for name, section in getattr(file, kind).items():
                yield f"{kind}.{name}", partial(section.part, name, self.shift(name))
        for name, connector in file.connector.items():
            shift = self.shift(connector.between[0])
            yield f"connector.{name}", partial(connector.parts, name, shift)
        for name, axis in file.axis.items():
            yield f"axis.{name}", partial(self.geometry, name)
            if axis.drive is not None:
                yield f"axis.{name}.drive", axis.drive.spec
            if axis.control is not None:
                # a transmission of 1 in place of a drive that may be wrong
                yield f"axis.{name}.control", partial(axis.control.spec, 1.0)
        for name, friction in file.friction.items():
            yield f"friction.{name}", friction.spec

    def geometry(self, name: str) -> DrivenAxis:
        """Where an axis is driven."""
        axis = self.file.axis[name]
        return axis.geometry(name, self.positions[name], self.shift(axis.driven_part))

    def parts(self, in_cut: bool = False) -> MachineParts:
        """Everything the machine is made of; with the contact of the cut, if it is to be.

        Raises
        ------
        InputError
        """
        file = self.file
        made = {key: self._told(key, make) for key, make in self.makers()}
        of = {
            kind: [made[f"{kind}.{name}"] for name in getattr(file, kind)]
            for kind in ("body", "beam", "connector")
        }
        connectors = [one for several in of["connector"] for one in several]
        bearings = [one for beam in of["beam"] for one in beam.connectors]
        axes = {
            name: self._told(f"axis.{name}", partial(self._axis, name))
            for name, axis in file.axis.items()
            if axis.drive is not None
        }
        return MachineParts(
            bodies=[*of["body"], *self._imported()],
            connectors=connectors,
            points=[point.part(name, self.shift(point.on)) for name, point in file.point.items()],
            beams=of["beam"],
            couplings=self._contact() if in_cut else (),
            axes=list(axes.values()),
            frictions=[
                one
                for name, friction in file.friction.items()
                for one in self._told(
                    f"friction.{name}",
                    partial(self._frictions, name, friction, axes, [*connectors, *bearings]),
                )
            ],
            damping_ratio=file.damping_ratio,
            allowed_rigid_motions=file.allowed_rigid_motions,
            highest_frequency=file.highest_frequency,
        )

    def _told(self, key: str, make: Callable[[], object]) -> object:
        with telling(self.file.name, key):
            return make()

    def _imported(self) -> list:
        return [
            self.file.imported_part(name).shifted(self.shift(name)) for name in self.file.imported
        ]

    def _axis(self, name: str) -> MachineAxis:
        axis = self.file.axis[name]
        return axis.axis(self.geometry(name), self.shift(axis.driven_part))

    def _contact(self) -> list[Coupling]:
        contact = self.file.contact
        ends = [(self.file.point[name], weight) for name, weight in self.file.contact_ends]
        return [
            Coupling(
                f"contact {direction}",
                [
                    Term(
                        point.on,
                        weight * np.eye(6)[SIX.index(direction)],
                        np.asarray(point.at) + self.shift(point.on),
                    )
                    for point, weight in ends
                ],
                contact.stiffness,
                contact.damping,
            )
            for direction in contact.directions
        ]

    def _frictions(
        self,
        name: str,
        friction: FrictionSection,
        axes: Mapping[str, MachineAxis],
        connectors: list[Connector],
    ) -> list[FrictionAt]:
        law, target = friction.spec(), friction.on
        if target.mode is not None:
            return [FrictionAt(name, law, mode=target.mode - 1)]
        if target.axis is not None:
            return [FrictionAt(name, law, self._travel(target.axis, target.at))]
        if target.motor is not None:
            driven = axes[target.motor]
            motions = [motor.angle for motor in driven.drive.parts(driven.geometry).motors]
        else:
            direction = SIX.index(target.direction)
            wanted = _connector_names(self.file, target.connector)
            motions = [_relative(one, direction) for one in connectors if one.name in wanted]
        if len(motions) == 1:
            return [FrictionAt(name, law, motions[0])]
        return [FrictionAt(f"{name}[{number}]", law, terms) for number, terms in enumerate(motions)]

    def _travel(self, name: str, at: tuple[float, ...] | None) -> tuple[Term, ...]:
        axis, geometry = self.file.axis[name], self.geometry(name)
        if axis.drive is not None and axis.drive.turns:
            return geometry.turning(geometry.moving), geometry.turning(geometry.carrying, -1.0)
        place = None if at is None else np.asarray(at) + self.shift(axis.driven_part)
        return geometry.travel(place)


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
