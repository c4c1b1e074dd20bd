"""Sentences on the page: wrapped at the width of the view."""

from __future__ import annotations

from typing import Any

import panel as pn

#: the text lies in an element of its own, which a style of the pane does not reach
_WRAPPED = "pre {white-space: pre-wrap; overflow-wrap: anywhere; margin: 0; font-family: inherit}"


def wrapped_text(
    text: str = "", width: int = 900, styles: dict[str, Any] | None = None
) -> pn.pane.Str:
    """Text that is shown as it stands, in lines of the width, pixels."""
    return pn.pane.Str(text, width=width, styles=styles or {}, stylesheets=[_WRAPPED])
