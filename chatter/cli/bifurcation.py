"""`chatter bifurcation CASE`: Poincaré sections over speed, depth or any other value."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.path import field_at, parse_path

if TYPE_CHECKING:
    from chatter.studies.bifurcation import BifurcationDiagram


def bifurcation(
    case: options.CaseFile,
    vary: Annotated[
        str,
        typer.Option(
            "--vary", metavar="PATH=FROM..TO", help='Such as cut.axial_depth="1 mm..4 mm".'
        ),
    ],
    count: Annotated[int, typer.Option("--count", help="Number of cuts.")] = 60,
    assignments: options.Assignments = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Simulate a case over a range of one value: where chatter sets in, and of what kind."""
    description = options.patched_case(case, assignments)
    path, values = _range(vary, count)
    from chatter.engine.loop import run
    from chatter.studies.bifurcation import bifurcation as run_bifurcation

    with progress_bar("cuts", run) as progress:
        diagram = run_bifurcation(description, path, values, progress)
    present(diagram, options.output_folder(out, case.stem), json=json, words=_print_onsets)


def _range(vary: str, count: int) -> tuple[str, list[float]]:
    path, equals, span = vary.partition("=")
    low, dots, high = span.partition("..")
    if not (equals and dots and path.strip()):
        raise InputError(
            f'--vary "{vary}": PATH=FROM..TO is required, such as cut.axial_depth="1 mm..4 mm"'
        )
    if not 2 <= count <= 100_000:
        raise InputError(f"--count {count}: a number from 2 to 100000 is required")
    path = path.strip()
    field = field_at(Case, parse_path(path))
    if field is None:
        raise InputError(f"--vary {path}: there is no such quantity in a case")
    try:
        ends = [field.read(end.strip().strip('"')) for end in (low, high)]
    except ValueError as error:
        raise InputError(f"--vary {path}: {error}") from None
    return path, list(np.linspace(*ends, count))


def _print_onsets(diagram: BifurcationDiagram) -> None:
    """Print every change of verdict along the range."""
    points = diagram.summary()["points"]
    typer.echo(f"{points[0]['value']:.6g}: {points[0]['verdict']}")
    for before, point in itertools.pairwise(points):
        if point["verdict"] != before["verdict"]:
            frequency = point["chatter_frequency_Hz"]
            at = f" at {frequency:.1f} Hz ({point['bifurcation']})" if frequency else ""
            typer.echo(f"from {point['value']:.6g}: {point['verdict']}{at}")
