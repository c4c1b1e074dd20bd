"""report.html: the explanation on one page that needs nothing else."""

from __future__ import annotations

import base64
import html
from io import BytesIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from chatter.explain.explanation import Explanation

_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #ccc;padding:.3em .7em;"
    "text-align:right}td:first-child,th:first-child{text-align:left}img{max-width:100%}"
)
_SAYING = {
    "explained": "The declared case lacks something, and it is known what.",
    "nothing-missing": "Nothing is missing: refitted within its tolerances, the declared case "
    "leaves noise alone.",
    "unexplained": "Something is missing that none of the effects known here explains.",
}
#: what follows of a finding in the signals, by how bad it is
FOLLOWS = {
    "fatal": "nothing can be concluded",
    "run": "the run is left out",
    "channel": "the channel is left out in this run",
    "samples": "the samples are left out",
    "note": "a note",
}


def report_of(explanation: Explanation, summary: dict[str, Any], picture: Figure) -> str:
    """Return the page.

    Parameters
    ----------
    explanation : Explanation
    summary : dict
        Of explanation.json.
    picture : Figure
    """
    title = html.escape(explanation.measurement.title)
    parts = [
        f"<h1>{title}</h1>",
        f"<p><b>{summary['verdict']}</b>. {_SAYING[summary['verdict']]}</p>",
        findings_of(summary["checks"]),
        _effects(summary),
        "<h2>Error</h2>",
        _errors(summary),
        "<h2>Candidates</h2>",
        _table(
            ["candidate", "left of unseen runs over noise", "BIC"],
            [
                [one["name"], _number(one["holdout_error"]), _number(one["bic"])]
                for one in summary["candidates"]
            ],
        ),
        "<h2>What is left</h2>",
        _lead(summary),
        f'<img alt="residual" src="data:image/png;base64,{_png(picture)}">',
        "<h2>Values refitted</h2>",
        _values(explanation),
    ]
    return page_of(title, "\n".join(parts))


def page_of(title: str, body: str) -> str:
    """Return a page that needs nothing else, of a title and a body in HTML."""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{title}</title><style>{_STYLE}</style></head><body>{body}</body></html>\n"
    )


def findings_of(checks: list[dict[str, str]]) -> str:
    """Return what was found in the signals, as a table; nothing where nothing was."""
    if not checks:
        return ""
    return "<h2>The data</h2>" + _table(
        ["what follows", "run", "channel", "what was found"],
        [[FOLLOWS[one["severity"]], one["run"], one["channel"], one["says"]] for one in checks],
    )


def _effects(summary: dict[str, Any]) -> str:
    parts = []
    for effect in summary["effects"]:
        rows = [
            [
                key,
                f"{_number(one['value'])} {one['unit']}",
                f"{_number(one['ci95'][0])} to {_number(one['ci95'][1])}",
            ]
            for key, one in effect["parameters"].items()
        ]
        alike = ", ".join(effect["confounded_with"])
        parts.append(
            f"<h2>{effect['name']}: {html.escape(effect['says'])}</h2>"
            f"<p>probability {effect['probability']:.3g}"
            + (f"; the data cannot tell it from {alike}" if alike else "")
            + "</p>"
            + _table(["parameter", "value", "95 % interval"], rows)
        )
    return "".join(parts)


def _errors(summary: dict[str, Any]) -> str:
    told = {
        "declared": "case as declared",
        "before": "uncertain values refitted",
        "after": "with what was added",
        "holdout_before": "unseen runs, refitted",
        "holdout_after": "unseen runs, with what was added",
        "noise_floor": "noise",
    }
    rows = [[text, _number(summary["error"][key])] for key, text in told.items()]
    return _table(["", "rms error over rms signal"], rows)


def _lead(summary: dict[str, Any]) -> str:
    lead = summary["signature"]["lead"]
    if not lead["over"]:
        return ""
    return (
        f"<p>Of what is left, the residual of {lead['residual']} hangs most on {lead['over']}: "
        f"{100.0 * lead['share']:.1f} % of its variance.</p>"
    )


def _values(explanation: Explanation) -> str:
    fit = explanation.found.final
    rows = []
    for place, one in enumerate(fit.parameters):
        low, high = fit.interval(place)
        rows.append(
            [
                one.name,
                _number(one.start),
                _number(float(fit.values[place])),
                f"{_number(low)} to {_number(high)}",
            ]
        )
    return _table(["path", "declared", "fitted", "95 % interval"], rows)


def _table(headers: list[str], rows: list[list[str]]) -> str:
    head = "".join(f"<th>{html.escape(text)}</th>" for text in headers)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><tr>{head}</tr>{body}</table>"


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"


def _png(picture: Figure) -> str:
    buffer = BytesIO()
    picture.savefig(buffer, format="png")
    return base64.b64encode(buffer.getvalue()).decode("ascii")
