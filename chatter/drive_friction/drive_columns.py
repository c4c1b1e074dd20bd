"""What the columns of a drive record are: position, velocity and effort, with their units.

A heading tells where it can; where it cannot, or tells two, the user states the column, and its
unit if the heading has none. The unit tells motor from slide: rad and N m, or m and N.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.description.units import dimension_of, measured_unit
from chatter.io.table import Table, split_heading
from chatter.io.trace_headings import (
    COMMANDED,
    DEVIATIONS,
    TIME,
    headings_of,
    plain_name,
    split_trace_heading,
    unit_of_trace,
)

Role = Literal["time", "position", "velocity", "effort"]
#: what a signal is by its unit: along the slide, about the motor, or before a constant is known
Kind = Literal["linear", "rotary", "current", "share"]

#: words of a heading that make it a role; the controls' own names stand beside the plain ones
_TOLD: Mapping[Role, re.Pattern[str]] = {
    "time": TIME,
    "position": re.compile(
        r"position|lageist|posizione|posici[oó]n|^(s|x|angle)$|^s ?(act|ist)|^pos\b"
    ),
    "velocity": re.compile(
        r"velocity|speed|drehzahl|geschwindigkeit|vitesse|velocit[aà]|velocidad|"
        r"^v$|^v ?(act|ist)|^n ?(act|ist)"
    ),
    "effort": re.compile(
        r"force|torque|effort|current|moment|strom|kraft|couple|courant|forza|coppia|corrente|fuerza|"
        r"^par\b|corriente|^i ?(act(ual)?|ist(wert)?|q)\b|^i\(q\)|^m ?(act|ist)"
    ),
}
#: words of what an axis was to do, which is not what it did
_DESIRED = re.compile(r"desired")
_EXAMPLES = {"position": "position [mm]", "velocity": "v act. X [mm/min]", "effort": "torque [N*m]"}
#: kind of a signal -> SI unit, and whether it is about an axis
_UNITS: Mapping[Role, Mapping[Kind, tuple[str, bool]]] = {
    "position": {"linear": ("m", False), "rotary": ("rad", True)},
    "velocity": {"linear": ("m/s", False), "rotary": ("rad/s", True)},
    "effort": {"linear": ("N", False), "rotary": ("N*m", False), "current": ("A", False)},
}


@dataclass(frozen=True)
class DriveSignal:
    """One signal of a record."""

    kind: Kind
    values: Array  # (n,), SI; a share of 1 is 100 %


def time_of(table: Table) -> Array:
    """Times (n,), s; InputError where no column tells them, or several do."""
    found = [
        index for index, name in enumerate(_names(table)) if _TOLD["time"].search(plain_name(name))
    ]
    if len(found) != 1:
        count = f"{len(found)} columns" if found else "no column"
        raise InputError(
            f"{table.path}: {count} of time; the columns are {headings_of(table)}; state them by "
            "--columns"
        )
    column = table.columns[found[0]]
    unit = measured_unit(split_trace_heading(column.heading)[1] or "s")
    if unit is None or unit.dimension != dimension_of("s"):
        raise InputError(f'{table.path}: "{column.heading}": a time is in s, ms or us')
    return unit.factor * table.numbers(found[0])


def signal_of(table: Table, role: Role, stated: str | None) -> DriveSignal | None:
    """Signal of a role: the column stated, or the one that its heading tells; None where none does.

    Parameters
    ----------
    table : Table
    role : str
        ``"position"``, ``"velocity"`` or ``"effort"``.
    stated : str, optional
        Heading of the column; a minus before it turns the sign, a unit behind it, in brackets,
        stands for that of the file.

    Raises
    ------
    InputError
        If no column, or more than one, is so headed, or the unit is none of the role.
    """
    if stated is None:
        index, unit, sign = _told(table, role), "", 1.0
        if index is None:
            return None
    else:
        index, unit, sign = _stated(table, role, stated)
    column = table.columns[index]
    unit = unit or split_trace_heading(column.heading)[1]
    kind, factor = _kind(table, role, column.heading, unit)
    return DriveSignal(kind, sign * factor * table.numbers(index))


def _told(table: Table, role: Role) -> int | None:
    names = [plain_name(name) for name in _names(table)]
    found = [
        index
        for index, name in enumerate(names)
        if _TOLD[role].search(name) and not _not_actual(name)
    ]
    exact = [index for index in found if names[index] in ("position", "velocity", "force")]
    found = exact if len(exact) == 1 else found
    if len(found) > 1:
        several = ", ".join(f'"{table.columns[index].heading}"' for index in found)
        raise InputError(
            f"{table.path}: {several} may each be the {role}; say which, such as "
            f'--{role} "{table.columns[found[0]].heading}"'
        )
    return found[0] if found else None


def _stated(table: Table, role: Role, stated: str) -> tuple[int, str, float]:
    text = stated.strip()
    sign = -1.0 if text.startswith("-") else 1.0
    text = text.removeprefix("-").strip()
    whole = [i for i, one in enumerate(table.columns) if one.heading.strip() == text]
    name, unit = (text, "") if whole else split_heading(text)
    found = whole or [
        i
        for i, one in enumerate(table.columns)
        if plain_name(name)
        in (plain_name(split_trace_heading(one.heading)[0]), plain_name(one.heading))
    ]
    if len(found) != 1:
        raise InputError(
            f'{table.path}: --{role} "{stated}": {len(found) or "no"} column'
            f"{'s are' if len(found) > 1 else ' is'} so headed; there are {headings_of(table)}"
        )
    return found[0], unit, sign


def _kind(table: Table, role: Role, heading: str, unit: str) -> tuple[Kind, float]:
    """What a signal is by its unit, and the factor to SI."""
    if role == "effort" and unit.strip() == "%":
        return "share", 0.01
    found = unit_of_trace(unit)
    if found is not None:
        for kind, (si, angular) in _UNITS[role].items():
            if found.dimension == dimension_of(si) and found.has_angle == angular:
                return kind, found.factor
    shown = f'has the unit "{unit}"' if unit else "has no unit"
    wanted = " or ".join(si for si, _ in _UNITS[role].values())
    bare = split_trace_heading(heading)[0]
    raise InputError(
        f'{table.path}: "{heading}" {shown}; {role} is in units of {wanted}; state it, such as '
        f'--{role} "{bare} [{split_heading(_EXAMPLES[role])[1]}]"'
    )


def _names(table: Table) -> list[str]:
    """Headings without their units."""
    return [split_trace_heading(column.heading)[0] for column in table.columns]


def _not_actual(name: str) -> bool:
    """Whether a name is of what is commanded, a deviation or a limit."""
    return any(words.search(name) for words in (COMMANDED, DEVIATIONS, _DESIRED))


def slide_travel_per_angle(lead: float) -> float:
    """Travel of the slide for an angle of the motor, m/rad, of that for a revolution, m."""
    return lead / (2.0 * math.pi)
