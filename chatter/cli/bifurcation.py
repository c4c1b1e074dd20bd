"""`chatter bifurcation CASE`: Poincaré sections over speed, depth or any other value."""

from __future__ import annotations

import itertools
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import announce_resumed, progress_bar
from chatter.cli.results import present
from chatter.description.unit_system import unit_at
from chatter.io.result_tables import require_kind
from chatter.report.console import print_line

if TYPE_CHECKING:
    from chatter.studies.bifurcation import BifurcationDiagram


_MOST_CUTS = 100_000


def bifurcation(
    case: options.CaseFile,
    vary: Annotated[
        str,
        typer.Option(
            "--vary", metavar="PATH=FROM..TO:COUNT", help='Such as cut.axial_depth="1 mm..4 mm:60".'
        ),
    ],
    count: Annotated[
        int, typer.Option("--count", help="Number of cuts where the range gives none.")
    ] = 60,
    assignments: options.Assignments = None,
    cluster: options.Cluster = None,
    tables: options.Tables = "csv",
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Simulate a case over a range of one value: where chatter sets in, and of what kind."""
    require_kind(tables, "--tables")
    description = options.patched_case(case, assignments)
    from chatter.engine.loop import run
    from chatter.studies.bifurcation import bifurcation as run_bifurcation
    from chatter.studies.parameter_axis import axis_of

    axis = axis_of(vary, description, "--vary", count, _MOST_CUTS)
    values = [value.patch[axis.path] for value in axis.values]

    folder = options.output_folder(out, case.stem)
    with progress_bar("cuts of the bifurcation diagram, step by step", run) as progress:
        diagram = run_bifurcation(
            description,
            axis.path,
            values,
            folder=folder,
            progress=progress,
            resumed=partial(announce_resumed, "cuts"),
            cluster=cluster,
        )
    options.print_coefficients(description)
    present(
        diagram, folder, json=json, words=_print_onsets, save=partial(diagram.save, tables=tables)
    )


def _print_onsets(diagram: BifurcationDiagram) -> None:
    """Print from where to where along the range cuts have the same verdict."""
    points = diagram.summary()["points"]

    def value_of(point: dict) -> str:
        return _in_unit(diagram, point["value"])

    for verdict, group in itertools.groupby(points, lambda point: point["verdict"]):
        alike = list(group)
        first, last = value_of(alike[0]), value_of(alike[-1])
        span = first if len(alike) == 1 else f"{first} to {last}"
        frequency = alike[0]["chatter_frequency_Hz"]
        at = f" at {frequency:.1f} Hz ({alike[0]['bifurcation']})" if frequency else ""
        onset = " where it sets in" if at and len(alike) > 1 else ""
        print_line(f"{span}: {verdict}{at}{onset}")
    left = [point for point in points if point["spread_um"] is None]
    if left:
        share, first = f"{len(left)} of {len(points)}", value_of(left[0])
        print_line(
            f"in {share} cuts, the first at {first}, the tool left the range of the model: they "
            "have no Poincaré section"
        )
    _print_linear(diagram)


def _print_linear(diagram: BifurcationDiagram) -> None:
    """Print the limits of the linear analysis and the cuts of which it says otherwise."""
    linear = diagram.linear
    if linear.reason:
        print_line(f"no limit of the linear analysis: {linear.reason}")
        return
    limits = [_in_unit(diagram, limit) for limit in linear.limits]
    where = f"{'chatter' if linear.unstable else 'stable'} from end to end"
    if limits:
        where = f"limit{'s' * (len(limits) > 1)} at {', '.join(limits)}"
    print_line(f"linear analysis ({linear.method}): {where}")
    for one in linear.disagreements:
        first, last = _in_unit(diagram, one.first), _in_unit(diagram, one.last)
        span = first if one.cuts == 1 else f"{first} to {last}"
        print_line(f"{span}: {one.simulated} in the simulation, {one.reason}")


def _in_unit(diagram: BifurcationDiagram, value: float) -> str:
    """Value of the path in the unit that people read it in."""
    return unit_at(diagram.case, diagram.path).text(value, ".5g").rstrip()
