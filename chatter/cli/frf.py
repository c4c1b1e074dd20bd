"""`chatter frf MACHINE`: frequency responses of a machine, linearised and by tests in time."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli.options import (
    Assignments,
    Json,
    MachinePath,
    OutputFolder,
    output_folder,
    patched_machine,
)
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.units import NUMBER
from chatter.report.console import print_line, print_table
from chatter.studies.frf_units import frf_unit

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.frf import FrfResult

Pairs = list[str] | None


@dataclass(frozen=True)
class FrfOptions:
    """What `chatter frf` is given."""

    machine: MachinePath
    assignments: Assignments = None
    only: Annotated[
        Pairs, typer.Option("--only", help="Name of a [frf.NAME] to run; repeatable.")
    ] = None
    excite: Annotated[
        str | None,
        typer.Option(
            "--excite", help='A test of your own: "table:y", "tool/table:y" or "motor:Y" (torque).'
        ),
    ] = None
    read: Annotated[str | None, typer.Option("--read", help="What is read in it.")] = None
    by: Annotated[
        str | None,
        typer.Option(
            "--by", help="hammer, chirp, multisine, torque impulse, torque multisine or linearised."
        ),
    ] = None
    level: Annotated[
        str | None, typer.Option("--level", help='Peak of the excitation, "100 N".')
    ] = None
    band: Annotated[
        str | None, typer.Option("--band", help='Lowest and highest frequency, "5 Hz..500 Hz".')
    ] = None
    moving: Annotated[
        Pairs, typer.Option("--moving", help='Axis in motion, "Y=420 mm/min"; repeatable.')
    ] = None
    position: Annotated[
        Pairs, typer.Option("--position", help='Place of an axis, "Y=100 mm"; repeatable.')
    ] = None
    brake: Annotated[Pairs, typer.Option("--brake", help="Axis held by its brake.")] = None
    free: Annotated[Pairs, typer.Option("--free", help="Axis held by nothing.")] = None
    no_friction: Annotated[bool, typer.Option("--no-friction", help="Leave all frictions out.")] = (
        False
    )
    in_cut: Annotated[bool, typer.Option("--in-cut", help="With the couplings of [contact].")] = (
        False
    )
    out: OutputFolder = None
    json: Json = False


@takes_options
def frf(options: FrfOptions) -> None:
    """Frequency responses of a machine: at rest, moving, brake on, control on, in the cut."""
    from chatter.cli.machine_tests import frf_sections
    from chatter.engine.loop import run
    from chatter.simulation.virtual_tests.from_file import frfs

    file = patched_machine(options.machine, options.assignments)
    band = options.band
    changes = {
        "excite": options.excite,
        "read": options.read,
        "by": options.by,
        "level": options.level,
        "band": None if band is None else _ends(band),
        "moving": options.moving,
        "position": options.position,
        "brake": options.brake,
        "free": options.free,
        "friction": False if options.no_friction else None,
        "in_cut": True if options.in_cut else None,
    }
    given = {key: value for key, value in changes.items() if value is not None}
    sections = frf_sections(file, options.only, given)
    folder = output_folder(options.out, options.machine.stem)
    with progress_bar("time steps of the tests", run) as progress:
        result = frfs(file, sections, progress)
    present(result, folder, json=options.json, words=_print_peaks, notes=result.notes)


def _ends(band: str) -> list[str]:
    """Ends of a band, FROM..TO or separated by a comma."""
    ends = [part.strip() for part in band.split(".." if ".." in band else ",")]
    unit = re.sub(rf"^{NUMBER}\s*", "", ends[-1])
    if not unit:
        raise InputError(
            f"--band {formatted(band)} has no unit; a band is written as in "
            f'"{ends[0]} Hz..{ends[-1]} Hz"'
        )
    # "10..200 Hz" is meant as 10 Hz..200 Hz
    return [f"{end} {unit}" if re.fullmatch(NUMBER, end) else end for end in ends]


def _print_peaks(result: FrfResult) -> None:
    for curve in result.summary()["curves"]:
        rows, (unit, factor) = [], frf_unit(curve["unit"])
        for how, key in (("linearised", "peaks"), ("test", "tested_peaks")):
            for peak in curve[key] or []:
                damping = peak["damping"]
                rows.append(
                    [
                        how,
                        f"{peak['frequency_Hz']:.2f}",
                        f"{factor * peak['magnitude']:.4g}",
                        "" if damping is None else f"{100.0 * damping:.2f}",
                    ]
                )
        state = f" ({curve['state']})" if curve["state"] else ""
        of_what = f"{curve['name']}{state}: peaks of the {curve['quantity']}"
        if rows:
            headers = ["", "frequency [Hz]", f"magnitude [{unit}]", "damping [%]"]
            print_table(of_what, headers, rows)
        else:
            print_line(_without_peaks(of_what, curve))


def _without_peaks(of_what: str, curve: dict) -> str:
    lowest, highest = curve["band_Hz"]
    largest, (unit, factor) = curve["largest"], frf_unit(curve["unit"])
    return (
        f"{of_what}: none from {lowest:g} to {highest:g} Hz; the largest value is "
        f"{factor * largest['magnitude']:.4g} {unit} at {largest['frequency_Hz']:.4g} Hz"
    )
