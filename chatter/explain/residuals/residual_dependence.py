"""A residual that nothing known explains, described freely: on what it hangs most, and how."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.residuals.by_channel import above_noise
from chatter.explain.residuals.dependence import Dependence, Sample, dependence, edges_of, places_in
from chatter.explain.residuals.finding import Curve, Curves, Finding, Map
from chatter.explain.residuals.normalised_residual import Left, Residual
from chatter.explain.residuals.over_variable import (
    PeriodTie,
    Tie,
    best_period,
    best_tie,
    panel_of,
    told_scale,
    y_label,
)
from chatter.explain.residuals.variables import FORMS, Form, Variable, named, variables_of

Array = NDArray[np.float64]

#: share of what its variable explains at all above which a period describes it better
_PERIODIC_ENOUGH = 0.6
#: bins of each of two variables, and what a second one must add to the share
_BINS_OF_TWO, _WORTH = 10, 0.05
#: variables that are tried in pairs
_PAIRED = 4
_PHASE_BINS = 24
#: in which variable of a kind periods are looked for
_PERIODIC = {"milling": "feed way", "axis": "position"}
#: forces that are not known; other signals follow from them
_FORCES = ("Fx", "Fy", "Fz", "force")


@dataclass(frozen=True, eq=False)
class Lead:
    """What a residual hangs on most, as a table.

    Parameters
    ----------
    finding : Finding
        Sentence and picture.
    table : dict
        "columns" and "rows", in the units of the columns.
    """

    finding: Finding
    table: dict[str, Any]

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json."""
        return {
            "says": self.finding.says,
            "beyond_chance": self.finding.beyond_chance,
            **self.finding.numbers,
            "table": self.table,
        }


class _Trial(NamedTuple):
    share: float
    lead: Callable[[], Lead]


def lead_of(residual: Residual, findings: Sequence[Finding]) -> Lead:
    """Describe a residual as a function of the one or two variables it hangs on most.

    Parameters
    ----------
    residual : Residual
    findings : sequence of Finding
        Of its views, for kinds that know no variables sample by sample.
    """
    variables = variables_of(residual)
    if not variables:
        return _strongest(findings)
    above = above_noise(residual, residual.channels)
    channels = [channel for channel in above if channel in _FORCES] or above
    if not channels:
        return _of_nothing(0.0)
    ties = [(best_tie(residual, c, v), v) for c in channels for v in variables]
    ties.sort(key=lambda one: -one[0].found.share)
    told = [(tie, v) for tie, v in ties if tie.found.beyond_chance]
    single = [_Trial(tie.found.share, _lead_by_one(residual, tie, v)) for tie, v in told]
    way = named(residual, _PERIODIC[residual.kind.name])
    period = best_period(residual, way, channels)
    best = max(single, key=lambda trial: trial.share, default=None)
    if period is not None and period.found.beyond_chance:
        trial = _Trial(period.found.share, _lead_by_period(residual, period))
        along_way = best is not None and told[0][1] is way
        if best is None or trial.share > (_PERIODIC_ENOUGH if along_way else 1.0) * best.share:
            best = trial
    leading = list(dict.fromkeys(variable for _, variable in ties))[:_PAIRED]
    two = _best_of_two(residual, channels, leading)
    if two is not None and two.share > (best.share + _WORTH if best else 0.0):
        best = two
    return best.lead() if best else _of_nothing(ties[0][0].found.share)


def _numbers(residual: Residual, channel: str, share: float, **more: Any) -> dict[str, Any]:
    squares = sum(float(part.scaled @ part.scaled) for part in residual.of(channel))
    count = sum(part.scaled.size for part in residual.of(channel))
    beyond = share * squares / max(squares - count, 1e-300) if squares > 1.2 * count else None
    return {
        "residual": channel,
        "share": share,
        "share_beyond_noise": None if beyond is None else min(beyond, 1.0),
        **more,
    }


# one variable ------------------------------------------------------------------------------------


