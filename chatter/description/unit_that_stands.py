"""Bare numbers that are set in a file, written in the unit of what they replace."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from chatter.description.errors import InputError
from chatter.description.path import Step, field_at, join_path
from chatter.description.quantities import QuantityField
from chatter.description.toml_document import value_at
from chatter.description.units import DIMENSIONS, QuantityError, parse, write


def in_unit_that_stands(
    kind: type[BaseModel], document: Any, steps: tuple[Step, ...], value: Any
) -> Any:
    """Write bare numbers, SI, in the unit of the text that they replace.

    Raises
    ------
    InputError
        If such a number cannot be written so.
    """
    field = field_at(kind, steps)
    stands = value_at(document, tuple(0 if step == "*" else step for step in steps))
    if field is None:
        return value
    if isinstance(value, list) and isinstance(stands, list) and len(value) == len(stands):
        pairs = zip(value, stands, strict=True)
        return [_like(entry, stood, field, steps) for entry, stood in pairs]
    return _like(value, stands, field, steps)


def _like(value: Any, stands: Any, field: Any, steps: tuple[Step, ...]) -> Any:
    bare = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not bare or not isinstance(stands, str):
        return value
    try:
        stood = field.matching(stands)
        return write(stood.read(value), _unit_of(stands, stood), stood.dimension)
    except ValueError as error:
        raise InputError(f"{join_path(steps)}: {error}") from None


def _unit_of(stands: str, field: QuantityField) -> str:
    """Unit of a text; that of SI in the place of a share of another value, such as "8 %"."""
    try:
        return parse(stands, field.dimension).unit
    except QuantityError:
        return DIMENSIONS[field.dimension].unit
