"""Pictures of a modal identification: measured against fitted, stabilisation diagram."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.plots import style
from chatter.studies.frf_units import frf_unit
from dynamics.frf.container import QUANTITY_UNIT, Frf
from dynamics.identification.mode_indicators import mode_indicator_function
from dynamics.identification.result import FrfModel, ModalFit

#: FRFs side by side in one picture
_MOST_COLUMNS = 4
_CURVE_POINTS = 4000
#: room above the poles for the legend, over the range of the axis
_HEADROOM = 0.15
#: colour of the FRFs behind the poles
_BEHIND = "#BBBBBB"
#: quantity of an FRF -> unit in which it is read, factor from SI
FRF_UNITS = {quantity: frf_unit(unit) for quantity, unit in QUANTITY_UNIT.items()}


def plot_fit(fit: ModalFit, title: str) -> Figure:
    """Draw magnitude and phase of every FRF, measured and fitted."""
    columns = min(len(fit.frfs), _MOST_COLUMNS)
    figure = style.new_figure(max(7.5, 4.2 * columns), 6.0)
    axes = figure.subplots(2, columns, sharex=True, squeeze=False, height_ratios=[2.0, 1.0])
    for column in range(columns):
        frf, model = fit.frfs[column], fit.models[column]
        draw_magnitude(axes[0, column], fit, frf, model)
        draw_phase(axes[1, column], fit, frf, model)
        error = fit.errors[column]
        axes[0, column].set_title(
            f"{_name(frf)}\nerror {error.rms:.1%} rms, {error.maximum:.1%} at most, of the peak",
            fontsize=9,
        )
    shown = "" if columns == len(fit.frfs) else f" (first {columns} of {len(fit.frfs)} FRFs)"
    count = len(fit.identified)
    figure.suptitle(f"{title}: {count} mode{'s'[: count != 1]}{shown}", fontsize=12)
    return figure


def _name(frf: Frf) -> str:
    response, reference = (
        f"{point.node}{point.direction}" for point in (frf.response, frf.reference)
    )
    pair = f"{response}/{reference}" if response or reference else ""
    return " ".join(part for part in (frf.source.rsplit("/", 1)[-1], pair) if part) or "FRF"


def _fitted_lines(fit: ModalFit) -> np.ndarray:
    """Lines for the fitted curve: even, and dense within every resonance."""
    even = np.linspace(fit.band.lowest, fit.band.highest, _CURVE_POINTS)
    near = [
        mode.frequency * (1.0 + mode.damping * np.linspace(-4.0, 4.0, 161))
        for mode in fit.identified
    ]
    lines = np.unique(np.concatenate([even, *near]))
    return lines[(lines >= fit.band.lowest) & (lines <= fit.band.highest)]


def draw_magnitude(axes: Axes, fit: ModalFit, frf: Frf, model: FrfModel) -> None:
    """Draw the magnitude, logarithmic, with the modes marked."""
    unit, factor = FRF_UNITS[frf.quantity]
    lines = _fitted_lines(fit)
    axes.semilogy(
        frf.frequency,
        np.abs(frf.values) * factor,
        color=style.GREY,
        linewidth=1.8,
        alpha=0.7,
        label="measured",
    )
    axes.semilogy(
        lines, np.abs(model.values(lines)) * factor, color=style.RED, linewidth=1.0, label="fitted"
    )
    for mode in fit.identified:
        colour = style.ORANGE if mode.warning else style.BLUE
        axes.axvline(mode.frequency, color=colour, linewidth=0.7, linestyle=":")
    inside = np.abs(frf.band(fit.band.lowest, fit.band.highest).values) * factor
    floor = max(float(inside.min()), 1e-5 * float(inside.max()))
    axes.set(ylim=(0.5 * floor, 2.0 * float(inside.max())), ylabel=f"{frf.quantity} [{unit}]")
    style.finish(axes)
    axes.legend(fontsize=8, loc="best")


def draw_phase(axes: Axes, fit: ModalFit, frf: Frf, model: FrfModel) -> None:
    """Draw the phase in degrees."""
    lines = _fitted_lines(fit)
    axes.plot(
        frf.frequency,
        np.degrees(np.angle(frf.values)),
        color=style.GREY,
        marker=".",
        markersize=1.5,
        linestyle="none",
    )
    fitted = np.degrees(np.angle(model.values(lines)))
    # a jump from -180 to 180 degrees is no line
    fitted[np.append(False, np.abs(np.diff(fitted)) > 180.0)] = np.nan
    axes.plot(lines, fitted, color=style.RED, linewidth=1.0)
    axes.set_ylim(-190.0, 190.0)
    axes.set_yticks([-180, -90, 0, 90, 180])
    axes.set_xlim(frf.frequency[0], frf.frequency[-1])
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("phase [deg]")
    style.finish(axes)


def _draw_frfs_behind(axes: Axes, fit: ModalFit) -> Axes:
    """Draw the magnitude of the FRFs behind the poles, with an axis of its own on the right."""
    behind = axes.twinx()
    quantity = fit.frfs[0].quantity
    unit, factor = FRF_UNITS[quantity]
    largest = 0.0
    for number, frf in enumerate(fit.frfs):
        inside = frf.as_quantity(quantity).band(fit.band.lowest, fit.band.highest)
        magnitude = np.abs(inside.values) * factor
        largest = max(largest, float(magnitude.max()))
        behind.semilogy(
            inside.frequency, magnitude, color=_BEHIND, linewidth=0.8,
            label="measured FRF" if number == 0 else None,
        )  # fmt: skip
    # beyond four decades noise at antiresonances takes the room
    lowest = max(behind.get_ylim()[0], 1e-4 * largest)
    behind.set(ylim=(lowest, largest * (largest / lowest) ** _HEADROOM))
    behind.set_ylabel(f"{quantity} [{unit}]", color=style.GREY)
    behind.tick_params(axis="y", which="both", colors=style.GREY)
    behind.grid(visible=False)
    behind.set_zorder(0)
    axes.set_zorder(1)
    return behind


def plot_stabilisation(fit: ModalFit, title: str) -> Figure:
    """Draw the poles of all model orders over frequency, with the FRFs behind them."""
    figure = style.new_figure(8.0, 6.2)
    axes, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    behind = _draw_frfs_behind(axes, fit)
    axes.set_facecolor("none")
    for number, diagram in enumerate(fit.diagrams):
        for stable, marker, colour, label in (
            (False, "x", style.ORANGE, "pole"),
            (True, "o", style.BLUE, "stable pole"),
        ):
            chosen = diagram.stable == stable
            axes.plot(
                diagram.frequency[chosen],
                diagram.order[chosen],
                marker,
                color=colour,
                markersize=3 if stable else 2.5,
                markerfacecolor="none",
                linestyle="none",
                label=label if number == 0 else None,
            )
    for mode in fit.identified:
        axes.axvline(mode.frequency, color=style.GREEN, linewidth=0.8)
        below.axvline(mode.frequency, color=style.GREEN, linewidth=0.8)
    below.plot(*mode_indicator_function(fit.undelayed_frfs), color=style.BLUE, linewidth=1.0)
    below.set(xlim=(fit.band.lowest, fit.band.highest), xlabel="frequency [Hz]")
    below.set(ylim=(0.0, 1.05), ylabel="mode indicator\nfunction [1]")
    style.finish(below)
    axes.set(ylabel="model order", title=f"{title}: stabilisation diagram, modes chosen in green")
    style.finish(axes)
    highest = max((int(one.order.max()) for one in fit.diagrams if one.order.size), default=1)
    axes.set_ylim(0.0, highest * (1.0 + _HEADROOM))
    drawn = [axes.get_legend_handles_labels(), behind.get_legend_handles_labels()]
    handles, labels = ([*drawn[0][k], *drawn[1][k]] for k in range(2))
    axes.legend(handles, labels, fontsize=8, loc="upper right", ncols=3)
    return figure
