"""Tables of signals, whose headings the user states where the file does not name them."""

import re
from dataclasses import replace
from pathlib import Path

from chatter.io.formats.csv import CSV, read_table, read_with_headings
from chatter.io.formats.format import Format
from chatter.io.formats.format_list import format_of
from chatter.io.formats.records import record_of, stated_record
from chatter.io.sensitivities import with_sensitivities
from chatter.io.table import Table, table_of
from dynamics.frf.container import MeasurementError

#: commas that stand in no brackets
_COMMA = re.compile(r",(?![^\[]*\])")


def read_signal_table(path: Path, columns: str | None = None) -> Table:
    """Signals of a file of any format.

    Parameters
    ----------
    path : Path
        File; of a file that holds several records ``FILE#RECORD``, by name or number from 1.
    columns : str, optional
        Names and units of all columns in their order, such as
        ``"time [s], force [N], acceleration [m/s^2]"``, instead of those of the file; of volts the
        sensitivity of the sensor, ``"force [2.25 mV/N]"``; of a share of full scale, as sound files
        have, what full scale is, ``"force [250 N/FS]"``.

    Raises
    ------
    MeasurementError
        If the file cannot be read, holds several records, or has another number of columns.
    """
    one = format_of(path, "signals")
    if columns is None:
        return signals_of(one, path)
    headings = _headings(path, columns)
    if one is CSV:
        table = read_with_headings(path, headings)
        return with_sensitivities(table, _units_of_text(path, len(headings)))
    return _under(headings, signals_of(one, path), one.own_unit)


def read_signal_tables(path: Path, columns: str | None = None) -> list[Table]:
    """Signals of every record of a file, or of the one that the path names; see above."""
    one = format_of(path, "signals")
    if one.read_records is None or stated_record(path)[1]:
        return [read_signal_table(path, columns)]
    tables = one.read_records(path).values()
    if columns is None:
        return list(tables)
    return [_under(_headings(path, columns), table, one.own_unit) for table in tables]


def signals_of(one: Format, path: Path) -> Table:
    """Signals of a file of a format, or of the record of it that the path names."""
    file, record = stated_record(path)
    if not record:
        return one.read_signals(path)
    if one.read_records is None:
        raise MeasurementError(
            f"{file}: a file of this format ({one.label}) is one record; nothing in it is called "
            f"{record[:60]!r}"
        )
    return record_of(file, one.read_records(file), record)


def _headings(path: Path, columns: str) -> list[str]:
    headings = [" ".join(heading.split()) for heading in _COMMA.split(columns)]
    if not all(headings) or len(set(headings)) != len(headings):
        raise MeasurementError(
            f'{path}: --columns "{columns}" must name every column once, such as '
            '"time [s], force [N], acceleration [m/s^2]"'
        )
    return headings


def _under(headings: list[str], table: Table, own_unit: str) -> Table:
    """Table under stated headings, of a format whose signals have a unit of its own."""
    if len(headings) != len(table.columns):
        held = ", ".join(column.heading for column in table.columns)
        raise MeasurementError(
            f"{table.path}: --columns states {len(headings)} columns where the file has "
            f"{len(table.columns)}: {held}"
        )
    stated = [
        replace(column, heading=heading, content=None)
        for column, heading in zip(table.columns, headings, strict=True)
    ]
    under = table_of(table.path, stated, "columns")
    units = [column.unit or (own_unit if k else "") for k, column in enumerate(table.columns)]
    return with_sensitivities(under, units)


def _units_of_text(path: Path, count: int) -> list[str]:
    """Units that the heading of a table in text has; empty where it has none of so many columns."""
    try:
        units = [column.unit for column in read_table(path).columns]
    except MeasurementError:
        units = []
    return units if len(units) == count else [""] * count
