"""[imported.NAME]: matrices of a finite element program, reduced to the points tied to them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from chatter.description.formatting import formatted
from chatter.description.machine.fields import Position
from chatter.description.quantities import quantity
from chatter.description.section import Section
from chatter.description.sections.structure import FileName


def _nodes(given: Any) -> tuple[int, ...]:
    whole = isinstance(given, (list, tuple)) and given
    if not whole or not all(isinstance(one, int) and not isinstance(one, bool) for one in given):
        raise ValueError(f"{formatted(given)} is given; a list of numbers of nodes is wanted")
    return tuple(given)


NodeNumbers = Annotated[
    tuple[int, ...],
    BeforeValidator(_nodes),
    WithJsonSchema({"type": "array", "items": {"type": "integer"}, "minItems": 1}),
]


class ImportedPointSection(Section):
    """Point tied to nodes: they follow it rigidly, or it follows them."""

    at: Position
    nodes: NodeNumbers
    kind: Literal["rigid", "interpolating"] = "rigid"
    weights: tuple[quantity("number", above=0.0), ...] | None = Field(
        None, description="of the nodes of an interpolating point"
    )


class ImportedSection(Section):
    """Part of which mass and stiffness matrix are read from files; lengths there in m."""

    mass: FileName = Field(examples=["M.npz"])
    stiffness: FileName = Field(examples=["K.npz"])
    damping: FileName | None = None
    nodes: FileName = Field(description="table of nodes: node, x, y, z", examples=["nodes.csv"])
    point: dict[str, ImportedPointSection] = Field(min_length=1)
    highest_frequency: quantity("frequency", above=0.0) = Field(
        description="of fixed-interface modes that are kept"
    )
    rail: tuple[str, ...] = Field(
        (), description="points between which other parts may be joined anywhere"
    )
