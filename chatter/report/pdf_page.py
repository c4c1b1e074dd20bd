"""A document as PDF pages."""

from __future__ import annotations

from typing import BinaryIO

from chatter.plots.pages import Pages, pages_of
from chatter.report.document import Document, Table, rows_of


def write_pdf(document: Document, version: str, date: str, file: BinaryIO) -> None:
    """Write a document as PDF.

    Parameters
    ----------
    document : Document
    version, date : str
        Of the program, and of the run.
    file : binary file
    """
    with pages_of(file, document.title) as pages:
        _fill(pages, document, version, date)


def _fill(pages: Pages, document: Document, version: str, date: str) -> None:
    pages.title(document.title)
    pages.text(document.question, color="#555555")
    if document.answer:
        pages.text(document.answer, 11.0, weight="bold")
    for picture in document.pictures:
        pages.picture(picture.png)
    if document.parts:
        pages.heading("Result")
    for part in document.parts:
        if isinstance(part, Table):
            if part.title:
                pages.heading(part.title, 10.5)
            pages.table(part.headers, part.rows)
        else:
            pages.text(part)
    if document.notes:
        pages.heading("Notes")
        for note in document.notes:
            pages.text(note)
    pages.heading("Method")
    for method in document.methods:
        pages.text(method)
    _fill_origin(pages, document, version, date)


def _fill_origin(pages: Pages, document: Document, version: str, date: str) -> None:
    """Write what was read, and the call."""
    pages.heading("Inputs")
    for described in document.descriptions:
        pages.text(described.name, weight="bold")
        pages.table(["key", "value"], rows_of(described))
    if document.files:
        rows = [[one.name, f"{one.size}", one.sha256] for one in document.files]
        pages.table(["file", "bytes", "SHA-256"], rows)
    pages.heading("How it was made")
    pages.code(document.command_line)
    pages.text(f"chatter {version}, {date}")
    if document.written:
        pages.text(f"Files written: {', '.join(path.name for path in document.written)}")
