"""Picture of cutting coefficients: mean forces of the cuts beside the laws fitted to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.cutting_coefficients.feed_series import differ_by_feed_alone
from chatter.cutting_coefficients.mean_forces import channels_of
from chatter.plots import style

if TYPE_CHECKING:
    from chatter.cutting_coefficients.result import Coefficients

#: points of a curve over the feed
_POINTS = 40
_FEED = "cut.feed_per_tooth"


def plot_coefficients(found: Coefficients) -> Figure:
    """Draw the mean forces of every channel over the feed per tooth, and the law that is kept."""
    names = channels_of(found.means)
    figure = style.new_figure(3.6 * max(len(names), 2), 3.9)
    figure.suptitle(_title(found), fontsize=11.0, x=0.01, ha="left")
    for axes, name in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        _draw_channel(axes, found, name)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower center", ncols=len(names), fontsize=8.0, frameon=False
    )
    return figure


def _draw_channel(axes: Axes, found: Coefficients, name: str) -> None:
    own = [one for one in found.means if one.channel == name]
    cases = {run.name: run.of(found.measurement.case) for run in found.measurement.runs}
    length, force = found.units.feed_per_tooth, found.units.force
    feeds = np.array([length.factor * cases[one.run].cut.feed_per_tooth for one in own])
    values = [force.factor * (one.value - found.offset_of(one)) for one in own]
    axes.errorbar(
        feeds, values, yerr=[2.0 * force.factor * one.deviation for one in own], fmt="o",
        color=style.BLUE, capsize=3.0, label="measured, +- 2 standard deviations",
    )  # fmt: skip
    if differ_by_feed_alone(list(cases.values())):
        line = np.linspace(0.5 * feeds.min(), 1.1 * feeds.max(), _POINTS)
        any_case = next(iter(cases.values()))
        for fit, colour, label in _shown(found):
            forces = [
                force.factor * fit.mean_forces_of(own[:1], any_case.patch({_FEED: feed}))[0]
                for feed in line / length.factor
            ]
            axes.plot(line, forces, color=colour, label=label)
    else:
        law = found.answer_law
        fitted = [force.factor * law.mean_forces_of([one], cases[one.run])[0] for one in own]
        axes.plot(feeds, fitted, "x", color=style.RED, label="fitted")
    axes.set_title(name, loc="left")
    axes.set_xlabel(f"feed per tooth [{length.name}]")
    axes.set_ylabel(f"mean force [{force.name}]")
    axes.set_xlim(left=0.0)


def _title(found: Coefficients) -> str:
    beside = ", whose offsets are taken off" if found.by_waveforms else ""
    return f"{found.measurement.title}: {found.law_name} law, by {found.origin}{beside}"


def _shown(found: Coefficients):
    """Laws that are drawn: that of the answer; of mean forces the linear one and others beside."""
    if found.by_waveforms:
        return [(found.answer_law, style.RED, found.law_name)]
    shown = [(found.kept, style.RED, found.kept.law.name)]
    linear = next((one for one in found.fits if one.law.name == "linear"), None)
    if linear is not None and linear is not found.kept:
        shown.append((linear, style.GREY, "linear"))
    own = found.by_direction
    if own is not None and own is not found.kept and own.exponents.size:
        shown.append((own, style.GREEN, "each direction by a form of its own"))
    return shown
