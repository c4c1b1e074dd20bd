"""Picture of a process optimisation: limits over speed and depth, removal over radial depth."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from chatter.description.units import rpm
from chatter.plots import style

if TYPE_CHECKING:
    from chatter.studies.optimisation.limits import Limits
    from chatter.studies.optimisation.optimum import Optimum

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
    """Draw the limits over speed and depth at the best radial depth, and the removal rate."""
    over_radial_depths = found.limits.radial_depths.size > 1
    figure = style.new_figure(9.0, 8.4 if over_radial_depths else 6.0)
    grid = figure.add_gridspec(
        2 if over_radial_depths else 1, 1, height_ratios=[2.4, 1.0][: 1 + over_radial_depths]
    )
    axes = figure.add_subplot(grid[0])
    draw_slice(axes, found)
    axes.set_title(_title(found), loc="left", pad=64.0)
    if over_radial_depths:
        draw_radial_depths(figure.add_subplot(grid[1]), found)
    return figure


def _title(found: Optimum) -> str:
    cut, length = found.grid_slice.case, found.units.length
    feed = length.text(cut.cut.feed_per_tooth)
    at = f"{length.text(cut.width_of_cut)} wide, {feed} a tooth"
    name = found.case.title or "Process optimisation"
    return f"{name}\n{at}" if found.best else f"{name}\nno cut keeps all limits; shown: {at}"


def draw_slice(axes: Axes, found: Optimum) -> None:
    """Draw stable depths, what the margins leave, boundaries of the limits, and the best cut."""
    grid_slice = found.grid_slice
    units = found.units
    speed, depth = rpm(grid_slice.speeds), grid_slice.depths * units.length.factor
    top = _top(found)
    _fill(axes, found, top)
    rate = grid_slice.removal_rate * units.removal_rate.factor
    lines = axes.contour(
        speed, depth, rate, levels=_levels(rate[depth <= top]), colors=[style.GREY],
        linewidths=0.6, alpha=0.8,
    )  # fmt: skip
    axes.clabel(lines, fmt="%g", fontsize=7.0)
    handles: list[Artist] = [_handle(style.GREY, "-", f"removal rate [{_rate_name(found)}]")]
    for key, usage in grid_slice.usage.items():
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
        (_KEPT_FILL, _kept(found.limits)),
    )
    handles += [Patch(facecolor=c, edgecolor=style.GREY, label=text) for c, text in fills]
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=7.5,
        frameon=False, borderaxespad=0.2,
    )  # fmt: skip
    axes.set_xlim(speed[0], speed[-1])
    axes.set(ylim=(0.0, top), xlabel="spindle speed [rpm]")
    axes.set_ylabel(f"axial depth [{units.length.name}]")
    style.finish(axes)


def _rate_name(found: Optimum) -> str:
    return found.units.removal_rate.name.replace("^3", "³")


def _kept(limits: Limits) -> str:
    """What the darker fill keeps: margins, or nothing yet of what a confidence takes off."""
    if limits.depth_margin or limits.speed_margin:
        return "stable, with margins, all limits kept"
    return f"all limits kept; a confidence of {limits.confidence:g} takes off more"


def _elsewhere(known: np.ma.MaskedArray, shown: np.ma.MaskedArray) -> str:
    """Say why a limit has no boundary in the picture."""
    if not shown.count():
        return "no stable cut here"
    if shown.min() >= 1.0:
        return "exceeded everywhere"
    return "never reached" if known.max() <= 1.0 else "reached only deeper"


def _top(found: Optimum) -> float:
    """Highest depth shown, in its unit: what is stable somewhere, not the whole search."""
    rows = found.grid_slice.kept.any(axis=1)
    highest = found.grid_slice.depths[rows].max() if rows.any() else found.grid_slice.depths[-1]
    return float(min(1.3 * highest, found.grid_slice.depths[-1])) * found.units.length.factor


def _fill(axes: Axes, found: Optimum, top: float) -> None:
    """Fill stable and unstable depths; over them where all limits are kept."""
    stable, factor = found.grid_slice.stable, found.units.length.factor
    depth = (np.arange(_FILL_ROWS) + 0.5) * top / _FILL_ROWS
    passed = np.array([np.searchsorted(c, depth / factor) % 2 for c in stable.crossings]).T
    axes.pcolormesh(
        rpm(stable.speeds), depth, passed,
        cmap=ListedColormap([style.STABLE_FILL, style.UNSTABLE_FILL]), vmin=0, vmax=1,
        shading="nearest", rasterized=True, zorder=0.4,
    )  # fmt: skip
    kept = found.grid_slice.feasible_between(found.limits, depth / factor) & (passed == 0)
    _fill_stretches(axes, rpm(stable.speeds), depth, kept)
    first = [depths[0] * factor if len(depths) else np.nan for depths in stable.crossings]
    axes.plot(rpm(stable.speeds), first, color=style.BLUE, linewidth=1.2, zorder=1.5)


def _fill_stretches(axes: Axes, speed: np.ndarray, depth: np.ndarray, kept: np.ndarray) -> None:
    """Fill what is kept (depths, speeds), from speed to speed where as many stretches go on."""
    edges = np.diff(np.pad(kept, ((1, 1), (0, 0))).astype(np.int8), axis=0)
    bounds = np.append(depth - 0.5 * (depth[1] - depth[0]), depth[-1])
    low, high = ([bounds[np.flatnonzero(column == side)] for column in edges.T] for side in (1, -1))
    counts = np.array([len(one) for one in low])
    borders = np.flatnonzero(np.diff(counts)) + 1
    for run in np.split(np.arange(speed.size), borders):
        for stretch in range(counts[run[0]]):
            axes.fill_between(
                speed[run],
                [low[column][stretch] for column in run],
                [high[column][stretch] for column in run],
                color=_KEPT_FILL,
                linewidth=0.0,
                zorder=0.5,
            )


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
    factor, rate = found.units.length.factor, found.units.removal_rate
    here = found.grid_slice.case.width_of_cut
    others = [
        one.point
        for one in found.candidates
        if one is not found.best and math.isclose(one.point.radial_depth, here, rel_tol=0.02)
    ]
    if others:
        handles += axes.plot(
            [rpm(point.spindle_speed) for point in others],
            [point.axial_depth * factor for point in others],
            "o", color="white", markeredgecolor=style.BLUE, markersize=7, zorder=5,
            label="runner-up",
        )  # fmt: skip
    if found.best is not None:
        point = found.best.point
        handles += axes.plot(
            rpm(point.spindle_speed), point.axial_depth * factor, "*", color=style.GREEN,
            markeredgecolor="black", markersize=16, zorder=6, linestyle="none", clip_on=False,
            label=f"optimum: {point.removal_rate * rate.factor:.4g} {_rate_name(found)}",
        )  # fmt: skip
    return handles


def draw_radial_depths(axes: Axes, found: Optimum) -> None:
    """Draw the highest removal rate over the radial depth."""
    (unit, factor), per_minute = found.units.length, found.units.removal_rate.factor
    radial_depths = [point.radial_depth * factor for point in found.over_radial_depths]
    rates = [point.removal_rate * per_minute for point in found.over_radial_depths]
    axes.plot(
        radial_depths,
        rates,
        ".-",
        color=style.BLUE,
        label="best of the coarse grid, before verification",
    )
    if found.best is not None:
        point = found.best.point
        axes.plot(
            point.radial_depth * factor, point.removal_rate * per_minute, "*", color=style.GREEN,
            markeredgecolor="black", markersize=16, linestyle="none", clip_on=False,
            label="optimum",
        )  # fmt: skip
    axes.set_xlim(*(end * factor for end in found.limits.radial_depths[[0, -1]]))
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.02)
    axes.set(xlabel=f"radial depth [{unit}]", ylabel=f"removal rate\n[{_rate_name(found)}]")
    style.finish(axes)
    if axes.has_data():
        axes.legend(fontsize=8.0, frameon=False, loc="best")
