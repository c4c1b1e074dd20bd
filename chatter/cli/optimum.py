"""`chatter optimum CASE`: the best speed, depth and width within the limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli.errors import reports_errors
from chatter.cli.options import Assignments, CaseFile, Json, OutputFolder
from chatter.cli.search import searched
from chatter.description.case import Case
from chatter.description.errors import RunError
from chatter.description.progress import Progress

if TYPE_CHECKING:
    from chatter.studies.optimisation.result import Optimum


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

    def search(description: Case, progress: Progress, folder: Path) -> Optimum:
        from chatter.studies.optimisation.study import optimum as run_optimum

        return run_optimum(description, samples, seed, progress, folder)

    found = searched(search, "search", case, assignments, out, json)
    if found.why_nothing:
        raise RunError(f"{found.case.name}: {found.why_nothing}")
