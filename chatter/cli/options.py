"""Options that every command shares."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from chatter.description.assignments import parse_assignments
from chatter.description.bare_numbers import refuse_bare_assignments
from chatter.description.case import MACHINE_PATH, Case, load
from chatter.description.errors import InputError
from chatter.description.material_words import coefficients_in_words, notes_on_material
from chatter.description.patchable import Description
from chatter.description.stated_cut import refuse_both_of_a_pair
from chatter.io.result_tables import KINDS
from chatter.report.console import print_message, print_notes
from chatter.report.recording import document
from chatter.stability.registry import AUTO, METHODS

if TYPE_CHECKING:
    from chatter.description.machine.machine_file import MachineFile

Described = TypeVar("Described", bound=Description)


CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).")]
MachinePath = Annotated[Path, typer.Argument(metavar="MACHINE", help="Machine file (TOML).")]
Assignments = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help='Patch the case, such as cut.axial_depth="2 mm"; repeatable.',
    ),
]
OutputFolder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Folder for what is written.")
]
Columns = Annotated[
    str | None,
    typer.Option(
        "--columns",
        metavar="HEADINGS",
        help='Of a file without headings: "time [s], force [N], acceleration [m/s^2]".',
    ),
]
Tables = Annotated[str, typer.Option("--tables", help=f"Files of the tables: {', '.join(KINDS)}.")]
Json = Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        metavar="ADDRESS",
        help='Dask cluster to compute on: "local" or tcp://host:port of a scheduler.',
    ),
]
Method = Annotated[
    str | None,
    typer.Option(
        "--method",
        help=f"{AUTO} (default), {', '.join(METHODS.names())}.",
        autocompletion=lambda: [AUTO, *METHODS.names()],
    ),
]


def patched_case(path: Path, assignments: list[str] | None) -> Case:
    """Load a case file and apply the assignments of the command line, which may mend it."""
    try:
        case = load(path)
    except InputError:
        # a machine is read once the case stands
        values = parse_assignments(assignments or [])
        own = {key: one for key, one in values.items() if not key.startswith(MACHINE_PATH)}
        if not own:
            raise
        case = Case.from_mended_file(path, own)
    return patched(case, assignments)


def print_coefficients(case: Case) -> None:
    """Print the coefficients of a case on stderr, with the source of a named material."""
    report = document()
    if report is not None:
        report.add_description(case)
    sentence = coefficients_in_words(case)
    if sentence is not None:
        print_message(sentence)
    print_notes(notes_on_material(case))


def patched_machine(path: Path, assignments: list[str] | None) -> MachineFile:
    """Load a machine file and apply the assignments of the command line."""
    from chatter.description.machine.machine_file import load_machine

    return patched(load_machine(path), assignments)


def patched(described: Described, assignments: list[str] | None) -> Described:
    """Apply the assignments of the command line to a description that was read."""
    values = parse_assignments(assignments or [])
    refuse_bare_assignments(type(described), values)
    refuse_both_of_a_pair(values)
    patched = described.patch(values) if values else described
    report = document()
    if report is not None:
        report.add_description(patched)
    print_notes(patched.notes)
    return patched


def output_folder(given: Path | None, name: str) -> Path:
    """Folder to write to: as given, else one named after the input, here.

    InputError, before the work is done, if nothing can be written there.
    """
    folder = given if given is not None else Path(f"{name}-out")
    there = next(one for one in (folder, *folder.absolute().parents) if one.exists())
    if not there.is_dir():
        raise InputError(f"--out {folder}: {there} is a file; a folder is required")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"--out {folder}: nothing may be written to {there}; name another folder")
    return folder
