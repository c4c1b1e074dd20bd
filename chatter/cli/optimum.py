"""`chatter optimum CASE`: the best speed, depth and width within the limits."""

from __future__ import annotations

from typing import Annotated

import typer

from chatter.cli.errors import reports_errors
from chatter.cli.options import (
    Assignments,
    CaseFile,
    Json,
    OutputFolder,
    output_folder,
    patched_case,
)
from chatter.cli.report import (
    announce_compilation,
    print_json,
    print_line,
    print_notes,
    print_written,
    progress_bar,
)
from chatter.errors import RunError


@reports_errors
def optimum(
    case: CaseFile,
    samples: Annotated[
        int, typer.Option("--samples", help="Of values such as 1650 +- 80 MPa.")
    ] = 200,
    seed: Annotated[int, typer.Option("--seed", help="Of the random numbers.")] = 1,
    assignments: Assignments = None,
    out: OutputFolder = None,
    json: Json = False,
) -> None:
    """Find the cut with the highest removal rate within the limits of [optimum]."""
    description = patched_case(case, assignments)
    from chatter.best_cut.study import optimum as run_optimum

    announce_compilation()
    folder = output_folder(out, case.stem)
    with progress_bar("search") as progress:
        found = run_optimum(description, samples, seed, progress, folder)
    written = found.save(folder)
    if json:
        print_json(found.summary())
    elif found.best is not None:
        for line in found.told():
            print_line(line)
    print_notes(found.notes)
    print_written(written)
    if found.best is None:
        raise RunError(f"{description.name}: {found.why_nothing}")
