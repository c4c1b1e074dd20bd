"""Units that a case, or its machine, states its values in."""

from __future__ import annotations

from typing import Any

import tomlkit

from chatter.description.case import MACHINE_PATH, Case
from chatter.description.machine.machine_file import MachineFile
from chatter.description.path import field_at, parse_path
from chatter.description.toml_document import value_at
from chatter.description.units import QuantityError, parse, unit_factor

#: of a value that a slider has left
_DIGITS = 5


def stated_dimension(case: Case, path: str) -> str:
    """Dimension of the quantity at a path, which may be one of two; empty where none is stated."""
    field, stated = _field_and_text(case, path)
    try:
        return field.matching(stated).dimension
    except (AttributeError, ValueError):
        return ""


def in_stated_unit(case: Case, path: str, value: Any) -> Any:
    """Write a quantity, such as "1.25 mm", in the unit that the case has at a path."""
    field, stated = _field_and_text(case, path)
    if field is None or not isinstance(stated, str) or not isinstance(value, str):
        return value
    try:
        dimension = field.matching(stated).dimension
        unit = parse(stated, dimension).unit
        given = parse(value, dimension).value
    except (QuantityError, ValueError):
        return value
    return f"{given / unit_factor(unit, dimension):.{_DIGITS}g} {unit}"


def _field_and_text(case: Case, path: str) -> tuple[Any, Any]:
    """Field of a path and what is written there."""
    inside = path.removeprefix(MACHINE_PATH)
    described = case if inside == path else case.machine_file()
    steps = parse_path(inside)
    written = value_at(tomlkit.parse(described.to_toml()).unwrap(), steps)
    return field_at(Case if described is case else MachineFile, steps), written
