"""Picture of a pitch design: limits before and after, and over the difference of pitch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.description.units import rpm
from chatter.plots import style

if TYPE_CHECKING:
    from chatter.studies.pitch_design.pitch_result import PitchResult

_COLOURS = {"alternating": style.ORANGE, "linear": "#CC79A7"}


def plot_pitch(found: PitchResult) -> Figure:
    """Draw the limits before and after, and what the rule and the families give."""
    figure = style.new_figure(8.4, 7.4)
    limits, families = figure.subplots(2, 1, height_ratios=[1.6, 1.0])
    draw_limits(limits, found)
    draw_families(families, found)
    limits.set_title(found.case.title or "Pitch angles", loc="left", pad=24.0)
    return figure


def draw_limits(axes: Axes, found: PitchResult) -> None:
    """Draw the first limit over speed before and after; where none was found the line ends."""
    speed, length = rpm(found.speeds), found.units.length
    curves = (("before", found.original, style.GREY), ("after", found.best, style.BLUE))
    for name, design, colour in curves:
        limits = design.limits
        angles = ", ".join(f"{angle:g}" for angle in design.pitch)
        known = np.where(limits < found.max_depth, limits * length.factor, np.nan)
        axes.plot(speed, known, color=colour, linewidth=1.6, label=f"{name}: {angles} deg")
        lowest = design.lowest_limit * length.factor
        # below all of its own curve; beside the axes, where no other one passes through it
        axes.axhline(lowest, color=colour, linewidth=0.9, linestyle=(0, (4, 2)))
        axes.annotate(
            f"{lowest:.3g} {length.name}", (1.0, lowest), xycoords=("axes fraction", "data"),
            xytext=(4, 0), textcoords="offset points", ha="left", va="center", fontsize=8.0,
            color=colour,
        )  # fmt: skip
    axes.set_xlim(speed[0], speed[-1])
    axes.set(ylim=(0.0, None), xlabel="spindle speed [rpm]")
    axes.set_ylabel(f"critical depth [{length.name}]")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize=8.0, frameon=False)
    style.finish(axes)


def draw_families(axes: Axes, found: PitchResult) -> None:
    """Draw the lowest limit over the difference of pitch, and where regeneration cancels."""
    unit, factor = found.units.length
    for curve in found.curves:
        colour = _COLOURS[curve.name]
        lowest = [one.lowest_limit * factor for one in curve.designs]
        axes.plot(np.degrees(curve.differences), lowest, ".-", color=colour, label=curve.name)
        for number, difference in enumerate(np.degrees(curve.rule)):
            label = f"rule, {curve.name}" if number == 0 else None
            axes.axvline(difference, color=colour, linewidth=1.2, linestyle=":", label=label)
    axes.axhline(
        found.best.lowest_limit * factor, color=style.BLUE, linewidth=1.0, linestyle="--",
        label="best found, between the speeds too",
    )  # fmt: skip
    axes.set(ylim=(0.0, None), xlabel="difference between neighbouring pitch angles [deg]")
    axes.set_ylabel(f"lowest critical depth [{unit}]")
    axes.legend(loc="best", fontsize=8.0, frameon=False, ncols=2)
    style.finish(axes)
