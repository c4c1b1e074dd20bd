"""Tables, lines and notes on the terminal; where files were written."""

import json
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

#: messages go to stderr, so that stdout holds results alone
MESSAGES = Console(stderr=True, highlight=False, soft_wrap=True)
RESULTS = Console(highlight=False, soft_wrap=True)


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


def print_message(text: str) -> None:
    """Print a message on stderr."""
    MESSAGES.print(text, markup=False)


def print_notes(notes: Sequence[str]) -> None:
    """Print what the user should know of a result."""
    for note in notes:
        print_message(f"note: {note}")


def print_written(paths: Sequence[Path]) -> None:
    """Print where files were written."""
    for path in paths:
        print_message(f"wrote {path}")
