"""What the page says, section by section."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from chatter.explain.residuals.finding import Finding
from chatter.explain.selection.separation import told_apart
from chatter.explain.signature import Signature
from chatter.report.explanation.page import (
    number,
    paragraph,
    percent,
    picture_of,
    section,
    table_of,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from chatter.explain.explanation import Explanation

Section = Callable[["Explanation", dict[str, Any], "Figure"], str]

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


def _verdict(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:
    error = summary["error"]
    parts = [f'<p class="verdict"><b>{summary["verdict"]}.</b> {_SAYING[summary["verdict"]]}</p>']
    if summary["effects"]:
        named = " and ".join(
            f"{one['name']} ({one['says']})" if one["says"] else one["name"]
            for one in summary["effects"]
        )
        parts.append(paragraph(f"Missing is: {named}."))
    if summary["verdict"] == "explained":
        parts.append(
            paragraph(
                f"The error on runs that were not seen falls from "
                f"{percent(error['holdout_before'])} of the signal to "
                f"{percent(error['holdout_after'])}; the noise is {percent(error['noise_floor'])}."
            )
        )
    else:
        parts.append(
            paragraph(
                f"The error is {percent(error['declared'])} of the signal as declared and "
                f"{percent(error['before'])} refitted; the noise is "
                f"{percent(error['noise_floor'])}."
            )
        )
    partial = [one["name"] for one in summary.get("partial", ())]
    if partial:
        parts.append(
            paragraph(
                f"{' and '.join(partial)} helps, but leaves something that is not known; it is "
                "not put into the case."
            )
        )
    lead = explanation.signatures.lead
    if lead is not None:
        parts.append(paragraph(f"A lead: {lead.finding.says}"))
    return "".join(parts)


def findings_of(checks: Sequence[dict[str, str]]) -> str:
    """Return what was found in the signals, as a table; nothing where nothing was."""
    if not checks:
        return ""
    return section(
        "The data",
        table_of(
            ["what follows", "run", "channel", "what was found"],
            [
                [
                    FOLLOWS.get(one["severity"], one["severity"]),
                    one["run"],
                    one["channel"],
                    one["says"],
                ]
                for one in checks
            ],
        ),
    )


def _checks(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:  # noqa: ARG001
    return findings_of(summary.get("checks", ()))


def _evidence(explanation: Explanation, summary: dict[str, Any], picture: Figure) -> str:  # noqa: ARG001
    signatures = explanation.signatures
    parts = [
        "<h3>What the refitted case leaves</h3>",
        _told(signatures.refitted),
        picture_of(picture, "signals and what is left of them"),
    ]
    if signatures.with_added is not None:
        parts += ["<h3>What is left with what was added</h3>", _told(signatures.with_added)]
    return section("Where the residual lives", *parts)


def _told(signature: Signature) -> str:
    pictures = [_panel(finding) for finding in signature.telling if finding.panel is not None]
    return "".join(pictures) + (paragraph(signature.nothing, "quiet") if signature.nothing else "")


def _panel(finding: Finding) -> str:
    from chatter.plots.residual_diagnostics import plot_findings

    return picture_of(plot_findings([finding]), finding.view, finding.says, "half")


def _lead(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:  # noqa: ARG001
    lead = explanation.signatures.lead
    if lead is None:
        return ""
    rows = [[number(value) for value in row] for row in lead.table["rows"]]
    drawn = _panel(lead.finding) if lead.finding.panel is not None else ""
    told = "" if drawn else paragraph(lead.finding.says)
    # beyond this a table is for programs, which read explanation.json
    table = table_of(lead.table["columns"], rows) if len(rows) <= 60 else ""
    return section("A lead: what is left, described freely", told, drawn, table)


def _effects(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:  # noqa: ARG001
    parts = []
    for effect in (*summary["effects"], *summary.get("partial", ())):
        rows = [
            [
                key,
                f"{number(one['value'])} {one['unit']}",
                f"{number(one['ci95'][0])} to {number(one['ci95'][1])}",
            ]
            for key, one in effect["parameters"].items()
        ]
        alike = ", ".join(effect["confounded_with"])
        parts += [
            f"<h3>{html.escape(effect['name'])}: {html.escape(effect['says'])}</h3>",
            paragraph(
                f"Probability {effect['probability']:.3g} among those tried"
                + (f"; the data cannot tell it from {alike}." if alike else ".")
            ),
            *(
                paragraph(html.escape(told_apart(name, trial)).capitalize() + ".")
                for name, trial in effect["told_apart_by"].items()
            ),
            table_of(["parameter", "value", "95 % interval"], rows),
        ]
    heading = "What was added" if summary["effects"] else "What helps, and is not enough"
    return section(heading, *parts) if parts else ""


def _ranking(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:  # noqa: ARG001
    rows = [
        [one["name"], number(one["holdout_error"]), number(one["bic"], 6)]
        for one in summary["candidates"]
    ]
    words = (
        "Each was added alone, fitted together with all uncertain values to some of the runs, and "
        "judged on the others: what is left there, over the noise."
    )
    table = table_of(["candidate", "left of unseen runs over noise", "BIC"], rows)
    return section("Candidates", paragraph(words), table) if rows else ""


def _errors(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:
    from chatter.plots.explanation import plot_errors

    errors, overall = explanation.before_after, summary["error"]
    steps = list(errors.fitted)
    headers = ["channel", "noise"]
    headers += [f"{step}, fitted runs" for step in steps] + [f"{s}, unseen runs" for s in steps]
    rows = [
        [channel, percent(errors.noise[channel])]
        + [percent(errors.fitted[step][channel]) for step in steps]
        + [percent(errors.unseen[step][channel]) for step in steps]
        for channel in errors.channels
    ]
    words = (
        f"Root mean square over that of the signal. Over all channels and runs: "
        f"{percent(overall['declared'])} as declared, {percent(overall['before'])} refitted, "
        f"{percent(overall['after'])} in the end, noise {percent(overall['noise_floor'])}. The "
        "table is of cases fitted to the runs for fitting alone."
    )
    return section(
        "Error before and after",
        paragraph(words),
        table_of(headers, rows),
        picture_of(plot_errors(errors), "errors by channel against the noise"),
    )


def _values(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:  # noqa: ARG001
    fit = explanation.found.final if explanation.verdict == "explained" else explanation.found.base
    rows = []
    for place, one in enumerate(fit.parameters):
        low, high = fit.interval(place)
        value = float(fit.values[place])
        moved = (value - one.start) / one.size if one.prior and one.size > 0.0 else None
        rows.append(
            [
                one.name,
                number(one.start) if one.prior else "",
                f"± {100.0 * one.size / abs(one.start):.3g} %" if one.prior and one.start else "",
                number(value),
                f"{100.0 * (value / one.start - 1.0):+.2g} %" if one.prior and one.start else "",
                "" if moved is None else f"{moved:+.1f}",
                f"{number(low)} to {number(high)}",
            ]
        )
    headers = [
        "path",
        "declared",
        "tolerance",
        "fitted",
        "change",
        "in tolerances",
        "95 % interval",
    ]
    words = "In SI units; the tolerance is one standard deviation of the declared value."
    return section("Values refitted", paragraph(words), table_of(headers, rows)) if rows else ""


def _lobes(explanation: Explanation, summary: dict[str, Any], _: Figure) -> str:  # noqa: ARG001
    from chatter.plots.explanation import plot_lobes_before_after

    found = explanation.lobes
    if found is None:
        return ""
    parts = [paragraph(text) for text in found.says]
    if found.diagrams:
        parts.insert(0, picture_of(plot_lobes_before_after(found), "lobes before and after"))
    return section("Lobes before and after", *parts)


#: in the order of the page
SECTIONS: tuple[Section, ...] = (
    _verdict,
    _checks,
    _effects,
    _lead,
    _errors,
    _lobes,
    _evidence,
    _ranking,
    _values,
)
