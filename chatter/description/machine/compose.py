"""Sections of a machine file at positions of its axes: where they are, and what can be wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dynamics.drive.parts import DrivenAxis

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

    def makers(self) -> Iterator[tuple[str, Callable[[], Any]]]:
        """Path of every section that can be wrong by itself, and what makes its part."""
        file = self.file
        for kind in ("body", "beam"):
            for name, section in getattr(file, kind).items():
                yield self._made_once_at_rest(f"{kind}.{name}", name, partial(section.part, name))
        for name, connector in file.connector.items():
            make = partial(connector.parts, name)
            yield self._made_once_at_rest(f"connector.{name}", connector.between[0], make)
        for name, axis in file.axis.items():
            yield f"axis.{name}", partial(self.geometry, name)
            if axis.drive is not None:
                yield f"axis.{name}.drive", axis.drive.spec
            if axis.control is not None:
                # a transmission of 1 in place of a drive that may be wrong
                yield f"axis.{name}.control", partial(axis.control.spec, 1.0)
        for name, friction in file.friction.items():
            yield f"friction.{name}", friction.spec

    def _made_once_at_rest(
        self, key: str, part: str, make: Callable[[NDArray[np.float64]], Any]
    ) -> tuple[str, Callable[[], Any]]:
        """Path and maker of what travels with a part; where that stays, it is made once."""
        shift = self.shift(part)
        if np.any(shift):
            return key, partial(make, shift)
        return key, partial(self.file.once, key, partial(make, shift))

    def geometry(self, name: str) -> DrivenAxis:
        """Where an axis is driven."""
        axis = self.file.axis[name]
        return axis.geometry(name, self.positions[name], self.shift(axis.driven_part))
