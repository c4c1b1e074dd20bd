"""Pages of an operator's sheet: table of cuts, and the diagram of each case."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, BinaryIO

from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from chatter.description.material_words import coefficients_in_words
from chatter.description.unit_system import UnitSystem, units_of
from chatter.operator_sheet.workbook import rows_of, units_of_all
from chatter.plots import style
from chatter.plots.stability_diagram import draw_limits
from chatter.stability.pockets import SPEED_MARGIN

if TYPE_CHECKING:
    from chatter.operator_sheet.cuts import CaseCuts
    from chatter.operator_sheet.sheet import Sheet

_A4 = 8.27, 11.69
_COLUMNS = 11
_FONT = 8.5
#: of the page, inch
_MARGIN = 0.4
#: characters of a title on one line, and of a long one on each of two
_TITLE, _LONG_TITLE = 58, 72


def _headers(units: UnitSystem) -> tuple[str, ...]:
    length = units.length.name
    return (
        "cut", "verdict", "speed\n[rpm]", f"vc\n[{units.cutting_speed.name}]", f"ap\n[{length}]",
        f"ae\n[{length}]", f"fz\n[{units.feed_per_tooth.name}]",
        f"feed\n[{units.feed_rate.name}]", f"limit\n[{length}]", "margin\n[%]",
        f"removal\n[{units.removal_rate.name.replace('^3', '³')}]",
    )  # fmt: skip


def write_pages(sheet: Sheet, file: BinaryIO) -> None:
    """Write the pages as PDF."""
    with PdfPages(file, metadata={"CreationDate": None}) as pdf:
        for page in pages(sheet):
            pdf.savefig(page)


def pages(sheet: Sheet) -> list[Figure]:
    """One page a case; before several, one with the table of them all."""
    each = [_page(one) for one in sheet.cases]
    return each if len(each) == 1 else [_table_of_all(sheet.cases), *each]


def _page(one: CaseCuts) -> Figure:
    figure = style.new_figure(*_A4)
    _leave_margins(figure)
    head, table, diagram, foot = figure.subplots(4, 1, height_ratios=[0.8, 1.7, 4.0, 0.6])
    for axes in (head, table, foot):
        axes.set_axis_off()
    title = one.case.title or one.case.name
    is_long = len(title) > _TITLE
    _write(head, 1.0, textwrap.fill(title, _LONG_TITLE, max_lines=2), 11.0 if is_long else 14.0)
    _write(head, 0.55, textwrap.fill(_set_up(one), 90))
    units = units_of(one.case)
    _draw_table(table, [row[1:] for row in rows_of(one, units)], _headers(units))
    draw_limits(diagram, one.diagram)
    diagram.set_xlabel("spindle speed [rpm]")
    _write(foot, 1.0, textwrap.fill(_remarks(one), 90))
    return figure


def _table_of_all(cases: Sequence[CaseCuts]) -> Figure:
    figure = style.new_figure(_A4[1], _A4[0])
    _leave_margins(figure)
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set_title("Cuts worth making", loc="left", fontsize=14.0)
    units = units_of_all(cases)
    rows = [row for one in cases for row in rows_of(one, units)]
    _draw_table(axes, [(_short(row[0]), *row[1:]) for row in rows], ("case", *_headers(units)))
    return figure


def _leave_margins(figure: Figure) -> None:
    layout = figure.get_layout_engine()
    assert isinstance(layout, ConstrainedLayoutEngine)
    layout.set(w_pad=_MARGIN, h_pad=_MARGIN)


def _draw_table(axes: Any, rows: Sequence[Sequence[Any]], headers: Sequence[str]) -> None:
    texts = [["" if value is None else f"{value}" for value in row] for row in rows]
    table = axes.table(cellText=texts, colLabels=headers, loc="upper center", cellLoc="right")
    table.auto_set_font_size(False)
    table.set_fontsize(_FONT)
    table.auto_set_column_width(range(len(headers)))
    for (row, column), cell in table.get_celld().items():
        cell.set_edgecolor("#BBBBBB")
        cell.set_height(0.17 if row == 0 else 0.09)
        if len(headers) > _COLUMNS:
            cell.set_height(0.05 if row == 0 else 0.03)
        if row == 0:
            cell.set_facecolor("#EEEEEE")
        elif texts[row - 1][column] == "chatter":
            cell.set_facecolor(style.UNSTABLE_FILL)


def _set_up(one: CaseCuts) -> str:
    tool, cut, length = one.case.tool, one.case.cut, units_of(one.case).length
    stated = (
        f"{tool.kind}, {tool.diameter * length.factor:.4g} {length.name}, {tool.teeth} teeth; "
        f"{cut.mode}, width of cut {one.case.width_of_cut * length.factor:.4g} {length.name}; "
        f"method {one.diagram.method}"
    )
    coefficients = coefficients_in_words(one.case)
    return stated if coefficients is None else f"{stated}; {coefficients}"


def _remarks(one: CaseCuts) -> str:
    kept = (
        f"Depths but the stated one keep {one.diagram.depth_margin:.0%} of the lowest limit within "
        f"{SPEED_MARGIN:.1%} of the speed in hand."
    )
    if one.diagram.why_no_pocket:
        kept = f"No other depth is stated: {one.diagram.why_no_pocket}."
    lines = [f"An empty limit: none was found up to the depth that was searched. {kept}"]
    lines += [
        f"The cut {cut.name} is not certain: {cut.because}." for cut in one.cuts if cut.because
    ]
    variation = one.variation
    if variation is not None:
        length = units_of(one.case).length
        shown = "" if variation.limit is None else f"{variation.limit * length.factor:.3g}"
        limit = f"{shown} {length.name}" if shown else "no limit"
        lines.append(
            f"Spindle-speed variation of {100.0 * variation.amplitude:.0f} % at "
            f"{variation.frequency:.2g} Hz raises the limit of the stated cut to {limit}, if the "
            "spindle can follow."
        )
    return " ".join(lines)


def _write(axes: Any, height: float, text: str, size: float = 9.5) -> None:
    shown = axes.text(0.0, height, text, transform=axes.transAxes, va="top", fontsize=size)
    shown.set_in_layout(False)


def _short(title: str, most: int = 34) -> str:
    return title if len(title) <= most else f"{title[: most - 1]}…"
