"""Spindle speeds without a unit: 14000 may be in rpm or in rad/s, so that neither is taken."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.path import Step, field_at, join_path, parse_path

_SPEED = "angular_speed"


def refuse_bare_speeds(kind: type[BaseModel], data: Any, name: str) -> None:
    """Raise InputError where nested tables of a file give a spindle speed as a bare number."""
    problems = [
        f"{name}: {join_path(steps)}: {formatted(value)} has no unit; "
        f'write "{formatted(value)} rpm", or "{formatted(value)} rad/s"'
        for steps, value in _numbers(data, ())
        if value != 0 and _is_speed(kind, steps)
    ]
    if problems:
        raise InputError(problems)


def give_speeds_their_unit(kind: type[BaseModel], document: Any) -> None:
    """Write bare spindle speeds of a document, which came from Python, with their unit."""
    for steps, value in list(_numbers(document, ())):
        if value != 0 and _is_speed(kind, steps):
            table = document
            for step in steps[:-1]:
                table = table[step]
            table[steps[-1]] = f"{float(value)!r} rad/s"


def refuse_bare_speed_assignments(
    kind: type[BaseModel], values: Mapping[str, Any], option: str = "--set"
) -> None:
    """Raise InputError where an assignment of the command line gives a bare spindle speed."""
    for path, value in values.items():
        try:
            steps = parse_path(path)
        except InputError:
            # told by the patch itself
            continue
        refuse_bare_speeds(kind, _nested(steps, value), option)


def _nested(steps: tuple[Step, ...], value: Any) -> Any:
    for step in reversed(steps):
        value = {step: value}
    return value


def _numbers(item: Any, steps: tuple[Step, ...]) -> Iterator[tuple[tuple[Step, ...], float]]:
    if isinstance(item, Mapping):
        for key, value in item.items():
            yield from _numbers(value, (*steps, key))
    elif isinstance(item, list):
        for index, value in enumerate(item):
            yield from _numbers(value, (*steps, index))
    elif isinstance(item, (int, float)) and not isinstance(item, bool):
        yield steps, item


def _is_speed(kind: type[BaseModel], steps: tuple[Step, ...]) -> bool:
    field = field_at(kind, steps)
    return field is not None and field.dimension == _SPEED and not getattr(field, "others", ())
