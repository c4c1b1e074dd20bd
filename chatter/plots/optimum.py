"""Picture of a search for the best cut: what limits it over speed and depth, and over width."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from chatter.description.units import rpm
from chatter.plots import style

if TYPE_CHECKING:
    from chatter.studies.optimisation.optimum import Optimum

_PER_MINUTE = 6e7
_FILL_ROWS = 800
_KEPT_FILL = "#BFE3D2"
#: key of [optimum] -> name, colour and line of its boundary
_BOUNDARIES = {
    "max_power": ("power", style.RED, "-"),
    "max_torque": ("torque", style.ORANGE, "--"),
    "max_deflection": ("deflection", "#CC79A7", "-."),
    "max_surface_error": ("surface error", "black", ":"),
}


def plot_optimum(found: Optimum) -> Figure:
    """Draw the limits over speed and depth at the best width, and the removal rate over width.

    Parameters
    ----------
    found : Optimum

    Returns
    -------
    matplotlib.figure.Figure
    """
    over_widths = found.limits.widths.size > 1
    figure = style.new_figure(9.0, 8.4 if over_widths else 6.0)
    grid = figure.add_gridspec(
        2 if over_widths else 1, 1, height_ratios=[2.4, 1.0][: 1 + over_widths]
    )
    axes = figure.add_subplot(grid[0])
    draw_sheet(axes, found)
    axes.set_title(_title(found), loc="left", pad=52.0)
    if over_widths:
        draw_widths(figure.add_subplot(grid[1]), found)
    return figure


def _title(found: Optimum) -> str:
    cut = found.sheet.case
    at = f"{cut.width_of_cut * 1e3:.4g} mm wide, {cut.cut.feed_per_tooth * 1e3:.4g} mm a tooth"
    name = found.case.title or "Best cut"
    return f"{name}\n{at}" if found.best else f"{name}\nno cut keeps all limits; shown: {at}"


def draw_sheet(axes: Axes, found: Optimum) -> None:
    """Draw stable depths, what the margins leave, boundaries of the limits, and the best cut."""
    sheet = found.sheet
    speed, depth = rpm(sheet.speeds), sheet.depths * 1e3
    top = _top(found)
    _fill(axes, found, top)
    rate = sheet.removal_rate * _PER_MINUTE
    lines = axes.contour(
        speed, depth, rate, levels=_levels(rate[depth <= top]), colors=[style.GREY],
        linewidths=0.6, alpha=0.8,
    )  # fmt: skip
    axes.clabel(lines, fmt="%g", fontsize=7.0)
    handles = [_handle(style.GREY, "-", "removal rate [cm³/min]")]
    for key, usage in sheet.usage.items():
        name, colour, line = _BOUNDARIES[key]
        known = np.ma.masked_invalid(usage)
        shown = known[depth <= top]
        reached = bool(shown.count()) and shown.min() < 1.0 < shown.max()
        label = f"{name} limit" + ("" if reached else f": {_elsewhere(known, shown)}")
        handles.append(_handle(colour, line, label))
        if reached:
            axes.contour(
                speed, depth, known, levels=[1.0], colors=[colour], linestyles=[line],
                linewidths=1.6,
            )  # fmt: skip
    handles += _mark_candidates(axes, found)
    fills = (
        (style.UNSTABLE_FILL, "chatter"),
        (style.STABLE_FILL, "stable"),
        (_KEPT_FILL, "stable, with margins, all limits kept"),
    )
    handles += [Patch(facecolor=c, edgecolor=style.GREY, label=text) for c, text in fills]
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, fontsize=7.5,
        frameon=False, borderaxespad=0.2,
    )  # fmt: skip
    axes.set_xlim(speed[0], speed[-1])
    axes.set_ylim(0.0, top)
    axes.set_xlabel("spindle speed [rpm]")
    axes.set_ylabel("axial depth [mm]")
    style.finish(axes)


def _elsewhere(known: np.ma.MaskedArray, shown: np.ma.MaskedArray) -> str:
    """Say why a limit has no boundary in the picture."""
    if not shown.count():
        return "no stable cut here"
    if shown.min() >= 1.0:
        return "exceeded everywhere"
    return "never reached" if known.max() <= 1.0 else "reached only deeper"


def _top(found: Optimum) -> float:
    """Highest depth shown, mm: what is stable somewhere, not the whole search."""
    rows = found.sheet.kept.any(axis=1)
    highest = found.sheet.depths[rows].max() if rows.any() else found.sheet.depths[-1]
    return float(min(1.3 * highest, found.sheet.depths[-1])) * 1e3


def _fill(axes: Axes, found: Optimum, top: float) -> None:
    """Fill stable and unstable depths; over them where all limits are kept."""
    stable, sheet = found.sheet.stable, found.sheet
    depth = (np.arange(_FILL_ROWS) + 0.5) * top / _FILL_ROWS
    passed = np.array([np.searchsorted(c, depth * 1e-3) % 2 for c in stable.crossings]).T
    axes.pcolormesh(
        rpm(stable.speeds), depth, passed,
        cmap=ListedColormap([style.STABLE_FILL, style.UNSTABLE_FILL]), vmin=0, vmax=1,
        shading="nearest", rasterized=True, zorder=0.4,
    )  # fmt: skip
    # the net of the sheet is coarser than the limits: nothing beyond them counts as kept
    row = _nearest(sheet.depths * 1e3, depth)
    column = _nearest(sheet.speeds, stable.speeds)
    kept = sheet.feasible[np.ix_(row, column)] & (passed == 0)
    if kept.any():
        axes.pcolormesh(
            rpm(stable.speeds), depth, np.ma.masked_where(~kept, np.ones(kept.shape)),
            cmap=ListedColormap([_KEPT_FILL]), shading="nearest", rasterized=True, zorder=0.5,
        )  # fmt: skip
    first = [found[0] * 1e3 if len(found) else np.nan for found in stable.crossings]
    axes.plot(rpm(stable.speeds), first, color=style.BLUE, linewidth=1.2, zorder=1.5)


def _nearest(places: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Index of the nearest of some ascending places to each wanted one."""
    return np.abs(places[:, None] - wanted[None, :]).argmin(axis=0)


