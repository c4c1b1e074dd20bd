"""Whether the residual changes from run to run with what was set."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.explain.residuals.finding import Curve, Curves, Finding
from chatter.explain.residuals.residual import Residual
from chatter.explain.residuals.variables import Condition, Measure

Array = NDArray[np.float64]

#: significance level, all pairs together
_SIGNIFICANCE = 0.02
_MOST_REPORTED = 3


class Trend(NamedTuple):
    """A measure of a channel against a condition, over the runs."""

    channel: str
    measure: Measure
    condition: Condition
    x: Array
    y: Array
    found: RankCorrelation


def over_runs(residual: Residual) -> Finding:
    """Rank correlation over the runs of the residual with what was set."""
    trends = _trends(residual)
    allowed = _SIGNIFICANCE / max(1, len(trends))
    shown = [g for g in trends if g.found.probability <= max(allowed, 1.0 / 4001.0)]
    shown.sort(key=lambda g: (g.found.probability, -abs(g.found.coefficient)))
    numbers = [
        {
            "channel": g.channel,
            "measure": g.measure.name,
            "with": g.condition.name,
            "rank_correlation": g.found.coefficient,
            "p_value": g.found.probability,
        }
        for g in trends
    ]
    names = tuple(dict.fromkeys(g.condition.name for g in trends))
    words = "; ".join(_words(g) for g in shown[:_MOST_REPORTED]) + "."
    description = words if shown else _listed(names)
    panel = None
    if trends:
        panel = _panel(shown or sorted(trends, key=lambda g: g.found.probability)[:1])
    return Finding("runs", description, bool(shown), {"correlations": numbers}, panel)


def _trends(residual: Residual) -> list[Trend]:
    found = []
    for channel in residual.channels:
        parts = residual.of(channel)
        for condition in residual.kind.conditions:
            x = np.array([condition.of(part) for part in parts])
            if np.ptp(x) == 0.0:
                continue
            for measure in residual.kind.measures:
                y = np.array([measure.of(part) for part in parts])
                correlation = rank_correlation(x, y)
                if measure.also is not None:
                    other = rank_correlation(x, np.array([measure.also(part) for part in parts]))
                    if correlation.coefficient * other.coefficient <= 0.0:
                        correlation = RankCorrelation(0.0, 1.0)
                    else:
                        correlation = max(correlation, other, key=lambda one: one.probability)
                found.append(Trend(channel, measure, condition, x, y, correlation))
    return found


def _words(trend: Trend) -> str:
    unit, scale = trend.measure.unit(trend.channel)
    order = np.argsort(trend.x)
    low, high = (scale * float(trend.y[order[end]]) for end in (0, -1))
    x_low, x_high = (trend.condition.scale * float(trend.x[order[end]]) for end in (0, -1))
    rises = "rises" if trend.found.coefficient > 0.0 else "falls"
    return (
        f"The {trend.measure.description} of the residual of {trend.channel} {rises} with the "
        f"{trend.condition.name}, from {low:.3g} {unit} at {x_low:.4g} {trend.condition.unit} to "
        f"{high:.3g} {unit} at {x_high:.4g} {trend.condition.unit} (rank correlation "
        f"{trend.found.coefficient:+.2f} over {trend.x.size} runs)"
    )


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names[:-1]) + f" or {names[-1]} of the runs" if len(names) > 1 else "the runs"


def _panel(shown: list[Trend]) -> Curves:
    first = shown[0]
    unit, scale = first.measure.unit(first.channel)
    alike = [
        g for g in shown if g.measure.name == first.measure.name and g.condition == first.condition
    ]
    curves = []
    for trend in alike:
        order = np.argsort(trend.x)
        curves.append(
            Curve(trend.x[order] * first.condition.scale, trend.y[order] * scale, trend.channel)
        )
    return Curves(
        tuple(curves),
        f"{first.condition.name} [{first.condition.unit}]",
        f"residual: {first.measure.name} [{unit}]",
        floor=0.0,
        joined=False,
    )


#: permutations, and runs below which ranks tell nothing
_PERMUTATIONS, _FEWEST = 4000, 5


class RankCorrelation(NamedTuple):
    """Spearman's (1904) coefficient of two series and how likely chance gives as much."""

    coefficient: float
    probability: float


def rank_correlation(first: Array, second: Array, seed: int = 0) -> RankCorrelation:
    """Rank correlation by permutations; (0, 1) where one of the series does not vary."""
    if first.size < _FEWEST or np.ptp(first) == 0.0 or np.ptp(second) == 0.0:
        return RankCorrelation(0.0, 1.0)
    x, y = (scipy.stats.rankdata(values) for values in (first, second))
    x, y = ((r - r.mean()) / np.linalg.norm(r - r.mean()) for r in (x, y))
    found = float(x @ y)
    rng = np.random.default_rng(seed)
    shuffled = rng.permuted(np.tile(y, (_PERMUTATIONS, 1)), axis=1) @ x
    as_much = int(np.sum(np.abs(shuffled) >= abs(found) - 1e-12))
    return RankCorrelation(found, (1 + as_much) / (1 + _PERMUTATIONS))
