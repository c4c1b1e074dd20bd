"""`chatter optimum CASE`: the best speed, depth and radial depth within the limits."""

from functools import partial
from typing import Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present, print_sentences
from chatter.description.errors import RunError
from chatter.io.result_tables import require_kind


def optimum(
    case: options.CaseFile,
    samples: Annotated[
        int, typer.Option("--samples", help="Of values such as 1650 +- 80 MPa.")
    ] = 200,
    seed: Annotated[int, typer.Option("--seed", help="Of the random numbers.")] = 1,
    assignments: options.Assignments = None,
    tables: options.Tables = "csv",
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Find the cut with the highest removal rate within the limits of [optimum]."""
    require_kind(tables, "--tables")
    description = options.patched_case(case, assignments)
    from chatter.studies.optimisation.process_optimisation import optimum as run_optimum

    folder = options.output_folder(out, case.stem)
    with progress_bar("cuts of the search") as progress:
        found = run_optimum(description, samples, seed, progress, folder)
    options.print_coefficients(description)
    present(
        found,
        folder,
        json=json,
        words=print_sentences,
        notes=found.notes,
        save=partial(found.save, tables=tables),
    )
    if found.why_nothing:
        raise RunError(f"{found.case.name}: {found.why_nothing}")