def _levels(rate: np.ndarray) -> np.ndarray:
    """Round numbers, about eight of them."""
    step = float(rate.max()) / 8.0
    power = 10.0 ** math.floor(math.log10(step))
    step = next(size * power for size in (1.0, 2.0, 5.0, 10.0) if size * power >= step)
    return step * np.arange(1, 12)


def _handle(colour: str, line: str, label: str) -> Line2D:
    return Line2D([], [], color=colour, linestyle=line, linewidth=1.6, label=label)


def _mark_candidates(axes: Axes, found: Optimum) -> list[Line2D]:
    handles = [_handle(style.BLUE, "-", "limit of stability")]
    here = found.sheet.case.width_of_cut
    others = [
        one.place
        for one in found.candidates
        if one is not found.best and math.isclose(one.place.radial_depth, here, rel_tol=0.02)
    ]
    if others:
        handles += axes.plot(
            [rpm(place.spindle_speed) for place in others],
            [place.axial_depth * 1e3 for place in others],
            "o", color="white", markeredgecolor=style.BLUE, markersize=7, zorder=5,
            label="runner-up",
        )  # fmt: skip
    if found.best is not None:
        place = found.best.place
        handles += axes.plot(
            rpm(place.spindle_speed), place.axial_depth * 1e3, "*", color=style.GREEN,
            markeredgecolor="black", markersize=16, zorder=6, linestyle="none", clip_on=False,
            label=f"best: {place.removal_rate * _PER_MINUTE:.4g} cm³/min",
        )  # fmt: skip
    return handles


def draw_widths(axes: Axes, found: Optimum) -> None:
    """Draw the highest removal rate over the radial depth."""
    widths = [place.radial_depth * 1e3 for place in found.over_widths]
    rates = [place.removal_rate * _PER_MINUTE for place in found.over_widths]
    axes.plot(
        widths,
        rates,
        ".-",
        color=style.BLUE,
        label="best of the coarse net, before the last checks",
    )
    if found.best is not None:
        place = found.best.place
        axes.plot(
            place.radial_depth * 1e3, place.removal_rate * _PER_MINUTE, "*", color=style.GREEN,
            markeredgecolor="black", markersize=16, linestyle="none", clip_on=False,
            label="best cut",
        )  # fmt: skip
    axes.set_xlim(found.limits.widths[0] * 1e3, found.limits.widths[-1] * 1e3)
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.02)
    axes.set_xlabel("radial depth [mm]")
    axes.set_ylabel("removal rate\n[cm³/min]")
    style.finish(axes)
    if axes.has_data():
        axes.legend(fontsize=8.0, frameon=False, loc="best")
