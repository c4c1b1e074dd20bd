"""`--report FILE` of every command: added here, once, to what typer sees of a command."""

from __future__ import annotations

import datetime
import functools
import inspect
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from chatter.cli.command_line import TYPED
from chatter.description.errors import InputError
from chatter.description.whole_files import write_whole
from chatter.report.console import print_message
from chatter.report.document import Document
from chatter.report.methods import METHODS
from chatter.report.recording import recording

_KINDS = (".html", ".pdf")

ReportFile = Annotated[
    Path | None,
    typer.Option(
        "--report",
        metavar="FILE",
        help="Also write a report, .html or .pdf: inputs, picture, tables, method.",
    ),
]


def with_report(name: str, command: Callable[..., None]) -> Callable[..., None]:
    """Give a command of a name the option `--report`."""

    @functools.wraps(command)
    def reported(*, report: Path | None = None, **given: Any) -> None:
        if report is None:
            command(**given)
            return
        if report.suffix.lower() not in _KINDS:
            raise InputError(f"--report: {report} must end in {' or '.join(_KINDS)}")
        document = _begun(name)
        with recording(document):
            try:
                command(**given)
            except typer.Exit:
                # the exit code says what the cut does; the report is as good
                _write(document, given, report)
                raise
        _write(document, given, report)

    signature = inspect.signature(command)
    hints = get_type_hints(command, include_extras=True)
    parameters = [
        parameter.replace(annotation=hints[key], kind=inspect.Parameter.KEYWORD_ONLY)
        for key, parameter in signature.parameters.items()
    ]
    option = inspect.Parameter(
        "report", inspect.Parameter.KEYWORD_ONLY, default=None, annotation=ReportFile
    )
    # where inspect.signature and typing.get_type_hints look, which typer asks
    reported.__dict__["__signature__"] = signature.replace(parameters=[*parameters, option])
    reported.__annotations__ = {**hints, "report": ReportFile}
    return reported


def _begun(command: str) -> Document:
    method = METHODS[command]
    return Document(command, shlex.join(["chatter", *TYPED.get()]), method.question, [method.how])


def _write(document: Document, given: dict[str, Any], path: Path) -> None:
    from chatter import __version__
    from chatter.report.html_page import html_page

    document.take_first_sentence_as_answer()
    for one in _paths(given):
        document.add_input(one)
    date = datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %z")
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix.lower() == ".html":
        write_whole(path, html_page(document, __version__, date))
    else:
        from chatter.report.pdf_page import write_pdf

        write_whole(path, lambda file: write_pdf(document, __version__, date, file))
    print_message(f"wrote {path}")


def _paths(given: dict[str, Any]) -> Iterator[Path]:
    """Files and folders that a command was given to read."""
    for name, value in given.items():
        # the folder of the results is no input
        if name == "out":
            continue
        for one in value if isinstance(value, list | tuple) else [value]:
            if isinstance(one, Path) and one.exists():
                yield one
