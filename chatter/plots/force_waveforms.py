"""Picture of force waveforms over a revolution, measured and fitted."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from chatter.cutting_coefficients.prediction import waveform
from chatter.cutting_coefficients.waveforms import Waveforms
from chatter.plots import style

#: cuts that are drawn: the others are told in coefficients.json
_MOST_CUTS = 6


def plot_waveforms(found: Waveforms) -> Figure:
    """Draw every channel of every cut over one revolution."""
    fit = found.kept
    drawn = list(zip(fit.averages, fit.residual, strict=True))[:_MOST_CUTS]
    channels = fit.averages[0].channels
    figure = style.new_figure(3.8 * max(len(channels), 2), 1.9 * len(drawn) + 0.8)
    figure.suptitle(
        f"Forces over a revolution: {fit.model.law.name} law", fontsize=11.0, x=0.01, ha="left"
    )
    grid = figure.subplots(len(drawn), len(channels), squeeze=False, sharex=True)
    for row, (one, left) in zip(grid, drawn, strict=True):
        measured, fitted = waveform(one.amplitude), waveform(one.amplitude + left)
        angle = np.arange(measured.shape[1]) * 360.0 / measured.shape[1]
        for number, (axes, name) in enumerate(zip(row, one.channels, strict=True)):
            axes.plot(angle, measured[number], color=style.BLUE, label="measured")
            axes.plot(angle, fitted[number], "--", color=style.RED, label="fitted")
            axes.set_title(f"{name}, {1e3 * one.case.cut.feed_per_tooth:g} mm a tooth", loc="left")
            axes.set_xlim(0.0, 360.0)
            axes.set_xticks([0, 90, 180, 270, 360])
        row[0].set_ylabel("force [N]")
    for axes in grid[-1]:
        axes.set_xlabel("turn of the spindle [deg]")
    grid[0][0].legend(fontsize=8.0)
    return figure
