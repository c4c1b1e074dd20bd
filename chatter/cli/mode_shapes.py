"""`chatter mode-shapes MACHINE`: natural frequencies and mode shapes of a machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.report.console import print_table

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.mode_shapes import ModeShapes


def mode_shapes(
    machine: options.MachinePath,
    assignments: options.Assignments = None,
    count: Annotated[
        int, typer.Option("--count", min=1, help="Largest number of modes, from the lowest.")
    ] = 12,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Natural frequencies and mode shapes of a machine, with their picture."""
    from chatter.simulation.virtual_tests.mode_shapes import mode_shapes as compute_mode_shapes

    file = options.patched_machine(machine, assignments)
    folder = options.output_folder(out, machine.stem)
    with progress_bar("mode shapes"):
        found = compute_mode_shapes(file, count)
    present(found, folder, json=json, words=_print_frequencies)


def _print_frequencies(found: ModeShapes) -> None:
    rows = [
        [str(number), f"{frequency:.2f}"]
        for number, frequency in enumerate(found.frequency, start=1)
    ]
    print_table(found.machine, ["mode", "natural frequency [Hz]"], rows)
