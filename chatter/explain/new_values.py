"""New values of a repaired case as people write them: in usual units, with six digits."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import tomlkit

from chatter.description.case import Case
from chatter.description.path import Step, field_at, join_path, parse_path
from chatter.description.shop_units import with_decimals
from chatter.description.units import NUMBER, unit_factor
from chatter.description.usual_units import of_dimension

_DIGITS = 6
_QUANTITY = re.compile(rf"\s*(?P<number>{NUMBER})\s*(?P<unit>[^0-9+±].*)?")
#: m, below which a length is in um
_SHORT = 1e-4
#: units beside those that messages have
_ALSO_USUAL = {"pressure_gradient": "N/mm^3"}


def in_usual_units(case: Case, declared: Case) -> Case:
    """Return a case whose values that are not as declared are in usual units, with six digits.

    Parameters
    ----------
    case : Case
        With values as a fit found them, in SI and with all digits.
    declared : Case
        What it was made from.
    """
    before = tomlkit.parse(declared.to_toml()).unwrap()
    after = tomlkit.parse(case.to_toml()).unwrap()
    changed = {join_path(steps): _written(steps, value) for steps, value in _new(before, after, ())}
    return case.patch(changed) if changed else case


def in_declared_unit(declared: Case, path: str, value: float) -> str:
    """Return a value in SI as text in the unit that a case has at a path, else in the usual one."""
    steps = parse_path(path)
    written = tomlkit.parse(declared.to_toml()).unwrap()
    for step in steps:
        there = isinstance(written, Mapping) and step in written
        written = written[step] if there else None
    match = _QUANTITY.fullmatch(with_decimals(written)) if isinstance(written, str) else None
    dimension = field_at(Case, steps).dimension
    unit = (match["unit"] if match else None) or _unit(dimension, value)
    return f"{value / unit_factor(unit, dimension):.{_DIGITS}g} {unit}".strip()


def _new(
    before: Any, after: Any, steps: tuple[Step, ...]
) -> Iterator[tuple[tuple[Step, ...], Any]]:
    """Paths and values that are not as they were; a list of numbers is one value."""
    if isinstance(after, Mapping):
        for key, value in after.items():
            was = before.get(key) if isinstance(before, Mapping) else None
            yield from _new(was, value, (*steps, key))
    elif isinstance(after, list) and any(isinstance(one, Mapping) for one in after):
        for index, value in enumerate(after):
            there = isinstance(before, list) and index < len(before)
            yield from _new(before[index] if there else None, value, (*steps, index))
    elif after != before and isinstance(after, (float, str, list)):
        yield steps, after


def _written(steps: tuple[Step, ...], value: Any) -> Any:
    if isinstance(value, list):
        return [_written((*steps, index), one) for index, one in enumerate(value)]
    field = field_at(Case, steps)
    if isinstance(value, str):
        return value if field is None else _with_fewer_digits(value)
    if not isinstance(value, float):
        return value
    unit = "" if field is None else _unit(field.dimension, value)
    if not unit:
        return float(f"{value:.{_DIGITS}g}")
    return f"{value / unit_factor(unit, field.dimension):.{_DIGITS}g} {unit}"


def _unit(dimension: str, value: float) -> str:
    if dimension == "length" and 0.0 < abs(value) < _SHORT:
        return "um"
    return _ALSO_USUAL.get(dimension) or of_dimension(dimension).name


def _with_fewer_digits(text: str) -> str:
    """Quantity with six digits; with a deviation, as it is."""
    match = _QUANTITY.fullmatch(with_decimals(text))
    if match is None:
        return text
    return f"{float(match['number']):.{_DIGITS}g} {match['unit'] or ''}".strip()
