"""Picture of the FRFs of a machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from chatter.plots import style
from chatter.studies.frf_units import frf_unit
from dynamics.frf.container import Frf

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.frf import FrfResult

_COLOURS = (style.BLUE, style.RED, style.GREEN, style.ORANGE, style.GREY, "#CC79A7", "#56B4E9")
_LEAST_COHERENCE = 0.999


def plot_frf(result: FrfResult) -> Figure:
    """Draw magnitude and phase of all curves, and the coherence where a test falls short of 1.

    Curves of one unit share a panel of the magnitude.

    Parameters
    ----------
    result : FrfResult
        Curves of one quantity.
    """
    units = list(dict.fromkeys(frf_unit(curve.unit)[0] for curve in result.curves))
    incoherent = _is_incoherent(result)
    heights = [2.2 if len(units) == 1 else 1.5] * len(units) + [1.0, 0.8][: 1 + incoherent]
    figure = style.new_figure(9.0, 1.0 + 1.7 * sum(heights))
    axes = figure.subplots(
        len(heights), 1, sharex=True, gridspec_kw={"height_ratios": heights}, squeeze=False
    )[:, 0]
    figure.suptitle(result.machine, fontsize=11.0, x=0.01, ha="left")
    by_unit = dict(zip(units, axes, strict=False))
    phase = axes[len(units)]
    lines = []
    for index, curve in enumerate(result.curves):
        colour = _COLOURS[index % len(_COLOURS)]
        unit, factor = frf_unit(curve.unit)
        pair = by_unit[unit], phase
        label = curve.name if not curve.state else f"{curve.name}: {curve.state}"
        lines.append(_draw(pair, curve.harmonic, factor, label, colour, ls="-", lw=1.4))
        if curve.tested is not None:
            _draw(pair, curve.tested, factor, "", colour, ls=":", lw=1.8)
            if incoherent and curve.tested.coherence is not None:
                axes[-1].plot(curve.tested.frequency, curve.tested.coherence, color=colour, lw=1.0)
    _label(result, by_unit, phase)
    if incoherent:
        axes[-1].set(ylabel="coherence", ylim=(0.0, 1.05))
    axes[-1].set(xlabel="frequency [Hz]", xlim=_band(result))
    if any(curve.tested is not None for curve in result.curves):
        for name, dashes in (("linearised", "-"), ("test in time", ":")):
            lines += axes[0].plot([], [], color="black", ls=dashes, label=name)
    _put_legend_below(figure, lines)
    for each in axes:
        style.finish(each)
    return figure


def _put_legend_below(figure: Figure, lines: Sequence[Line2D]) -> None:
    """Legend below the panels, which have curves everywhere, in the columns that find room."""
    look: dict[str, Any] = {"loc": "outside lower center", "fontsize": 8.0, "frameon": False}
    for columns in (3, 2, 1):
        legend = figure.legend(handles=lines, ncols=columns, **look)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()


def _is_incoherent(result: FrfResult) -> bool:
    """Whether the coherence of a test falls short of 1."""
    tests = (curve.tested for curve in result.curves if curve.tested is not None)
    return any(
        frf.coherence is not None and np.min(frf.coherence) < _LEAST_COHERENCE for frf in tests
    )


def _label(result: FrfResult, by_unit: Mapping[str, Axes], phase: Axes) -> None:
    what = result.curves[0].harmonic.quantity
    for unit, panel in by_unit.items():
        panel.set_yscale("log")
        panel.set_ylabel(f"{what} [{unit}]")
    phase.set(ylabel="phase [deg]", yticks=[-180, -90, 0, 90, 180], ylim=(-190, 190))


def _draw(
    pair: tuple[Axes, Axes], frf: Frf, factor: float, label: str, colour: str, **line: Any
) -> Line2D:
    size = factor * np.abs(frf.values)
    (drawn,) = pair[0].plot(frf.frequency, size, color=colour, label=label or None, **line)
    phase = np.degrees(np.angle(frf.values))
    # a jump from -180 to 180 is no line
    broken = np.where(np.abs(np.diff(phase, prepend=phase[0])) > 180.0, np.nan, phase)
    pair[1].plot(frf.frequency, broken, color=colour, **line)
    return drawn


def _band(result: FrfResult) -> tuple[float, float]:
    lowest = min(curve.harmonic.frequency[0] for curve in result.curves)
    highest = max(curve.harmonic.frequency[-1] for curve in result.curves)
    return float(lowest), float(highest)
