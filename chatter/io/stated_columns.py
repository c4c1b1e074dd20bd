"""Tables of signals, whose headings the user states where the file does not name them."""

import re
from dataclasses import replace
from pathlib import Path

from chatter.io.formats.csv import CSV, read_with_headings
from chatter.io.formats.format_list import format_of
from chatter.io.table import Table, table_of
from dynamics.frf.container import MeasurementError

#: commas that stand in no brackets
_COMMA = re.compile(r",(?![^\[]*\])")


def read_signal_table(path: Path, columns: str | None = None) -> Table:
    """Signals of a file of any format.

    Parameters
    ----------
    path : Path
    columns : str, optional
        Names and units of all columns in their order, such as
        ``"time [s], force [N], acceleration [m/s^2]"``, instead of those of the file.

    Raises
    ------
    MeasurementError
        If the file cannot be read, or has another number of columns.
    """
    one = format_of(path, "signals")
    if columns is None:
        return one.read_signals(path)
    headings = [" ".join(heading.split()) for heading in _COMMA.split(columns)]
    if not all(headings) or len(set(headings)) != len(headings):
        raise MeasurementError(
            f'{path}: --columns "{columns}" must name every column once, such as '
            '"time [s], force [N], acceleration [m/s^2]"'
        )
    if one is CSV:
        return read_with_headings(path, headings)
    table = one.read_signals(path)
    if len(headings) != len(table.columns):
        held = ", ".join(column.heading for column in table.columns)
        raise MeasurementError(
            f"{path}: --columns states {len(headings)} columns where the file has "
            f"{len(table.columns)}: {held}"
        )
    stated = [
        replace(column, heading=heading, content=None)
        for column, heading in zip(table.columns, headings, strict=True)
    ]
    return table_of(path, stated, "columns")
