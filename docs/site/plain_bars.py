"""Bars of magnitudes in docstrings, such as |mu|, are no substitutions of reStructuredText."""

from __future__ import annotations

from typing import Any


def _escape(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    lines[:] = [line.replace("|", r"\|") for line in lines]


def setup(app: Any) -> dict[str, bool]:
    """Register the change of docstrings, before their sections are read."""
    app.connect("autodoc-process-docstring", _escape, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
