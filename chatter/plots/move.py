"""Picture of a move of a machine's axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.plots import style

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.move import MoveResult

_COLOURS = (style.BLUE, style.RED, style.GREEN, style.ORANGE)


def plot_move(result: MoveResult) -> Figure:
    """Draw position, velocity, errors and effort of every axis, and the contour of a path."""
    plane = result.contour is not None and len(result.axes) >= 2
    figure = style.new_figure(11.0, 8.0)
    figure.suptitle(result.name, fontsize=11.0, x=0.01, ha="left")
    axes = figure.subplots(2, 2) if not plane else figure.subplots(2, 3).reshape(2, 3)
    time = result.time
    for index, axis in enumerate(result.axes):
        colour = _COLOURS[index % len(_COLOURS)]
        axes[0, 0].plot(time, result.wanted[:, index] * 1e3, color=colour, lw=1.2, label=axis)
        axes[0, 1].plot(time, result.velocity[:, index], color=colour, lw=1.0, label=axis)
        at_motor = (result.wanted - result.motor)[:, index] * 1e6
        axes[1, 0].plot(time, at_motor, color=colour, lw=1.0, label=f"{axis} motor")
        if result.tool is not None:
            at_tool = (result.wanted - result.tool)[:, index] * 1e6
            axes[1, 0].plot(time, at_tool, color=colour, lw=1.0, ls=":", label=f"{axis} tool")
        unit = result.effort_unit(index).replace("*", " ")
        label = f"{axis} [{unit}]"
        axes[1, 1].plot(time, result.effort[:, index], color=colour, lw=0.8, label=label)
    _label(axes[0, 0], "position set [mm]")
    _label(axes[0, 1], "velocity [m/s]")
    _label(axes[1, 0], "set less actual [µm]")
    _label(axes[1, 1], "effort of the motors")
    if plane:
        _draw_path(axes[0, 2], result)
        axes[1, 2].plot(time, result.contour * 1e6, color=style.BLUE, lw=1.0)
        _label(axes[1, 2], "contour error [µm]", legend=False)
    for each in axes.flat:
        style.finish(each)
    return figure


def _label(panel: Axes, text: str, legend: bool = True) -> None:
    panel.set(xlabel="time [s]", ylabel=text)
    if legend:
        _legend_above(panel)


def _draw_path(panel: Axes, result: MoveResult) -> None:
    """Path with the contour error enlarged so that it can be seen."""
    wanted = result.wanted[:, :2]
    went = (result.motor if result.tool is None else result.tool)[:, :2]
    largest = float(np.max(np.abs(result.contour), initial=0.0))
    size = float(np.max(np.ptp(wanted, axis=0), initial=0.0))
    factor = 1.0 if largest == 0.0 else 10.0 ** np.floor(np.log10(0.1 * size / largest))
    enlarged = wanted + factor * _across(wanted, went)
    panel.plot(wanted[:, 0] * 1e3, wanted[:, 1] * 1e3, color=style.GREY, lw=1.0, label="set")
    panel.plot(
        enlarged[:, 0] * 1e3,
        enlarged[:, 1] * 1e3,
        color=style.BLUE,
        lw=1.0,
        label=f"error x {factor:g}",
    )
    panel.set(aspect="equal", xlabel=f"{result.axes[0]} [mm]", ylabel=f"{result.axes[1]} [mm]")
    _legend_above(panel)


def _legend_above(panel: Axes) -> None:
    """Legend above the panel, where no curve is."""
    panel.legend(
        fontsize=8.0,
        frameon=False,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=2,
        borderaxespad=0.1,
    )


def _across(wanted: np.ndarray, went: np.ndarray) -> np.ndarray:
    """Part of the deviation across the direction of the set motion."""
    along = np.gradient(wanted, axis=0)
    length = np.linalg.norm(along, axis=1, keepdims=True)
    unit = np.divide(along, length, out=np.zeros_like(along), where=length > 0.0)
    off = went - wanted
    return np.where(length > 0.0, off - np.sum(off * unit, axis=1, keepdims=True) * unit, 0.0)
