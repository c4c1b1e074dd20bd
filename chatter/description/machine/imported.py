"""[imported.NAME]: parts of which matrices and nodes are read from files."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from chatter.description.file_name import FileName
from chatter.description.formatting import formatted
from chatter.description.machine.fields import Position
from chatter.description.quantities import QuantityField, quantity
from chatter.description.section import Section, raise_if_any
from dynamics.structure.imported import ModelUnits
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.surface_constraint import Nodes

#: of a box, m: nodes on its faces are inside
_ON_FACE = 1e-6


def _nodes(given: Any) -> tuple[int, ...]:
    whole = isinstance(given, (list, tuple)) and given
    if not whole or not all(isinstance(one, int) and not isinstance(one, bool) for one in given):
        raise ValueError(f"{formatted(given)} is given; a list of numbers of nodes is required")
    return tuple(given)


NodeNumbers = Annotated[
    tuple[int, ...],
    BeforeValidator(_nodes),
    WithJsonSchema({"type": "array", "items": {"type": "integer"}, "minItems": 1}),
]


def _rails(given: Any) -> tuple[tuple[str, ...], ...]:
    rails = given if isinstance(given, (list, tuple)) else [given]
    if rails and all(isinstance(one, str) for one in rails):
        rails = [rails]
    for rail in rails:
        if not isinstance(rail, (list, tuple)) or not all(isinstance(one, str) for one in rail):
            raise ValueError(
                f"{formatted(rail)} is given; a list of names of points is required, or several"
            )
    return tuple(tuple(rail) for rail in rails)


_POINTS = {"type": "array", "items": {"type": "string"}, "minItems": 2}
Rails = Annotated[
    tuple[tuple[str, ...], ...],
    BeforeValidator(_rails),
    WithJsonSchema({"anyOf": [_POINTS, {"type": "array", "items": _POINTS}]}),
]


def _unit_of(dimension: str) -> Any:
    """Field type of a unit of a model: a name such as "mm", read as one of it in SI."""
    field = QuantityField(dimension, above=0.0)

    def read(given: Any) -> float:
        if isinstance(given, str) and given.strip()[:1].isalpha():
            return field.read(f"1 {given}")
        return field.read(given)

    examples = {"length": "mm", "mass": "t", "time": "s"}
    schema = {"type": "string", "examples": [examples[dimension]], "minLength": 1}
    return Annotated[float, BeforeValidator(read), WithJsonSchema(schema)]


class UnitsSection(Section):
    """Units of a finite element model; its force is mass times length over time squared."""

    length: _unit_of("length") = Field(1.0, description="m by default")
    mass: _unit_of("mass") = Field(1.0, description="kg by default; with mm and N it is t")
    time: _unit_of("time") = Field(1.0, description="s by default")

    @property
    def model_units(self) -> ModelUnits:
        """The units in SI."""
        return ModelUnits(self.length, self.mass, self.time)


class NamesSection(Section):
    """Names of matrices in files that hold several."""

    mass: str | None = Field(None, examples=["MAAX"])
    stiffness: str | None = Field(None, examples=["KAAX"])
    damping: str | None = Field(None, examples=["BAAX"])

    @property
    def given(self) -> dict[str, str]:
        """Names by what the matrix is."""
        return {key: name for key, name in self.model_dump().items() if name is not None}


class ImportedPointSection(Section):
    """Point tied to nodes: they follow it rigidly, or it follows them."""

    at: Position
    nodes: NodeNumbers | None = Field(None, description="numbers; or give within, or box")
    within: quantity("length", above=0.0) | None = Field(
        None, description="every node at most so far from the point"
    )
    box: tuple[Position, Position] | None = Field(
        None, description="every node between two corners"
    )
    kind: Literal["rigid", "interpolating"] = "rigid"
    weights: tuple[quantity("number", above=0.0), ...] | None = Field(
        None, description="of the nodes of an interpolating point"
    )

    @model_validator(mode="after")
    def _check_nodes(self) -> ImportedPointSection:
        keys = [key for key in ("nodes", "within", "box") if getattr(self, key) is not None]
        problems = []
        if len(keys) > 1:
            problems.append(("", f"{' and '.join(keys)} are both given; one is required"))
        if not keys:
            problems.append(("nodes", "is missing; give numbers of nodes, within or box"))
        if self.weights is not None and self.nodes is None:
            problems.append(("weights", "needs nodes by their numbers"))
        raise_if_any(problems)
        return self

    def chosen(self, name: str, nodes: Nodes) -> tuple[int, ...]:
        """Numbers of the nodes of this point; StructureError if there are none."""
        if self.nodes is not None:
            return self.nodes
        distance = np.linalg.norm(nodes.coordinates - np.asarray(self.at), axis=1)
        if self.within is not None:
            inside = distance <= self.within
        else:
            low, high = np.sort(np.asarray(self.box), axis=0)
            inside = np.all(
                (nodes.coordinates >= low - _ON_FACE) & (nodes.coordinates <= high + _ON_FACE),
                axis=1,
            )
        if not np.any(inside):
            nearest = int(np.argmin(distance))
            raise StructureError(
                f'point "{name}": there are no nodes where they are looked for; the nearest, '
                f"{nodes.names[nearest]}, is {1e3 * distance[nearest]:.4g} mm from the point (see "
                "units)"
            )
        return tuple(int(number) for number in nodes.names[inside])


class ImportedSection(Section):
    """Part of which mass and stiffness matrix are read from files."""

    mass: FileName = Field(examples=["M.npz"])
    stiffness: FileName = Field(examples=["K.npz"])
    damping: FileName | None = None
    nodes: FileName = Field(
        description="table of nodes (node, x, y, z), or input file", examples=["nodes.csv"]
    )
    names: NamesSection = NamesSection()
    units: UnitsSection = UnitsSection()
    total_mass: quantity("mass", above=0.0) | None = Field(
        None, description="of the part; matrices of another one are refused"
    )
    point: dict[str, ImportedPointSection] = Field(min_length=1)
    highest_frequency: quantity("frequency", above=0.0) = Field(
        description="of fixed-interface modes that are kept"
    )
    rail: Rails = Field(
        (),
        description="points between which other parts may be joined anywhere; a list of them, or a "
        "list a rail",
    )
