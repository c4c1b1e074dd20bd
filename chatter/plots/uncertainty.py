"""Picture of uncertain limits: band of lobes, distribution, convergence."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.description.units import rpm
from chatter.plots import style

if TYPE_CHECKING:
    from chatter.studies.uncertainty.monte_carlo import Uncertainty

_BINS = 24
#: room on both sides of the distribution, where the depth of the cut is written
_BESIDE = 0.05
#: numbers of samples at which the convergence is drawn
_CONVERGENCE_POINTS = 60
#: samples drawn as thin lines
_DRAWN_SAMPLES = 25


def plot_uncertainty(found: Uncertainty) -> Figure:
    """Draw the band of lobes, the limit at the speed of the cut and the convergence."""
    figure = style.new_figure(9.0, 7.2)
    figure.suptitle(found.case.title or found.case.name, fontsize=11.0, x=0.01, ha="left")
    grid = figure.add_gridspec(2, 2, height_ratios=[1.6, 1.0])
    draw_band(figure.add_subplot(grid[0, :]), found)
    draw_distribution(figure.add_subplot(grid[1, 0]), found)
    draw_convergence(figure.add_subplot(grid[1, 1]), found)
    return figure


def draw_band(axes: Axes, found: Uncertainty) -> None:
    """Draw quantiles of the limit over speed, and the cut with its probability."""
    speed, cut = rpm(found.speeds), found.case.cut
    length = found.units.length
    top = max(found.max_depth, 1.05 * cut.axial_depth) * length.factor
    low, middle, high = found.quantiles() * length.factor
    axes.fill_between(
        speed, np.minimum(low, top), np.minimum(high, top), color=style.BLUE, alpha=0.22,
        linewidth=0.0, label="5 to 95 % of the limits",
    )  # fmt: skip
    for row in found.limits[:_DRAWN_SAMPLES] * length.factor:
        axes.plot(speed, _to_the_top(row, top), color=style.BLUE, linewidth=0.35, alpha=0.35)
    axes.plot(
        speed, _to_the_top(middle, top), color=style.BLUE, linewidth=1.8, label="median limit"
    )
    ends = found.interval
    label = f"cut: stable with {found.probability:.1%} ({ends[0]:.1%} to {ends[1]:.1%})"
    if found.for_certain_in_words():
        label += f", for certain {found.least_probability:.1%}"
    colour = style.GREEN if found.least_probability >= 0.5 else style.ORANGE
    colour = style.RED if found.probability < 0.5 else colour
    style.mark_cut(axes, cut, label, length, color=colour)
    axes.set(xlim=(speed[0], speed[-1]), ylim=(0.0, _highest_depth(found, high, top)))
    axes.set(xlabel="spindle speed [rpm]", ylabel=f"axial depth [{length.name}]")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=8.5, frameon=False)
    style.finish(axes)


def _highest_depth(found: Uncertainty, high: np.ndarray, top: float) -> float:
    if not np.isfinite(high).all():
        return top
    depth = found.case.cut.axial_depth * found.units.length.factor
    return min(top, 1.1 * max(float(high.max()), depth))


def _to_the_top(values: np.ndarray, top: float) -> np.ndarray:
    """Curve that leaves the picture beside speeds without a limit; it ended short of its top."""
    known = np.isfinite(values)
    beside = ~known & (np.append(known[1:], False) | np.insert(known[:-1], 0, False))
    return np.where(beside, 1.02 * top, np.where(known, values, np.nan))


def draw_distribution(axes: Axes, found: Uncertainty) -> None:
    """Draw the distribution of the limit at the speed of the cut."""
    length = found.units.length
    limit = found.operating[np.isfinite(found.operating)] * length.factor
    if limit.size:
        spread = np.ptp(limit) > 0.0
        axes.hist(limit, bins=_BINS if spread else 1, color=style.BLUE, alpha=0.6)
        quantiles = found.operating_quantiles() * length.factor
        for value, line in zip(quantiles, (":", "-", ":"), strict=True):
            if np.isfinite(value):
                axes.axvline(value, color=style.BLUE, linestyle=line, linewidth=1.4)
    depth = found.case.cut.axial_depth * length.factor
    axes.axvline(depth, color="black", linewidth=1.4, linestyle=(0, (4, 2)))
    low, high = axes.get_xlim()
    axes.set_xlim(low - _BESIDE * (high - low), high + _BESIDE * (high - low))
    axes.annotate(
        "depth of the cut", (depth, 0.99), xycoords=("data", "axes fraction"), rotation=90,
        xytext=(-2, 0), textcoords="offset points", ha="right", va="top", fontsize=7.5,
    )  # fmt: skip
    missing = len(found.operating) - limit.size
    deepest = length.text(found.max_depth, ".3g")
    beyond = f" ({missing} samples above {deepest})" if missing else ""
    speed = f"{rpm(found.case.cut.spindle_speed):.0f} rpm"
    axes.set_xlabel(f"limit at {speed} [{length.name}]{beyond}")
    axes.set_ylabel("samples")
    style.finish(axes)


def draw_convergence(axes: Axes, found: Uncertainty) -> None:
    """Draw the probability of a stable cut over the number of samples."""
    count = np.unique(np.linspace(1, len(found.stable), _CONVERGENCE_POINTS).round().astype(int))
    share, ends = found.convergence(count)
    axes.fill_between(
        count, ends[:, 0], ends[:, 1], color=style.ORANGE, alpha=0.3, linewidth=0.0,
        label="95 % confidence",
    )  # fmt: skip
    axes.plot(count, share, color=style.RED, linewidth=1.4, label="probability of stability")
    axes.set(xlim=(1, count[-1]), ylim=(-0.02, 1.02), xlabel="samples", ylabel="probability")
    axes.legend(fontsize=8.0, frameon=False, loc="best")
    style.finish(axes)
