"""Sensors whose file has volts: the user states their sensitivity, as in "force [2.25 mV/N]"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from chatter.io.table import Column, Table
from dynamics.frf.container import MeasurementError

#: unit of a voltage as files write it -> V
VOLTS = {
    **dict.fromkeys(("V", "Volt", "Volts", "volt", "volts"), 1.0),
    **dict.fromkeys(("mV", "millivolts"), 1e-3),
    **dict.fromkeys(("uV", "\u00b5V", "\u03bcV"), 1e-6),
}
_SENSITIVITY = re.compile(
    r"(?P<number>\d+(\.\d*)?([eE][+-]?\d+)?)\s*(?P<unit>[^\s/]+)\s*/\s*(?P<per>.+)"
)


def with_sensitivities(table: Table, own_units: Sequence[str]) -> Table:
    """Table of which columns of volts are in the unit of their stated sensitivity.

    Parameters
    ----------
    table : Table
        Under stated headings.
    own_units : sequence of str
        Of the columns in the file; empty where it names none: a sensitivity is then of volts.

    Raises
    ------
    MeasurementError
        If a column of volts has another unit stated and no sensitivity, or a sensitivity is stated
        of what is no voltage.
    """
    columns = [
        _in_unit(table, index, own_unit.strip())
        for index, own_unit in zip(range(len(table.columns)), own_units, strict=True)
    ]
    return replace(table, columns=tuple(columns))


def _in_unit(table: Table, index: int, own_unit: str) -> Column:
    column = table.columns[index]
    found = _SENSITIVITY.fullmatch(column.unit.strip())
    if found is None:
        if own_unit in VOLTS and column.unit and column.unit not in VOLTS:
            raise MeasurementError(
                f"{table.path}: column {index + 1} is in {own_unit} in the file, and --columns "
                f"states {column.heading}: state the sensitivity of the sensor, such as "
                f'"{column.name} [2.5 {own_unit}/{column.unit}]"; 1 where it is in '
                f"{column.unit} already"
            )
        return column
    number, unit, per = float(found["number"]), found["unit"], found["per"].strip()
    per = per[1:-1] if per.startswith("(") and per.endswith(")") else per
    if unit not in VOLTS and per not in VOLTS:
        return column
    if (own_unit and own_unit not in VOLTS) or number == 0.0:
        raise MeasurementError(
            f"{table.path}: column {index + 1} is in {own_unit or 'V'} in the file, and --columns "
            f"states {column.heading}: a sensitivity above zero, of volts, was expected"
        )
    volts = table.numbers(index) * VOLTS[own_unit or "V"]
    if unit in VOLTS:
        return replace(
            column, heading=f"{column.name} [{per}]", cells=volts / (number * VOLTS[unit])
        )
    return replace(column, heading=f"{column.name} [{unit}]", cells=volts * number / VOLTS[per])
