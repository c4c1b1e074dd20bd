"""Picture of a bifurcation diagram."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chatter.description.unit_system import unit_at
from chatter.plots.style import BLUE, GREY, RED, UNSTABLE_FILL, finish, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from chatter.studies.bifurcation import BifurcationDiagram

_COLOURS = {"stable": BLUE, "chatter": RED}
#: axes of less motion than this share of the other are left out
_STILL = 1e-3
#: room beside the first and the last value, as a share of their range
_BESIDE = 0.015


def plot_bifurcation(diagram: BifurcationDiagram) -> Figure:
    """Plot Poincaré sections of the displacement over the value that varies."""
    unit, factor = unit_at(diagram.case, diagram.path)
    of_motion = diagram.units.displacement.factor
    unit_of_motion = diagram.units.instead_of("µm").name
    sizes = [
        max(np.abs(point.poincare_section[:, axis]).max(initial=0.0) for point in diagram.points)
        for axis in range(3)
    ]
    moving = [axis for axis in range(3) if sizes[axis] > _STILL * max(sizes)] or [0]
    figure = new_figure(7.5, 2.6 * len(moving) + 0.6)
    panels = figure.subplots(len(moving), 1, sharex=True, squeeze=False)[:, 0]
    for panel, axis in zip(panels, moving, strict=True):
        for point in diagram.points:
            motion = point.poincare_section[:, axis] * of_motion
            panel.plot(
                np.full(motion.size, point.value * factor),
                motion,
                linestyle="none",
                marker=".",
                markersize=2.5,
                color=_COLOURS.get(point.verdict, GREY),
            )
        _mark_incomplete(panel, diagram, factor)
        _mark_linear(panel, diagram, factor)
        panel.set_ylabel(f"{'xyz'[axis]} at the Poincaré section [{unit_of_motion}]")
        finish(panel)
    drawn = {point.verdict for point in diagram.points if point.is_complete}
    for verdict in (one for one in _COLOURS if one in drawn):
        panels[0].plot([], [], linestyle="none", marker=".", color=_COLOURS[verdict], label=verdict)
    figure.legend(
        *panels[0].get_legend_handles_labels(),
        loc="outside upper right",
        ncols=2,
        frameon=False,
        fontsize=9,
    )
    name = diagram.path.split(".")[-1].replace("_", " ")
    values = [point.value * factor for point in diagram.points]
    # the sections at both ends stand beside the frame, not half behind it
    beside = _BESIDE * (max(values) - min(values)) or _BESIDE * abs(values[0]) or 1.0
    ends = min(values) - beside, max(values) + beside
    panels[-1].set_xlim(*ends)
    panels[-1].set_xlabel(f"{name} [{unit}]" if unit else name)
    if diagram.case.title:
        panels[0].set_title(diagram.case.title, loc="left")
    return figure


def _mark_linear(panel: Axes, diagram: BifurcationDiagram, factor: float) -> None:
    """Shade the values at which the linear analysis says chatter, and draw its limits."""
    linear, name = diagram.linear, f"by the linear analysis ({diagram.linear.method})"
    for number, (start, end) in enumerate(linear.unstable):
        label = "_" if number else f"chatter {name}"
        panel.axvspan(start * factor, end * factor, color=UNSTABLE_FILL, zorder=0, label=label)
    for number, limit in enumerate(linear.limits):
        label = "_" if number else "its limit"
        panel.axvline(limit * factor, color="black", linestyle="--", linewidth=1.0, label=label)


def _mark_incomplete(panel: Axes, diagram: BifurcationDiagram, factor: float) -> None:
    """Mark at the lower end the cuts that have no Poincaré section."""
    values = [point.value * factor for point in diagram.points if not point.is_complete]
    if not values:
        return
    panel.plot(
        values,
        np.full(len(values), 0.03),
        transform=panel.get_xaxis_transform(),
        linestyle="none",
        marker="x",
        markersize=5.0,
        color=RED,
        clip_on=False,
        label="chatter, the tool left the range of the model",
    )
