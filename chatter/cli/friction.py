"""`chatter friction RECORDS`: friction and inertia of a drive from records of its moves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.description.errors import InputError
from chatter.description.units import QuantityError, parse
from chatter.report.console import answer_in_report, print_line, print_table

if TYPE_CHECKING:
    from chatter.drive_friction.result import DriveFriction


@dataclass(frozen=True)
class FrictionOptions:
    """What `chatter friction` is given."""

    records: Annotated[
        list[Path],
        typer.Argument(metavar="RECORDS...", help="Files of moves, or a folder of kind axis."),
    ]
    position: Annotated[
        str | None,
        typer.Option("--position", metavar="HEADING", help="Column, where headings do not tell."),
    ] = None
    velocity: Annotated[
        str | None, typer.Option("--velocity", metavar="HEADING", help="Column of the velocity.")
    ] = None
    effort: Annotated[
        str | None,
        typer.Option(
            "--effort",
            metavar="HEADING",
            help='Column of force, torque or current, such as "i act. X [A]"; - turns its sign.',
        ),
    ] = None
    columns: options.Columns = None
    lead: Annotated[
        str | None, typer.Option("--lead", help='Travel for a revolution of the motor, "10 mm".')
    ] = None
    torque_constant: Annotated[
        str | None, typer.Option("--torque-constant", help='Of the motor, "1.2 N*m/A".')
    ] = None
    force_constant: Annotated[
        str | None, typer.Option("--force-constant", help='Of a linear motor, "80 N/A".')
    ] = None
    rated_torque: Annotated[
        str | None, typer.Option("--rated-torque", help='Torque of 100 %, "2.4 N*m".')
    ] = None
    rated_force: Annotated[
        str | None, typer.Option("--rated-force", help='Force of 100 %, "900 N".')
    ] = None
    inertia: Annotated[
        str | None,
        typer.Option("--inertia", help='Known: "24.7 kg", or "0.01 kg*m^2" about the motor.'),
    ] = None
    low_pass: Annotated[
        str | None,
        typer.Option("--low-pass", help='Cut-off frequency, "60 Hz" or less by default.'),
    ] = None
    law: Annotated[
        str | None, typer.Option("--law", help="Keep viscous, coulomb, stribeck or lugre.")
    ] = None
    name: Annotated[str, typer.Option("--name", help="Axis of [friction.NAME].")] = "axis"
    out: options.OutputFolder = None
    json: options.Json = False


@takes_options
def friction(given: FrictionOptions) -> None:
    """Find friction and inertia of a drive from records of its moves."""
    from chatter.drive_friction.drive_records import DriveSettings, drive_records
    from chatter.drive_friction.identify import friction as identify

    settings = DriveSettings(
        given.position,
        given.velocity,
        given.effort,
        given.columns,
        _positive("--lead", given.lead, "length"),
        _positive("--torque-constant", given.torque_constant, "torque_constant"),
        _positive("--force-constant", given.force_constant, "force_constant"),
        _positive("--rated-torque", given.rated_torque, "torque"),
        _positive("--rated-force", given.rated_force, "force"),
    )
    records = drive_records(given.records, settings)
    dimension = "moment_of_inertia" if records.rotary else "mass"
    folder = options.output_folder(given.out, given.records[0].resolve().stem)
    with progress_bar("friction laws"):
        found = identify(
            records,
            inertia=_positive("--inertia", given.inertia, dimension),
            low_pass=_positive("--low-pass", given.low_pass, "frequency"),
            law=given.law,
            name=given.name,
        )
    present(found, folder, json=given.json, words=_print_friction, notes=found.notes)


def _positive(option: str, given: str | None, dimension: str) -> float | None:
    if given is None:
        return None
    try:
        value = parse(given, dimension).value
    except QuantityError as error:
        raise InputError(f"{option}: {error}") from None
    if not value > 0.0:
        raise InputError(f"{option}: {given} is not above 0")
    return value


def _print_friction(found: DriveFriction) -> None:
    summary = found.summary()
    rows = [
        [one["name"], f"{one['value']:.4g}", _interval(one["ci95"]), one["unit"]]
        for one in summary["parameters"]
    ]
    count = len(found.given.records)
    title = f"{summary['law']} friction {summary['motion']}, {count} record{'s'[: count > 1]}"
    values = ", ".join(f"{name} {value} {unit}" for name, value, _, unit in rows)
    answer_in_report(f"{title}: {values}")
    print_table(title, ["parameter", "value", "95 %", "unit"], rows)
    for one in summary["laws"]:
        error = one["holdout_error"]
        words = one["reason"] or ("not judged" if error is None else f"{error:.1%}")
        print_line(
            f"{one['law']}: error on parts held out {words}"
            if error is not None
            else f"{one['law']}: {words}"
        )
    print_line(
        f"left of the effort below {summary['low_pass_Hz']:g} Hz: {summary['residual']:.1%} of its "
        "deviation"
    )


def _interval(ends: list[float | None]) -> str:
    lower, upper = ("unbounded" if end is None else f"{end:.4g}" for end in ends)
    return f"{lower} to {upper}"
