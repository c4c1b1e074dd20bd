"""`chatter lobes CASE`: the stability lobe diagram."""

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
from chatter.cli.progress import progress_bar
from chatter.cli.results import present, print_sentences
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.formatting import rounded_down, to_digits
from chatter.description.usual_units import UsualUnit
from chatter.io.result_tables import require_kind
from chatter.report.console import print_answer, print_line, print_table

if TYPE_CHECKING:
    from chatter.stability.diagram import StabilityDiagram


#: what computes limits that hold with edge forces
_IN_TIME = (
    "`chatter check --method time-domain` computes the limit at the speed of the cut with edge "
    "forces, `chatter lobes --method time-domain` at every speed of lobes.speeds.count"
)


@dataclass(frozen=True)
class LobesOptions:
    """What `chatter lobes` is given."""

    case: CaseFile
    assignments: Assignments = None
    method: Method = None
    x: Annotated[
        str | None,
        typer.Option(
            "--x",
            metavar="PATH=FROM..TO[:COUNT]",
            help='Critical depth over any value, such as cut.radial_depth="0.5 mm..10 mm:40".',
        ),
    ] = None
    y: Annotated[
        str | None,
        typer.Option(
            "--y",
            metavar="PATH=FROM..TO[:COUNT]",
            help="Map of the spectral radius over this and --x, else over spindle speed.",
        ),
    ] = None
    grid: Annotated[
        bool, typer.Option("--grid", help="Also write the spectral radius on the whole grid.")
    ] = False
    cluster: Cluster = None
    live: Annotated[
        bool, typer.Option("--live", help="Show a page in the browser that follows sliders.")
    ] = False
    port: Annotated[int, typer.Option("--port", help="Of --live; by default a free one.")] = 0
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="With --live, open no browser.")
    ] = False
    tables: Tables = "csv"
    out: OutputFolder = None
    json: Json = False


@takes_options
def lobes(options: LobesOptions) -> None:
    """Compute the stability lobe diagram of a case."""
    require_kind(options.tables, "--tables")
    description = patched_case(options.case, options.assignments)
    live, grid, of_live = options.live, options.grid, options.port or options.no_browser
    if options.x or options.y:
        if live or grid or of_live:
            raise InputError("--x and --y draw a diagram of their own; leave --live, --grid out")
        _over_paths(description, options)
        return
    of_files = grid or options.json or options.out or options.cluster or options.tables != "csv"
    if live and of_files:
        raise InputError(
            "--live shows a page and writes no files; leave --grid, --json, --tables and --out away"
        )
    if not live and of_live:
        raise InputError("--port and --no-browser belong to --live; give it with them")
    if live:
        _serve(description, options)
        return
    if options.cluster is not None and not grid:
        raise InputError(
            "--cluster computes the grid of a diagram, or one over --x and --y; give one of them"
        )
    from chatter.studies.diagram_over_axes import lobes as run_lobes

    folder = output_folder(options.out, options.case.stem)
    with progress_bar("stability limits at all speeds") as progress:
        diagram = run_lobes(description, options.method, grid, progress, options.cluster, folder)
    print_coefficients(description)
    present(
        diagram,
        folder,
        json=options.json,
        words=_print_diagram,
        notes=diagram.notes,
        save=partial(diagram.save, tables=options.tables),
    )


def _over_paths(case: Case, options: LobesOptions) -> None:
    """Compute and write a diagram over other paths than the spindle speed."""
    from chatter.studies.diagram_over_axes import lobes_over

    folder = output_folder(options.out, options.case.stem)
    with progress_bar("stability at the points of the diagram") as progress:
        diagram = lobes_over(
            case, options.x, options.y, options.method, progress, options.cluster, folder
        )
    print_coefficients(case)
    present(
        diagram,
        folder,
        json=options.json,
        words=print_sentences,
        notes=diagram.notes,
        save=partial(diagram.save, tables=options.tables),
    )


def _serve(description: Case, options: LobesOptions) -> None:
    """Serve the stability view of the case until Ctrl-C."""
    from chatter.cli.app import refuse_without_panel, serve

    refuse_without_panel()
    from chatter.app.live_case import LiveCase

    page = LiveCase(description, options.method)
    with progress_bar("first diagram") as progress:
        page.diagram({}, "coarse", progress)
        from chatter.app.workbench.server import WorkbenchServer

        text = description.to_toml() if options.assignments else None
        folder, name = options.case.resolve().parent, options.case.name
        server = WorkbenchServer(folder, name, options.port, options.method, text)
    serve(server, json=False, no_browser=options.no_browser)


