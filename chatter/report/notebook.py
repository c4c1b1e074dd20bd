"""A result as a notebook shows it: what it is, its sentences, its table, its picture."""

from __future__ import annotations

import base64
import re
import sys
from html import escape
from importlib.util import find_spec
from typing import Any

from chatter.description.unit_system import METRIC
from chatter.plots.interactive_picture import interactive_picture
from chatter.plots.notebook_scripts import load_notebook_scripts
from chatter.plots.style import png_of
from chatter.report.summary_rows import summary_rows

#: characters of a repr that a notebook shows
_LONGEST_REPR = 200


def notebook_page(result: Any) -> str:
    """HTML of a result; its texts are escaped, its picture is inlined.

    In a notebook with Panel installed, a picture of lines and areas can be zoomed.

    Parameters
    ----------
    result : object
        With ``plot()``; ``sentences()`` and ``rows()`` are shown where it has them, else what
        ``summary()`` has.
    """
    parts = [f"<p>{escape(one)}</p>" for one in _words(result)]
    rows = ("".join(f"<td>{escape(one)}</td>" for one in row) for row in _rows(result))
    table = "".join(f"<tr>{row}</tr>" for row in rows)
    if table:
        parts.append(f"<table>{table}</table>")
    drawn = result.plot()
    pages = drawn if isinstance(drawn, (list, tuple)) else [drawn]
    return "".join((*parts, *map(_picture, pages)))


def _rows(result: Any) -> list[Any]:
    """Table of a result; that of its summary where it has none and no sentences."""
    if callable(getattr(result, "rows", None)):
        return result.rows()
    if hasattr(result, "sentences") or not hasattr(result, "summary"):
        return []
    return summary_rows(result.summary(), getattr(result, "units", METRIC))


def _words(result: Any) -> list[str]:
    """Sentences of a result; its verdict where it has one and no sentences."""
    if hasattr(result, "sentences"):
        return result.sentences()
    summary = result.summary() if hasattr(result, "summary") else {}
    words = [str(summary[key]) for key in ("verdict", "reason") if summary.get(key)]
    return [_name(result), *([": ".join(words)] if words else [])]


def _name(result: Any) -> str:
    """What a result is, and of what case."""
    told = repr(result)
    if len(told) <= _LONGEST_REPR and not told.startswith("<"):
        return told
    # of arrays, or of a class whose name is one word of Python
    kind = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(result).__name__).removesuffix(" Result")
    case = getattr(result, "case", None)
    titles = (getattr(one, "title", "") for one in (result, case))
    title = next(filter(None, titles), getattr(case, "name", ""))
    return ": ".join(filter(None, (kind.capitalize(), title)))


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
