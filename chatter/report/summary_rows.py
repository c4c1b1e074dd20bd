"""Rows of a table from the content of summary.json, whose keys end with the unit of their value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from chatter.description.unit_system import METRIC, UnitSystem

#: ends of keys, longest first, and the unit that is read
_UNITS = {
    "mm_per_min": "mm/min",
    "m_per_min": "m/min",
    "cm3_per_min": "cm^3/min",
    "m_per_N": "m/N",
    "per_s": "1/s",
    "percent": "%",
    "mm3": "mm^3",
    "rpm": "rpm",
    "deg": "deg",
    "mm": "mm",
    "um": "um",
    "us": "us",
    "Hz": "Hz",
    "Nm": "N m",
    "MB": "MB",
    "kg": "kg",
    "N": "N",
    "W": "W",
    "J": "J",
    "s": "s",
}
#: beginnings of the keys of roughness, which inches are too coarse for
_ROUGHNESS = ("Ra_", "Rz_")
#: told above the table
_TOLD_ELSEWHERE = frozenset({"title", "verdict", "reason"})
_MOST_ROWS = 24


def summary_rows(summary: Mapping[str, Any], units: UnitSystem = METRIC) -> list[tuple[str, str]]:
    """Names with units, and values of four digits, of what a summary holds that fits in a cell.

    Parameters
    ----------
    summary : mapping
        Content of summary.json; what is below the second level, lists and numbers without a unit
        are left out.
    units : UnitSystem
        That the table is in.
    """
    return list(_rows(summary, "", units))[:_MOST_ROWS]


def _rows(values: Mapping[str, Any], within: str, units: UnitSystem) -> Iterator[tuple[str, str]]:
    for key, value in values.items():
        if isinstance(value, Mapping):
            if not within:
                yield from _rows(value, f"{_in_words(key)}, ", units)
        elif key not in _TOLD_ELSEWHERE:
            yield from _row(key, value, within, units)


def _row(key: str, value: Any, within: str, units: UnitSystem) -> Iterator[tuple[str, str]]:
    if isinstance(value, bool):
        yield within + _in_words(key), "yes" if value else "no"
    elif isinstance(value, int):
        yield within + _in_words(key), str(value)
    elif isinstance(value, str) and value:
        yield within + _in_words(key), value
    elif isinstance(value, float):
        for end, unit in _UNITS.items():
            if key.endswith(f"_{end}"):
                name = _in_words(key.removesuffix(f"_{end}"))
                quantity = "roughness" if key.startswith(_ROUGHNESS) else ""
                read = units.instead_of(unit, quantity)
                yield f"{within}{name} [{read.name}]", f"{value * read.factor:.4g}"
                return


def _in_words(key: str) -> str:
    return key.replace("_", " ")
