"""Picture of a verdict: which depths are stable at the operating speed."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from chatter.description.units import rpm
from chatter.plots import style
from chatter.stability.neglected_effects import CHATTER, STABLE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from chatter.stability.check import StabilityCheck

#: of the depth shown over the larger of limit and operating point
_BEYOND = 1.4


def plot_check(result: StabilityCheck) -> Figure:
    """Bar of the axial depths at the operating speed, stable and not, with the cut on it."""
    cut, (unit, factor) = result.case.cut, result.units.length
    depth = cut.axial_depth * factor
    crossings = np.asarray(result.limit.crossings[0]) * factor
    deepest = result.max_depth * factor
    shown = min(deepest, _BEYOND * max(depth, *crossings)) if crossings.size else deepest
    ends = [0.0, *crossings[crossings < shown], max(shown, depth)]
    figure = style.new_figure(6.5, 1.6)
    axes = figure.subplots()
    for i, (start, end) in enumerate(itertools.pairwise(ends)):
        fill, word = (style.UNSTABLE_FILL, "chatter") if i % 2 else (style.STABLE_FILL, "stable")
        axes.axvspan(start, end, color=fill)
        if end - start > 0.12 * ends[-1]:
            axes.text(0.5 * (start + end), 0.8, word, ha="center", va="center")
    colour = {STABLE: style.GREEN, CHATTER: style.RED}.get(result.verdict, style.ORANGE)
    axes.plot(
        depth, 0.35, "o", color=colour, markeredgecolor="black", markersize=9,
        label=f"this cut, {depth:.4g} {unit}, {result.verdict}",
    )  # fmt: skip
    axes.set(
        xlim=(0.0, ends[-1]), ylim=(0.0, 1.0), yticks=[],
        xlabel=f"axial depth [{unit}]", title=f"at {rpm(cut.spindle_speed):.6g} rpm",
    )  # fmt: skip
    axes.legend(loc="lower right", fontsize=8)
    style.finish(axes)
    return figure
