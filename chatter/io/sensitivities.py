"""Sensors whose file has volts, or a share of full scale, as WAV files have: "FS".

The user states their sensitivity, as in "force [2.25 mV/N]" or "force [250 N/FS]".
"""

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
#: unit of what a recorder has as a share of its full scale
FULL_SCALE = "FS"
_SENSITIVITY = re.compile(
    r"(?P<number>\d+(\.\d*)?([eE][+-]?\d+)?)\s*(?P<unit>[^\s/]+)\s*/\s*(?P<per>.+)"
)


def with_sensitivities(table: Table, own_units: Sequence[str]) -> Table:
    """Table of which columns of volts, or of full scale, are in the unit of their sensitivity.

    Parameters
    ----------
    table : Table
        Under stated headings.
    own_units : sequence of str
        Of the columns in the file; empty where it names none: a sensitivity is then of volts.

    Raises
    ------
    MeasurementError
        If a column of volts or of full scale has another unit stated and no sensitivity, or a
        sensitivity is stated of what is neither.
    """
    columns = [
        _in_unit(table, index, own_unit.strip())
        for index, own_unit in zip(range(len(table.columns)), own_units, strict=True)
    ]
    return replace(table, columns=tuple(columns))


def _in_unit(table: Table, index: int, own_unit: str) -> Column:
    column = table.columns[index]
    found = _SENSITIVITY.fullmatch(column.unit.strip())
    scales = {FULL_SCALE: 1.0} if own_unit == FULL_SCALE else VOLTS
    if found is None:
        if own_unit == FULL_SCALE and column.unit not in ("", FULL_SCALE):
            raise MeasurementError(
                f"{table.path}: column {index + 1} is a share of full scale in the file, and "
                f"--columns states {column.heading}: state what full scale is, such as "
                f'"{column.name} [250 {column.unit}/{FULL_SCALE}]"; 1 where it is in '
                f"{column.unit} already"
            )
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
    known = {*VOLTS, FULL_SCALE}
    if unit not in known and per not in known:
        return column
    is_other = bool(own_unit) and own_unit not in scales
    if is_other or number == 0.0 or not {unit, per} & scales.keys():
        of = "full scale" if own_unit == FULL_SCALE else "volts"
        raise MeasurementError(
            f"{table.path}: column {index + 1} is in {own_unit or 'V'} in the file, and --columns "
            f"states {column.heading}: a sensitivity above zero, of {of}, was expected"
        )
    values = table.numbers(index) * scales[own_unit or "V"]
    if unit in scales:
        return replace(
            column, heading=f"{column.name} [{per}]", cells=values / (number * scales[unit])
        )
    return replace(column, heading=f"{column.name} [{unit}]", cells=values * number / scales[per])
