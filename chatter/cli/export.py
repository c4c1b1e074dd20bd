"""`chatter export MACHINE`: state space of a machine with names and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.report.console import print_notes, print_table

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.export import StateSpaceExport

PointsOfTest = list[str] | None


def export(
    machine: options.MachinePath,
    assignments: options.Assignments = None,
    excite: Annotated[
        PointsOfTest,
        typer.Option("--excite", help='Input, "motor:Y", "table:y", "tool/work:x"; repeatable.'),
    ] = None,
    read: Annotated[PointsOfTest, typer.Option("--read", help="Output; repeatable.")] = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """State space of a machine, A, B, C, D with names and units, as .npz and .mat."""
    from chatter.simulation.virtual_tests.export import export as export_machine

    file = options.patched_machine(machine, assignments)
    folder = options.output_folder(out, machine.stem)
    with progress_bar("state space"):
        found = export_machine(file, excite or (), read or ())
    present(found, folder, json=json, words=_print_export)


def _print_export(found: StateSpaceExport) -> None:
    summary = found.summary()
    rows = [
        [way, one["name"], one["unit"]]
        for way, key in (("input", "inputs"), ("output", "outputs"))
        for one in summary[key]
    ]
    print_table(f"{summary['states']} states", ["", "place", "unit"], rows)
    for note in summary["notes"]:
        print_notes([note])
