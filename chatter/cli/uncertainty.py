"""`chatter uncertainty CASE`: what the tolerances of the input make of the limits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli.options import (
    Assignments,
    CaseFile,
    Cluster,
    Json,
    Method,
    OutputFolder,
    Tables,
    output_folder,
    patched_case,
    print_coefficients,
)
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import announce_resumed, progress_bar
from chatter.cli.results import present
from chatter.io.result_tables import require_kind
from chatter.report.console import print_line

if TYPE_CHECKING:
    from chatter.studies.uncertainty.monte_carlo import Uncertainty


@dataclass(frozen=True)
class UncertaintyOptions:
    """What `chatter uncertainty` is given."""

    case: CaseFile
    samples: Annotated[int, typer.Option("--samples", help="Number of samples.")] = 200
    seed: Annotated[int, typer.Option("--seed", help="Of the random numbers.")] = 1
    speeds: Annotated[int, typer.Option("--speeds", help="Speeds of the band.")] = 121
    assignments: Assignments = None
    method: Method = None
    cluster: Cluster = None
    tables: Tables = "csv"
    out: OutputFolder = None
    json: Json = False


@takes_options
def uncertainty(options: UncertaintyOptions) -> None:
    """Propagate values such as "1650 +- 80 MPa" to a band of lobes and a probability."""
    require_kind(options.tables, "--tables")
    description = patched_case(options.case, options.assignments)
    from chatter.studies.uncertainty.monte_carlo import uncertainty as run_uncertainty

    folder = output_folder(options.out, options.case.stem)
    with progress_bar("samples of the uncertain values") as progress:
        found = run_uncertainty(
            description,
            options.samples,
            options.seed,
            speeds=options.speeds,
            method=options.method,
            folder=folder,
            progress=progress,
            resumed=partial(announce_resumed, "samples"),
            cluster=options.cluster,
        )
    print_coefficients(description)
    present(
        found,
        folder,
        json=options.json,
        words=_print_probability,
        save=partial(found.save, tables=options.tables),
    )


def _print_probability(found: Uncertainty) -> None:
    summary, length = found.summary(), found.units.instead_of("mm")
    point, limit = summary["operating_point"], summary["limit_at_operating_speed_mm"]
    low, high = point["confidence_interval_95"]
    print_line(
        f"{length.text(point['axial_depth_mm'])} at {point['spindle_speed_rpm']:.0f} rpm is "
        f"stable with a probability of {point['probability_of_stability']:.1%} "
        f"(95 % confidence: {low:.1%} to {high:.1%}, {summary['samples']} samples)"
    )
    left = found.for_certain_in_words()
    if left:
        print_line(left)
    ends = [
        "none found" if limit[key] is None else length.text(limit[key])
        for key in ("5_percent", "50_percent", "95_percent")
    ]
    print_line(f"critical depth there: median {ends[1]}, 5 % below {ends[0]}, 5 % above {ends[2]}")
    for line in _lines_on_variance(found.shares()):
        print_line(line)


def _lines_on_variance(shares: dict[str, float | None]) -> list[str]:
    """Shares of the variance in whole per cent that add up to 100, the largest first."""
    from chatter.studies.uncertainty.shares_of_variance import whole_percentages

    known = {path: share for path, share in shares.items() if share is not None}
    if not known:
        return []
    rest = max(0.0, 1.0 - sum(known.values()))
    percent = whole_percentages([*known.values(), rest])
    lines = [
        f"{path}: {share} % of its variance"
        for path, share in sorted(zip(known, percent, strict=False), key=lambda pair: -pair[1])
    ]
    return [*lines, f"curvature and joint influence: {percent[-1]} %"]
