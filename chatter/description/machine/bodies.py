"""[body.NAME], [connector.NAME], [point.NAME] and [contact]."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from chatter.description.directions import Direction
from chatter.description.formatting import formatted
from chatter.description.machine.fields import Position, Positions, Size
from chatter.description.quantities import QuantityField, list_type, quantity
from chatter.description.section import Section, raise_if_any
from dynamics.structure.bodies import Body, Connector, Point

_INERTIA = QuantityField("moment_of_inertia")
#: where six entries of a tensor stand
_ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def _inertia(given: Any) -> tuple[float, ...]:
    if not isinstance(given, (list, tuple)) or len(given) not in (3, 6):
        raise ValueError(
            f"{formatted(given)} is given; three principal moments of inertia are required, or six "
            "entries of the tensor: xx, yy, zz, xy, xz, yz"
        )
    return tuple(_INERTIA.read(part) for part in given)


Inertia = list_type(
    tuple[float, ...],
    _inertia,
    _INERTIA,
    "about the centre of gravity: three principal moments of inertia, or xx, yy, zz, xy, xz, yz of "
    "the tensor (off the diagonal with its minus sign)",
    3,
    6,
)


class BodySection(Section):
    """Rigid body."""

    mass: quantity("mass", above=0.0)
    inertia: Inertia | None = None
    size: Size | None = Field(
        None, description="edges of a uniform block, for its moments of inertia; or give inertia"
    )
    centre: Position = Field(description="centre of gravity")

    @model_validator(mode="after")
    def _check_inertia(self) -> BodySection:
        given = (self.inertia is not None) + (self.size is not None)
        text = {
            0: "is missing; give three moments of inertia, or the size of a block",
            2: "inertia and size are both given; one is required",
        }
        key = "inertia" if given == 0 else ""
        raise_if_any([(key, text[given])] if given != 1 else [])
        return self

    @property
    def tensor(self) -> NDArray[np.float64]:
        """Inertia tensor (3, 3), kg m^2."""
        if self.size is not None:
            square = np.square(self.size)
            return np.diag(self.mass / 12.0 * (np.sum(square) - square))
        tensor = np.zeros((3, 3))
        for (row, column), value in zip(_ENTRIES, self.inertia, strict=False):
            tensor[row, column] = tensor[column, row] = value
        return tensor

    def part(self, name: str) -> Body:
        """The body at position 0 of the axes that carry it."""
        return Body(name, self.mass, self.tensor, self.centre)


class SixStiffness(Section):
    """Stiffness along and about the connector's x, y, z."""

    x: quantity("stiffness", at_least=0.0) = 0.0
    y: quantity("stiffness", at_least=0.0) = 0.0
    z: quantity("stiffness", at_least=0.0) = 0.0
    rx: quantity("rotational_stiffness", at_least=0.0) = 0.0
    ry: quantity("rotational_stiffness", at_least=0.0) = 0.0
    rz: quantity("rotational_stiffness", at_least=0.0) = 0.0

    @property
    def values(self) -> tuple[float, ...]:
        """(6,), N/m and N m/rad."""
        return tuple(getattr(self, key) for key in SIX)


class SixDamping(Section):
    """Damping along and about the connector's x, y, z."""

    x: quantity("damping", at_least=0.0) = 0.0
    y: quantity("damping", at_least=0.0) = 0.0
    z: quantity("damping", at_least=0.0) = 0.0
    rx: quantity("rotational_damping", at_least=0.0) = 0.0
    ry: quantity("rotational_damping", at_least=0.0) = 0.0
    rz: quantity("rotational_damping", at_least=0.0) = 0.0

    @property
    def values(self) -> tuple[float, ...]:
        """(6,), N s/m and N m s/rad."""
        return tuple(getattr(self, key) for key in SIX)


SIX = ("x", "y", "z", "rx", "ry", "rz")


class ConnectorSection(Section):
    """Springs and dampers between two parts, at one place or the same at several."""

    between: tuple[str, str] = Field(
        description='two parts, or one and "ground"; the connector travels with the first',
        examples=[["table", "ground"]],
    )
    at: Position | None = None
    positions: Positions | None = Field(None, description="several equal ones; or give at")
    stiffness: SixStiffness
    damping: SixDamping = SixDamping()
    axes: tuple[Direction, Direction, Direction] | None = Field(
        None, description="directions of the connector's own x, y, z; the machine's by default"
    )

    @model_validator(mode="after")
    def _check_place(self) -> ConnectorSection:
        given = (self.at is not None) + (self.positions is not None)
        text = {
            0: ("at", 'is missing; a place is required, such as ["0 mm", "0 mm", "0 mm"]'),
            2: ("", "at and places are both given; one is required"),
        }
        raise_if_any([text[given]] if given != 1 else [])
        return self

    def names(self, name: str) -> list[str]:
        """Names of the connectors that this one stands for."""
        if self.at is not None:
            return [name]
        return [f"{name}[{number}]" for number in range(len(self.positions))]

    def parts(self, name: str) -> list[Connector]:
        """The connectors at position 0 of the axes that carry their first part."""
        positions = self.positions if self.at is None else (self.at,)
        return [
            Connector(
                one,
                *self.between,
                at,
                self.stiffness.values,
                self.damping.values,
                np.eye(3) if self.axes is None else np.array(self.axes),
            )
            for one, at in zip(self.names(name), positions, strict=True)
        ]


class PointSection(Section):
    """Named place on a part."""

    on: str = Field(description='body, beam or imported part, or "ground"', examples=["table"])
    at: Position

    def part(self, name: str, shift: NDArray[np.float64]) -> Point:
        """The point, shifted (3,) m with its part."""
        return Point(name, self.on, np.asarray(self.at) + shift)


class ContactSection(Section):
    """Springs and dampers between tool point and workpiece while in the cut."""

    stiffness: quantity("stiffness", at_least=0.0)
    damping: quantity("damping", at_least=0.0) = 0.0
    directions: tuple[Literal["x", "y", "z"], ...] = Field(("x", "y", "z"), min_length=1)


class ModeDampingSection(Section):
    """Damping ratio of the modes whose undamped frequencies lie in a band."""

    from_: quantity("frequency", at_least=0.0) = Field(alias="from")
    to: quantity("frequency", above=0.0)
    ratio: quantity("number", at_least=0.0, below=1.0)

    @model_validator(mode="after")
    def _check_order(self) -> ModeDampingSection:
        if self.from_ >= self.to:
            text = f"from ({self.from_:g} Hz) is not less than to ({self.to:g} Hz)"
            raise_if_any([("", f"the band is empty: {text}")])
        return self
