"""Picture of what a case leaves of a measurement, before and after an effect was added."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from chatter.plots import style

if TYPE_CHECKING:
    from chatter.explain.explanation import Explanation

_SHOWN_RUNS = 3


def plot_explanation(explanation: Explanation) -> Figure:
    """Draw measured signals and residuals of some runs.

    Parameters
    ----------
    explanation : Explanation
    """
    kind = explanation.found.kind
    runs = explanation.measurement.runs[:_SHOWN_RUNS]
    channels = kind.channels(runs[0])
    figure = style.new_figure(11.0, 1.0 + 2.1 * len(channels))
    figure.suptitle(
        f"{explanation.measurement.title}: {explanation.verdict}", fontsize=11.0, x=0.01, ha="left"
    )
    panels = figure.subplots(len(channels), len(runs), squeeze=False)
    before, after = explanation.refitted, explanation.case
    for column, run in enumerate(runs):
        left = {}
        for name, case in (("before", before), ("after", after)):
            left[name] = kind.predict(run.of(case), run)
        along, label = _abscissa(run.signals)
        for row, channel in enumerate(channels):
            if channel not in run.signals:
                continue
            panel, signal = panels[row, column], run.signals[channel]
            x = along if along is not None and along.size == signal.size else np.arange(signal.size)
            panel.plot(x, signal, color="#BBBBBB", lw=0.6, label="measured")
            panel.plot(
                x, signal - left["before"][channel], color=style.RED, lw=0.6, label="left, refitted"
            )
            if explanation.verdict == "explained":
                panel.plot(
                    x, signal - left["after"][channel], color=style.BLUE, lw=0.6, label="left, with"
                )
            panel.set_ylabel(channel)
            if row == 0:
                panel.set_title(run.name, loc="left")
            if row == len(channels) - 1:
                panel.set_xlabel(label)
            style.finish(panel)
    panels[0, 0].legend(fontsize=7.0, frameon=False)
    return figure


def _abscissa(signals: dict) -> tuple[np.ndarray | None, str]:
    for name, label in (("time", "time [s]"), ("frequency", "frequency [Hz]")):
        if name in signals:
            return signals[name], label
    return None, "point"
