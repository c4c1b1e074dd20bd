"""Workbooks (XLSX), read by openpyxl: the table of a sheet, with its heading."""

import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from chatter.io.formats.csv import table_of_lines
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_tables
from chatter.io.formats.named_arrays import require_size
from chatter.io.formats.records import Tables, of_file, only_record
from chatter.io.table import Table, is_number
from dynamics.frf.container import MeasurementError

#: multiple of the rows of numbers of any other sheet from which a sheet is that of the record
_FAR_MORE = 10
#: what rows and cells take, bytes, and the longest text of a cell that Excel has
_BYTES_OF_ROW, _BYTES_OF_CELL, _LONGEST_TEXT = 128, 8, 32_767


def read_sheets(path: Path) -> Tables:
    """Tables of the sheets that hold numbers; formulas as the values last computed.

    Rows are read as the lines of a text: names and units above the numbers, on one line or two.
    Where one sheet has ten times as many rows of numbers as any other it is the only record.
    MeasurementError if openpyxl is not installed, the file is no workbook, unpacks to too much, or
    no sheet holds a table of numbers.
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
            size = _Size(path)
            sheets = {sheet.title: _lines(sheet, size) for sheet in book.worksheets}
        finally:
            book.close()
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no workbook that can be read: {error}") from error
    return of_file(path, _tables(path, sheets, _sheets_of_records(path, sheets)))


def _tables(
    path: Path, sheets: Mapping[str, Sequence[str]], names: Sequence[str]
) -> dict[str, Table]:
    """Tables of sheets by name; a few numbers that are no table are notes and passed over.

    MeasurementError where a sheet with as many rows as a record is none, as it may be one.
    """
    rows = {name: _rows_of_numbers(sheets[name]) for name in names}
    found: dict[str, Table] = {}
    for name in names:
        try:
            found[name] = table_of_lines(path, sheets[name])
        except MeasurementError as error:
            if _FAR_MORE * rows[name] > max(rows.values()):
                reason = str(error).removeprefix(f"{path}: ")
                where = f"{path}: sheet {name}" if len(names) > 1 else str(path)
                raise MeasurementError(f"{where}: {reason}") from error
    return found


def _sheets_of_records(path: Path, sheets: Mapping[str, Sequence[str]]) -> list[str]:
    """Names of the sheets with rows of numbers, or of that with far more than any other."""
    counts = {name: _rows_of_numbers(lines) for name, lines in sheets.items()}
    filled = [name for name in counts if counts[name]]
    if not filled:
        raise MeasurementError(f"{path}: no sheet holds rows of numbers")
    longest = max(filled, key=lambda name: counts[name])
    others = max((counts[name] for name in filled if name != longest), default=0)
    return [longest] if counts[longest] >= _FAR_MORE * others else filled


class _Size:
    """Bytes of the rows read so far: one cell in a far corner makes rows and columns up to it."""

    def __init__(self, path: Path) -> None:
        self._path, self._bytes = path, 0

    def add(self, row: Sequence[str]) -> Sequence[str]:
        """The row, counted."""
        self._bytes += _BYTES_OF_ROW + _BYTES_OF_CELL * len(row) + sum(map(len, row))
        require_size(self._path, float(self._bytes))
        return row


def _lines(sheet: Any, size: _Size) -> list[str]:
    """Rows as lines of cells between tabs, blank ones to the left and right of all left out."""
    # rows are as long as they are, not as wide as the sheet says of itself
    sheet.reset_dimensions()
    cells = sheet.iter_rows(values_only=True)
    rows = [size.add([_text(cell) for cell in row]) for row in cells]
    first = min((k for row in rows for k, cell in enumerate(row) if cell), default=0)
    return ["\t".join(row[first:]).rstrip("\t") for row in rows]


def _text(cell: object) -> str:
    if isinstance(cell, float):
        return repr(cell)
    return "" if cell is None else " ".join(str(cell)[:_LONGEST_TEXT].split())


def _rows_of_numbers(lines: Sequence[str]) -> int:
    return sum(map(_has_numbers, lines))


def _has_numbers(line: str) -> bool:
    cells = line.split("\t")
    # the text "0,25" is a number of a spreadsheet that has decimal commas
    return sum(is_number(cell.replace(",", ".")) for cell in cells) > 1


XLSX = Format(
    name="xlsx",
    label="workbook",
    help='sheets with names and units above the numbers, a record each; needs "chatter[formats]"',
    extensions=(".xlsx", ".xlsm"),
    read_frfs=lambda path: frfs_of_tables(read_sheets(path)),
    read_signals=only_record(read_sheets),
    read_records=read_sheets,
)
