"""`chatter explain MEASUREMENT`: what the declared case lacks, or that nothing is missing."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from chatter.cli import options
from chatter.cli.progress import RunningWork, progress_bar, report_stage
from chatter.cli.results import present
from chatter.description.case import Case
from chatter.description.formatting import signed
from chatter.description.kinds_of_files import refuse_other_file
from chatter.description.usual_units import usual_unit
from chatter.report.console import print_answer, print_line, print_table
from chatter.report.parameters import parameter_row

if TYPE_CHECKING:
    from chatter.explain.explanation import Explanation

MeasurementPath = Annotated[
    Path, typer.Argument(metavar="MEASUREMENT", help="Folder with measurement.toml.")
]
DeclaredCase = Annotated[
    Path | None, typer.Option("--case", help="Case to judge instead of the one declared.")
]

#: share of the work from which on no effect is added any more, so that the rest can be told
_EFFECTS_FOUND = 0.85


def explain(
    measurement: MeasurementPath,
    case: DeclaredCase = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Trace what a measurement shows and its declared case lacks, and add it."""
    from chatter.explain.explanation import explain as run_explain
    from chatter.explain.measurement_file import read_measurement

    refuse_other_file(measurement, "measurement")
    declared = read_measurement(measurement, case)
    folder = options.output_folder(out, measurement.resolve().stem)
    with progress_bar("reading the signals") as work:
        result = run_explain(declared, progress=partial(_report_step, work), folder=folder)
    options.print_coefficients(declared.case)
    present(result, folder, json=json, words=_print_explanation)


def _report_step(work: RunningWork, description: str, share: float) -> None:
    """Report a step; its share of the whole only once it is known how many effects there are."""
    if share >= _EFFECTS_FOUND:
        report_stage(work, description, share)
        return
    work.stage(description)
    work(0, 1)


def print_checks(checks: list[dict[str, str]]) -> None:
    """Print what was found in the signals, with what follows."""
    from chatter.explain.data_checks.finding import FOLLOWS

    fatal = [one for one in checks if one["severity"] == "fatal"]
    for one in fatal or checks:
        print_line(f"{one['description']} ({FOLLOWS[one['severity']]})")


def _print_explanation(result: Explanation) -> None:
    from chatter.explain.next_measurement.proposal import in_words as in_words_next
    from chatter.explain.selection.discriminating_test import in_words

    summary = result.summary()
    print_answer(f"verdict: {summary['verdict']}")
    print_checks(summary["checks"])
    for effect in summary["effects"]:
        rows = [parameter_row(key, one) for key, one in effect["parameters"].items()]
        title = (
            f"{effect['name']} (probability {effect['probability']:.3g}): {effect['description']}"
        )
        print_table(title, ["parameter", "value", "unit", "95 % interval"], rows)
        if effect["confounded_with"]:
            print_line(
                f"the data do not discriminate against: {', '.join(effect['confounded_with'])}"
            )
        for name, test in effect["discriminating_test"].items():
            print_line(f"  {in_words(name, test)}")
    helping = [
        f"{one['name']} (probability {one['probability']:.2g})"
        for one in summary.get("partial", ())
    ]
    if helping:
        print_line(f"may explain a part, not added: {', '.join(helping)}")
    for term in summary.get("empirical", ()):
        print_line(
            f"learnt over the {term['over']}, explains nothing: error of holdout runs "
            f"{term['holdout_before']:.4g} to {term['holdout_after']:.4g} of the signal"
        )
    for one in summary["out_of_tolerance"]:
        print_line(
            f"out of tolerance: {one['path']} declared "
            f"{_in_usual_unit(one['declared'], one['path'])}, refitted "
            f"{_in_usual_unit(one['refitted'], one['path'])} "
            f"({one['standard_deviations']:+.1f} standard deviations)"
        )
    _print_refitted(summary)
    error = summary["error"]
    rows = [
        [key.replace("_", " "), f"{value:.4g}"]
        for key, value in error.items()
        if isinstance(value, float)
    ]
    if rows:
        print_table("error of the prediction", ["of", "rms over signal"], rows)
    _print_errors_by_kind(summary)
    if summary["next_measurement"] is not None:
        print_line(in_words_next(summary["next_measurement"]))
    signature = summary["signature"]
    if signature["refitted"] is None:
        return
    dependence = signature["residual_dependence"]
    if dependence is not None:
        print_line(f"residual dependence: {dependence['description']}")
    print_line("residual of the refitted case:")
    print_diagnostics(signature["refitted"])


def _print_errors_by_kind(summary: dict[str, Any]) -> None:
    """Print the errors of a set-up by kind of measurement."""
    names = ("noise_floor", "declared", "before", "after", "holdout_before", "holdout_after")
    rows = [
        [kind, *("" if error[name] is None else f"{error[name]:.4g}" for name in names)]
        for kind, error in summary.get("error_by_kind", {}).items()
    ]
    if rows:
        columns = ["kind", *(name.replace("_", " ") for name in names)]
        print_table("error by kind of measurement", columns, rows)


def _print_refitted(summary: dict[str, Any]) -> None:
    """Print what became of the declared values."""
    moved = summary.get("refitted", [])
    rows = [
        [
            one["name"],
            _in_usual_unit(one["declared"], one["name"]),
            _in_usual_unit(one["refitted"], one["name"]),
            f"{signed(100.0 * one['change'])} %",
            f"{one['tolerances']:+.2f}",
        ]
        for one in moved
    ]
    if rows:
        columns = ["declared value", "declared", "refitted", "change", "tolerances"]
        print_table("refitted", columns, rows)
    for remark in summary.get("remarks", ()):
        print_line(remark)


def _in_usual_unit(value: float, path: str) -> str:
    unit = usual_unit(Case, path)
    return f"{value * unit.factor:.5g} {unit.name}".rstrip()


def print_diagnostics(signature: dict) -> None:
    """Print what the diagnostics of a residual find."""
    for one in signature["diagnostics"]:
        if one["significant"]:
            print_line(f"  {one['description']}")
    if signature["no_significant_dependence"]:
        print_line(f"  {signature['no_significant_dependence']}")
