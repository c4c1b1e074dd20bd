"""Description of a residual that no known effect explains: on what it depends most, and how."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.formatting import to_digits
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.dependence import Dependence, bins_of, dependence, edges_of
from chatter.explain.residuals.finding import Curve, Curves, Finding, Map
from chatter.explain.residuals.regression import (
    PeriodRegression,
    Regression,
    Target,
    best_period,
    best_regression,
    panel_of,
)
from chatter.explain.residuals.residual import Residual
from chatter.explain.residuals.variables import Variable

Array = NDArray[np.float64]

#: share of what its variable explains at all above which a period describes it better
_PERIODIC_ENOUGH = 0.6
#: bins of each of two variables, and what a second one must add to the share
_BINS_OF_TWO, _LEAST_ADDED = 10, 0.05
#: variables that are tried in pairs
_PAIRED = 4
_PHASE_BINS = 24
_NAME = "residual dependence"
_NONE = "The residual depends on none of the variables examined."


@dataclass(frozen=True, eq=False)
class ResidualDependence:
    """What a residual depends on most, as a table."""

    finding: Finding  # sentence and picture
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[float]] = ()  # in the units of the columns

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json."""
        return {
            "description": self.finding.description,
            "significant": self.finding.significant,
            **self.finding.numbers,
            "table": {"columns": list(self.columns), "rows": [list(row) for row in self.rows]},
        }


class _Trial(NamedTuple):
    share: float
    described: Callable[[], ResidualDependence]


def residual_dependence(residual: Residual, findings: Sequence[Finding]) -> ResidualDependence:
    """Describe a residual as a function of the one or two variables it depends on most.

    Findings of its diagnostics serve kinds that know no variables sample by sample.
    """
    kind, above = residual.kind, residual.above_noise
    if not kind.variables:
        return _strongest(findings)
    channels = [channel for channel in above if channel in kind.sources] or above
    if not channels:
        return _none(0.0)
    regressions = [(best_regression(residual, c, v), v) for c in channels for v in kind.variables]
    regressions.sort(key=lambda one: -one[0].found.share)
    trials = [
        _Trial(one.found.share, partial(_by_one, residual, one, v))
        for one, v in regressions
        if one.found.significant
    ]
    best = trials[0] if trials else None
    periodic = kind.variable(kind.periodic_variable)
    period = best_period(residual, periodic, channels)
    if period is not None and period.found.significant:
        strongest = next((v for one, v in regressions if one.found.significant), None)
        enough = _PERIODIC_ENOUGH if strongest is periodic else 1.0
        if best is None or period.found.share > enough * best.share:
            best = _Trial(period.found.share, partial(_by_period, residual, period, periodic))
    leading = list(dict.fromkeys(variable for _, variable in regressions))[:_PAIRED]
    two = _best_of_two(residual, channels, leading)
    if two is not None and two.share > (best.share + _LEAST_ADDED if best else 0.0):
        best = two
    return best.described() if best else _none(regressions[0][0].found.share)


def _numbers(residual: Residual, target: Target, share: float, **more: Any) -> dict[str, Any]:
    parts = residual.of(target.channel)
    squares = sum(float(part.normalised @ part.normalised) for part in parts)
    count = sum(part.normalised.size for part in parts)
    beyond = share * squares / max(squares - count, 1e-300) if squares > 1.2 * count else None
    return {
        "residual": target.channel,
        "share": share,
        "share_beyond_noise": None if beyond is None else min(beyond, 1.0),
        "form": target.form.name,
        **more,
    }


def _by_one(residual: Residual, regression: Regression, variable: Variable) -> ResidualDependence:
    target, share = regression.target, regression.found.share
    words = f"{to_digits(100.0 * share)} % of {target.phrase} depends on {variable.label}."
    numbers = _numbers(residual, target, share, over=[variable.name])
    finding = Finding(_NAME, words, True, numbers, panel_of(variable, [regression]))
    return _with_table(finding, regression, variable)


def _with_table(finding: Finding, regression: Regression, variable: Variable) -> ResidualDependence:
    curve = regression.curve(variable)
    rows = [
        [float(x), float(y), float(e)]
        for x, y, e in zip(curve.x, curve.y, curve.spread, strict=True)
        if np.isfinite(y)
    ]
    columns = (variable.heading, regression.target.label, "standard error")
    return ResidualDependence(finding, columns, rows)


