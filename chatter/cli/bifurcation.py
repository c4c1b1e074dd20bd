"""`chatter bifurcation CASE`: once-per-period points over speed, depth or any other value."""

from __future__ import annotations

import itertools
from typing import Annotated

import numpy as np
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
from chatter.cli.report import announce_compilation, print_json, print_written, progress_bar
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.path import field_at, parse_path


@reports_errors
def bifurcation(
    case: CaseFile,
    vary: Annotated[
        str,
        typer.Option(
            "--vary", metavar="PATH=FROM..TO", help='Such as cut.axial_depth="1 mm..4 mm".'
        ),
    ],
    count: Annotated[int, typer.Option("--count", help="Number of cuts.")] = 60,
    assignments: Assignments = None,
    out: OutputFolder = None,
    json: Json = False,
) -> None:
    """Simulate a case over a range of one value: where chatter sets in, and of what kind."""
    description = patched_case(case, assignments)
    path, values = _range(vary, count)
    from chatter.engine.loop import run
    from chatter.studies.bifurcation import bifurcation as run_bifurcation

    announce_compilation(run)
    with progress_bar("cuts") as progress:
        diagram = run_bifurcation(description, path, values, progress)
    written = diagram.save(output_folder(out, case.stem))
    if json:
        print_json(diagram.summary())
    else:
        for point in _onsets(diagram.summary()["points"]):
            typer.echo(point)
    print_written(written)


def _range(vary: str, count: int) -> tuple[str, list[float]]:
    path, equals, span = vary.partition("=")
    low, dots, high = span.partition("..")
    if not (equals and dots and path.strip()):
        raise InputError(
            f'--vary "{vary}": PATH=FROM..TO is wanted, such as cut.axial_depth="1 mm..4 mm"'
        )
    if not 2 <= count <= 100_000:
        raise InputError(f"--count {count}: a number from 2 to 100000 is wanted")
    path = path.strip()
    field = field_at(Case, parse_path(path))
    if field is None:
        raise InputError(f"--vary {path}: there is no such quantity in a case")
    try:
        ends = [field.read(end.strip().strip('"')) for end in (low, high)]
    except ValueError as error:
        raise InputError(f"--vary {path}: {error}") from None
    return path, list(np.linspace(*ends, count))


def _onsets(points: list[dict]) -> list[str]:
    """Sentences for every change of verdict along the range."""
    told = [f"{points[0]['value']:.6g}: {points[0]['verdict']}"]
    for before, point in itertools.pairwise(points):
        if point["verdict"] != before["verdict"]:
            heard = point["chatter_frequency_Hz"]
            at = f" at {heard:.1f} Hz ({point['bifurcation']})" if heard else ""
            told.append(f"from {point['value']:.6g}: {point['verdict']}{at}")
    return told
