"""`chatter compare MEASUREMENT`: error of the declared case by run and channel."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from chatter.cli import options
from chatter.cli.explain import DeclaredCase, MeasurementPath, print_checks, print_diagnostics
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.description.kinds_of_files import refuse_other_file
from chatter.io.headings import signal_unit
from chatter.report.console import answer_in_report, print_table

if TYPE_CHECKING:
    from chatter.explain.comparison import Comparison


def compare(
    measurement: MeasurementPath,
    case: DeclaredCase = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Error of a case's prediction, by run and channel."""
    from chatter.explain.comparison import compare as run_compare
    from chatter.explain.measurement_file import read_measurement

    refuse_other_file(measurement, "measurement")
    declared = read_measurement(measurement, case)
    folder = options.output_folder(out, measurement.resolve().stem)
    with progress_bar("predicting the runs"):
        result = run_compare(declared)
    options.print_coefficients(declared.case)
    present(result, folder, json=json, words=partial(_print_errors, declared.title))


def _print_errors(title: str, result: Comparison) -> None:
    answer_in_report(result.headline)
    print_checks([one.as_dict() for one in result.checks])
    rows = [
        [
            one.run,
            one.channel,
            _in_usual_unit(one.error, one.channel),
            f"{100.0 * one.relative:.2f}",
            f"{one.over_noise:.2f}",
        ]
        for one in result.errors
    ]
    headers = ["run", "channel", "rms error", "of the signal [%]", "times the noise"]
    print_table(title, headers, rows)
    if result.signature is not None:
        print_diagnostics(result.signature.summary())


def _in_usual_unit(error: float, channel: str) -> str:
    unit = signal_unit(channel)
    return f"{error * unit.factor:.4g} {unit.name}".rstrip()
