"""Pictures of an explanation: what is left of signals, errors and lobes before and after."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from chatter.description.units import rpm
from chatter.plots import style
from chatter.plots.residual_diagnostics import plot_findings

if TYPE_CHECKING:
    from chatter.explain.before_after import BeforeAfter
    from chatter.explain.explanation import Explanation
    from chatter.explain.kinds.kind import Signals
    from chatter.explain.lobes_before_after import LobesBeforeAfter
    from chatter.explain.residuals.normalised_residual import Left, Residual

_SHOWN_RUNS = 3
#: deepest over shallowest cut beyond which depths are drawn on a logarithmic scale
_WIDE = 15.0
_STEP_COLOURS = (style.GREY, style.ORANGE, style.BLUE)
_STEP_LINES = ("--", "-.", "-")


def plot_explanation(explanation: Explanation) -> Figure:
    """Draw measured signals and residuals of some runs.

    Parameters
    ----------
    explanation : Explanation
    """
    added = explanation.signatures.with_added
    residuals = {"left, refitted": explanation.signatures.refitted.residual}
    if added is not None:
        label = "left, with " + " and ".join(
            stage.best.effect.name for stage in explanation.found.accepted
        )
        residuals[label] = added.residual
    if explanation.measurement.kind == "stability":
        return _plot_verdicts(explanation)
    title = f"{explanation.measurement.title}: {explanation.verdict}"
    return plot_residuals(residuals, title)


def _plot_verdicts(explanation: Explanation) -> Figure:
    """Draw where tests are judged wrongly, before and after."""
    signatures = {"refitted": explanation.signatures.refitted}
    if explanation.signatures.with_added is not None:
        signatures["with what was added"] = explanation.signatures.with_added
    return plot_findings(
        [
            replace(signature.findings[0], view=f"{signature.findings[0].view}, {name}")
            for name, signature in signatures.items()
        ]
    )


def plot_residuals(residuals: dict[str, Residual], title: str) -> Figure:
    """Draw measured signals of some runs, and what cases leave of them.

    Parameters
    ----------
    residuals : dict of str to Residual
        Of the same measurement, by what the legend says.
    title : str
    """
    first = next(iter(residuals.values()))
    runs = _shown(first)
    channels = first.channels
    figure = style.new_figure(3.8 * len(runs) + 0.4, 1.2 + 1.9 * len(channels))
    figure.suptitle(title, fontsize=11.0, x=0.01, ha="left")
    panels = figure.subplots(len(channels), len(runs), squeeze=False)
    for row, channel in enumerate(channels):
        for column, name in enumerate(runs):
            _draw_left(panels[row, column], _parts(residuals, channel, name))
            if row == 0:
                panels[row, column].set_title(name, loc="left")
            style.finish(panels[row, column])
    told = [axes.get_legend_handles_labels() for axes in panels.ravel()]
    figure.legend(
        *max(told, key=lambda one: len(one[1])),
        loc="outside upper right",
        ncols=4,
        fontsize=8.0,
        frameon=False,
    )
    return figure


def _shown(residual: Residual) -> list[str]:
    """First run, the one in the middle, and the one that is farthest from its noise."""
    names = list(dict.fromkeys(part.run.name for part in residual.parts))
    worst = max(residual.parts, key=lambda part: part.over_noise).run.name
    wanted = list(dict.fromkeys([worst, names[0], names[len(names) // 2], *names]))
    return [name for name in names if name in wanted[:_SHOWN_RUNS]]


def _parts(residuals: dict[str, Residual], channel: str, run: str) -> dict[str, Left]:
    """Parts of a channel of a run; none where it was left out."""
    return {
        label: part
        for label, residual in residuals.items()
        for part in residual.parts
        if (part.channel, part.run.name) == (channel, run)
    }


def _draw_left(axes: Axes, parts: dict[str, Left]) -> None:
    if not parts:
        axes.text(0.5, 0.5, "left out", ha="center", transform=axes.transAxes)
        return
    first = next(iter(parts.values()))
    x, label = _abscissa(first.run.signals, first.measured.size)
    channel = first.channel
    unit, scale = _unit(channel)
    order = np.argsort(x)
    axes.plot(x[order], scale * first.measured[order], color="#B5B5B5", lw=0.7, label="measured")
    for (name, part), colour in zip(parts.items(), (style.RED, style.BLUE), strict=False):
        axes.plot(x[order], scale * part.values[order], color=colour, lw=0.8, label=name)
    axes.set_ylabel(f"{channel} [{unit}]" if unit else channel)
    axes.set_xlabel(label)


def _unit(channel: str) -> tuple[str, float]:
    if channel in ("real", "imag"):
        return "µm/N", 1e6
    if channel == "stable":
        return "", 1.0
    from chatter.explain.residuals.variables import told_unit

    return told_unit(channel)


def _abscissa(signals: Signals, count: int) -> tuple[NDArray[np.float64], str]:
    told = (
        ("time", "time [s]", 1.0),
        ("frequency", "frequency [Hz]", 1.0),
        ("spindle_speed", "spindle speed [rpm]", rpm(1.0)),
    )
    for name, label, scale in told:
        if name in signals and signals[name].size == count:
            return scale * signals[name], label
    return np.arange(count), "point"


def plot_errors(errors: BeforeAfter) -> Figure:
    """Draw errors over the signal by channel, on fitted and on unseen runs, with the noise.

    Parameters
    ----------
    errors : BeforeAfter
    """
    figure = style.new_figure(9.5, 3.4)
    panels = figure.subplots(1, 2, sharey=True)
    told = ("runs that were fitted", "runs that were not seen")
    for axes, steps, title in zip(panels, (errors.fitted, errors.unseen), told, strict=True):
        places = np.arange(len(errors.channels))
        width = 0.8 / len(steps)
        for number, (step, values) in enumerate(steps.items()):
            at = places + (number - 0.5 * (len(steps) - 1)) * width
            bars = axes.bar(
                at,
                [100.0 * values[channel] for channel in errors.channels],
                width,
                color=_STEP_COLOURS[number],
                label=step,
            )
            axes.bar_label(bars, fmt="%.2g", fontsize=7.0, padding=1.0)
        for place, channel in zip(places, errors.channels, strict=True):
            axes.hlines(
                100.0 * errors.noise[channel],
                place - 0.45,
                place + 0.45,
                color="black",
                lw=1.4,
                label="noise" if place == 0 else None,
            )
        axes.set_xticks(places, errors.channels)
        axes.set_title(title, loc="left")
        style.finish(axes)
    panels[0].set_ylabel("error over signal [%]")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=4, fontsize=8.0, frameon=False)
    panels[0].margins(y=0.15)
    return figure


def plot_lobes_before_after(found: LobesBeforeAfter) -> Figure:
    """Draw limits of the cases over each other, with the cuts that were measured.

    Parameters
    ----------
    found : LobesBeforeAfter
    """
    figure = style.new_figure(8.5, 4.4)
    axes = figure.subplots()
    top = 0.0
    for number, (step, diagram) in enumerate(found.diagrams.items()):
        limit = diagram.limits.critical_depth
        axes.plot(
            rpm(diagram.limits.spindle_speed),
            1e3 * np.where(np.isfinite(limit), limit, np.nan),
            color=_STEP_COLOURS[number],
            ls=_STEP_LINES[number],
            lw=1.6,
            label=f"limit, {step}",
        )
        top = max(top, 1e3 * float(diagram.max_depth[0]))
    _draw_cuts(axes, found)
    depths = 1e3 * found.depth
    if depths.max() > _WIDE * depths.min():
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.set_ylim(0.5 * depths.min(), top)
    else:
        axes.set_ylim(0.0, top)
    axes.set_xlabel("spindle speed [rpm]")
    axes.set_ylabel("axial depth [mm]")
    style.finish(axes)
    figure.legend(loc="outside upper left", ncols=3, fontsize=8.5, frameon=False)
    return figure


def _draw_cuts(axes: Axes, found: LobesBeforeAfter) -> None:
    speed, depth = rpm(found.speed), 1e3 * found.depth
    if found.stable is None:
        axes.plot(speed, depth, "D", color="black", mfc="white", ms=5, label="cuts")
        return
    for chosen, marker, colour, label in (
        (found.stable, "o", style.GREEN, "measured stable"),
        (~found.stable, "x", style.RED, "measured chatter"),
    ):
        axes.plot(speed[chosen], depth[chosen], marker, color=colour, mfc="none", ms=5, label=label)
