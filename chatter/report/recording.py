"""The document that a command fills while it prints; there is none without `--report`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from chatter.report.document import Document

_DOCUMENT: ContextVar[Document | None] = ContextVar("document", default=None)


def document() -> Document | None:
    """Document of the command that runs; None where no report was asked for."""
    return _DOCUMENT.get()


@contextmanager
def recording(filled: Document) -> Iterator[None]:
    """Let what is printed fill a document."""
    token = _DOCUMENT.set(filled)
    try:
        yield
    finally:
        _DOCUMENT.reset(token)
