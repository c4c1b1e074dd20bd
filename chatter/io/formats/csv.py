"""Tables in text: comma, semicolon, tab or space separated, names and units in the heading."""

import csv
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from chatter.description.units import measured_unit
from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.node_table import read_nodes
from chatter.io.formats.number_marks import with_plain_numbers
from chatter.io.formats.stated_rate import is_over_time_or_frequency, stated_step
from chatter.io.table import Column, Table, is_number, split_heading
from chatter.io.time_stamps import is_time_stamp, seconds_of
from dynamics.frf.container import MeasurementError

_COMMENT = ("#", "%", "//", "!")
#: lines in which numbers may stand above a heading
_LINES_ABOVE = 200
_DATE = re.compile(r"[0-9]{1,4}[-./][0-9]{1,2}[-./][0-9]{1,4}")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+(,\d+)?([eE][+-]?\d+)?")
#: a whole number with its thousands in groups, which may be one with a decimal comma
_GROUPS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")


def read_table(path: Path) -> Table:
    """Read a table with a heading line.

    Separators may be comma, semicolon, tab or spaces; where it is not the comma, a decimal comma
    is understood. Lines that begin with ``#``, ``%``, ``!`` or ``//`` are comments; the last of
    them may be the heading. Cells may be words.

    MeasurementError if the file is not text, has no rows of numbers, no heading, or a row with too
    few or too many cells; the message names file and line.
    """
    return table_of_lines(path, read_lines(path))


def table_of_lines(path: Path, lines: Sequence[str]) -> Table:
    """Table of the lines of a text, as `read_table`."""
    lines = with_plain_numbers(path, lines)
    for first in _first_rows(path, lines):
        separator = _separator(lines[first])
        headings, begin = _headings(lines[:first], separator, _cells(lines[first], separator))
        if headings:
            break
    else:
        raise MeasurementError(
            f"{path}: no heading with names and units above the numbers; the first line must be "
            'like "frequency [Hz],real [m/N],imag [m/N]" or "time [s],force [N]"; or state them: '
            '--columns "time [s], force [N], acceleration [m/s^2]"'
        )
    rows, numbers = [], []
    for index in range(begin, len(lines)):
        if not lines[index].strip() or _is_comment(lines[index]):
            continue
        row = _without_ends(_cells(lines[index], separator), len(headings))
        if len(row) != len(headings):
            if index < first:
                continue
            if _are_words(lines[index:]):
                break
            raise MeasurementError(
                f"{path}: line {index + 1} has {len(row)} columns where the heading has "
                f"{len(headings)}: {lines[index].strip()[:60]!r}"
            )
        rows.append(row)
        numbers.append(index + 1)
    return _table(path, headings, rows, numbers, lines[:begin])


def _are_words(lines: Sequence[str]) -> bool:
    """Whether no line holds a number in a cell of its own, as below the last row of a record."""
    words = (word for line in lines for word in re.split(r"[\s;,]+", line))
    return not any(is_number(word) for word in words if word)


def _table(
    path: Path,
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    lines: Sequence[int],
    above: Sequence[str],
) -> Table:
    """Table of rows, with decimal points and with times of day as seconds since the first.

    Where no column is a time, it is that of the sampling rate which the lines above state.
    """
    columns = []
    each = list(zip(*_with_points(rows), strict=True))
    headings, each = _with_dates_in_times(list(headings), each)
    for heading, cells in zip(headings, each, strict=True):
        if not heading and not any(cell.strip() for cell in cells):
            continue
        seconds = seconds_of(cells) if is_time_stamp(cells[0]) else None
        is_time = seconds is not None
        columns.append(Column("time [s]" if is_time else heading, seconds if is_time else cells))
    step = stated_step(above)
    if step is not None and not any(is_over_time_or_frequency(one.heading) for one in columns):
        columns.insert(0, Column("time [s]", step * np.arange(len(rows))))
    return Table(path, tuple(columns), lines)


