"""What every command does with its result: files, JSON or words, notes."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol, TypeVar

from chatter.cli.progress import running
from chatter.report.console import (
    print_answer,
    print_json,
    print_line,
    print_notes,
    print_written,
    stdout_for_json,
)
from chatter.report.methods import methods_of
from chatter.report.recording import document


class Saved(Protocol):
    """A result that writes its own files."""

    def summary(self) -> dict:
        """Content of summary.json."""
        ...

    def save(self, folder: str | Path) -> list[Path]:
        """Write the files and return which."""
        ...


Result = TypeVar("Result", bound=Saved)


def present(
    result: Result,
    folder: Path,
    *,
    json: bool,
    words: Callable[[Result], None],
    notes: Sequence[str] = (),
    save: Callable[[Path], list[Path]] | None = None,
) -> None:
    """Write the files of a result and print it, as JSON or in words; notes follow on stderr.

    It writes its files itself, unless it is told how to `save` them.
    """
    with running("writing the results"):
        written = (save or result.save)(folder)
    print_result(result, json=json, words=words)
    print_notes(notes)
    print_written(written)
    if not any(path.suffix.lower() == ".png" for path in written):
        _draw_into_report(result)


def _draw_into_report(result: Saved) -> None:
    """Draw a result whose files are no pictures into the report, if there is to be one."""
    report = document()
    drawn = getattr(result, "plot", None)
    if report is None or drawn is None:
        return
    from chatter.plots.style import png_of
    from chatter.report.document import Picture

    pages = drawn()
    for number, page in enumerate(pages if isinstance(pages, (list, tuple)) else [pages], start=1):
        report.pictures.append(Picture(f"page {number}", png_of(page)))


def print_result(result: Result, *, json: bool, words: Callable[[Result], None]) -> None:
    """Print a result, as JSON or in words; a report has the words of both."""
    report = document()
    if report is not None:
        report.methods.extend(methods_of(result.summary()))
    if not json:
        words(result)
        return
    if report is not None:
        with stdout_for_json():
            words(result)
    print_json(result.summary())


class WithSentences(Saved, Protocol):
    """A result that has its own sentences."""

    def sentences(self) -> list[str]:
        """Sentences for the terminal."""
        ...


def print_sentences(result: WithSentences) -> None:
    """Print the sentences of a result; one that found nothing has none."""
    for number, sentence in enumerate(result.sentences()):
        (print_line if number else print_answer)(sentence)
