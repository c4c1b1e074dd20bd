"""XLSX of an operator's sheet."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from chatter.description.errors import InputError
from chatter.operator_sheet.cuts import CaseCuts

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

HEADERS = (
    "case", "cut", "verdict", "spindle speed [rpm]", "cutting speed [m/min]", "axial depth [mm]",
    "width of cut [mm]", "feed per tooth [mm]", "feed rate [mm/min]", "limit [mm]", "margin [%]",
    "removal rate [cm^3/min]",
)  # fmt: skip
_WIDTH_OF_COLUMN = 14


def workbook_of(cases: Sequence[CaseCuts]) -> bytes:
    """Workbook with a table of the cuts of all cases, and the limits of each over speed.

    InputError if openpyxl is not installed.
    """
    try:
        import openpyxl
    except ImportError as error:
        raise InputError(
            'sheet.xlsx needs openpyxl; install the extra "formats": pip install "chatter[formats]"'
        ) from error
    book = openpyxl.Workbook()
    table = book.active
    table.title = "cuts"
    _append(table, HEADERS)
    for one in cases:
        for row in rows_of(one):
            _append(table, row)
    for place, one in enumerate(cases, start=1):
        _append_limits(book.create_sheet(f"limits {place}"), one)
    for worksheet in book.worksheets:
        worksheet.freeze_panes = "A2"
        for column in worksheet.columns:
            worksheet.column_dimensions[column[0].column_letter].width = _WIDTH_OF_COLUMN
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


def rows_of(one: CaseCuts) -> list[tuple[Any, ...]]:
    """Rows of the cuts of a case, under `HEADERS`."""
    title = one.case.title or one.case.name
    return [
        (
            title,
            cut.name,
            cut.verdict,
            "any" if cut.spindle_speed is None else round(cut.spindle_speed),
            _rounded(cut.cutting_speed, 1),
            _rounded(cut.axial_depth, 3),
            _rounded(cut.width_of_cut, 3),
            _rounded(cut.feed_per_tooth, 4),
            None if cut.feed_rate is None else round(cut.feed_rate),
            _rounded(cut.limit, 3),
            None if cut.margin is None else round(100.0 * cut.margin, 1),
            _rounded(cut.removal_rate, 2),
        )
        for cut in one.cuts
    ]


def _append_limits(worksheet: Worksheet, one: CaseCuts) -> None:
    _append(worksheet, ("spindle speed [rpm]", "limit [mm]", "chatter frequency [Hz]"))
    limits = one.diagram.limits
    for speed, depth, frequency in zip(
        one.diagram.axis.values, limits.critical_depth, limits.chatter_frequency, strict=True
    ):
        _append(worksheet, (float(speed), _finite(1e3 * depth), _finite(frequency)))


def _append(worksheet: Worksheet, row: Sequence[Any]) -> None:
    worksheet.append(list(row))
    for cell in worksheet[worksheet.max_row]:
        # a title that begins with "=" is text, no formula
        if isinstance(cell.value, str):
            cell.data_type = "s"


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None else round(value, digits)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
