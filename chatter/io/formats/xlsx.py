"""Workbooks (XLSX), read by openpyxl: the table of one sheet, with its heading."""

import zipfile
from pathlib import Path
from typing import Any

from chatter.io.formats.csv import table_of_lines
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.named_arrays import require_size
from chatter.io.table import Table, is_number
from dynamics.frf.container import MeasurementError


def read_workbook(path: Path) -> Table:
    """Table of the one sheet that holds numbers; formulas as the values last computed.

    Rows are read as the lines of a text: names and units above the numbers, on one line or two.
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
    filled = {name: lines for name, lines in sheets.items() if any(map(_has_numbers, lines))}
    if len(filled) != 1:
        raise MeasurementError(
            f"{path}: {len(filled)} sheets hold rows of numbers ({', '.join(filled) or 'none'}); "
            "keep one, or save the sheet as CSV"
        )
    return table_of_lines(path, next(iter(filled.values())))


def _lines(sheet: Any) -> list[str]:
    """Rows as lines of cells between tabs, the blank ones at the right left out."""
    return [
        "\t".join(_text(cell) for cell in row).rstrip("\t")
        for row in sheet.iter_rows(values_only=True)
    ]


def _text(cell: object) -> str:
    if isinstance(cell, float):
        return repr(cell)
    return "" if cell is None else " ".join(str(cell).split())


def _has_numbers(line: str) -> bool:
    cells = line.split("\t")
    return sum(is_number(cell) for cell in cells) > 1


XLSX = Format(
    name="xlsx",
    label="workbook",
    help='one sheet with names and units above the numbers; needs "chatter[formats]"',
    extensions=(".xlsx", ".xlsm"),
    read_frfs=lambda path: frfs_of_table(read_workbook(path)),
    read_signals=read_workbook,
)
