"""Picture of an assembly: response at the tool point, and lobes over the stick-out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.description.units import rpm
from chatter.plots import style

if TYPE_CHECKING:
    from chatter.assembly.assemble import Assembly

#: stick-outs in the legend, beside the best one: as many as the height of the axes holds
_MOST_NAMED = 12


def plot_assembly(assembly: Assembly) -> Figure:
    """Draw the tool point at each stick-out; with a case also its lobes and removal rates."""
    if assembly.lobes is None:
        figure = style.new_figure(8.0, 4.8)
        _draw_receptance(figure.subplots(), assembly)
        return figure
    figure = style.new_figure(9.0, 8.6)
    response, limit, rate = figure.subplots(3, 1, height_ratios=[1.2, 1.3, 0.8])
    _draw_receptance(response, assembly)
    _draw_lobes(limit, assembly)
    _draw_removal_rate(rate, assembly)
    return figure


def _draw_receptance(axes: Axes, assembly: Assembly) -> None:
    count = assembly.stick_out.size
    named = {*np.linspace(0, count - 1, min(count, _MOST_NAMED)).round(), assembly.best}
    for k, colour, width in _looks(assembly):
        axes.semilogy(
            assembly.frequency,
            1e6 * np.abs(assembly.receptance[k]),
            color=colour,
            linewidth=width,
            label=assembly.units.length.text(assembly.stick_out[k]) if k in named else None,
        )
    axes.set(xlabel="frequency [Hz]", ylabel="receptance at the tool point [um/N]")
    axes.set_title(assembly.file.title or assembly.file.name)
    style.finish(axes)
    # beside the axes: responses fill them, and a peak may be anywhere
    axes.legend(
        title="stick-out", fontsize=7, title_fontsize=8, loc="upper left",
        bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0,
    )  # fmt: skip


def _draw_lobes(axes: Axes, assembly: Assembly) -> None:
    lobes = assembly.lobes
    if lobes is None:
        return
    length = assembly.units.length
    for k, colour, width in _looks(assembly):
        axes.plot(
            rpm(lobes.spindle_speed), length.factor * lobes.usable_depth[k], color=colour,
            linewidth=width,
        )  # fmt: skip
    axes.set(
        xlabel="spindle speed [rpm]",
        ylabel=f"critical depth, at most\nlength of the flutes [{length.name}]",
    )
    axes.set_ylim(bottom=0.0)
    style.finish(axes)


def _draw_removal_rate(axes: Axes, assembly: Assembly) -> None:
    lobes = assembly.lobes
    if lobes is None:
        return
    best, length, removal = assembly.best, assembly.units.length, assembly.units.removal_rate
    stick_out, rate = length.factor * assembly.stick_out, removal.factor * lobes.removal_rate
    axes.plot(stick_out, rate, "o-", color=style.BLUE)
    axes.plot(
        stick_out[best],
        rate[best],
        "o",
        color=style.RED,
        label=f"{stick_out[best]:.4g} {length.name} at {rpm(lobes.best_speed[best]):.0f} rpm",
    )
    axes.set(
        xlabel=f"stick-out [{length.name}]",
        ylabel=f"highest removal\nrate [{removal.name.replace('^3', '³')}]",
    )
    axes.set_ylim(bottom=0.0)
    style.finish(axes)
    axes.legend(fontsize=8)


def _looks(assembly: Assembly) -> list[tuple[int, tuple[float, ...], float]]:
    """Index, colour and line width of each stick-out; the best one is thick."""
    count = assembly.stick_out.size
    shades = colormaps["viridis"](np.linspace(0.0, 0.9, count))
    return [(k, tuple(shades[k]), 2.0 if k == assembly.best else 1.0) for k in range(count)]
