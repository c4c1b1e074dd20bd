"""Tables, lines and notes on the terminal and in the report; where files were written."""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from chatter.report.recording import document

#: messages go to stderr, so that stdout holds results alone
MESSAGES = Console(stderr=True, highlight=False, soft_wrap=True)
RESULTS = Console(highlight=False, soft_wrap=True)
_WIDTH_OF_FILES = 140


@contextmanager
def stdout_for_json() -> Iterator[None]:
    """Keep words off stdout, which JSON has for itself; a report still takes them."""
    RESULTS.quiet = True
    try:
        yield
    finally:
        RESULTS.quiet = False


def print_json(summary: dict) -> None:
    """Print a summary as JSON on stdout."""
    RESULTS.print(json.dumps(summary, indent=2), markup=False, emoji=False)


def print_table(title: str, headers: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table on stdout."""
    report = document()
    if report is not None:
        from chatter.report.document import Table as ReportTable

        report.parts.append(ReportTable(title, list(headers), [list(row) for row in rows]))
    # as text: a unit in brackets is no markup
    table = Table(title=Text(title), title_justify="left")
    for header in headers:
        table.add_column(Text(header), justify="right")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    if not RESULTS.is_terminal:
        # a file or a pipe has no width of its own
        RESULTS.width = max(RESULTS.width, _WIDTH_OF_FILES)
    RESULTS.print(table)


def print_answer(text: str) -> None:
    """Print the sentence that answers what the command was asked."""
    report = document()
    if report is not None:
        report.add_answer(text.strip())
    RESULTS.print(text, markup=False, emoji=False)


def answer_in_report(text: str) -> None:
    """State what answers the question of a report, where the terminal has it in a table."""
    report = document()
    if report is not None:
        report.add_answer(text)


def print_line(text: str) -> None:
    """Print a line of a result on stdout."""
    report = document()
    if report is not None:
        report.parts.append(text.strip())
    RESULTS.print(text, markup=False, emoji=False)


def print_message(text: str) -> None:
    """Print a message on stderr."""
    MESSAGES.print(text, markup=False, emoji=False)


def print_notes(notes: Sequence[str]) -> None:
    """Print what the user should know of a result."""
    report = document()
    for note in notes:
        if report is not None:
            report.add_note(note)
        print_message(f"note: {note}")


def print_written(paths: Sequence[Path]) -> None:
    """Print where files were written."""
    report = document()
    if report is not None:
        report.add_written(paths)
    for path in paths:
        print_message(f"wrote {path}")
