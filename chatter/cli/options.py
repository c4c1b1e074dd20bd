"""Options that every command shares."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from chatter.case import Case, load, parse_assignments

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).")]
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
Method = Annotated[
    str | None,
    typer.Option("--method", help="semi-discretization (default), zero-order or time."),
]


def patched_case(path: Path, assignments: list[str] | None) -> Case:
    """Load a case file and apply the assignments of the command line."""
    case = load(path)
    return case.patch(parse_assignments(assignments)) if assignments else case


def output_folder(given: Path | None, name: str) -> Path:
    """Folder to write to: as given, else one named after the input, here."""
    return given if given is not None else Path(f"{name}-out")
