"""What the commands that search have in common: progress, files, what was found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol, TypeVar

from chatter.cli.options import output_folder, patched_case
from chatter.cli.report import (
    announce_compilation,
    print_json,
    print_line,
    print_notes,
    print_written,
    progress_bar,
)
from chatter.description.case import Case
from chatter.description.progress import Progress


class Found(Protocol):
    """What a search has found."""

    @property
    def notes(self) -> Sequence[str]:
        """What the user should know of it."""
        ...

    def told(self) -> list[str]:
        """Sentences for the terminal."""
        ...

    def summary(self) -> dict:
        """Content of summary.json."""
        ...

    def save(self, folder: str | Path) -> list[Path]:
        """Write the files and return which."""
        ...


Result = TypeVar("Result", bound=Found)


def searched(
    search: Callable[[Case, Progress, Path], Result],
    noun: str,
    case: Path,
    assignments: list[str] | None,
    out: Path | None,
    json: bool,
) -> Result:
    """Search for something of a case, show progress, write and tell what was found.

    Parameters
    ----------
    search : callable
        (case, progress, folder) -> what was found; the folder keeps what is finished.
    noun : str
        What the progress counts.
    case, assignments, out, json
        As the command was given them.
    """
    description = patched_case(case, assignments)
    folder = output_folder(out, case.stem)
    announce_compilation()
    with progress_bar(noun) as progress:
        found = search(description, progress, folder)
    written = found.save(folder)
    if json:
        print_json(found.summary())
    else:
        for line in found.told():
            print_line(line)
    print_notes(found.notes)
    print_written(written)
    return found
