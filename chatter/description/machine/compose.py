"""Sections of a machine file at positions of its axes: where they are, and what can be wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dynamics.drive.parts import DrivenAxis
from dynamics.structure.bodies import Connector

if TYPE_CHECKING:
    from chatter.description.machine.bodies import ConnectorSection
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

    def makers(self) -> Iterator[tuple[str, Callable[[], Any]]]:
        """Path of every section that can be wrong by itself, and what makes its part."""
        file = self.file
        for kind in ("body", "beam"):
            for name, section in getattr(file, kind).items():
                key, make = f"{kind}.{name}", partial(section.part, name)
                yield key, partial(self._part, key, name, make)
        for name, connector in file.connector.items():
            yield f"connector.{name}", partial(self._connectors, name, connector)
        for name, axis in file.axis.items():
            yield f"axis.{name}", partial(self.geometry, name)
            if axis.drive is not None:
                yield self._made_once(f"axis.{name}.drive", axis.drive.spec)
            if axis.control is not None:
                # a transmission of 1 in place of a drive that may be wrong
                yield self._made_once(f"axis.{name}.control", partial(axis.control.spec, 1.0))
        for name, friction in file.friction.items():
            yield self._made_once(f"friction.{name}", friction.spec)

    def _made_once(self, key: str, make: Callable[[], Any]) -> tuple[str, Callable[[], Any]]:
        """Path and maker of what is the same at all positions."""
        return key, partial(self.file.once, key, make)

    def _part(self, key: str, name: str, make: Callable[[], Any]) -> Any:
        """Part where it is, which was made once."""
        shift = self.shift(name)
        part = self.file.once(key, make)
        return part.shifted(shift) if np.any(shift) else part

    def _connectors(self, name: str, section: ConnectorSection) -> list[Connector]:
        """Connectors where their first part is, which were made once."""
        shift = self.shift(section.between[0])
        connectors = self.file.once(f"connector.{name}", partial(section.parts, name))
        return [one.shifted(shift) for one in connectors] if np.any(shift) else connectors

    def geometry(self, name: str) -> DrivenAxis:
        """Where an axis is driven."""
        axis = self.file.axis[name]
        return axis.geometry(name, self.positions[name], self.shift(axis.driven_part))