def _with_dates_in_times(
    headings: list[str], columns: list[Sequence[str]]
) -> tuple[list[str], list[Sequence[str]]]:
    """Columns of which one of dates, beside one of times of day, is joined to that."""
    for k in range(len(columns) - 1):
        if _DATE.fullmatch(columns[k][0].strip()) and is_time_stamp(columns[k + 1][0]):
            joined = [" ".join(pair) for pair in zip(columns[k], columns[k + 1], strict=True)]
            return headings[:k] + headings[k + 1 :], [*columns[:k], joined, *columns[k + 2 :]]
    return headings, columns


def _with_points(rows: Sequence[Sequence[str]]) -> Sequence[Sequence[str]]:
    """Decimal commas of cells in quotes as points: "1,234" is 1.234 where another says so."""
    with_comma = {cell for row in rows for cell in row if "," in cell and _is_comma_number(cell)}
    if all(_GROUPS.fullmatch(cell.strip()) for cell in with_comma):
        return rows
    return [[cell.replace(",", ".") if cell in with_comma else cell for cell in r] for r in rows]


def _is_comma_number(cell: str) -> bool:
    return _DECIMAL_COMMA.fullmatch(cell.strip()) is not None


def read_with_headings(path: Path, headings: Sequence[str]) -> Table:
    """Read the rows of numbers of a text, whose headings are stated.

    Lines above the first row are passed over. MeasurementError if there is no row, or one has
    another number of cells than there are headings.
    """
    lines = with_plain_numbers(path, read_lines(path))
    starts = list(_first_rows(path, lines))
    fitting = (
        index
        for index in starts
        if len(_row_of(lines[index], _separator(lines[index]), len(headings))) == len(headings)
    )
    first = next(fitting, starts[0])
    separator = _separator(lines[first])
    rows, numbers = [], []
    for index in range(first, len(lines)):
        if not lines[index].strip() or _is_comment(lines[index]):
            continue
        row = _row_of(lines[index], separator, len(headings))
        if len(row) != len(headings):
            raise MeasurementError(
                f"{path}: line {index + 1} has {len(row)} columns where --columns states "
                f"{len(headings)}: {lines[index].strip()[:60]!r}"
            )
        rows.append(row)
        numbers.append(index + 1)
    return _table(path, headings, rows, numbers, lines[:first])


def _row_of(line: str, separator: str | None, count: int) -> list[str]:
    """Cells of a row of so many columns."""
    return _without_ends(_cells(line.strip() if separator is None else line, separator), count)


def _without_ends(row: list[str], count: int) -> list[str]:
    """Row without blank cells behind so many: separators at the end of a line."""
    while len(row) > count and not row[-1].strip():
        row.pop()
    return row


def _first_rows(path: Path, lines: Sequence[str]) -> Iterator[int]:
    """First row of numbers, and further down each that has another number of cells.

    Lines of numbers may stand above a heading. MeasurementError if there is no row.
    """
    first = _first_row(lines)
    if first is None:
        raise MeasurementError(f"{path}: no line of numbers; the file is text only")
    yield first
    count = len(_cells(lines[first], _separator(lines[first])))
    for index in range(first + 1, min(len(lines), first + _LINES_ABOVE)):
        cells = _cells(lines[index], _separator(lines[index]))
        if len(cells) != count and cells and is_number(cells[0]):
            count = len(cells)
            yield index


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENT)


def _separator(line: str) -> str | None:
    """Separator of a line of numbers; None for white space."""
    words = line.split()
    if len(words) > 1 and all(_DECIMAL_COMMA.fullmatch(word) for word in words):
        return None
    return next((one for one in (";", "\t", ",") if one in line.strip()), None)


def _cells(line: str, separator: str | None) -> list[str]:
    """Cells of a line of numbers, with decimal points."""
    if separator != ",":
        line = line.replace(",", ".")
    if separator is None:
        return line.split()
    if '"' in line:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    return line.split(separator)


