"""What the commands say on the terminal: progress, tables, where files went."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

#: messages go to stderr, so that stdout holds results alone
MESSAGES = Console(stderr=True, highlight=False, soft_wrap=True)
RESULTS = Console(highlight=False, soft_wrap=True)


@contextmanager
def progress_bar(description: str) -> Iterator:
    """Show a progress bar on stderr; yields a function of (done, total)."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=MESSAGES, transient=True) as bar:
        task = bar.add_task(description, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def announce_compilation(driver: object | None = None) -> None:
    """Say that the first use compiles, where the cache does not hold the kernels yet.

    Parameters
    ----------
    driver : compiled function, optional
        Asked for alone; by default any kernel will do.
    """
    from chatter.engine.presets import CACHE_FOLDER, is_compiled

    known = any(CACHE_FOLDER.rglob("*.nbi")) if driver is None else is_compiled(driver)
    if not known:
        MESSAGES.print("first use: compiling the numerical kernels, once, about half a minute ...")


def print_json(summary: dict) -> None:
    """Print a summary as JSON on stdout."""
    RESULTS.print(json.dumps(summary, indent=2), markup=False)


def print_table(title: str, headers: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table on stdout."""
    # as text: a unit in brackets is no markup
    table = Table(title=Text(title), title_justify="left")
    for header in headers:
        table.add_column(Text(header), justify="right")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    RESULTS.print(table)


def print_line(text: str) -> None:
    """Print a line of a result on stdout."""
    RESULTS.print(text, markup=False)


def print_notes(notes: Sequence[str]) -> None:
    """Print what the user should know of a result."""
    for note in notes:
        MESSAGES.print(f"note: {note}", markup=False)


def print_written(paths: Sequence[Path]) -> None:
    """Say where files were written."""
    for path in paths:
        MESSAGES.print(f"wrote {path}", markup=False)
