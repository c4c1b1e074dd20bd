"""Headings of traces that controls write: a name, and a unit in brackets or behind a slash."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from chatter.description.units import MeasuredUnit, measured_unit
from chatter.io.table import Column, Table, heading_of_name, split_heading

#: name of a column of time
TIME = re.compile(r"^(t|time|zeit|timestamp|temps|tempo|tiempo)\b")
#: words of what is commanded
COMMANDED = re.compile(
    r"command|\bcmd\b|set ?p|\bset\b|nominal|\bnom\b|soll|consign|comand|\breference\b"
)
#: words of deviations, limits and feedforward
DEVIATIONS = re.compile(
    r"err(eur|ore?)|\bdif|deviation|limit|forward|schlepp|abweich|grenz|vorsteuer|[eé]cart"
)
#: units of drives as their programs write them -> as the units library has them
_WRITTEN = {
    "nm": "N*m", "ncm": "N*cm", "r/min": "rpm", "1/min": "rpm", "u/min": "rpm",
    "min-1": "rpm", "min^-1": "rpm", "/min": "rpm", "aeff": "A", "arms": "A",
}  # fmt: skip
#: what a revolution is called in a unit, besides those that the units library knows
_COUNTS = ("1", "r", "u", "rev")
#: a unit behind an underscore; one letter might be an axis, but for the time
_BEHIND_A_STROKE = re.compile(
    r"(?P<name>.+?)_(?P<unit>mm_min|m_min|mm_s|m_s|mm|um|ms|us|rpm|Nm)|(?P<time>t|time|zeit)_s",
    re.IGNORECASE,
)
_OF_STROKES = {"mm_min": "mm/min", "m_min": "m/min", "mm_s": "mm/s", "m_s": "m/s"}
_IN_UNIT = re.compile(r"(?P<name>.+?)\s+in\s+(?P<unit>\S+)")
#: of time, position, velocity, speed, force, current and torque
_SYMBOLS = ("t", "s", "x", "v", "n", "F", "I", "i", "M")


def split_trace_heading(heading: str) -> tuple[str, str]:
    """Split a heading as `split_heading` does, and one with its unit behind a slash: ``"t/ms"``.

    A quotient stands for a value over its unit (ISO 80000-1): the unit is one that is known, and
    what stands before the slash is a symbol, or does not end in a unit itself, as in
    ``"feed mm/min"``. ``"X_cmd_mm"`` ends in a unit that is no axis.
    """
    name, unit = split_heading(heading)
    if not unit and (behind := _BEHIND_A_STROKE.fullmatch(name)):
        if behind["time"]:
            return behind["time"], "s"
        return behind["name"], _OF_STROKES.get(behind["unit"].lower(), behind["unit"])
    # "v/(mm/min)" is split before its bracket
    if unit:
        return name.removesuffix("/").strip(), unit
    before, _, behind = (part.strip() for part in name.rpartition("/"))
    if not before or unit_of_trace(behind) is None:
        return name, ""
    last = before.split()[-1]
    of_a_unit = last.lower() in _COUNTS or unit_of_trace(last) is not None
    return (name, "") if of_a_unit and before not in _SYMBOLS else (before, behind)


def with_units(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Columns whose units may stand behind a slash or a word: ``"Zeit/ms"``, ``"Force in N"``.

    Behind a stroke they are told where all columns have one: ``"time_s"`` and ``"force_N"``, while
    ``"sensor_A"`` may be the first of two.
    """
    found = tuple(map(_with_unit, columns))
    if any(one.unit or one.content for one in columns):
        return found
    stroked = tuple(replace(one, heading=heading_of_name(one.heading)) for one in found)
    return stroked if all(one.unit for one in stroked) else found


def _with_unit(column: Column) -> Column:
    if column.content is not None or (column.unit and not column.name.endswith("/")):
        return column
    name, unit = split_trace_heading(column.heading)
    if unit:
        return replace(column, heading=f"{name} [{unit}]")
    behind = _IN_UNIT.fullmatch(column.name)
    known = None if behind is None else unit_of_trace(behind["unit"])
    if known is not None and known.dimension:
        return replace(column, heading=f"{behind['name']} [{behind['unit']}]")
    return column


def unit_of_trace(text: str) -> MeasuredUnit | None:
    """Unit as it is written on controls; None where it is none."""
    compact = text.replace(" ", "")
    return measured_unit(_WRITTEN.get(compact.lower(), compact)) if compact else None


def plain_name(name: str) -> str:
    """Name in small letters, with blanks for dots and underscores."""
    return " ".join(re.sub(r"[._]+", " ", name.lower()).split())


def headings_of(table: Table) -> str:
    """Headings of a table, as messages list them."""
    return ", ".join(f'"{column.heading}"' for column in table.columns)
