"""Pictures of an explanation: residuals of signals, errors and lobes before and after."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from chatter.description.arrays import Array
from chatter.description.units import rpm
from chatter.explain.residuals.variables import reported_unit
from chatter.io.headings import signal_unit
from chatter.plots import style
from chatter.plots.residual_diagnostics import plot_findings

if TYPE_CHECKING:
    from chatter.explain.comparison import Comparison
    from chatter.explain.empirical.learning import Learnt
    from chatter.explain.errors import BeforeAfter
    from chatter.explain.explanation import Explanation
    from chatter.explain.kinds.kind import Cuts, Signals
    from chatter.explain.lobes_before_after import LobesBeforeAfter
    from chatter.explain.measurement import Measurement
    from chatter.explain.residuals.channel_residual import ChannelResidual
    from chatter.explain.residuals.residual import Residual

_SHOWN_RUNS = 3
#: columns over which signals are drawn: label, drawn over SI
_ABSCISSAE = {
    "time": ("time [s]", 1.0),
    "frequency": ("frequency [Hz]", 1.0),
    "spindle_speed": ("spindle speed [rpm]", rpm(1.0)),
}
#: deepest over shallowest cut beyond which depths are drawn on a logarithmic scale
_WIDE = 15.0
_MODEL_COLOURS = (style.GREY, style.ORANGE, style.BLUE)
_MODEL_LINES = ("--", "-.", "-")


def plot_explanation(explanation: Explanation) -> Figure:
    """Draw measured signals and residuals of some runs."""
    added = " and ".join(explanation.found.effect_names)
    signatures = {"residual of the refitted case": explanation.refitted_signature}
    if explanation.repaired_signature is not None:
        signatures[f"residual with {added} added"] = explanation.repaired_signature
    if not explanation.predictions.kind.is_sampled:
        findings = [(signature.findings[0], name) for name, signature in signatures.items()]
        return plot_findings([replace(one, name=f"{one.name}: {name}") for one, name in findings])
    title = f"{explanation.measurement.title}: {explanation.verdict}"
    return plot_residuals({name: one.residual for name, one in signatures.items()}, title)


def plot_comparison(comparison: Comparison) -> Figure:
    """Draw measured signals and residuals of some runs.

    Parameters
    ----------
    comparison : Comparison
        With a signature.
    """
    residual = comparison.signature.residual
    if not residual.kind.is_sampled:
        return plot_findings(comparison.signature.findings[:1])
    measurement = comparison.measurement
    title = f"{measurement.title}: residual of {Path(measurement.case.name).name}"
    return plot_residuals({"residual": residual}, title)


def plot_signals(measurement: Measurement) -> Figure:
    """Draw the signals of the first run as recorded."""
    run = measurement.runs[0]
    channels = [name for name in run.signals if name not in _ABSCISSAE] or list(run.signals)
    figure = style.new_figure(7.0, 0.8 + 1.4 * len(channels))
    figure.suptitle(f"{measurement.title}: {run.name}", fontsize=11.0, x=0.01, ha="left")
    panels = figure.subplots(len(channels), 1, squeeze=False)
    for axes, channel in zip(panels.ravel(), channels, strict=True):
        x, label = abscissa(run.signals, run.signals[channel].size)
        unit = signal_unit(channel)
        axes.plot(x, run.signals[channel] * unit.factor, color=style.BLUE, lw=0.8)
        axes.set(ylabel=f"{channel} [{unit.name}]" if unit.name else channel, xlabel=label)
        style.finish(axes)
    return figure


def plot_residuals(residuals: dict[str, Residual], title: str) -> Figure:
    """Draw measured signals of some runs, and their residuals by what the legend says."""
    first = next(iter(residuals.values()))
    runs = _shown(first)
    channels = {name: _channels(first, name) for name in runs}
    rows = max(len(names) for names in channels.values())
    figure = style.new_figure(3.8 * len(runs) + 0.4, 1.2 + 1.9 * rows)
    figure.suptitle(title, fontsize=11.0, x=0.01, ha="left")
    panels = figure.subplots(rows, len(runs), squeeze=False)
    for column, name in enumerate(runs):
        panels[0, column].set_title(name, loc="left")
        for axes in panels[len(channels[name]) :, column]:
            axes.set_axis_off()
        for axes, channel in zip(panels[:, column], channels[name], strict=False):
            _draw_residuals(axes, _parts(residuals, channel, name))
            style.finish(axes)
    legends = [axes.get_legend_handles_labels() for axes in panels.ravel()]
    figure.legend(
        *max(legends, key=lambda one: len(one[1])),
        loc="outside lower center",
        ncols=4,
        fontsize=8.0,
        frameon=False,
    )
    return figure


def _shown(residual: Residual) -> list[str]:
    """First run, the one in the middle, and the one that is farthest from its noise.

    Of a set-up the one that is farthest from its noise of every kind.
    """
    names = list(dict.fromkeys(part.run.name for part in residual.parts))
    ranked = sorted(residual.parts, key=lambda part: -part.over_noise)
    if residual.measurement.parts:
        worst = {part.run.kind: part.run.name for part in reversed(ranked)}
        return [name for name in names if name in worst.values()]
    wanted = list(dict.fromkeys([ranked[0].run.name, names[0], names[len(names) // 2], *names]))
    return [name for name in names if name in wanted[:_SHOWN_RUNS]]


def _channels(residual: Residual, run: str) -> tuple[str, ...]:
    """Channels to draw of a run: all, also where one was excluded; of a set-up those it has."""
    if not residual.measurement.parts:
        return residual.channels
    return tuple(part.channel for part in residual.parts if part.run.name == run)


def _parts(residuals: dict[str, Residual], channel: str, run: str) -> dict[str, ChannelResidual]:
    """Parts of a channel of a run; none where it was excluded."""
    return {
        label: part
        for label, residual in residuals.items()
        for part in residual.parts
        if (part.channel, part.run.name) == (channel, run)
    }


def _draw_residuals(axes: Axes, parts: dict[str, ChannelResidual]) -> None:
    if not parts:
        axes.text(0.5, 0.5, "excluded", ha="center", transform=axes.transAxes)
        return
    first = next(iter(parts.values()))
    x, label = abscissa(first.run.signals, first.measured.size)
    channel = first.channel
    unit, scale = channel_unit(channel)
    order = np.argsort(x)
    axes.plot(x[order], scale * first.measured[order], color="#B5B5B5", lw=0.7, label="measured")
    for (name, part), colour in zip(parts.items(), (style.RED, style.BLUE), strict=False):
        axes.plot(x[order], scale * part.values[order], color=colour, lw=0.8, label=name)
    axes.set(ylabel=f"{channel} [{unit}]" if unit else channel, xlabel=label)


def channel_unit(channel: str) -> tuple[str, float]:
    """Unit that a channel is drawn in, and the number of it in one of SI."""
    if channel in ("real", "imag"):
        return "µm/N", 1e6
    if channel == "stable":
        return "", 1.0
    return reported_unit(channel)


def abscissa(signals: Signals, count: int) -> tuple[Array, str]:
    """Values that a signal of so many points is drawn over, and the label of their axis."""
    for name, (label, scale) in _ABSCISSAE.items():
        if name in signals and signals[name].size == count:
            return scale * signals[name], label
    return np.arange(count), "point"


def plot_errors(errors: BeforeAfter) -> Figure:
    """Draw errors over the signal by channel, on fitted and on holdout runs, with the noise."""
    figure = style.new_figure(9.5, 3.4)
    panels = figure.subplots(1, 2, sharey=True)
    titles = ("fitted runs", "holdout runs")
    for axes, models, title in zip(panels, (errors.fitted, errors.holdout), titles, strict=True):
        positions = np.arange(len(errors.channels))
        width = 0.8 / len(models)
        for number, (model, values) in enumerate(models.items()):
            at = positions + (number - 0.5 * (len(models) - 1)) * width
            bars = axes.bar(
                at,
                [100.0 * values[channel] for channel in errors.channels],
                width,
                color=_MODEL_COLOURS[number],
                label=model,
            )
            axes.bar_label(bars, fmt="%.2g", fontsize=7.0, padding=1.0)
        for x, channel in zip(positions, errors.channels, strict=True):
            axes.hlines(
                100.0 * errors.noise[channel],
                x - 0.45,
                x + 0.45,
                color="black",
                lw=1.4,
                label="noise" if x == 0 else None,
            )
        axes.set_xticks(positions, errors.channels)
        axes.set_title(title, loc="left")
        style.finish(axes)
    panels[0].set_ylabel("error over signal [%]")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=4, fontsize=8.0, frameon=False)
    panels[0].margins(y=0.15)
    return figure


#: drawn over SI, and unit, by dimension of the variable of a term
_OVER = {"angle": (180.0 / np.pi, "deg"), "length": (1e3, "mm"), "velocity": (1.0, "m/s")}


def plot_terms(learnt: Learnt) -> Figure:
    """Draw every term that was learnt over its variable."""
    figure = style.new_figure(4.6 * len(learnt.terms), 3.0)
    panels = np.atleast_1d(figure.subplots(1, len(learnt.terms)))
    for axes, term in zip(panels, learnt.terms, strict=True):
        table = learnt.case.empirical_over(term.over)
        scale, unit = _OVER[table.DIMENSION[table.over]]
        axes.plot(scale * np.array(table.at), table.factor or table.force, color=style.BLUE)
        axes.axhline(1.0 if table.factor else 0.0, color=style.GREY, lw=0.8)
        within = ", one period" if table.repeats else ""
        axes.set_xlabel(f"{table.over}{within} [{unit}]")
        axes.set_ylabel("factor of the cutting force" if table.factor else "force [N]")
        style.finish(axes)
    return figure


def plot_lobes_before_after(found: LobesBeforeAfter) -> Figure:
    """Draw limits of the cases over each other, with the cuts that were measured."""
    figure = style.new_figure(8.5, 4.4)
    axes = figure.subplots()
    top = 0.0
    for number, (model, diagram) in enumerate(found.diagrams.items()):
        limit = diagram.limits.critical_depth
        axes.plot(
            rpm(diagram.limits.spindle_speed),
            1e3 * np.where(np.isfinite(limit), limit, np.nan),
            color=_MODEL_COLOURS[number],
            ls=_MODEL_LINES[number],
            lw=1.6,
            label=f"limit, {model}",
        )
        top = max(top, 1e3 * float(diagram.max_depth[0]))
    _draw_cuts(axes, found.cuts)
    depths = 1e3 * found.cuts.depth
    if depths.max() > _WIDE * depths.min():
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.set_ylim(0.5 * depths.min(), top)
    else:
        axes.set_ylim(0.0, top)
    axes.set(xlabel="spindle speed [rpm]", ylabel="axial depth [mm]")
    style.finish(axes)
    figure.legend(loc="outside upper left", ncols=3, fontsize=8.5, frameon=False)
    return figure


def _draw_cuts(axes: Axes, cuts: Cuts) -> None:
    speed, depth = rpm(cuts.speed), 1e3 * cuts.depth
    if cuts.stable is None:
        axes.plot(speed, depth, "D", color="black", mfc="white", ms=5, label="cuts")
        return
    for chosen, marker, colour, label in (
        (cuts.stable, "o", style.GREEN, "measured stable"),
        (~cuts.stable, "x", style.RED, "measured chatter"),
    ):
        axes.plot(speed[chosen], depth[chosen], marker, color=colour, mfc="none", ms=5, label=label)
