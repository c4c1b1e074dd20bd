"""The command line as it was typed, for the report."""

from contextvars import ContextVar

#: words after the name of the program
TYPED: ContextVar[tuple[str, ...]] = ContextVar("typed", default=())
