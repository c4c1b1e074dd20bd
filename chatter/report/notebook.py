"""A result as a notebook shows it: what it is, its sentences, its table, its picture."""

from __future__ import annotations

import base64
from html import escape
from typing import Any

from chatter.plots.style import png_of


def notebook_page(result: Any) -> str:
    """HTML of a result; its texts are escaped, its picture is inlined.

    Parameters
    ----------
    result : object
        With ``plot()``; ``sentences()`` and ``rows()`` are shown where it has them.
    """
    sentences = result.sentences() if hasattr(result, "sentences") else [repr(result)]
    parts = [f"<p>{escape(one)}</p>" for one in sentences]
    if callable(getattr(result, "rows", None)):
        rows = ("".join(f"<td>{escape(one)}</td>" for one in row) for row in result.rows())
        parts.append(f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>")
    picture = base64.b64encode(png_of(result.plot())).decode("ascii")
    parts.append(f'<img src="data:image/png;base64,{picture}" style="max-width:100%">')
    return "".join(parts)
