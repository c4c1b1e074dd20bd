"""`chatter compare MEASUREMENT`: error of the declared case by run and channel."""

from __future__ import annotations

from chatter.cli.errors import reports_errors
from chatter.cli.explain import DeclaredCase, MeasurementPath, print_checks, print_diagnostics
from chatter.cli.options import Json, OutputFolder, output_folder
from chatter.cli.report import announce_compilation, print_json, print_table, print_written


@reports_errors
def compare(
    measurement: MeasurementPath,
    case: DeclaredCase = None,
    out: OutputFolder = None,
    json: Json = False,
) -> None:
    """Error of a case's prediction, by run and channel."""
    from chatter.explain.comparison import compare as run_compare
    from chatter.explain.measurement_file import read_measurement

    declared = read_measurement(measurement, case)
    announce_compilation()
    result = run_compare(declared)
    written = result.save(output_folder(out, measurement.resolve().stem))
    if json:
        print_json(result.summary())
    else:
        print_checks([one.as_dict() for one in result.checks])
        rows = [
            [
                one.run,
                one.channel,
                f"{one.error:.4g}",
                f"{100.0 * one.relative:.2f}",
                f"{one.over_noise:.2f}",
            ]
            for one in result.errors
        ]
        headers = ["run", "channel", "rms error [SI]", "of the signal [%]", "times the noise"]
        print_table(declared.title, headers, rows)
        if result.signature is not None:
            print_diagnostics(result.signature.summary())
    print_written(written)