def _print_diagram(diagram: StabilityDiagram) -> None:
    summary, units = diagram.summary(), diagram.units
    length, removal_rate = units.instead_of("mm"), units.instead_of("cm³/min")
    lowest, operating = summary["lowest_limit"], summary["operating_point"]
    depth, margin = summary["margin"]["depth"], summary["margin"]["spindle_speed"]
    rows = [
        [
            f"{pocket['spindle_speed_rpm']:.0f}",
            _depth_of_pocket(pocket["axial_depth_mm"], length),
            _limit(pocket["critical_depth_mm"], summary["max_axial_depth_mm"], length),
            to_digits(pocket["removal_rate_cm3_per_min"] * removal_rate.factor, 3),
        ]
        for pocket in summary["pockets"]
    ]
    if rows and diagram.resting_friction < 1.0:
        print_line(
            "pockets keep what frictions at rest may take of their limits, stuck or without them; "
            "the curve is that of frictions as they vibrate (structure.friction_amplitude)"
        )
    if rows:
        print_table(
            f"pockets worth using ({depth:.0%} below the limit, {margin:.1%} off in speed)",
            [
                "speed [rpm]",
                f"depth [{length.name}]",
                f"limit [{length.name}]",
                f"removal [{removal_rate.name}]",
            ],
            rows,
        )
    elif diagram.why_no_pocket:
        print_line(f"no pocket is named: {diagram.why_no_pocket}")
        print_line(_IN_TIME)
    else:
        print_line("no pocket between these speeds is deeper than what any of them allows")
    if lowest["critical_depth_mm"] is not None:
        print_line(
            f"{_stable_below(lowest['stable_below_mm'], diagram)} (lowest limit "
            f"{length.text(lowest['critical_depth_mm'])}, at "
            f"{lowest['spindle_speed_rpm']:.0f} rpm, "
            f"chatter at {lowest['chatter_frequency_Hz']:.0f} Hz{_taken_off(diagram)})"
        )
    elif lowest["stable_below_mm"] is not None:
        below = _stable_below(lowest["stable_below_mm"], diagram)
        print_line(f"{below} ({_without_limit(diagram)}{_taken_off(diagram)})")
    else:
        print_line(_without_limit(diagram))
    limit = operating["critical_depth_mm"]
    sure = "" if operating["certain"] else " by the linear analysis, not certain"
    print_answer(
        f"operating point {operating['spindle_speed_rpm']:.0f} rpm, "
        f"{length.text(operating['axial_depth_mm'])}: "
        f"{'stable' if operating['stable'] else 'chatter'}{sure}; "
        f"limit there {_limit(limit, summary['max_axial_depth_mm'], length)} {length.name}"
    )
    if not operating["certain"]:
        print_line("; ".join([*_what_may_turn(diagram), "`chatter simulate` decides"]))
    error = summary["resolution"]["estimated_error"]
    accuracy = "" if error is None else f"; limits accurate to {max(error, 1e-6):.1g}"
    print_line(f"method: {summary['method']}{accuracy}")


def _what_may_turn(diagram: StabilityDiagram) -> list[str]:
    """Clauses on what may turn the verdict on the cut; the note says by how much at all speeds."""
    from chatter.stability.neglected_effects import reasons_of

    known = diagram.neglected_at_all_speeds
    left = [effect for effect in diagram.deciding if effect not in known]
    reasons = reasons_of(left, stable=diagram.operating_is_stable)
    if diagram.why_no_pocket or len(left) == len(diagram.deciding):
        return reasons
    return [*(f"{one.name} may turn this verdict (see the note)" for one in known), *reasons]


def _stable_below(depth: float, diagram: StabilityDiagram) -> str:
    from chatter.stability.registry import METHODS

    if depth > 0.0:
        speeds = "any of these speeds"
        if not METHODS[diagram.method].is_linear:
            speeds = f"the {diagram.limits.spindle_speed.size} speeds computed, not between them,"
        length = diagram.units.instead_of("mm")
        return f"stable at {speeds} below {rounded_down(depth * length.factor)} {length.name}"
    return "no depth is stable at any speed for certain"


def _without_limit(diagram: StabilityDiagram) -> str:
    """Say that no speed has a limit, and what ended the search."""
    deepest, tool = max(diagram.max_depth.tolist()), diagram.case.tool
    reached = deepest >= tool.depth_that_tool_allows * (1.0 - 1e-9)
    why = f", tool.{tool.limiting_length}" if reached else ", where the search ends"
    return f"no limit at any of these speeds up to {diagram.units.length.text(deepest)}{why}"


def _taken_off(diagram: StabilityDiagram) -> str:
    """What is taken off the lowest limit, and why."""
    told = [
        f"; less {one.share:.0%}: {one.name} that set in at a chip of zero"
        for one in diagram.neglected_at_all_speeds
        if not diagram.why_no_pocket
    ]
    if diagram.resting_friction < 1.0:
        share = 1.0 - diagram.resting_friction
        told.append(f"; less {share:.0%}: frictions of axes at rest, stuck or without them")
    return "".join(told)


def _limit(depth: float | None, max_depth: float, length: UsualUnit) -> str:
    """Limit, mm, as a number of a unit; how far was searched where there is none."""
    sign, shown = ("> ", max_depth) if depth is None else ("", depth)
    return f"{sign}{shown * length.factor:.4g}"


def _depth_of_pocket(depth: float, length: UsualUnit) -> str:
    """Depth, mm, to a thousandth of a mm, or a ten-thousandth of an inch."""
    return f"{depth:.3f}" if length.factor == 1.0 else f"{depth * length.factor:.4f}"
