"""Picture of the friction of a drive: effort over time, friction over velocity and position."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.plots import style

if TYPE_CHECKING:
    from chatter.drive_friction.result import DriveFriction

#: points of the curve of the law over velocity
_POINTS = 400


def plot_drive_friction(found: DriveFriction) -> Figure:
    """Draw measured and predicted effort, and what is left of it less inertia beside the law."""
    figure = style.new_figure(12.0, 4.2)
    figure.suptitle(f"{found.name}: {found.kept.name} friction", fontsize=11.0, x=0.01, ha="left")
    panels = figure.subplots(1, 3)
    _draw_effort(panels[0], found)
    _draw_velocity(panels[1], found)
    _draw_position(panels[2], found)
    for panel in panels:
        style.finish(panel)
    return figure


def _unit(found: DriveFriction) -> str:
    return found.unit("coulomb").replace("*", " ")


def _draw_effort(panel: Axes, found: DriveFriction) -> None:
    low_pass, start = found.settings.low_pass, 0.0
    for k, record in enumerate(found.given.records):
        time = start + record.time - record.time[0]
        measured = low_pass.apply(record.effort, record.sample_time)
        fitted = found.kept.effort(record, low_pass)
        labels = ("measured", "fitted") if k == 0 else (None, None)
        panel.plot(time, measured, color=style.GREY, lw=1.0, label=labels[0])
        panel.plot(time, fitted, color=style.RED, lw=1.0, label=labels[1])
        start = float(time[-1])
    cutoff = low_pass.cutoff
    panel.set(xlabel="time [s]", ylabel=f"effort below {cutoff:g} Hz [{_unit(found)}]")
    panel.legend(fontsize=8.0, frameon=False)


def _draw_velocity(panel: Axes, found: DriveFriction) -> None:
    speed = "rad/s" if found.given.rotary else "m/s"
    ends = []
    for record, friction in _measured(found):
        panel.plot(record.velocity, friction, ".", color=style.BLUE, ms=2.0, alpha=0.5)
        ends += [record.velocity.min(), record.velocity.max()]
    velocity = np.linspace(min(ends), max(ends), _POINTS)
    panel.plot(velocity, found.kept.law.steady_state_force(velocity), color=style.RED, label="law")
    if points := found.constant_speeds:
        panel.errorbar(
            [one.velocity for one in points],
            [one.effort - found.kept.offset for one in points],
            yerr=[2.0 * one.standard_error for one in points],
            fmt="s", ms=4.0, color="black", mfc="none", lw=0.8, label="means at constant speed",
        )  # fmt: skip
    panel.set(xlabel=f"velocity [{speed}]", ylabel=f"friction [{_unit(found)}]")
    panel.legend(fontsize=8.0, frameon=False)


def _draw_position(panel: Axes, found: DriveFriction) -> None:
    factor, unit = (1.0, "rad") if found.given.rotary else (1e3, "mm")
    low_pass = found.settings.low_pass
    for record, friction in _measured(found):
        along = low_pass.apply(found.kept.friction(record), record.sample_time)
        panel.plot(factor * record.position, friction, color=style.BLUE, lw=0.8)
        panel.plot(factor * record.position, along, color=style.RED, lw=1.0)
    panel.set(xlabel=f"position [{unit}]", ylabel=f"friction [{_unit(found)}]")


def _measured(found: DriveFriction):
    """Records, and what inertia and offset leave of their effort, low-passed."""
    low_pass = found.settings.low_pass
    for record in found.given.records:
        acceleration = np.gradient(record.velocity, record.sample_time)
        rest = record.effort - found.kept.inertia * acceleration - found.kept.offset
        yield record, low_pass.apply(rest, record.sample_time)
