"""Workbooks (XLSX), read by openpyxl: the table of one sheet, with its heading."""

import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from chatter.io.formats.csv import table_of_lines
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.named_arrays import require_size
from chatter.io.table import Table, is_number
from dynamics.frf.container import MeasurementError

#: multiple of the rows of numbers of any other sheet from which a sheet is that of the record
_FAR_MORE = 10


def read_workbook(path: Path) -> Table:
    """Table of the one sheet that holds numbers; formulas as the values last computed.

    Rows are read as the lines of a text: names and units above the numbers, on one line or two.
    Of several sheets with numbers that one is read which has ten times as many rows as any other.
    MeasurementError if openpyxl is not installed, the file is no workbook, unpacks to too much, or
    none or several of its sheets hold numbers.
    """
    try:
        import openpyxl
    except ImportError as error:
        raise MeasurementError(
            f'{path}: workbooks are read with openpyxl: install "chatter[formats]"'
        ) from error
    try:
        with zipfile.ZipFile(path) as archive:
            require_size(path, float(sum(one.file_size for one in archive.infolist())))
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        try:
            sheets = {sheet.title: _lines(sheet) for sheet in book.worksheets}
        finally:
            book.close()
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no workbook that can be read: {error}") from error
    return table_of_lines(path, sheets[_sheet_of_record(path, sheets)])


def _sheet_of_record(path: Path, sheets: Mapping[str, Sequence[str]]) -> str:
    """Name of the one sheet with rows of numbers, or of that with far more than any other."""
    counts = {name: sum(map(_has_numbers, lines)) for name, lines in sheets.items()}
    filled = sorted((name for name in counts if counts[name]), key=lambda name: -counts[name])
    if not filled:
        raise MeasurementError(f"{path}: no sheet holds rows of numbers")
    if len(filled) > 1 and counts[filled[0]] < _FAR_MORE * counts[filled[1]]:
        names = ", ".join(name for name in sheets if counts[name])
        raise MeasurementError(
            f"{path}: {len(filled)} sheets hold rows of numbers ({names}); "
            "keep one, or save the sheet as CSV"
        )
    return filled[0]


def _lines(sheet: Any) -> list[str]:
    """Rows as lines of cells between tabs, blank ones to the left and right of all left out."""
    rows = [[_text(cell) for cell in row] for row in sheet.iter_rows(values_only=True)]
    first = min((k for row in rows for k, cell in enumerate(row) if cell), default=0)
    return ["\t".join(row[first:]).rstrip("\t") for row in rows]


def _text(cell: object) -> str:
    if isinstance(cell, float):
        return repr(cell)
    return "" if cell is None else " ".join(str(cell).split())


def _has_numbers(line: str) -> bool:
    cells = line.split("\t")
    # the text "0,25" is a number of a spreadsheet that has decimal commas
    return sum(is_number(cell.replace(",", ".")) for cell in cells) > 1


XLSX = Format(
    name="xlsx",
    label="workbook",
    help='one sheet with names and units above the numbers; needs "chatter[formats]"',
    extensions=(".xlsx", ".xlsm"),
    read_frfs=lambda path: frfs_of_table(read_workbook(path)),
    read_signals=read_workbook,
)
