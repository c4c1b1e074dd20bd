"""report.html: the explanation on one page that needs nothing else; its text is in templates/."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from chatter.explain.contradiction import Contradiction
from chatter.explain.data_checks.finding import FOLLOWS
from chatter.explain.explanation import Explanation
from chatter.explain.next_measurement.proposal import in_words as measure_next
from chatter.explain.residuals.finding import Finding
from chatter.explain.selection.discriminating_test import in_words
from chatter.plots.explanation import plot_errors, plot_lobes_before_after, plot_terms
from chatter.plots.residual_diagnostics import plot_findings
from chatter.plots.style import png_of
from chatter.report.parameters import parameter_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def page_of(explanation: Explanation, summary: dict[str, Any], residuals: bytes) -> str:
    """Page of an explanation, its summary as in explanation.json, and its residuals as a PNG."""
    found = explanation.found
    return (
        _templates()
        .get_template("explanation.html")
        .render(
            title=explanation.measurement.title,
            summary=summary,
            error=summary["error"],
            errors=explanation.before_after,
            dependence=explanation.residual_dependence,
            refitted=explanation.refitted_signature,
            repaired=explanation.repaired_signature,
            effect_names=found.effect_names,
            at_noise=found.is_at_noise,
            fit=found.final if explanation.adds_effects else found.base,
            lobes=explanation.lobes,
            residuals=residuals,
            learnt=explanation.empirical,
            follows=FOLLOWS,
            in_words=in_words,
            measure_next=measure_next(summary["next_measurement"]),
        )
    )


def page_of_contradiction(contradiction: Contradiction, summary: dict[str, Any]) -> str:
    """Return the page of data and a case that contradict each other."""
    return (
        _templates()
        .get_template("contradiction.html")
        .render(
            title=contradiction.measurement.title,
            verdict=contradiction.verdict,
            found=summary["checks"],
            follows=FOLLOWS,
        )
    )


def _templates() -> Environment:
    templates = Environment(
        loader=PackageLoader("chatter.report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    templates.filters |= {
        "number": _number,
        "percent": _percent,
        "parameter": lambda one, name: parameter_row(name, one),
        "png": png_of,
        "embedded": _embedded,
        "drawn": _drawn,
        "errors_drawn": plot_errors,
        "terms_drawn": plot_terms,
        "lobes_drawn": plot_lobes_before_after,
    }
    return templates


def _number(value: float | None, digits: int = 4) -> str:
    """Number in a table; nothing where there is none."""
    return "" if value is None else f"{value:.{digits}g}"


def _percent(value: float | None) -> str:
    """Share in a table, in percent."""
    return "" if value is None else f"{100.0 * value:.3g} %"


def _drawn(finding: Finding) -> Figure:
    return plot_findings([finding])


def _embedded(png: bytes) -> str:
    """Picture as the source of an image inside the page."""
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")
