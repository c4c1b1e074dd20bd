"""`chatter modes FRF...`: modal parameters of measured FRFs or of a folder of hammer records."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import running
from chatter.cli.results import present
from chatter.description.errors import InputError
from chatter.report.console import answer_in_report, print_line, print_table

if TYPE_CHECKING:
    from chatter.studies.modal_test import ModalTest


@dataclass(frozen=True)
class ModesOptions:
    """What `chatter modes` is given."""

    files: Annotated[
        list[Path], typer.Argument(metavar="FRF...", help="FRF files, hammer records, or a folder.")
    ]
    keep: Annotated[
        list[str] | None,
        typer.Option("--keep", metavar="RECORD", help="Use a hammer record in spite of its fault."),
    ] = None
    direction: Annotated[
        str | None, typer.Option("--direction", help="x, y or z, where the files do not say.")
    ] = None
    side: Annotated[str, typer.Option("--side", help="tool or workpiece.")] = "tool"
    band: Annotated[
        tuple[float, float] | None,
        typer.Option("--band", metavar="LOWEST HIGHEST", help="Fit this band only, in Hz."),
    ] = None
    mode_count: Annotated[
        int | None, typer.Option("--mode-count", help="Fix the number of modes.")
    ] = None
    pole: Annotated[
        list[str] | None,
        typer.Option(
            "--pole",
            metavar="HZ,DAMPING",
            help="Refine this pole of the stabilisation diagram, such as 922,0.03; repeatable.",
        ),
    ] = None
    columns: options.Columns = None
    sampling_rate: Annotated[
        str | None,
        typer.Option("--sampling-rate", help='Of records without time, such as "25.6 kHz".'),
    ] = None
    out: options.OutputFolder = None
    json: options.Json = False


@takes_options
def modes(options_: ModesOptions) -> None:
    """Identify modal parameters from measured FRFs or hammer records."""
    from chatter.io.formats.records import stem_of
    from chatter.io.hammer_records import StatedRecord
    from chatter.monitoring.detect import sampling_frequency
    from chatter.studies.modal_test import modes as run_modes

    folder = options.output_folder(options_.out, stem_of(options_.files[0]) or "modes")
    with running("fitting modes to the responses"):
        result = run_modes(
            options_.files,
            keep=options_.keep or (),
            direction=options_.direction,
            side=options_.side,
            band=options_.band,
            mode_count=options_.mode_count,
            columns=StatedRecord(options_.columns, sampling_frequency(options_.sampling_rate)),
            poles=_poles(options_.pole),
        )
    present(
        result,
        folder,
        json=options_.json,
        words=_print_modes,
        notes=[*result.notes, *result.fit.warnings],
    )


def _poles(given: list[str] | None) -> list[tuple[float, float]] | None:
    """Frequencies, Hz, and damping ratios; InputError for what is no pair of numbers."""
    found = []
    for text in given or ():
        try:
            frequency, damping = map(float, text.split(","))
        except ValueError:
            raise InputError(
                f"--pole {text}: a frequency in Hz and a damping ratio are required, "
                "such as 922,0.03"
            ) from None
        found.append((frequency, damping))
    return found or None


def _found_modes(frequencies: list[float]) -> str:
    if not frequencies:
        return "no mode is found"
    count = "1 mode" if len(frequencies) == 1 else f"{len(frequencies)} modes"
    return f"{count}: {', '.join(f'{one:.4g}' for one in frequencies)} Hz"


def _print_modes(result: ModalTest) -> None:
    summary = result.summary()
    answer_in_report(_found_modes([mode["frequency_Hz"] for mode in summary["modes"]]))
    rows = [
        [
            f"{mode['frequency_Hz']:.2f}",
            f"{mode['damping']:.4f}",
            "-" if mode["mass_kg"] is None else f"{mode['mass_kg']:.4g}",
            f"{mode['fit_error']:.1%}",
        ]
        for mode in summary["modes"]
    ]
    print_table("modes", ["frequency [Hz]", "damping", "mass [kg]", "fit error"], rows)
    for record in summary["records"]["excluded"]:
        print_line(f"excluded {record['record']}: {record['reason']}")
    print_line(
        f"synthesis error {summary['fit_error']['maximum']:.2%} of the peak at most, "
        f"{summary['fit_error']['rms']:.2%} rms, {summary['band_Hz'][0]:.0f} to "
        f"{summary['band_Hz'][1]:.0f} Hz"
    )
