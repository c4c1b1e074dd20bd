"""`chatter coefficients RECORDS`: cutting coefficients from the forces of a series of cuts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.description.errors import InputError
from chatter.report.console import print_line, print_notes, print_table, print_written

if TYPE_CHECKING:
    from chatter.cutting_coefficients.result import Coefficients


def coefficients(
    records: Annotated[
        Path, typer.Argument(metavar="RECORDS", help="Measurement folder of kind milling.")
    ],
    case: Annotated[
        Path | None, typer.Option("--case", help="In place of the case of measurement.toml.")
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option("--table", help="Own table of materials to add the coefficients to."),
    ] = None,
    name: Annotated[
        str | None, typer.Option("--name", help="Name of the new row of that table.")
    ] = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Find the cutting coefficients of a series of cuts by their mean forces."""
    from chatter.cutting_coefficients.identify import coefficients as identify

    if (table is None) != (name is None):
        raise InputError("--table and --name belong together: a row of a table, and its name")
    with progress_bar("mean forces and laws"):
        found = identify(records, case)
    folder = options.output_folder(out, records.resolve().name)
    present(found, folder, json=json, words=_print_coefficients)
    if table is not None:
        print_written([found.keep_in(table, name)])


def _print_coefficients(found: Coefficients) -> None:
    summary = found.summary()
    rows = [
        [one["name"], f"{one['value']:.4g}", f"{one['standard_deviation']:.2g}", one["unit"]]
        for one in summary["coefficients"]
    ]
    rows += [
        ["exponent", f"{one['value']:.3f}", f"{one['standard_deviation']:.2g}", ""]
        for one in summary["exponents"]
    ]
    title = f"{summary['law']} law, {len(found.measurement.runs)} cuts"
    print_table(title, ["coefficient", "value", "+-", "unit"], rows)
    if summary["holdout_error"]:
        worst = max(summary["holdout_error"].values())
        print_line(f"mean forces of a cut held out are predicted to {worst:.1%} or better")
    for name, sign in summary["signs"].items():
        print_line(f"{name} is taken {'as it is' if sign > 0.0 else 'with its sign turned'}")
    for note in summary["notes"]:
        print_notes([note])
