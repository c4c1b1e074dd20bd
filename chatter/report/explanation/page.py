"""Tables, pictures and the page around them, as HTML without scripts."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from io import BytesIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STYLE = (
    "body{font:15px/1.5 Georgia,serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}"
    "h1,h2,h3,table,figcaption{font-family:Helvetica,Arial,sans-serif}"
    "h1{font-size:1.6em}h2{font-size:1.25em;margin:2em 0 .4em;border-bottom:1px solid #999}"
    "h3{font-size:1.05em;margin:1.2em 0 .2em}"
    "table{border-collapse:collapse;margin:1em 0;font-size:.88em}"
    "td,th{border:1px solid #bbb;padding:.25em .7em;text-align:right}"
    "td:first-child,th:first-child{text-align:left}td.text{text-align:left}"
    "figure{margin:1em 0;display:inline-block;vertical-align:top}img{max-width:100%}"
    "figcaption{font-size:.88em;color:#333}.half{width:49%}"
    ".verdict{border-left:.4em solid #0072B2;padding:.3em 1em;background:#f3f6f8;font-size:1.1em}"
    ".quiet{color:#555}"
    "@media print{body{font-size:10.5pt;margin:0;max-width:none;padding:0}"
    "h2,h3{break-after:avoid}figure,table,tr{break-inside:avoid}.verdict{background:none}}"
)


def page_of(title: str, body: str) -> str:
    """Return a page that needs nothing else, of a title and a body in HTML."""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{title}</title><style>{_STYLE}</style></head><body>{body}</body></html>\n"
    )


def section(heading: str, *parts: str) -> str:
    """Heading and what stands below it."""
    return f"<h2>{html.escape(heading)}</h2>" + "".join(parts)


def paragraph(text: str, kind: str = "") -> str:
    """Paragraph of plain text."""
    mark = f' class="{kind}"' if kind else ""
    return f"<p{mark}>{html.escape(text)}</p>"


def table_of(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Table of plain text; nothing where there are no rows."""
    if not rows:
        return ""
    head = "".join(f"<th>{html.escape(text)}</th>" for text in headers)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><tr>{head}</tr>{body}</table>"


def picture_of(figure: Figure, alternative: str, caption: str = "", kind: str = "") -> str:
    """Picture inside the page."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png")
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    mark = f' class="{kind}"' if kind else ""
    told = f"<figcaption>{html.escape(caption)}</figcaption>" if caption else ""
    return (
        f'<figure{mark}><img alt="{html.escape(alternative)}" '
        f'src="data:image/png;base64,{data}">{told}</figure>'
    )


def number(value: float | None, digits: int = 4) -> str:
    """Number in a table; nothing where there is none."""
    return "" if value is None else f"{value:.{digits}g}"


def percent(value: float | None) -> str:
    """Share in a table, in percent."""
    return "" if value is None else f"{100.0 * value:.3g} %"
