"""The views of every kind of measurement: a new one is a module and an entry here."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from chatter.explain.residuals.by_channel import by_channel
from chatter.explain.residuals.finding import Finding
from chatter.explain.residuals.misclassified_tests import misjudged, over_depth, over_speed
from chatter.explain.residuals.normalised_residual import Residual
from chatter.explain.residuals.over_lines import by_condition, over_lines
from chatter.explain.residuals.over_runs import over_runs
from chatter.explain.residuals.over_time import over_time
from chatter.explain.residuals.over_variable import over_period, over_variable
from chatter.explain.residuals.spectrum import spectrum

View = Callable[[Residual], Finding]

VIEWS: Mapping[str, tuple[View, ...]] = {
    "milling": (
        by_channel,
        spectrum,
        over_variable("tooth angle"),
        over_variable("spindle angle"),
        over_period("feed way"),
        over_runs,
        over_time,
    ),
    "axis": (
        by_channel,
        over_variable("velocity"),
        over_variable("direction"),
        over_variable("way since reversal"),
        over_variable("position"),
        over_period("position"),
        over_variable("acceleration"),
        over_runs,
    ),
    "stability": (misjudged, over_speed, over_depth),
    "frf": (by_condition, over_lines),
}


def look(residual: Residual) -> tuple[Finding, ...]:
    """Look at a residual by every view of its kind of measurement."""
    return tuple(view(residual) for view in VIEWS[residual.kind.name])


def nothing_beyond_chance(findings: tuple[Finding, ...]) -> str:
    """One sentence for all views that show nothing."""
    silent = [finding.says for finding in findings if not finding.beyond_chance]
    sentences = [text for text in silent if text.endswith(".")]
    names = [text for text in silent if not text.endswith(".")]
    if names:
        listed = ", ".join(names[:-1]) + f" and {names[-1]}" if len(names) > 1 else names[0]
        sentences.append(f"Nothing beyond chance over {listed}.")
    return " ".join(sentences)
