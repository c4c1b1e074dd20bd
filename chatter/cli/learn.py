"""`chatter learn CASE CUTS`: what cutting tests leave possible, and the next cut to make."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli.options import (
    Assignments,
    CaseFile,
    Json,
    OutputFolder,
    output_folder,
    patched_case,
    print_coefficients,
)
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import progress_bar, report_stage
from chatter.cli.results import present
from chatter.description.case import Case
from chatter.description.formatting import to_digits
from chatter.description.usual_units import UsualUnit, usual_unit
from chatter.report.console import print_answer, print_line, print_table
from chatter.report.parameters import read_in

if TYPE_CHECKING:
    from chatter.learning.learn import Learnt


@dataclass(frozen=True)
class LearnOptions:
    """What `chatter learn` is given."""

    case: CaseFile
    cuts: Annotated[
        Path,
        typer.Argument(metavar="CUTS", help="CSV table of cutting tests, or a measurement folder."),
    ]
    aim: Annotated[
        str, typer.Option("--aim", help='Of the next cut: "information" or "metal".')
    ] = "information"
    risk: Annotated[
        float, typer.Option("--risk", help="Largest probability of chatter of the next cut.")
    ] = 0.5
    particles: Annotated[int, typer.Option("--particles", help="Number of particles.")] = 128
    seed: Annotated[int, typer.Option("--seed", help="Of the random numbers.")] = 1
    assignments: Assignments = None
    out: OutputFolder = None
    json: Json = False


@takes_options
def learn(options: LearnOptions) -> None:
    """Learn from a few cutting tests what a case leaves open, and choose the next cut."""
    description = patched_case(options.case, options.assignments)
    from chatter.learning.learn import learn as run_learn

    folder = output_folder(options.out, options.case.stem)
    with progress_bar("learning from the tests") as work:
        found = run_learn(
            description,
            options.cuts,
            aim=options.aim,
            risk=options.risk,
            particles=options.particles,
            seed=options.seed,
            progress=partial(report_stage, work),
            folder=folder,
        )
    print_coefficients(description)
    present(found, folder, json=options.json, words=_print_learnt, notes=found.notes)


def _print_learnt(found: Learnt) -> None:
    summary = found.summary()
    rows = [_row(one) for one in summary["parameters"]]
    count = summary["tests"]
    title = f"learnt from {count} {'test' if count == 1 else 'tests'}"
    print_table(title, ["value", "unit", "declared", "learnt", "95 % interval"], rows)
    verdicts = summary["verdicts"]
    if verdicts["judged"]:
        print_line(
            f"{verdicts['right']} of {verdicts['judged']} verdicts are as the learnt case has them"
        )
    _print_next_cut(summary, found.units.instead_of("mm"))


def _row(one: dict) -> list[str]:
    """Value with its unit, as declared and as learnt."""
    declared, learnt = one["declared"], one["learnt"]
    unit, factor = _read_in(one)
    low, high = (f"{factor * end:.4g}" for end in learnt["ci95"])
    deviation = to_digits(factor * declared["standard_deviation"])
    before = f"{factor * declared['value']:.4g} +- {deviation}"
    return [one["path"], unit, before, f"{factor * learnt['median']:.4g}", f"{low} to {high}"]


def _read_in(one: dict) -> tuple[str, float]:
    """Unit that people read a value in, and the number of it in one of SI."""
    if one["unit"]:
        return read_in(one["unit"], one["learnt"]["median"])
    return usual_unit(Case, one["path"])


def _print_next_cut(summary: dict, length: UsualUnit) -> None:
    chosen = summary["next_cut"]
    if chosen is None:
        print_answer("no cut of the diagram is within the risk; allow more by --risk")
        return
    print_answer(
        f"next cut: {length.text(chosen['axial_depth_mm'], '.3g')} at "
        f"{chosen['spindle_speed_rpm']:.0f} rpm, stable with a probability of "
        f"{chosen['probability_of_stability']:.0%}, expected to give "
        f"{chosen['expected_information_bit']:.2g} bit"
    )
    if summary["nothing_left_to_learn"]:
        print_line("no cut is expected to say more: the limits are as sure as tests scatter")
