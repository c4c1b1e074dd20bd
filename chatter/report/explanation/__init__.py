"""report.html: the explanation on one page that needs nothing else.

=============== ====================================================================
module          responsibility
=============== ====================================================================
page            tables, pictures and the page around them
sections        what the page says, section by section: where a new one joins
=============== ====================================================================
"""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

from chatter.report.explanation.page import page_of
from chatter.report.explanation.sections import FOLLOWS, SECTIONS, findings_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from chatter.explain.explanation import Explanation

__all__ = ["FOLLOWS", "findings_of", "page_of", "report_of"]


def report_of(explanation: Explanation, summary: dict[str, Any], picture: Figure) -> str:
    """Return the page.

    Parameters
    ----------
    explanation : Explanation
    summary : dict
        Of explanation.json.
    picture : Figure
        Of signals and what is left of them.
    """
    title = html.escape(explanation.measurement.title)
    parts = [section(explanation, summary, picture) for section in SECTIONS]
    return page_of(title, "\n".join([f"<h1>{title}</h1>", *filter(None, parts)]))