def _lead_by_one(residual: Residual, tie: Tie, variable: Variable) -> Callable[[], Lead]:
    def lead() -> Lead:
        says = (
            f"{100.0 * tie.found.share:.2g} % of what is left of {tie.channel}"
            f"{_taken(tie.form)} hangs on {variable.label}."
        )
        numbers = _numbers(
            residual, tie.channel, tie.found.share, over=[variable.name], form=tie.form.name
        )
        finding = Finding("lead", says, True, numbers, panel_of(variable, [tie]))
        return Lead(finding, _table(variable, tie))

    return lead


def _taken(form: Form) -> str:
    return f", taken {form.says}," if form.says else ""


def _table(variable: Variable, tie: Tie) -> dict[str, Any]:
    scale = told_scale(tie)
    rows = [
        [float(variable.told(x)), float(y * scale), float(e * scale)]
        for x, y, e in zip(tie.middles, tie.found.coefficients, tie.found.errors, strict=True)
        if np.isfinite(y)
    ]
    unit = f" [{variable.unit}]" if variable.unit else ""
    return {"columns": [f"{variable.name}{unit}", y_label(tie), "standard error"], "rows": rows}


# a period ----------------------------------------------------------------------------------------


def _lead_by_period(residual: Residual, tie: PeriodTie) -> Callable[[], Lead]:
    """Mean over one period, runs laid over each other by their phases."""

    def lead() -> Lead:
        variable = named(residual, _PERIODIC[residual.kind.name])
        length = tie.found.length
        edges = np.linspace(0.0, length, _PHASE_BINS + 1)
        samples = []
        for part in residual.of(tie.channel):
            weight = tie.form.weight(part) / part.deviation
            values = variable.of(part)
            turns = values / length - _phase(part, weight, values, length)
            samples.append(
                Sample(part.scaled, weight, places_in(np.mod(turns, 1.0) * length, edges))
            )
        folded = dependence(samples, _PHASE_BINS)
        shape = Tie(tie.channel, tie.form, folded, 0.5 * (edges[1:] + edges[:-1]))
        told = length * variable.scale
        says = (
            f"{100.0 * tie.found.share:.2g} % of what is left of {tie.channel}{_taken(tie.form)} "
            f"hangs on {variable.label}, with a period of {told:.3g} {variable.unit} and an "
            f"amplitude of {_amplitude(shape)}."
        )
        numbers = _numbers(
            residual,
            tie.channel,
            tie.found.share,
            over=[variable.name],
            form=tie.form.name,
            period=length,
        )
        panel = panel_of(variable, [shape])
        within = Curves(
            panel.curves,
            f"{variable.name} within a period of {told:.3g} {variable.unit} [{variable.unit}]",
            panel.y_label,
            floor=0.0,
        )
        return Lead(Finding("lead", says, True, numbers, within), _table(variable, shape))

    return lead


def _phase(part: Left, weight: Array, values: Array, length: float) -> float:
    """Where in a period the residual of a run is highest, in periods."""
    angle = 2.0 * np.pi * values / length
    basis = np.column_stack([np.ones(angle.size), np.cos(angle), np.sin(angle)]) * weight[:, None]
    _, cosine, sine = np.linalg.lstsq(basis, part.scaled, rcond=None)[0]
    return float(np.arctan2(sine, cosine)) / (2.0 * np.pi)


def _amplitude(tie: Tie) -> str:
    values = tie.found.coefficients * told_scale(tie)
    half = 0.5 * float(np.nanmax(values) - np.nanmin(values))
    unit = y_label(tie).split("[")[1].rstrip("]")
    return f"{half:.2g} {unit}"


# two variables -----------------------------------------------------------------------------------


