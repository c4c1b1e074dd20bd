"""`chatter move MACHINE`: tracking and contour error of a trajectory."""

from typing import Annotated

import typer

from chatter.cli import options
from chatter.cli.errors import EXIT_RUN_FAILED
from chatter.cli.progress import progress_bar
from chatter.description.formatting import to_digits
from chatter.report.console import print_json, print_line, print_notes, print_table, print_written

#: where the work of drives goes -> in words
_ENERGIES = {"friction": "friction", "dissipated": "dampers", "stored": "stored at the end"}


def move(
    machine: options.MachinePath,
    assignments: options.Assignments = None,
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Name of a [move.NAME] to run; repeatable.")
    ] = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Move the axes of a machine: tracking error, contour error, torque."""
    from chatter.cli.machine_tests import move_sections
    from chatter.engine.loop import run
    from chatter.simulation.virtual_tests.from_file import file_move

    file = options.patched_machine(machine, assignments)
    sections = move_sections(file, only)
    folder = options.output_folder(out, machine.stem)
    summaries, written, interrupted = {}, [], False
    behind: list[str] = []
    for name, section in sections.items():
        with progress_bar(f"move {name}", run) as progress:
            result = file_move(file, name, section, progress)
        written += result.save(folder / name if len(sections) > 1 else folder)
        summaries[name] = result.summary()
        behind += [*file.questions_of_positions(section.position)]
        behind += [f"{name}: {text}" for text in summaries[name]["notes"]]
        interrupted = interrupted or result.interrupted
        if interrupted:
            break
    if json:
        print_json(summaries)
    else:
        _print_errors(summaries)
    print_notes(behind)
    print_written(written)
    if interrupted:
        raise typer.Exit(EXIT_RUN_FAILED)


def _print_errors(summaries: dict) -> None:
    for name, summary in summaries.items():
        rows = [
            [
                axis,
                to_digits(errors["motor_error_um"], 4),
                to_digits(errors["tracking_error_um"], 4),
                to_digits(errors["tool_error_um"], 4) if "tool_error_um" in errors else "",
                f"{errors['effort']:.4g} {errors['effort_unit'].replace('*', ' ')}",
            ]
            for axis, errors in summary["axes"].items()
        ]
        titles = ["axis", "motor [um]", "scale [um]", "tool [um]", "effort"]
        print_table(f"{name}: largest set less actual", titles, rows)
        if summary["contour_error_um"] is not None:
            print_line(f"largest contour error {summary['contour_error_um']:.4g} um")
        energy = summary.get("energy_J")
        if not energy:
            continue
        taken = ", ".join(
            f"{words} {energy[key]:.4g} J" for key, words in _ENERGIES.items() if key in energy
        )
        print_line(f"work of the drives {energy.get('drives', 0.0):.4g} J: {taken}")
