"""Picture of the FRFs of a machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.plots import style
from chatter.studies.frf_units import frf_unit
from dynamics.frf.container import Frf

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.frf import FrfResult

_COLOURS = (style.BLUE, style.RED, style.GREEN, style.ORANGE, style.GREY, "#CC79A7", "#56B4E9")
_LEAST_COHERENCE = 0.999


def plot_frf(result: FrfResult) -> Figure:
    """Draw magnitude and phase of all curves, and the coherence where a test falls short of 1.

    Parameters
    ----------
    result : FrfResult
        Curves of one quantity.
    """
    shown = [curve.tested for curve in result.curves if curve.tested is not None]
    incoherent = [
        frf
        for frf in shown
        if frf.coherence is not None and np.min(frf.coherence) < _LEAST_COHERENCE
    ]
    rows = 3 if incoherent else 2
    figure = style.new_figure(9.0, 6.4 if rows == 2 else 7.6)
    axes = figure.subplots(
        rows, 1, sharex=True, gridspec_kw={"height_ratios": [2.2, 1.0, 0.8][:rows]}
    )
    figure.suptitle(result.machine, fontsize=11.0, x=0.01, ha="left")
    units = {frf_unit(curve.unit)[0] for curve in result.curves}
    for index, curve in enumerate(result.curves):
        colour = _COLOURS[index % len(_COLOURS)]
        label = curve.name if not curve.state else f"{curve.name}: {curve.state}"
        unit, factor = frf_unit(curve.unit)
        if len(units) > 1:
            label += f" [{unit}]"
        _draw(axes[:2], curve.harmonic, factor, label, colour, linestyle="-", linewidth=1.4)
        if curve.tested is not None:
            _draw(axes[:2], curve.tested, factor, "", colour, linestyle=":", linewidth=1.8)
            if incoherent and curve.tested.coherence is not None:
                axes[2].plot(curve.tested.frequency, curve.tested.coherence, color=colour, lw=1.0)
    if shown:
        for name, line in (("linearised", "-"), ("test in time", ":")):
            axes[0].plot([], [], color="black", linestyle=line, label=name)
    axes[0].set_yscale("log")
    what = result.curves[0].harmonic.quantity
    axes[0].set_ylabel(f"{what} [{units.pop()}]" if len(units) == 1 else what)
    axes[1].set(ylabel="phase [deg]", yticks=[-180, -90, 0, 90, 180], ylim=(-190, 190))
    if incoherent:
        axes[2].set(ylabel="coherence", ylim=(0.0, 1.05))
    axes[-1].set(xlabel="frequency [Hz]", xlim=_band(result))
    # below the panels: there are curves everywhere in them, and the title is above
    figure.legend(
        *axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8.0,
        frameon=False,
    )  # fmt: skip
    for each in axes:
        style.finish(each)
    return figure


def _draw(
    pair: tuple[Axes, Axes], frf: Frf, factor: float, label: str, colour: str, **line: object
) -> None:
    size = factor * np.abs(frf.values)
    pair[0].plot(frf.frequency, size, color=colour, label=label or None, **line)
    phase = np.degrees(np.angle(frf.values))
    # a jump from -180 to 180 is no line
    broken = np.where(np.abs(np.diff(phase, prepend=phase[0])) > 180.0, np.nan, phase)
    pair[1].plot(frf.frequency, broken, color=colour, **line)


def _band(result: FrfResult) -> tuple[float, float]:
    lowest = min(curve.harmonic.frequency[0] for curve in result.curves)
    highest = max(curve.harmonic.frequency[-1] for curve in result.curves)
    return float(lowest), float(highest)
