"""Options that every command shares."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.description.assignments import parse_assignments
from chatter.description.case import Case, load
from chatter.stability.registry import AUTO, METHODS

if TYPE_CHECKING:
    from chatter.description.machine.machine_file import MachineFile

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
    ),
]


def patched_case(path: Path, assignments: list[str] | None) -> Case:
    """Load a case file and apply the assignments of the command line."""
    case = load(path)
    return case.patch(parse_assignments(assignments)) if assignments else case


def patched_machine(path: Path, assignments: list[str] | None) -> MachineFile:
    """Load a machine file and apply the assignments of the command line."""
    from chatter.description.machine.machine_file import load_machine

    machine = load_machine(path)
    return machine.patch(parse_assignments(assignments)) if assignments else machine


def output_folder(given: Path | None, name: str) -> Path:
    """Folder to write to: as given, else one named after the input, here."""
    return given if given is not None else Path(f"{name}-out")
