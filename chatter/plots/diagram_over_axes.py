"""Pictures of limits and stability over any path of a case."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from chatter.plots import style

if TYPE_CHECKING:
    from chatter.studies.results_over_axes import PathLimits, StabilityMap

_FILL_ROWS = 1000
#: spectral radii beyond this look alike
_HIGHEST_RADIUS = 2.0
_RADIUS_COLOURS = LinearSegmentedColormap.from_list(
    "spectral radius",
    [
        (0.0, "#5AB08F"),
        (0.5, style.STABLE_FILL),
        (0.5, style.UNSTABLE_FILL),
        (1.0, "#D9905F"),
    ],
)


def plot_limits(diagram: PathLimits) -> Figure:
    """Draw stable depths and the chatter frequency at the limit over the values of a path.

    Parameters
    ----------
    diagram : PathLimits

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = style.new_figure(8.0, 6.4)
    limit, frequency = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
    _draw_limits(limit, diagram)
    _draw_frequency(frequency, diagram)
    limit.set_title(diagram.case.title or "Stability limit", pad=34.0, loc="left")
    return figure


def _draw_limits(axes: Axes, diagram: PathLimits) -> None:
    x, top = diagram.x, _top(diagram)
    depth = (np.arange(_FILL_ROWS) + 0.5) * top / _FILL_ROWS
    chatter = np.array([np.searchsorted(found, depth) % 2 for found in diagram.crossings]).T
    # nothing is known beyond the search, and where there was none
    beyond = ~(depth[:, None] <= diagram.searched_to[None, :])
    axes.pcolormesh(
        x,
        depth * 1e3,
        np.ma.masked_where(beyond, chatter),
        cmap=ListedColormap([style.STABLE_FILL, style.UNSTABLE_FILL]),
        shading="nearest",
        vmin=0,
        vmax=1,
        zorder=0.5,
        rasterized=True,
    )
    most = max((len(found) for found in diagram.crossings), default=0)
    for place in range(1, most):
        edge = [d[place] * 1e3 if len(d) > place else math.nan for d in diagram.crossings]
        axes.plot(x, edge, ".", markersize=3.5, color=style.BLUE, zorder=1.5)
    first = np.where(np.isfinite(diagram.critical_depth), diagram.critical_depth * 1e3, math.nan)
    # where stretches come or go the limit jumps: no line across
    jumps = np.flatnonzero(np.diff([len(found) for found in diagram.crossings])) + 1
    across, first = np.insert(x, jumps, x[jumps]), np.insert(first, jumps, math.nan)
    kinds = np.insert(np.array(diagram.bifurcation, dtype="U8"), jumps, "none")
    label = f"limit, {diagram.method.replace('-', ' ')}"
    axes.plot(across, first, ".-", color=style.BLUE, linewidth=1.6, markersize=3.5, label=label)
    flip = kinds == "flip"
    if flip.any():
        flips = np.where(flip, first, math.nan)
        axes.plot(
            across, flips, ".-", color=style.RED, linewidth=2.0, markersize=4, label="limit by flip"
        )
    _mark_case(axes, diagram.standing, diagram.case.cut.axial_depth * 1e3, (x[0], x[-1]))
    _name_sides(axes)
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(0.0, top * 1e3)
    axes.set_ylabel("axial depth [mm]")
    style.finish(axes)


def _top(diagram: PathLimits) -> float:
    """Highest depth shown, m: what all limits reach, or all of the search without any."""
    found = [crossing for crossings in diagram.crossings for crossing in crossings]
    highest = 1.15 * max(found) if found else float(np.nanmax(diagram.searched_to))
    return max(highest, 1.05 * diagram.case.cut.axial_depth)


def _draw_frequency(axes: Axes, diagram: PathLimits) -> None:
    kinds = np.array(diagram.bifurcation)
    for kind, name, colour in (("hopf", "Hopf", style.BLUE), ("flip", "flip", style.RED)):
        of_kind = kinds == kind
        if of_kind.any():
            heard = diagram.chatter_frequency[of_kind]
            axes.plot(diagram.x[of_kind], heard, ".", markersize=4, color=colour, label=name)
    axes.set_xlabel(diagram.axis.axis_label)
    axes.set_ylabel("chatter\nfrequency [Hz]")
    style.finish(axes)
    if axes.has_data():
        axes.legend(loc="best", fontsize=7.5, framealpha=0.85, ncols=2)


def _mark_case(axes: Axes, x: float, y: float, inside: tuple[float, float]) -> None:
    if math.isfinite(x) and math.isfinite(y) and inside[0] <= x <= inside[1]:
        axes.plot(
            x,
            y,
            marker="D",
            markersize=7,
            markeredgecolor="black",
            color="white",
            linestyle="none",
            label="the case",
            zorder=5,
        )


def _name_sides(axes: Axes) -> None:
    """Legend above the axes, with the fills of both sides."""
    lines, labels = axes.get_legend_handles_labels()
    fills = [
        Patch(facecolor=style.STABLE_FILL, edgecolor=style.GREY, label="stable"),
        Patch(facecolor=style.UNSTABLE_FILL, edgecolor=style.GREY, label="chatter"),
    ]
    axes.legend(
        [*lines, *fills],
        [*labels, "stable", "chatter"],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.02),
        ncols=5,
        fontsize=8.5,
        frameon=False,
        borderaxespad=0.0,
    )


def plot_map(diagram: StabilityMap) -> Figure:
    """Draw the spectral radius over two paths, with the boundary of stability.

    Parameters
    ----------
    diagram : StabilityMap

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = style.new_figure(8.0, 5.6)
    axes = figure.subplots()
    x, y, radius = diagram.x, diagram.y, diagram.spectral_radius
    radius = np.ma.masked_invalid(radius)
    lowest = min(float(radius.min()), 0.99)
    highest = min(max(float(radius.max()), 1.01), _HIGHEST_RADIUS)
    mesh = axes.pcolormesh(
        x,
        y,
        radius,
        cmap=_RADIUS_COLOURS,
        norm=TwoSlopeNorm(1.0, lowest, highest),
        shading="nearest",
        rasterized=True,
    )
    if radius.min() < 1.0 < radius.max():
        growth = np.ma.log(np.ma.maximum(radius, 1e-300))
        axes.contour(x, y, growth, levels=[0.0], colors=[style.BLUE], linewidths=1.6)
        axes.plot([], [], color=style.BLUE, linewidth=1.6, label="|µ| = 1")
    if y[0] <= diagram.standing[1] <= y[-1]:
        _mark_case(axes, *diagram.standing, (x[0], x[-1]))
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(y[0], y[-1])
    axes.set_xlabel(diagram.x_axis.axis_label)
    axes.set_ylabel(diagram.y_axis.axis_label)
    axes.set_title(diagram.case.title or "Spectral radius", pad=28.0, loc="left")
    _name_sides(axes)
    style.finish(axes)
    extend = "max" if radius.max() > _HIGHEST_RADIUS else "neither"
    bar = figure.colorbar(mesh, ax=axes, extend=extend)
    bar.set_label("spectral radius |µ|, stable below 1")
    return figure
