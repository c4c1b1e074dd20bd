"""Field types of machine files: places, pairs, names; kinds and their keys."""

import dataclasses
import re
from collections.abc import Callable, Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from chatter.description.formatting import formatted
from chatter.description.quantities import QuantityField, quantities
from chatter.description.section import Section

#: no machine is larger, so that a number meant in mm is not taken for one in m
_FARTHEST = 200.0
_NAME = re.compile(r"[A-Za-z_][\w-]*", re.ASCII)

Coordinate = QuantityField("length", at_least=-_FARTHEST, at_most=_FARTHEST)
Position = quantities(3, "length", at_least=-_FARTHEST, at_most=_FARTHEST)
Size = quantities(3, "length", above=0.0, at_most=_FARTHEST)


def _places(given: Any) -> tuple[tuple[float, ...], ...]:
    many = isinstance(given, (list, tuple)) and given
    if not many or not all(isinstance(one, (list, tuple)) and len(one) == 3 for one in given):
        raise ValueError(
            f"{formatted(given)} is given; a list of places is required, "
            'such as [["0 mm", "0 mm", "0 mm"], ...]'
        )
    return tuple(tuple(Coordinate.read(part) for part in one) for one in given)


Positions = Annotated[
    tuple[tuple[float, float, float], ...],
    BeforeValidator(_places),
    WithJsonSchema(
        {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "array",
                "items": {"anyOf": Coordinate.json_schema()["anyOf"]},
                "minItems": 3,
                "maxItems": 3,
            },
            "description": "places, three lengths each",
        }
    ),
    Coordinate,
]


def pair(dimension: str, **bounds: float) -> Any:
    """Return the field type of two quantities, or of one that stands for both."""
    field = QuantityField(dimension, **bounds)

    def read(given: Any) -> tuple[float, float]:
        both = given if isinstance(given, (list, tuple)) else (given, given)
        if len(both) != 2:
            raise ValueError(
                f"{formatted(given)} is given; {field.noun}, or a list of two, is required"
            )
        return field.read(both[0]), field.read(both[1])

    alternatives = field.json_schema()["anyOf"]
    schema = {
        "anyOf": [
            *alternatives,
            {"type": "array", "items": {"anyOf": alternatives}, "minItems": 2, "maxItems": 2},
        ],
        "description": f"{field.noun}, or a list of two",
    }
    return Annotated[tuple[float, float], BeforeValidator(read), WithJsonSchema(schema), field]


def name_problems(tables: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, str]]:
    """Tell names that paths could not lead to.

    Tables are by kind and name.
    """
    return [
        (
            kind,
            f"the name {formatted(name)} is not allowed; letters, digits, _ and - make a name, "
            "the first a letter",
        )
        for kind, table in tables.items()
        for name in table
        if not _NAME.fullmatch(name)
    ]


def arguments(section: Section, make: type | Callable, but: tuple[str, ...] = ()) -> dict[str, Any]:
    """Values that a section gives for the fields of a specification.

    Sections within are left out; `but` names further ones.
    """
    values = {name: getattr(section, name, None) for name in fields_of(make) if name not in but}
    return {
        name: value
        for name, value in values.items()
        if value is not None and not isinstance(value, Section)
    }


def fields_of(make: type) -> dict[str, bool]:
    """Names of the fields of a specification, and whether each is needed."""
    return {
        field.name: field.default is dataclasses.MISSING
        and field.default_factory is dataclasses.MISSING
        for field in dataclasses.fields(make)
    }
