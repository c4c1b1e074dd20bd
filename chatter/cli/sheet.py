"""`chatter sheet CASE...`: the operator's page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.report.console import print_line, print_table

if TYPE_CHECKING:
    from chatter.operator_sheet.sheet import Sheet

#: columns of the workbook that a terminal has room for
_COLUMNS = (1, 2, 3, 5, 8, 9, 10)


def sheet(
    cases: Annotated[list[Path], typer.Argument(metavar="CASE...", help="Case files (TOML).")],
    assignments: options.Assignments = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """One page for the operator: speeds, depths, feeds, limits, margins, as PDF and XLSX."""
    from chatter.operator_sheet.sheet import sheet as sheet_of

    described = [options.patched_case(path, assignments) for path in cases]
    folder = options.output_folder(out, cases[0].stem if len(cases) == 1 else "sheet")
    with progress_bar("limits and pockets") as progress:
        found = sheet_of(described, progress)
    for case in described:
        options.print_coefficients(case)
    present(found, folder, json=json, words=_print_sheet)


def _print_sheet(found: Sheet) -> None:
    from chatter.description.unit_system import units_of
    from chatter.operator_sheet.workbook import headers_in, rows_of

    for one in found.cases:
        units = units_of(one.case)
        headers, rows = headers_in(units), rows_of(one, units)
        texts = [["" if row[i] is None else f"{row[i]}" for i in _COLUMNS] for row in rows]
        print_table(rows[0][0], [headers[i] for i in _COLUMNS], texts)
        for cut in one.cuts:
            if cut.because:
                print_line(f"{one.case.name}: {cut.name} not certain: {cut.because}")
        if one.variation is not None:
            print_line(
                f"{one.case.name}: spindle-speed variation of {one.variation.amplitude:.0%} at "
                f"{one.variation.frequency:.2g} Hz raises the limit of the stated cut"
            )
