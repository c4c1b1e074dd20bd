"""Whether what is left grows from run to run with what was set."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.units import rpm
from chatter.explain.residuals.finding import Curve, Curves, Finding
from chatter.explain.residuals.normalised_residual import Left, Residual
from chatter.explain.residuals.ranks import RankCorrelation, rank_correlation
from chatter.explain.residuals.variables import begun_at, direction, told_unit

Array = NDArray[np.float64]

#: probability of a chance finding, all pairs together
_ALLOWED = 0.02
_MOST_TOLD = 3


class Condition(NamedTuple):
    """What was set in a run."""

    name: str
    unit: str
    scale: float
    of: Callable[[Left], float]


class Measure(NamedTuple):
    """A number that tells of the residual of a run.

    A trend counts only where ``also``, the same in another measure, has it too: a residual that
    is the same in all runs falls over the signal, one that is a share of it rises by itself.
    """

    name: str
    says: str
    of: Callable[[Left], float]
    unit: Callable[[str], tuple[str, float]]
    also: Callable[[Left], float] | None = None


def _gain(left: Left) -> float:
    """Share of itself by which the prediction is too small."""
    return float(left.values @ left.predicted) / max(float(left.predicted @ left.predicted), 1e-300)


def _size(left: Left) -> float:
    """Root mean square beyond the noise, over the signal."""
    return _absolute(left) / max(math.sqrt(float(np.mean(left.measured**2))), 1e-300)


def _absolute(left: Left) -> float:
    """Root mean square beyond the noise, SI."""
    beyond = float(np.mean(left.values**2)) - left.noise**2
    return math.sqrt(max(beyond, 0.0))


def _friction(left: Left) -> float:
    """Mean along the direction of motion."""
    return float(np.mean(left.values * direction(left)))


def _percent(_: str) -> tuple[str, float]:
    return "%", 100.0


CONDITIONS: Mapping[str, tuple[Condition, ...]] = {
    "milling": (
        Condition("spindle speed", "rpm", rpm(1.0), lambda left: left.case.cut.spindle_speed),
        Condition("feed per tooth", "mm", 1e3, lambda left: left.case.cut.feed_per_tooth),
        Condition("axial depth", "mm", 1e3, lambda left: left.case.cut.axial_depth),
        Condition("radial depth", "mm", 1e3, lambda left: left.case.cut.radial_depth or 0.0),
        Condition("cut time", "s", 1.0, lambda left: left.run.cut_time),
    ),
    "axis": (
        Condition("time since the first move", "s", 1.0, begun_at),
        Condition(
            "highest speed",
            "mm/s",
            1e3,
            lambda left: float(np.max(np.abs(left.run.signals["velocity"]))),
        ),
        Condition("travel", "mm", 1e3, lambda left: float(np.ptp(left.run.signals["position"]))),
    ),
}

MEASURES: Mapping[str, tuple[Measure, ...]] = {
    "milling": (
        Measure("gain", "share by which the prediction is too small", _gain, _percent),
        Measure("size", "size over the signal", _size, _percent, _absolute),
    ),
    "axis": (
        Measure("mean x direction", "mean along the direction of motion", _friction, told_unit),
        Measure("mean", "mean", lambda left: float(np.mean(left.values)), told_unit),
    ),
}


class Growth(NamedTuple):
    """A measure of a channel against a condition, over the runs."""

    channel: str
    measure: Measure
    condition: Condition
    x: Array
    y: Array
    found: RankCorrelation


def over_runs(residual: Residual) -> Finding:
    """Rank correlation over the runs of the residual with what was set."""
    growths = _growths(residual)
    allowed = _ALLOWED / max(1, len(growths))
    shown = [g for g in growths if g.found.probability <= max(allowed, 1.0 / 4001.0)]
    shown.sort(key=lambda g: (g.found.probability, -abs(g.found.coefficient)))
    numbers = [
        {
            "channel": g.channel,
            "measure": g.measure.name,
            "with": g.condition.name,
            "rank_correlation": g.found.coefficient,
            "probability_of_chance": g.found.probability,
        }
        for g in growths
    ]
    names = tuple(dict.fromkeys(g.condition.name for g in growths))
    says = "; ".join(_words(g) for g in shown[:_MOST_TOLD]) + "." if shown else _listed(names)
    panel = None
    if growths:
        panel = _panel(shown or sorted(growths, key=lambda g: g.found.probability)[:1])
    return Finding("runs", says, bool(shown), {"correlations": numbers}, panel)


def _growths(residual: Residual) -> list[Growth]:
    found = []
    for channel in residual.channels:
        parts = residual.of(channel)
        for condition in CONDITIONS.get(residual.kind.name, ()):
            x = np.array([condition.of(part) for part in parts])
            if np.ptp(x) == 0.0:
                continue
            for measure in MEASURES[residual.kind.name]:
                y = np.array([measure.of(part) for part in parts])
                correlation = rank_correlation(x, y)
                if measure.also is not None:
                    other = rank_correlation(x, np.array([measure.also(part) for part in parts]))
                    if correlation.coefficient * other.coefficient <= 0.0:
                        correlation = RankCorrelation(0.0, 1.0)
                    else:
                        correlation = max(correlation, other, key=lambda one: one.probability)
                found.append(Growth(channel, measure, condition, x, y, correlation))
    return found


def _words(growth: Growth) -> str:
    unit, scale = growth.measure.unit(growth.channel)
    order = np.argsort(growth.x)
    low, high = (scale * float(growth.y[order[place]]) for place in (0, -1))
    x_low, x_high = (growth.condition.scale * float(growth.x[order[p]]) for p in (0, -1))
    rises = "rises" if growth.found.coefficient > 0.0 else "falls"
    return (
        f"The {growth.measure.says} of what is left of {growth.channel} {rises} with the "
        f"{growth.condition.name}, from {low:.3g} {unit} at {x_low:.4g} {growth.condition.unit} to "
        f"{high:.3g} {unit} at {x_high:.4g} {growth.condition.unit} (rank correlation "
        f"{growth.found.coefficient:+.2f} over {growth.x.size} runs)"
    )


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names[:-1]) + f" or {names[-1]} of the runs" if len(names) > 1 else "the runs"


def _panel(shown: list[Growth]) -> Curves:
    first = shown[0]
    unit, scale = first.measure.unit(first.channel)
    alike = [
        g for g in shown if g.measure.name == first.measure.name and g.condition == first.condition
    ]
    curves = []
    for growth in alike:
        order = np.argsort(growth.x)
        curves.append(
            Curve(
                growth.x[order] * first.condition.scale,
                growth.y[order] * scale,
                growth.channel,
            )
        )
    return Curves(
        tuple(curves),
        f"{first.condition.name} [{first.condition.unit}]",
        f"left: {first.measure.name} [{unit}]",
        floor=0.0,
        joined=False,
    )
