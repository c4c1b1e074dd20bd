"""Picture of what cutting tests leave possible: probability of stability, tests, next cut."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.description.arrays import Array
from chatter.description.units import rpm
from chatter.plots import style

if TYPE_CHECKING:
    from chatter.explain.measurement import Run
    from chatter.learning.diagram import ParticleDiagram
    from chatter.learning.learn import Learnt

_LEVELS = np.linspace(0.0, 1.0, 11)


def plot_learning(found: Learnt) -> Figure:
    """Draw the probability of stability over the diagram, and what was learnt of every value."""
    figure = style.new_figure(9.5, 7.6)
    figure.suptitle(found.case.title or found.case.name, fontsize=11.0, x=0.01, ha="left")
    grid = figure.add_gridspec(2, 1, height_ratios=[2.2, 1.0])
    draw_probability(figure, figure.add_subplot(grid[0]), found)
    draw_parameters(figure.add_subplot(grid[1]), found)
    return figure


def draw_probability(figure: Figure, axes: Axes, found: Learnt) -> None:
    """Draw the probability that a cut is stable, the median limit, tests and next cut."""
    diagram, (unit, factor) = found.diagram, found.units.length
    speed, depth = rpm(diagram.speeds), factor * diagram.depths
    filled = axes.contourf(
        speed, depth, diagram.probability.T, levels=_LEVELS, cmap="RdYlGn", alpha=0.55
    )
    bar = figure.colorbar(filled, ax=axes, pad=0.01, ticks=_LEVELS[::2])
    bar.set_label("probability of a stable cut")
    axes.plot(
        speed, _median(diagram, factor), color="black", linewidth=1.8, label="median limit, now"
    )
    if found.first is not diagram:
        axes.plot(
            speed, _median(found.first, factor), "--", color="black", linewidth=1.2,
            label="median limit, at the first test",
        )  # fmt: skip
    for run in found.measurement.runs:
        if run.record == "stable":
            _draw_tests(axes, run, factor)
    chosen = found.next_cut
    if chosen is not None:
        axes.plot(
            rpm(chosen.spindle_speed), factor * chosen.axial_depth, marker="*", markersize=17,
            color=style.BLUE, markeredgecolor="white", linestyle="none",
            label=f"next cut, for {found.aim}",
        )  # fmt: skip
    axes.set(xlim=(speed[0], speed[-1]), ylim=(0.0, depth[-1]))
    axes.set(xlabel="spindle speed [rpm]", ylabel=f"axial depth [{unit}]")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=8.0, frameon=False)
    style.finish(axes)


def _median(diagram: ParticleDiagram, factor: float) -> Array:
    """Median limit (s,), m times a factor; NaN where half of the particles have none."""
    limits = np.sort(diagram.limits, axis=0)[len(diagram.limits) // 2]
    return np.where(np.isfinite(limits), factor * limits, np.nan)


def _draw_tests(axes: Axes, run: Run, factor: float) -> None:
    stable = run.signals["stable"] > 0.5
    speed, depth = rpm(run.signals["spindle_speed"]), factor * run.signals["axial_depth"]
    for chosen, label, marker, colour in (
        (stable, "test: stable", "o", style.GREEN),
        (~stable, "test: chatter", "X", style.RED),
    ):
        if chosen.any():
            axes.plot(
                speed[chosen], depth[chosen], marker, color=colour, markeredgecolor="black",
                markersize=6.5, linestyle="none", label=label,
            )  # fmt: skip


def draw_parameters(axes: Axes, found: Learnt) -> None:
    """Draw 5, 50 and 95 % of every value before and after, in declared standard deviations."""
    before, after = found.before.counted, found.after.counted
    names = [_short(one.name) for one in found.after.prior.parameters]
    places = np.arange(len(names))
    for counted, shift, colour, label in (
        (before, -0.14, style.GREY, "declared"),
        (after, 0.14, style.BLUE, "learnt"),
    ):
        low, middle, high = np.quantile(counted, (0.05, 0.5, 0.95), axis=0)
        axes.errorbar(
            places + shift, middle, [middle - low, high - middle], fmt="o", color=colour,
            markersize=4.0, capsize=2.5, linewidth=1.4, label=label,
        )  # fmt: skip
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xticks(places, names, rotation=35, ha="right", fontsize=7.0)
    axes.set_ylabel("deviation from declared\n[standard deviations]")
    axes.legend(loc="best", fontsize=8.0, frameon=False, ncols=2)
    style.finish(axes)
    axes.tick_params(axis="x", labelsize=7.0)


def _short(name: str) -> str:
    """Name of a value as it is read beside others."""
    return name.removeprefix("structure.").removeprefix("material.").replace("_", " ")
