"""A result as a notebook shows it: what it is, its sentences, its table, its picture."""

from __future__ import annotations

import base64
import sys
from html import escape
from importlib.util import find_spec
from typing import Any

from chatter.plots.interactive_picture import interactive_picture
from chatter.plots.notebook_scripts import load_notebook_scripts
from chatter.plots.style import png_of

#: characters of a repr that a notebook shows
_LONGEST_REPR = 200


def notebook_page(result: Any) -> str:
    """HTML of a result; its texts are escaped, its picture is inlined.

    In a notebook with Panel installed, a picture of lines and areas can be zoomed.

    Parameters
    ----------
    result : object
        With ``plot()``; ``sentences()`` and ``rows()`` are shown where it has them.
    """
    parts = [f"<p>{escape(one)}</p>" for one in _words(result)]
    if callable(getattr(result, "rows", None)):
        rows = ("".join(f"<td>{escape(one)}</td>" for one in row) for row in result.rows())
        parts.append(f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>")
    drawn = result.plot()
    pages = drawn if isinstance(drawn, (list, tuple)) else [drawn]
    return "".join((*parts, *map(_picture, pages)))


def _words(result: Any) -> list[str]:
    """Sentences of a result; its verdict where it has one and no sentences."""
    if hasattr(result, "sentences"):
        return result.sentences()
    summary = result.summary() if hasattr(result, "summary") else {}
    words = [str(summary[key]) for key in ("verdict", "reason") if summary.get(key)]
    told = repr(result)
    if len(told) > _LONGEST_REPR:  # of a record whose arrays say nothing here
        told = " ".join(filter(None, (type(result).__name__, getattr(result, "title", ""))))
    return [told, *([": ".join(words)] if words else [])]


def _picture(drawn: Any) -> str:
    picture = base64.b64encode(png_of(drawn)).decode("ascii")
    image = f'<img src="data:image/png;base64,{picture}" style="max-width:100%">'
    alive = interactive_picture(drawn) if _loads_bokeh() else None
    if alive is None:
        return image
    # scripts do not run in a notebook that is not trusted: there the image is shown
    return f"{alive}<details><summary>image</summary>{image}</details>"


def _loads_bokeh() -> bool:
    """Whether this is a notebook that can show Bokeh, whose scripts are loaded once from disk."""
    shell = sys.modules.get("IPython")
    kernel = getattr(shell.get_ipython() if shell else None, "kernel", None)
    if kernel is None or find_spec("panel") is None:
        return False
    load_notebook_scripts()
    return True
