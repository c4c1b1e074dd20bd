"""Panels of residual diagnostics, and pages of them."""

import math
from collections.abc import Sequence
from functools import singledispatch
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from chatter.explain.residuals.finding import Bars, Curves, Finding, Map, Panel, Points
from chatter.plots import style

_COLOURS = (style.BLUE, style.ORANGE, style.GREEN, style.RED, style.GREY, "#56B4E9")
_MARKERS = "osD^vP"
_WIDTH, _HEIGHT = 5.4, 3.1
_LEGEND = {"fontsize": 7.5, "frameon": False}


def plot_findings(findings: Sequence[Finding], columns: int = 2) -> Figure:
    """Draw the panels of findings side by side."""
    shown = [finding for finding in findings if finding.panel is not None]
    columns = max(1, min(columns, len(shown)))
    rows = max(1, math.ceil(len(shown) / columns))
    figure = style.new_figure(_WIDTH * columns, _HEIGHT * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, finding in zip(panels, shown, strict=False):
        draw_finding(axes, finding)
    for axes in panels[len(shown) :]:
        axes.set_visible(False)
    return figure


def draw_finding(axes: Axes, finding: Finding) -> None:
    """Draw the panel of a finding with its name."""
    draw(finding.panel, axes)
    axes.set_title(finding.name, loc="left")
    style.finish(axes)


@singledispatch
def draw(panel: Panel, axes: Axes) -> None:
    """Draw a panel."""
    raise TypeError(f"{type(panel).__name__} is not drawn on {type(axes).__name__}")


@draw.register
def _(panel: Bars, axes: Axes) -> None:
    count = max(1, len(panel.series))
    width = 0.8 / count
    positions = np.arange(len(panel.categories))
    for number, (name, values) in enumerate(panel.series.items()):
        axes.bar(
            positions + (number - 0.5 * (count - 1)) * width,
            values,
            width,
            color=_COLOURS[number % len(_COLOURS)],
            label=name,
        )
    if panel.floor is not None:
        axes.axhline(panel.floor, color="black", lw=0.9, ls="--")
    axes.set_xticks(positions, panel.categories)
    if len(panel.categories) > 5:
        axes.tick_params(axis="x", rotation=45)
    axes.set_ylabel(panel.label)
    axes.margins(y=0.18)
    axes.legend(ncols=count, loc="upper right", **_LEGEND)


@draw.register
def _(panel: Curves, axes: Axes) -> None:
    looks = zip(cycle(_COLOURS), cycle(_MARKERS), panel.curves, strict=False)
    for colour, marker, curve in looks:
        few = curve.x.size <= 40
        axes.plot(
            curve.x,
            curve.y,
            color=colour,
            lw=1.2 if panel.joined else 0.0,
            marker=marker if few or not panel.joined else "",
            markersize=3.5,
            label=curve.label or None,
        )
        if curve.spread is not None:
            spread = 2.0 * np.nan_to_num(curve.spread)
            axes.fill_between(
                curve.x, curve.y - spread, curve.y + spread, color=colour, alpha=0.2, lw=0.0
            )
    for name, values in panel.marks.items():
        for number, value in enumerate(values):
            label = name if number == 0 else None
            axes.axvline(value, color=style.GREY, lw=0.9, ls=":", label=label)
    _scale(axes, panel.logarithmic)
    if panel.floor is not None:
        axes.axhline(panel.floor, color="black", lw=0.9, ls="--")
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label)
    if any(curve.label for curve in panel.curves) or panel.marks:
        axes.legend(**_LEGEND)


def _scale(axes: Axes, logarithmic: str) -> None:
    for name, axis in (("x", axes.xaxis), ("y", axes.yaxis)):
        if name in logarithmic:
            (axes.set_xscale if name == "x" else axes.set_yscale)("log")
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())


@draw.register
def _(panel: Map, axes: Axes) -> None:
    shown = panel.values[np.isfinite(panel.values)]
    most = float(np.quantile(np.abs(shown), 0.98)) if shown.size else 1.0
    image = axes.pcolormesh(
        panel.x_edges, panel.y_edges, panel.values, cmap="PuOr", vmin=-most, vmax=most
    )
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label)
    _scale(axes, panel.logarithmic)
    bar = axes.figure.colorbar(image, ax=axes)
    bar.set_label(panel.label, fontsize=8.5)
    bar.ax.tick_params(labelsize=8.0)


#: colour, marker and fill of classes of points, in their order
_CLASSES = (
    (style.GREEN, "o", False),
    (style.GREY, "x", True),
    (style.BLUE, "^", True),
    (style.RED, "v", True),
)


@draw.register
def _(panel: Points, axes: Axes) -> None:
    draw_points(panel, axes)
    if panel.curve is not None:
        axes.plot(
            panel.curve.x, panel.curve.y, color="black", lw=1.2, label=panel.curve.label, zorder=1.5
        )
    _scale(axes, panel.logarithmic)
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label)
    axes.margins(y=0.15)
    # below the axes: within them there are points everywhere
    axes.legend(ncols=2, loc="upper left", bbox_to_anchor=(0.0, -0.2), **_LEGEND)


def draw_points(panel: Points, axes: Axes) -> None:
    """Draw points of several classes."""
    for (name, (x, y)), (colour, marker, filled) in zip(
        panel.classes.items(), cycle(_CLASSES), strict=False
    ):
        if x.size:
            axes.plot(
                x,
                y,
                marker,
                color=colour,
                mfc=colour if filled else "none",
                markersize=5.0,
                label=f"{name} ({x.size})",
            )
