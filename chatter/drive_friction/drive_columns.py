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
from chatter.description.units import MeasuredUnit, dimension_of, measured_unit
from chatter.io.table import Table, split_heading

Role = Literal["time", "position", "velocity", "effort"]
#: what a signal is by its unit: along the slide, about the motor, or before a constant is known
Kind = Literal["linear", "rotary", "current", "share"]

#: words of a heading that make it a role; the controls' own names stand beside the plain ones
_TOLD: Mapping[Role, re.Pattern[str]] = {
    "time": re.compile(r"^(t|time|zeit|timestamp|temps|tempo|tiempo)\b"),
    "position": re.compile(
        r"position|lageist|posizione|posici[oó]n|^(s|x|angle)$|^s ?(act|ist)|^pos\b"
    ),
    "velocity": re.compile(
        r"velocity|speed|drehzahl|geschwindigkeit|vitesse|velocit[aà]|velocidad|"
        r"^v$|^v ?(act|ist)|^n ?(act|ist)"
    ),
    "effort": re.compile(
        r"force|torque|current|moment|strom|kraft|couple|courant|forza|coppia|corrente|fuerza|"
        r"^par\b|corriente|^i ?(act(ual)?|ist(wert)?|q)\b|^i\(q\)|^m ?(act|ist)"
    ),
}
#: words of what is commanded, left over or limited, which is not what the axis did
_NOT_ACTUAL = re.compile(
    r"command|set ?p|\bset\b|nominal|\bnom\b|soll|error|\bdif|deviation|limit|forward|desired|"
    r"schlepp|abweich|grenz|vorsteuer|consign|nominale|comand|err(eur|ore)|[eé]cart"
)
_EXAMPLES = {"position": "position [mm]", "velocity": "v act. X [mm/min]", "effort": "torque [N*m]"}
#: units of drives as their programs write them -> as the units library has them
_WRITTEN = {
    "nm": "N*m", "ncm": "N*cm", "r/min": "rpm", "1/min": "rpm", "u/min": "rpm",
    "min-1": "rpm", "min^-1": "rpm", "/min": "rpm", "aeff": "A", "arms": "A",
}  # fmt: skip
#: what a revolution is called in a unit, besides those that the units library knows
_COUNTS = ("1", "r", "u", "rev")
#: of time, position, velocity, speed, force, current and torque
_SYMBOLS = ("t", "s", "x", "v", "n", "F", "I", "i", "M")
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


def split_drive_heading(heading: str) -> tuple[str, str]:
    """Split a heading as `split_heading` does, and one with its unit behind a slash: ``"t/ms"``.

    A quotient stands for a value over its unit (ISO 80000-1): the unit is one that is known, and
    what stands before the slash is a symbol, or does not end in a unit itself, as in
    ``"feed mm/min"``.
    """
    name, unit = split_heading(heading)
    # "v/(mm/min)" is split before its bracket
    if unit:
        return name.removesuffix("/").strip(), unit
    before, _, behind = (part.strip() for part in name.rpartition("/"))
    if not before or _unit(behind) is None:
        return name, ""
    last = before.split()[-1]
    of_a_unit = last.lower() in _COUNTS or _unit(last) is not None
    return (name, "") if of_a_unit and before not in _SYMBOLS else (before, behind)


def _unit(text: str) -> MeasuredUnit | None:
    """Unit as it is written on controls; None where it is none."""
    compact = text.replace(" ", "")
    return measured_unit(_WRITTEN.get(compact.lower(), compact)) if compact else None


def time_of(table: Table) -> Array:
    """Times (n,), s; InputError where no column tells them, or several do."""
    found = [
        index for index, name in enumerate(_names(table)) if _TOLD["time"].search(_plain(name))
    ]
    if len(found) != 1:
        count = f"{len(found)} columns" if found else "no column"
        raise InputError(
            f"{table.path}: {count} of time; the columns are {_headings(table)}; state them by "
            "--columns"
        )
    column = table.columns[found[0]]
    unit = measured_unit(split_drive_heading(column.heading)[1] or "s")
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
    unit = unit or split_drive_heading(column.heading)[1]
    kind, factor = _kind(table, role, column.heading, unit)
    return DriveSignal(kind, sign * factor * table.numbers(index))


def _told(table: Table, role: Role) -> int | None:
    names = [_plain(name) for name in _names(table)]
    found = [
        index
        for index, name in enumerate(names)
        if _TOLD[role].search(name) and not _NOT_ACTUAL.search(name)
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
        if _plain(name) in (_plain(split_drive_heading(one.heading)[0]), _plain(one.heading))
    ]
    if len(found) != 1:
        raise InputError(
            f'{table.path}: --{role} "{stated}": {len(found) or "no"} column'
            f"{'s are' if len(found) > 1 else ' is'} so headed; there are {_headings(table)}"
        )
    return found[0], unit, sign


def _kind(table: Table, role: Role, heading: str, unit: str) -> tuple[Kind, float]:
    """What a signal is by its unit, and the factor to SI."""
    if role == "effort" and unit.strip() == "%":
        return "share", 0.01
    found = _unit(unit)
    if found is not None:
        for kind, (si, angular) in _UNITS[role].items():
            if found.dimension == dimension_of(si) and found.has_angle == angular:
                return kind, found.factor
    shown = f'has the unit "{unit}"' if unit else "has no unit"
    wanted = " or ".join(si for si, _ in _UNITS[role].values())
    bare = split_drive_heading(heading)[0]
    raise InputError(
        f'{table.path}: "{heading}" {shown}; {role} is in units of {wanted}; state it, such as '
        f'--{role} "{bare} [{split_heading(_EXAMPLES[role])[1]}]"'
    )


def _names(table: Table) -> list[str]:
    """Headings without their units."""
    return [split_drive_heading(column.heading)[0] for column in table.columns]


def _headings(table: Table) -> str:
    return ", ".join(f'"{column.heading}"' for column in table.columns)


def _plain(name: str) -> str:
    return " ".join(re.sub(r"[._]+", " ", name.lower()).split())


def slide_travel_per_angle(lead: float) -> float:
    """Travel of the slide for an angle of the motor, m/rad, of that for a revolution, m."""
    return lead / (2.0 * math.pi)
