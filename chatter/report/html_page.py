"""A document as one HTML page: pictures inlined, no scripts, nothing from elsewhere."""

from __future__ import annotations

import base64

from jinja2 import Environment, PackageLoader, StrictUndefined

from chatter.report.document import Document, Picture, Table, rows_of


def html_page(document: Document, version: str, date: str) -> str:
    """Page of a document; every text of it is escaped.

    Parameters
    ----------
    document : Document
    version, date : str
        Of the program, and of the run.
    """
    templates = Environment(
        loader=PackageLoader("chatter.report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    templates.filters["inlined"] = _inlined
    templates.tests["table"] = lambda part: isinstance(part, Table)
    return templates.get_template("report.html").render(
        document=document,
        version=version,
        date=date,
        described=[(one.name, rows_of(one)) for one in document.descriptions],
    )


def _inlined(picture: Picture) -> str:
    return "data:image/png;base64," + base64.b64encode(picture.png).decode("ascii")
