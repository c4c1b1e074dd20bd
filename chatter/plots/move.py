"""Picture of a move of a machine's axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.plots import style

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.move import MoveResult

_EFFORTS = {"N": "force", "N m": "torque"}
_COLOURS = (style.BLUE, style.RED, style.GREEN, style.ORANGE)


def plot_move(result: MoveResult) -> Figure:
    """Draw position, velocity, errors and effort of every axis, and the contour of a path."""
    plane = result.contour is not None and len(result.axes) >= 2
    figure = style.new_figure(11.0, 8.0)
    figure.suptitle(result.name, fontsize=11.0, x=0.01, ha="left")
    axes = figure.subplots(2, 2) if not plane else figure.subplots(2, 3).reshape(2, 3)
    time = result.time
    unit, factor = _velocity_unit(result)
    for index, axis in enumerate(result.axes):
        line = {"color": _colour(index), "lw": 1.0}
        axes[0, 0].plot(time, result.wanted[:, index] * 1e3, label=axis, **line)
        axes[0, 1].plot(time, result.velocity[:, index] * factor, label=axis, **line)
        for place, went, dashes in _places(result):
            error = (result.wanted - went)[:, index] * 1e6
            axes[1, 0].plot(time, error, ls=dashes, label=f"{axis} {place}", **line)
    _label(axes[0, 0], "position set [mm]")
    _label(axes[0, 1], f"velocity [{unit}]")
    _label(axes[1, 0], "set less actual [µm]")
    if plane:
        _draw_path(axes[0, 2], result)
        axes[1, 2].plot(time, result.contour * 1e6, color=style.BLUE, lw=1.0)
        _label(axes[1, 2], "contour error [µm]", legend=False)
    for each in axes.flat:
        style.finish(each)
    _draw_efforts(axes[1, 1], result)
    return figure


def _colour(index: int) -> str:
    return _COLOURS[index % len(_COLOURS)]


def _velocity_unit(result: MoveResult) -> tuple[str, float]:
    """Unit of feeds: mm/min where all are slow, m/min else; and how many are 1 m/s."""
    fastest = float(np.max(np.abs(result.velocity), initial=0.0))
    return ("mm/min", 60e3) if fastest * 60.0 < 1.0 else ("m/min", 60.0)


def _places(result: MoveResult) -> list[tuple[str, np.ndarray, str]]:
    """Where positions are read, and the line of each; a scale beside the motor is the motor's."""
    found = [("motor", result.motor, "-")]
    if not np.allclose(result.scale, result.motor, rtol=0.0, atol=1e-9):
        found.append(("scale", result.scale, "--"))
    return found if result.tool is None else [*found, ("tool", result.tool, ":")]


def _draw_efforts(panel: Axes, result: MoveResult) -> None:
    """Torques and forces of the motors; forces on an axis of their own at the right."""
    panels: dict[str, Axes] = {}
    for index, axis in enumerate(result.axes):
        unit = result.effort_unit(index).replace("*", " ")
        if unit not in panels:
            panels[unit] = panel.twinx() if panels else panel
            panels[unit].set_ylabel(f"{_EFFORTS.get(unit, 'effort')} of the motors [{unit}]")
            if panels[unit] is not panel:
                style.finish_at_right(panels[unit])
        panels[unit].plot(result.time, result.effort[:, index], color=_colour(index), lw=0.8)
        panel.plot([], [], color=_colour(index), lw=0.8, label=f"{axis} [{unit}]")
    if len(panels) > 1:
        for one in panels.values():  # zero at one height
            one.set_ylim(np.array([-1.0, 1.0]) * np.max(np.abs(one.get_ylim())))
    panel.set_xlabel("time [s]")
    _legend_above(panel)


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
    factor = 1.0 if largest == 0.0 else _round_below(0.1 * size / largest)
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


def _round_below(value: float) -> float:
    """Largest 1, 2 or 5 times a power of ten that is no larger."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(one for one in (1.0, 2.0, 5.0) if one * power <= value * (1 + 1e-9)))


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
