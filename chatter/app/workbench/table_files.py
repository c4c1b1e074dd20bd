"""Tables of the page as CSV and XLSX, and as HTML."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

from chatter.description.errors import InputError
from chatter.io.result_tables import csv_of_rows
from chatter.studies.frf_units import frf_unit

_SHOWN_ROWS = 60


class PageTable(NamedTuple):
    """Headings with units, and rows of texts and numbers."""

    headings: Sequence[str]
    rows: Sequence[Sequence[Any]]


def table_of(path: Path) -> PageTable:
    """Read a table that a result has written; FRFs in the units in which people read them."""
    with path.open(encoding="utf-8", newline="") as lines:
        headings, *rows = list(csv.reader(lines)) or [[]]
    read = [_heading_read(one) for one in headings]
    factors = [factor for _, factor in read]
    return PageTable(
        [heading for heading, _ in read],
        [
            [
                factor * value if isinstance(value, float) else value
                for value, factor in zip(map(_number, row), factors, strict=False)
            ]
            for row in rows
        ],
    )


def _heading_read(heading: str) -> tuple[str, float]:
    """Heading "name [unit]" with the unit in which it is read, and the number of it in its own."""
    name, bracket, unit = heading.partition(" [")
    if not bracket or not unit.endswith("]"):
        return heading, 1.0
    shown, factor = frf_unit(unit[:-1])
    return f"{name} [{shown}]", factor


def as_csv(table: PageTable) -> io.StringIO:
    """Return the table as CSV."""
    rows = [[_text(cell) for cell in row] for row in table.rows]
    return io.StringIO(csv_of_rows([list(table.headings), *rows]))


def as_xlsx(table: PageTable) -> io.BytesIO:
    """Return the table as a workbook; InputError if openpyxl is not installed."""
    try:
        import openpyxl
    except ImportError:
        raise InputError("XLSX requires openpyxl: pip install 'chatter[formats]'") from None
    book = openpyxl.Workbook(write_only=True)
    sheet = book.create_sheet("table")
    sheet.append([_inert(cell) for cell in table.headings])
    for row in table.rows:
        sheet.append([None if cell != cell else _inert(cell) for cell in row])
    content = io.BytesIO()
    book.save(content)
    content.seek(0)
    return content


def as_html(table: PageTable) -> str:
    """Return the first rows as HTML; all texts are escaped."""
    head = "".join(f"<th>{escape(str(one))}</th>" for one in table.headings)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(_short(cell))}</td>' for cell in row)}</tr>"
        for row in table.rows[:_SHOWN_ROWS]
    )
    more = len(table.rows) - _SHOWN_ROWS
    rest = f"<p>{more} more rows are in the file</p>" if more > 0 else ""
    return f'<table class="chatter-table"><thead><tr>{head}</tr></thead>{body}</table>{rest}'


def _number(cell: str) -> Any:
    try:
        return float(cell)
    except ValueError:
        return cell


def _text(cell: Any) -> str:
    return (
        ""
        if cell is None or cell != cell
        else f"{cell:.9g}"
        if isinstance(cell, float)
        else str(cell)
    )


def _short(cell: Any) -> str:
    return (
        ""
        if cell is None or cell != cell
        else f"{cell:.4g}"
        if isinstance(cell, float)
        else str(cell)
    )


def _inert(cell: Any) -> Any:
    """Text that a spreadsheet takes for a formula, made one that it does not."""
    return f"'{cell}" if isinstance(cell, str) and cell[:1] in "=+-@" else cell
