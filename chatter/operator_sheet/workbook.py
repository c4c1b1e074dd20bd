"""XLSX of an operator's sheet."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from chatter.description.errors import InputError
from chatter.description.unit_system import INCH, METRIC, UnitSystem, units_of
from chatter.description.usual_units import UsualUnit
from chatter.operator_sheet.cuts import CaseCuts

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

#: digits behind the point of lengths, feeds a tooth and rates: an inch has more than a millimetre
_DIGITS = {METRIC: (3, 4, 1, 0, 2), INCH: (4, 5, 0, 2, 3)}
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
    units = units_of_all(cases)
    _append(table, (*headers_in(units), "not certain because"))
    for one in cases:
        for row, cut in zip(rows_of(one, units), one.cuts, strict=True):
            _append(table, (*row, cut.because or None))
    for place, one in enumerate(cases, start=1):
        _append_limits(book.create_sheet(f"limits {place}"), one, units.length)
    for worksheet in book.worksheets:
        worksheet.freeze_panes = "A2"
        for column in worksheet.columns:
            worksheet.column_dimensions[column[0].column_letter].width = _WIDTH_OF_COLUMN
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


def units_of_all(cases: Sequence[CaseCuts]) -> UnitSystem:
    """Units of a table of several cases: inches where all are in inches."""
    return INCH if all(units_of(one.case) is INCH for one in cases) else METRIC


def headers_in(units: UnitSystem) -> tuple[str, ...]:
    """Heading of `rows_of`."""
    length = units.length.name
    return (
        "case", "cut", "verdict", "spindle speed [rpm]",
        f"cutting speed [{units.cutting_speed.name}]", f"axial depth [{length}]",
        f"width of cut [{length}]", f"feed per tooth [{units.feed_per_tooth.name}]",
        f"feed rate [{units.feed_rate.name}]", f"limit [{length}]", "margin [%]",
        f"removal rate [{units.removal_rate.name}]",
    )  # fmt: skip


def rows_of(one: CaseCuts, units: UnitSystem) -> list[tuple[Any, ...]]:
    """Rows of the cuts of a case, under `headers_in`."""
    title = one.case.title or one.case.name
    lengths, per_tooth, speed, rate, removed = _DIGITS[units]

    def length(value: float | None, digits: int = lengths) -> float | None:
        return _shown(value, METRIC.length, units.length, digits)

    return [
        (
            title,
            cut.name,
            cut.verdict,
            "any" if cut.spindle_speed is None else round(cut.spindle_speed),
            _shown(cut.cutting_speed, METRIC.cutting_speed, units.cutting_speed, speed),
            length(cut.axial_depth),
            length(cut.width_of_cut),
            length(cut.feed_per_tooth, per_tooth),
            _shown(cut.feed_rate, METRIC.feed_rate, units.feed_rate, rate),
            length(cut.limit),
            None if cut.margin is None else round(100.0 * cut.margin, 1),
            _shown(cut.removal_rate, METRIC.removal_rate, units.removal_rate, removed),
        )
        for cut in one.cuts
    ]


def _append_limits(worksheet: Worksheet, one: CaseCuts, length: UsualUnit) -> None:
    heading = "spindle speed [rpm]", f"limit [{length.name}]", "chatter frequency [Hz]"
    _append(worksheet, heading)
    limits = one.diagram.limits
    for speed, depth, frequency in zip(
        one.diagram.axis.values, limits.critical_depth, limits.chatter_frequency, strict=True
    ):
        _append(worksheet, (float(speed), _finite(length.factor * depth), _finite(frequency)))


def _append(worksheet: Worksheet, row: Sequence[Any]) -> None:
    worksheet.append(list(row))
    for cell in worksheet[worksheet.max_row]:
        # a title that begins with "=" is text, no formula
        if isinstance(cell.value, str):
            cell.data_type = "s"


def _shown(
    value: float | None, metric: UsualUnit, unit: UsualUnit, digits: int
) -> float | int | None:
    """A value in a metric unit in another one, with so many digits behind the point."""
    if value is None:
        return None
    found = value if unit == metric else value / metric.factor * unit.factor
    return round(found, digits) if digits else round(found)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
