"""Picture of force waveforms over a revolution, measured and fitted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.cutting_coefficients.prediction import PredictedCut, waveform
from chatter.cutting_coefficients.revolution_average import RevolutionAverage
from chatter.cutting_coefficients.waveforms import Waveforms
from chatter.description.arrays import Array
from chatter.plots import style

#: cuts that are drawn: the others are told in coefficients.json
_MOST_CUTS = 6


def plot_waveforms(found: Waveforms, predicted: Sequence[PredictedCut] = ()) -> Figure:
    """Draw every channel of every cut over one revolution, those that were not fitted last."""
    fit = found.kept
    drawn = [
        (one, one.amplitude, one.amplitude + left, "fitted")
        for one, left in zip(fit.averages, fit.residual, strict=True)
    ][:_MOST_CUTS]
    drawn += [
        (one.average, one.average.amplitude, one.aligned(), "predicted")
        for one in predicted[:_MOST_CUTS]
    ]
    channels = fit.averages[0].channels
    figure = style.new_figure(3.8 * max(len(channels), 2), 1.9 * len(drawn) + 0.8)
    figure.suptitle(
        f"Forces over a revolution: {fit.model.law.name} law", fontsize=11.0, x=0.01, ha="left"
    )
    grid = figure.subplots(len(drawn), len(channels), squeeze=False, sharex=True)
    for row, (average, measured, other, label) in zip(grid, drawn, strict=True):
        _draw_cut(row, average, waveform(measured), waveform(other), label)
    for axes in grid[-1]:
        axes.set_xlabel("turn of the spindle [deg]")
    grid[0][0].legend(fontsize=8.0)
    if predicted:
        grid[-1][0].legend(fontsize=8.0)
    return figure


def _draw_cut(
    row: Sequence[Axes], average: RevolutionAverage, measured: Array, other: Array, label: str
) -> None:
    angle = np.arange(measured.shape[1]) * 360.0 / measured.shape[1]
    for number, (axes, name) in enumerate(zip(row, average.channels, strict=True)):
        axes.plot(angle, measured[number], color=style.BLUE, label="measured")
        axes.plot(angle, other[number], "--", color=style.RED, label=label)
        feed = 1e3 * average.case.cut.feed_per_tooth
        axes.set_title(f"{name}, {feed:g} mm a tooth, {label}", loc="left", fontsize=9.5)
        axes.set_xlim(0.0, 360.0)
        axes.set_xticks([0, 90, 180, 270, 360])
    row[0].set_ylabel("force [N]")
