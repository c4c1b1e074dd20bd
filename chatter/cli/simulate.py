"""`chatter simulate CASE`: the cut in the time domain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.errors import EXIT_RUN_FAILED
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.report.console import print_table

if TYPE_CHECKING:
    from chatter.simulation.result import SimulationResult

#: peak at the start over that of the settled cut from which on it is worth a line
_NOTABLE = 1.02


def simulate(
    case: options.CaseFile,
    assignments: options.Assignments = None,
    chip: Annotated[
        str | None, typer.Option("--chip", help="delay (default), dexel or voxel.")
    ] = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Simulate the cut of a case: forces, vibration, surface, chatter or not."""
    description = options.patched_case(case, assignments)
    if chip is not None:
        description = description.patch({"simulation.chip": chip})
    from chatter.engine.loop import run
    from chatter.simulation.simulate import simulate as run_simulation

    with progress_bar("time steps of the cut", run) as progress:
        result = run_simulation(description, progress=progress)
    options.print_coefficients(description)
    present(
        result,
        options.output_folder(out, case.stem),
        json=json,
        words=_print_summary,
        notes=result.summary()["notes"],
    )
    if result.interrupted:
        raise typer.Exit(EXIT_RUN_FAILED)


def _print_summary(result: SimulationResult) -> None:
    summary = result.summary()
    peak, mean = summary["peak_force_N"], summary["mean_force_N"]
    rows = [[name, f"{peak[name]:.4g}", f"{mean[name]:.4g}"] for name in peak]
    print_table("force on the tool, settled cut", ["", "peak [N]", "mean [N]"], rows)
    power = summary["power"]
    typer.echo(
        f"power {power['mean_W']:.4g} W mean, {power['peak_W']:.4g} W peak; "
        f"torque {power['mean_torque_Nm']:.3g} N m mean"
    )
    typer.echo(
        f"cutting speed {summary['cutting_speed_m_per_min']:.4g} m/min, "
        f"feed rate {summary['feed_rate_mm_per_min']:.4g} mm/min; "
        f"displacement {summary['peak_displacement_um']:.3g} um peak"
    )
    _print_transient(summary)
    error = summary.get("surface_location_error_um")
    if error is not None:
        typer.echo(f"surface location error {error:.3g} um")
    frequency = summary["chatter_frequency_Hz"]
    at = "" if frequency is None else f" at {frequency:.1f} Hz"
    typer.echo(f"{summary['verdict']}{at}: {summary['reason']}")


def _print_transient(summary: dict) -> None:
    """Print what the start exceeds the settled cut by, where it does."""
    start = summary.get("transient")
    if start is None:
        return
    above = [
        f"{start[key]:.4g} {unit}"
        for key, unit in (("peak_resultant_N", "N"), ("peak_displacement_um", "um"))
        if start[key] > _NOTABLE * summary[key]
    ]
    if above:
        typer.echo(f"at the start, until {start['until_s']:.3g} s: up to {' and '.join(above)}")
