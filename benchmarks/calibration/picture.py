"""Reliability diagram: share that is true over stated probability."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
from matplotlib.figure import Figure

from benchmarks.calibration.reliability import Summary

#: of an interval of 95 %
_DEVIATIONS = 1.96


def draw(summary: Summary, file: Path) -> None:
    """Write the diagram, with Wilson's (1927) intervals of the shares."""
    figure = Figure(figsize=(5.6, 5.2), layout="constrained")
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 1.0], color="grey", linewidth=1.0, label="as stated")
    for k, one in enumerate(summary.bins):
        low, high = interval(one.true, one.count)
        axes.plot([one.stated] * 2, [low, high], color="tab:blue", linewidth=1.2)
        axes.plot(
            one.stated, one.true, "o", color="tab:blue", markersize=4.0 + 1.5 * math.log(one.count),
            label="share that is true, with its 95 % interval" if k == 0 else None,
        )  # fmt: skip
        axes.annotate(
            str(one.count), (one.stated, one.true), xytext=(-7, 5), textcoords="offset points",
            fontsize=8, ha="right",
        )  # fmt: skip
    axes.set(xlim=(-0.02, 1.04), ylim=(-0.02, 1.04))
    axes.set_xlabel("stated probability of an effect [-]")
    axes.set_ylabel("share of the statements that are true [-]")
    axes.set_title(
        f"{summary.sets} sets, {summary.statements} statements: expected calibration error "
        f"{summary.error:.1%}",
        fontsize=10,
    )
    axes.legend(loc="upper left", fontsize=8, frameon=False)
    figure.savefig(file, dpi=130)


def interval(share: float, count: int) -> tuple[float, float]:
    """95 % interval of a share of so many."""
    square = _DEVIATIONS**2 / count
    middle = (share + 0.5 * square) / (1.0 + square)
    half = (
        _DEVIATIONS
        * math.sqrt(share * (1.0 - share) / count + 0.25 * square / count)
        / (1.0 + square)
    )
    return max(middle - half, 0.0), min(middle + half, 1.0)
