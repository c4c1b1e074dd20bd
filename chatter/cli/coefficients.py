"""`chatter coefficients RECORDS`: cutting coefficients from the forces of a series of cuts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from chatter.cli import options
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.cutting_coefficients.number_of_cuts import number_of_cuts
from chatter.description.errors import InputError
from chatter.description.formatting import to_digits
from chatter.description.units import QuantityError, parse
from chatter.report.console import (
    answer_in_report,
    print_line,
    print_notes,
    print_table,
    print_written,
)

if TYPE_CHECKING:
    from chatter.cutting_coefficients.result import Coefficients
    from chatter.description.usual_units import UsualUnit

#: directions that share an exponent where there is one
_ALL = 3


@dataclass(frozen=True)
class CoefficientOptions:
    """What `chatter coefficients` is given."""

    records: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDS", help="Measurement folder of kind milling, or one file of forces."
        ),
    ]
    case: Annotated[
        Path | None, typer.Option("--case", help="In place of the case of measurement.toml.")
    ] = None
    columns: options.Columns = None
    table: Annotated[
        Path | None,
        typer.Option("--table", help="Own table of materials to add the coefficients to."),
    ] = None
    name: Annotated[
        str | None, typer.Option("--name", help="Name of the new row of that table.")
    ] = None
    waveforms: Annotated[
        bool,
        typer.Option(
            "--waveforms/--mean-forces",
            help="Fit the whole waveforms too, with runout; or the mean forces alone.",
        ),
    ] = True
    hold_out: Annotated[
        list[str] | None,
        typer.Option(
            "--hold-out", metavar="FILE", help="Run that is predicted, not fitted; repeatable."
        ),
    ] = None
    rake: Annotated[
        str | None,
        typer.Option(
            "--rake", metavar="ANGLE", help='Normal rake, "8 deg": the oblique law is fitted too.'
        ),
    ] = None
    out: options.OutputFolder = None
    json: options.Json = False


@takes_options
def coefficients(given: CoefficientOptions) -> None:
    """Find the cutting coefficients of a series of cuts by their mean forces and waveforms."""
    from chatter.cutting_coefficients.identify import coefficients as identify

    if (given.table is None) != (given.name is None):
        raise InputError("--table and --name belong together: a row of a table, and its name")
    folder = options.output_folder(given.out, given.records.resolve().stem)
    with progress_bar("mean forces and laws"):
        found = identify(given.records, given.case, given.hold_out or (), given.columns)
    if given.waveforms:
        with progress_bar("waveforms and runout"):
            found = found.with_waveforms()
    if given.rake is not None:
        found = found.with_rake(_angle(given.rake))
    present(found, folder, json=given.json, words=_print_coefficients)
    if given.table is not None and given.name is not None:
        print_written([found.keep_in(given.table, given.name)])


def _angle(given: str) -> float:
    try:
        return parse(given, "angle").value
    except QuantityError as error:
        raise InputError(f"--rake: {error}") from error


def _print_coefficients(found: Coefficients) -> None:
    summary = found.summary()
    rows = [
        [one["name"], f"{one['value']:.4g}", to_digits(one["standard_deviation"]), one["unit"]]
        for one in summary["coefficients"]
    ]
    rows += [
        [_of_exponent(one["of"]), f"{one['value']:.3f}", to_digits(one["standard_deviation"]), ""]
        for one in summary["exponents"]
    ]
    cuts = number_of_cuts(len(found.measurement.runs))
    title = f"{summary['law']} law, {summary['from']} of {cuts}"
    values = ", ".join(f"{name} {value} {unit}".rstrip() for name, value, _, unit in rows)
    answer_in_report(f"{title}: {values}")
    print_table(title, ["coefficient", "value", "+-", "unit"], rows)
    if summary["from"] == "mean forces" and summary["holdout_error"]:
        for place, error in found.worst_means().items():
            print_line(
                f"mean forces of a cut held out, {place} the feeds of the others, are predicted "
                f"to {error:.1%} or better"
            )
    for name, sign in summary["signs"].items():
        print_line(f"{name} is taken {'as it is' if sign > 0.0 else 'with its sign turned'}")
    if found.waveforms is not None:
        _print_waveforms(summary["waveforms"], summary["law"] if found.by_waveforms else "")
        for place, error in found.waveforms.worst_peaks().items():
            print_line(
                f"peak-to-peak forces of a cut held out, {place} the feeds of the others, are "
                f"predicted to {error:.1%} or better"
            )
    if summary["oblique"] is not None:
        _print_oblique(summary["oblique"])
    if summary["not_fitted"]:
        _print_predicted(summary["not_fitted"], found.units.force)
    for note in summary["notes"]:
        print_notes([note])


def _of_exponent(directions: list[str]) -> str:
    return "exponent" if len(directions) == _ALL else f"{' and '.join(directions)} exponent"


def _print_oblique(one: dict[str, Any]) -> None:
    print_table(
        "oblique law, rake as given and shear angle by Merchant",
        ["number", "value", "+-", "unit"],
        [
            [key["name"], f"{key['value']:.4g}", to_digits(key["standard_deviation"]), key["unit"]]
            for key in one["values"]
        ],
    )
    if not one["holds"]:
        print_line("the oblique law does not hold: the axial force is not that of this helix")


def _print_predicted(cuts: dict[str, Any], force: UsualUnit) -> None:
    print_table(
        "cuts that were not fitted",
        ["run", "channel", f"mean [{force.name}]", "predicted", f"peak-to-peak [{force.name}]",
         "predicted"],
        [
            [
                run, channel,
                f"{force.factor * one['mean_N']:.1f}",
                f"{force.factor * one['mean_predicted_N']:.1f}",
                f"{force.factor * one['peak_to_peak_N']:.0f}",
                f"{force.factor * one['peak_to_peak_predicted_N']:.0f}",
            ]
            for run, channels in cuts.items()
            for channel, one in channels.items()
        ],
    )  # fmt: skip


def _print_waveforms(summary: dict[str, Any], shown: str) -> None:
    """Print what waveforms say; `shown` is the law whose coefficients are printed already."""
    keys = ["runout", "helix"]
    if summary["law"] != shown:
        keys = ["coefficients", "exponents", *keys]
    numbers = [one for key in keys for one in summary[key]]
    if numbers:
        print_table(
            f"{summary['law']} law, whole waveforms of {number_of_cuts(len(summary['cuts']))}",
            ["number", "value", "+-", "unit"],
            [
                [
                    one["name"], f"{one['value']:.4g}", to_digits(one["standard_deviation"]),
                    one["unit"],
                ]
                for one in numbers
            ],
        )  # fmt: skip
    for name, one in summary["resonances"].items():
        print_line(f"{name} has a resonance at {one['frequency_Hz']:.0f} Hz")
    if summary["low_pass_Hz"] is not None:
        print_line(f"all channels pass a low-pass of {summary['low_pass_Hz']:.0f} Hz")
    for cut in summary["cuts"]:
        left = ", ".join(f"{name} {share:.0%}" for name, share in cut["left"].items())
        print_line(f"{cut['run']}: the waveforms leave {left} of the varying force")
    print_notes(summary["notes"])