def _by_period(
    residual: Residual, regression: PeriodRegression, variable: Variable
) -> ResidualDependence:
    """Mean over one period, runs superimposed by their phases."""
    target, found = regression
    length = found.length
    edges = np.linspace(0.0, length, _PHASE_BINS + 1)
    samples = []
    for part in residual.of(target.channel):
        weight = target.form.weight(part) / part.deviation
        values = variable.of(part)
        cycles = values / length - _phase(part, weight, values, length)
        samples.append(target.sample(part, bins_of(np.mod(cycles, 1.0) * length, edges)))
    shape = Regression(target, dependence(samples, _PHASE_BINS), 0.5 * (edges[1:] + edges[:-1]))
    period = f"{length * variable.scale:.3g} {variable.unit}"
    coefficients = shape.found.coefficients * target.scale
    half = 0.5 * float(np.nanmax(coefficients) - np.nanmin(coefficients))
    words = (
        f"{to_digits(100.0 * found.share)} % of {target.phrase} depends on {variable.label}, "
        f"with a period of {period} and an amplitude of {to_digits(half)} {target.unit}."
    )
    numbers = _numbers(residual, target, found.share, over=[variable.name], period=length)
    label = f"{variable.name} within a period of {period} [{variable.unit}]"
    finding = Finding(_NAME, words, True, numbers, panel_of(variable, [shape], label))
    return _with_table(finding, shape, variable)


def _phase(part: ChannelResidual, weight: Array, values: Array, length: float) -> float:
    """Where in a period the residual of a run is highest, in periods."""
    angle = 2.0 * np.pi * values / length
    basis = np.column_stack([np.ones(angle.size), np.cos(angle), np.sin(angle)]) * weight[:, None]
    _, cosine, sine = np.linalg.lstsq(basis, part.normalised, rcond=None)[0]
    return float(np.arctan2(sine, cosine)) / (2.0 * np.pi)


class _OnTwo(NamedTuple):
    """Regression on two variables: edges of the bins of each, and coefficients row by row."""

    target: Target
    variables: tuple[Variable, Variable]
    edges: Sequence[Array]
    found: Dependence


def _best_of_two(
    residual: Residual, channels: Sequence[str], variables: Sequence[Variable]
) -> _Trial | None:
    trials = []
    for channel, pair in itertools.product(channels, itertools.combinations(variables, 2)):
        parts = residual.of(channel)
        values = [[v.of(part) for part in parts] for v in pair]
        edges = [edges_of(np.concatenate(one), _BINS_OF_TWO) for one in values]
        columns, rows = edges[0].size - 1, edges[1].size - 1
        bins = []
        for x, y in zip(*values, strict=True):
            column, row = bins_of(x, edges[0]), bins_of(y, edges[1])
            bins.append(np.where((column >= 0) & (row >= 0), row * columns + column, -1))
        for form in residual.kind.forms:
            target = Target(channel, form)
            samples = [target.sample(part, own) for part, own in zip(parts, bins, strict=True)]
            found = dependence(samples, columns * rows)
            if found.significant:
                one = _OnTwo(target, pair, edges, found)
                trials.append(_Trial(found.share, partial(_by_two, residual, one)))
    return max(trials, key=lambda trial: trial.share, default=None)


def _by_two(residual: Residual, regression: _OnTwo) -> ResidualDependence:
    target, (first, second), edges, found = regression
    x, y = first.reported(edges[0]), second.reported(edges[1])
    values = target.scale * found.coefficients.reshape(y.size - 1, x.size - 1)
    words = (
        f"{to_digits(100.0 * found.share)} % of {target.phrase} depends on {first.label} and "
        f"{second.label} together."
    )
    numbers = _numbers(residual, target, found.share, over=[first.name, second.name])
    rows = [
        [float(0.5 * (x[i] + x[i + 1])), float(0.5 * (y[j] + y[j + 1])), float(values[j, i])]
        for j, i in np.argwhere(np.isfinite(values))
    ]
    scales = "".join(axis for axis, v in zip("xy", (first, second), strict=True) if v.logarithmic)
    labels = (first.heading, second.heading, target.label)
    finding = Finding(_NAME, words, True, numbers, Map(x, y, values, *labels, scales))
    return ResidualDependence(finding, labels, rows)


def _strongest(findings: Sequence[Finding]) -> ResidualDependence:
    """Of kinds without variables sample by sample: what the diagnostics found."""
    significant = [finding for finding in findings if finding.significant]
    words = " ".join(finding.description for finding in significant)
    drawn = next((f.panel for f in reversed(significant) if f.panel is not None), None)
    finding = Finding(_NAME, words or _NONE, bool(significant), {}, drawn)
    if not isinstance(drawn, Curves):
        return ResidualDependence(finding)
    curve = max(drawn.curves, key=_height)
    rows = [[float(x), float(y)] for x, y in zip(curve.x, curve.y, strict=True)]
    return ResidualDependence(finding, (drawn.x_label, drawn.y_label), rows)


def _height(curve: Curve) -> float:
    return float(np.nanmax(np.abs(curve.y)))


def _none(share: float) -> ResidualDependence:
    words = (
        f"{_NONE} The best of them explains {100.0 * max(share, 0.0):.1f} % of it in holdout runs."
    )
    return ResidualDependence(Finding(_NAME, words, False))
