"""`chatter simulate CASE`: the cut in the time domain."""

from __future__ import annotations

from typing import Annotated

import typer

from chatter.cli.errors import EXIT_RUN_FAILED, reports_errors
from chatter.cli.options import (
    Assignments,
    CaseFile,
    Json,
    OutputFolder,
    output_folder,
    patched_case,
)
from chatter.cli.report import (
    announce_compilation,
    print_json,
    print_notes,
    print_table,
    print_written,
    progress_bar,
)


@reports_errors
def simulate(
    case: CaseFile,
    assignments: Assignments = None,
    chip: Annotated[
        str | None, typer.Option("--chip", help="delay (default), dexel or voxel.")
    ] = None,
    out: OutputFolder = None,
    json: Json = False,
) -> None:
    """Simulate the cut of a case: forces, vibration, surface, chatter or not."""
    description = patched_case(case, assignments)
    if chip is not None:
        description = description.patch({"simulation.chip": chip})
    from chatter.engine.loop import run
    from chatter.simulation.simulate import simulate as run_simulation

    announce_compilation(run)
    with progress_bar("time steps") as progress:
        result = run_simulation(description, progress)
    written = result.save(output_folder(out, case.stem))
    summary = result.summary()
    if json:
        print_json(summary)
    else:
        _print_summary(summary)
    print_notes(summary["notes"])
    print_written(written)
    if result.interrupted:
        raise typer.Exit(EXIT_RUN_FAILED)


def _print_summary(summary: dict) -> None:
    peak, mean = summary["peak_force_N"], summary["mean_force_N"]
    rows = [[name, f"{peak[name]:.4g}", f"{mean[name]:.4g}"] for name in peak]
    print_table("force on the tool", ["", "peak [N]", "mean [N]"], rows)
    power = summary["power"]
    typer.echo(
        f"power {power['mean_W']:.4g} W mean, {power['peak_W']:.4g} W peak; "
        f"torque {power['mean_torque_Nm']:.3g} N m mean"
    )
    error = summary.get("surface_location_error_um")
    if error is not None:
        typer.echo(f"surface location error {error:.3g} um")
    frequency = summary["chatter_frequency_Hz"]
    heard = "" if frequency is None else f" at {frequency:.1f} Hz"
    typer.echo(f"{summary['verdict']}{heard}: {summary['reason']}")
