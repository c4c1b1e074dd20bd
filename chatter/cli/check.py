"""`chatter check CASE`: verdict on the operating point, in words or as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import print_result, print_sentences
from chatter.report.console import print_notes, print_table, print_written
from chatter.report.recording import document

if TYPE_CHECKING:
    from chatter.stability.check import StabilityCheck

#: of `--exit-code`, where the cut chatters, and where the linear analysis cannot tell
EXIT_CHATTER, EXIT_NOT_CERTAIN = 3, 4

ExitCode = Annotated[
    bool,
    typer.Option(
        "--exit-code",
        help=f"Leave with {EXIT_CHATTER} where the cut chatters, with {EXIT_NOT_CERTAIN} where "
        "what the linear analysis leaves out may decide.",
    ),
]


def check(
    case: options.CaseFile,
    assignments: options.Assignments = None,
    method: options.Method = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
    exit_code: ExitCode = False,
) -> None:
    """Judge the operating point of a case: stable or chatter, and the critical depth."""
    description = options.patched_case(case, assignments)
    from chatter.stability.check import check as run_check
    from chatter.stability.neglected_effects import CHATTER, STABLE

    with progress_bar("critical depth at this speed") as progress:
        result = run_check(description, method, progress)
    options.print_coefficients(description)
    print_result(result, json=json, words=_print_verdict)
    report = document()
    if report is not None:
        from chatter.plots.style import png_of
        from chatter.report.document import Picture

        report.pictures.append(Picture("stability over axial depth", png_of(result.plot())))
    print_notes(result.notes)
    if out is not None:
        print_written(result.save(out))
    if exit_code and result.verdict != STABLE:
        raise typer.Exit(EXIT_CHATTER if result.verdict == CHATTER else EXIT_NOT_CERTAIN)


def _print_verdict(result: StabilityCheck) -> None:
    print_sentences(result)
    print_table("", ["quantity", "value"], result.rows())