def _best_of_two(
    residual: Residual, channels: Sequence[str], variables: Sequence[Variable]
) -> _Trial | None:
    trials = []
    for channel in channels:
        parts = residual.of(channel)
        for first, second in itertools.combinations(variables, 2):
            edges = [
                edges_of(np.concatenate([v.of(part) for part in parts]), _BINS_OF_TWO)
                for v in (first, second)
            ]
            columns, rows = edges[0].size - 1, edges[1].size - 1
            for form in FORMS[residual.kind.name]:
                samples = []
                for part in parts:
                    x, y = (
                        places_in(v.of(part), e)
                        for v, e in zip((first, second), edges, strict=True)
                    )
                    place = np.where((x >= 0) & (y >= 0), y * columns + x, -1)
                    samples.append(Sample(part.scaled, form.weight(part) / part.deviation, place))
                found = dependence(samples, columns * rows)
                if found.beyond_chance:
                    tie = _TieOfTwo(channel, form, (first, second), edges, found)
                    trials.append(_Trial(found.share, _lead_by_two(residual, tie)))
    return max(trials, key=lambda trial: trial.share, default=None)


class _TieOfTwo(NamedTuple):
    channel: str
    form: Form
    variables: tuple[Variable, Variable]
    edges: Sequence[Array]
    found: Dependence


def _lead_by_two(residual: Residual, tie: _TieOfTwo) -> Callable[[], Lead]:
    def lead() -> Lead:
        first, second = tie.variables
        alone = Tie(tie.channel, tie.form, tie.found, tie.edges[0][1:])
        scale = told_scale(alone)
        x, y = (
            variable.told(edges) for edges, variable in zip(tie.edges, tie.variables, strict=True)
        )
        values = scale * tie.found.coefficients.reshape(y.size - 1, x.size - 1)
        says = (
            f"{100.0 * tie.found.share:.2g} % of what is left of {tie.channel}{_taken(tie.form)} "
            f"hangs on {first.label} and {second.label} together."
        )
        labels = [f"{v.name} [{v.unit}]" if v.unit else v.name for v in tie.variables]
        numbers = _numbers(
            residual,
            tie.channel,
            tie.found.share,
            over=[first.name, second.name],
            form=tie.form.name,
        )
        rows = [
            [float(0.5 * (x[i] + x[i + 1])), float(0.5 * (y[j] + y[j + 1])), float(values[j, i])]
            for j in range(y.size - 1)
            for i in range(x.size - 1)
            if np.isfinite(values[j, i])
        ]
        scales = "".join(axis for axis, v in zip("xy", tie.variables, strict=True) if v.logarithmic)
        panel = Map(x, y, values, *labels, y_label(alone), scales)
        return Lead(
            Finding("lead", says, True, numbers, panel),
            {"columns": [*labels, y_label(alone)], "rows": rows},
        )

    return lead


# others ------------------------------------------------------------------------------------------


def _strongest(findings: Sequence[Finding]) -> Lead:
    """Of kinds without variables sample by sample: what the views say."""
    telling = [finding for finding in findings if finding.beyond_chance]
    says = " ".join(finding.says for finding in telling)
    drawn = next((f.panel for f in reversed(telling) if f.panel is not None), None)
    rows, columns = [], []
    if isinstance(drawn, Curves):
        columns = [drawn.x_label, drawn.y_label]
        curve = drawn.curves[0] if len(drawn.curves) == 1 else _highest(drawn.curves)
        rows = [[float(x), float(y)] for x, y in zip(curve.x, curve.y, strict=True)]
    finding = Finding("lead", says or _NOTHING, bool(telling), {}, drawn)
    return Lead(finding, {"columns": columns, "rows": rows})


def _highest(curves: Sequence[Curve]) -> Curve:
    return max(curves, key=lambda curve: float(np.nanmax(np.abs(curve.y))))


_NOTHING = "What is left hangs on nothing that is looked at here."


def _of_nothing(share: float) -> Lead:
    says = (
        f"{_NOTHING} The best of the variables explains {100.0 * max(share, 0.0):.1f} % of it in "
        "runs that were not looked at."
    )
    return Lead(Finding("lead", says, False), {"columns": [], "rows": []})