def _first_row(lines: Sequence[str]) -> int | None:
    """First line that begins with a number, else the first with a number in it."""
    with_numbers = None
    for index, line in enumerate(lines):
        if not line.strip() or _is_comment(line):
            continue
        cells = _cells(line, _separator(line))
        are_numbers = [is_number(cell) or _is_comma_number(cell) for cell in cells]
        are_numbers[0] = are_numbers[0] or is_time_stamp(cells[0])
        if are_numbers[0]:
            return index
        if with_numbers is None and any(are_numbers):
            with_numbers = index
    return with_numbers


def _headings(
    lines: Sequence[str], separator: str | None, row: Sequence[str]
) -> tuple[list[str], int]:
    """Headings among the lines above the first row, and the line on which rows may begin."""
    counts = range(len(_without_ends(list(row), 1)), len(row) + 1)
    for are_comments in (False, True):
        found = [
            (cells, index)
            for cells, index in _candidates(lines, separator, len(row))
            if len(cells) in counts and (are_comments or not _is_comment(lines[index]))
        ]
        if not found:
            continue
        headings, index = found[-1]
        if len(found) > 1 and _are_units(headings):
            # names on one line, units on the next
            pairs = zip(found[-2][0], headings, strict=True)
            headings = [_with_unit(name, unit) for name, unit in pairs]
        return _filled_from_above(headings, lines[:index], separator), index + 1
    return [], len(lines)


def _are_units(cells: Sequence[str]) -> bool:
    """Whether a line is the units of the names on the one before it: in brackets, or known."""
    if any("[" in cell or "(" in cell for cell in cells):
        return all(cell == "-" or _in_brackets(cell) is not None for cell in cells if cell)
    units = [cell for cell in cells if cell not in ("", "1", "-", "%")]
    known = sum(measured_unit(cell) is not None for cell in units)
    return 2 * known >= len(units) and not is_over_time_or_frequency(f"{cells[0]} [1]")


def _in_brackets(cell: str) -> str | None:
    """What stands in the brackets around a cell; None where they are not around all of it."""
    name, unit = split_heading(f"in {cell}")
    return unit if name == "in" and cell.endswith(("]", ")")) else None


def _filled_from_above(
    headings: list[str], above: Sequence[str], separator: str | None
) -> list[str]:
    """Blank headings by the next one above them, as of cells that were merged downwards."""
    if separator is None or all(headings):
        return headings
    rows = [_cells(line, separator) for line in reversed(above)]
    return [
        heading or next((row[k].strip() for row in rows if k < len(row) and row[k].strip()), "")
        for k, heading in enumerate(headings)
    ]


def _with_unit(name: str, unit: str) -> str:
    unit = unit.strip('" ')
    within = _in_brackets(unit)
    unit = unit if within is None else within
    return f"{name.strip(chr(34) + ' ')} [{unit}]"


def _candidates(
    lines: Sequence[str], separator: str | None, count: int
) -> Iterator[tuple[list[str], int]]:
    """Cells and number of every line that may be a heading; the unit "1" is one."""
    for index, line in enumerate(lines):
        if line.strip():
            cells = _heading_cells(line, separator, count)
            if cells and not any(is_number(cell) and cell != "1" for cell in cells):
                yield cells, index


def _heading_cells(line: str, separator: str | None, count: int) -> list[str]:
    line = line.lstrip(" ").lstrip("#%!/").strip(None if separator is None else " \r\n")
    if separator is None or separator not in line:
        separator = _separator(re.sub(r"\[[^\]]*\]", "", line))
    if separator is not None:
        cells = [cell.strip().strip('"') for cell in line.rstrip(separator).split(separator)]
        return [cell for cell in cells if cell] if len(cells) > count else cells
    cells = re.findall(r"[^\[\]]+\[[^\]]*\]|\S+", line) if "[" in line else line.split()
    return [cell.strip() for cell in cells] if len(cells) == count else []


CSV = Format(
    name="csv",
    label="table in text",
    help="name and unit of every column in the heading; comma, semicolon, tab or spaces between "
    "columns; with any of the last three also decimal commas",
    extensions=(".csv", ".txt", ".tsv", ".dat", ".asc"),
    read_frfs=lambda path: frfs_of_table(read_table(path)),
    read_signals=read_table,
    read_nodes=read_nodes,
)
