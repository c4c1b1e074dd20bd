"""Values without a unit that are hardly in that of SI.

A spindle speed of 14000 may be in rpm or in rad/s, so that neither is taken; a power of 1.2 is no
1.2 W.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from pydantic import BaseModel

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.path import Step, field_at, join_path, leaves, parse_path


class _Units(NamedTuple):
    """Units that a bare number could have."""

    usual: str
    si: str
    below: float = math.inf  # a bare number below it is in the usual unit, one above it in SI

    def wanted(self, number: str) -> str:
        """What to write in the place of a number."""
        either = f', or "{number} {self.si}"' if math.isinf(self.below) else ""
        return f'write "{number} {self.usual}"{either}'


#: W: no spindle that mills has less
LEAST_POWER = 20.0
#: of a spindle speed, wherever it is, and of other keys
_OF_SPINDLE = _Units("rpm", "rad/s")
_OF_KEYS: dict[tuple[Step, ...], _Units] = {
    ("cut", "cutting_speed"): _Units("m/min", "m/s"),
    ("cut", "feed_rate"): _Units("mm/min", "m/s"),
    ("optimum", "max_power"): _Units("kW", "W", LEAST_POWER),
    # ten minutes: a life of so many seconds is none
    ("optimum", "min_tool_life"): _Units("min", "s", 600.0),
}


def refuse_bare_numbers(kind: type[BaseModel], data: Any, name: str) -> None:
    """Raise InputError where nested tables of a file give a speed of a cut as a bare number."""
    problems = [
        f"{name}: {join_path(steps)}: {formatted(value)} has no unit; "
        f"{units.wanted(formatted(value))}"
        for steps, value, units in _bare_numbers(kind, data)
    ]
    if problems:
        raise InputError(problems)


def give_bare_numbers_their_unit(kind: type[BaseModel], document: Any) -> None:
    """Write bare speeds of a cut in a document, which came from Python, with their unit."""
    for steps, value, units in list(_bare_numbers(kind, document)):
        table = document
        for step in steps[:-1]:
            table = table[step]
        table[steps[-1]] = f"{float(value)!r} {units.si}"


def refuse_bare_assignments(
    kind: type[BaseModel], values: Mapping[str, Any], option: str = "--set"
) -> None:
    """Raise InputError where an assignment of the command line gives a bare speed of a cut."""
    for path, value in values.items():
        try:
            steps = parse_path(path)
        except InputError:
            # told by the patch itself
            continue
        refuse_bare_numbers(kind, _nested(steps, value), option)


def _nested(steps: tuple[Step, ...], value: Any) -> Any:
    for step in reversed(steps):
        value = {step: value}
    return value


def _bare_numbers(
    kind: type[BaseModel], data: Any
) -> Iterator[tuple[tuple[Step, ...], float, _Units]]:
    """Path, value and possible units of each bare value that is hardly in SI, but zero."""
    for steps, value in leaves(data):
        if not isinstance(value, (int, float)) or isinstance(value, bool):
            continue
        units = _OF_SPINDLE if _is_spindle_speed(kind, steps) else _OF_KEYS.get(steps)
        if value != 0 and units is not None and value < units.below:
            yield steps, value, units


def _is_spindle_speed(kind: type[BaseModel], steps: tuple[Step, ...]) -> bool:
    field = field_at(kind, steps)
    return (
        field is not None
        and field.dimension == "angular_speed"
        and not getattr(field, "others", ())
    )
