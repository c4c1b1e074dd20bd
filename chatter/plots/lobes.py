"""Picture of a stability lobe diagram."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from chatter.description.units import rpm
from chatter.plots import style
from chatter.stability.pockets import DEPTH_MARGIN, SPEED_MARGIN

if TYPE_CHECKING:
    from chatter.stability.diagram import LobeDiagram

_FILL_ROWS = 1000


def plot_lobes(diagram: LobeDiagram) -> Figure:
    """Draw limit depth and chatter frequency over spindle speed.

    Parameters
    ----------
    diagram : LobeDiagram

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = style.new_figure(8.0, 7.0)
    limit, frequency = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
    draw_limit(limit, diagram)
    draw_chatter_frequency(frequency, diagram)
    frequency.text(
        0.0,
        -0.42,
        _pocket_list(diagram),
        transform=frequency.transAxes,
        fontsize=8.5,
        va="top",
        linespacing=1.5,
    )
    limit.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.02),
        ncols=3,
        fontsize=8.5,
        frameon=False,
        borderaxespad=0.0,
    )
    limit.set_title(diagram.case.title or "Stability limit", pad=52.0, loc="left")
    return figure


def draw_limit(axes: Axes, diagram: LobeDiagram) -> None:
    """Draw stable and unstable depths, pockets and operating point into axes."""
    speed = rpm(diagram.limits.spindle_speed)
    top = _top(diagram)
    _fill_unstable(axes, speed, diagram, top)
    label = _METHOD_LABEL[diagram.method]
    depth = _finite(diagram.limits.critical_depth)
    axes.plot(speed, depth * 1e3, color=style.BLUE, linewidth=1.6, label=label)
    if diagram.method != "zero-order":
        axes.plot(
            speed,
            _finite(diagram.zero_order.critical_depth) * 1e3,
            color=style.GREY,
            linewidth=1.0,
            linestyle=(0, (4, 2)),
            label=_METHOD_LABEL["zero-order"],
        )
    _mark_flips(axes, speed, diagram)
    _mark_pockets(axes, diagram)
    _mark_operating_point(axes, diagram)
    axes.set_xlim(speed[0], speed[-1])
    axes.set_ylim(0.0, top * 1e3)
    axes.set_ylabel("axial depth [mm]")
    style.finish(axes)


_METHOD_LABEL = {
    "collocation": "limit, collocation",
    "semi-discretization": "limit, semi-discretization",
    "semi-discretization-0": "limit, semi-discretization of order 0",
    "semi-discretization-2": "limit, semi-discretization of order 2",
    "full-discretization": "limit, full discretization",
    "matrix-free": "limit, matrix-free",
    "multi-frequency": "limit, multi-frequency",
    "zero-order": "limit, zeroth-order",
    "time-domain": "limit, time domain",
}


def _finite(depth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Leave a gap in the line where no limit was found."""
    return np.where(np.isfinite(depth), depth, np.nan)


def _top(diagram: LobeDiagram) -> float:
    """Highest depth shown, m: all of the search where the case gave it, else what matters."""
    return max(diagram.deepest, 1.05 * diagram.case.cut.axial_depth)


def _fill_unstable(
    axes: Axes, speed: NDArray[np.float64], diagram: LobeDiagram, top: float
) -> None:
    """Fill every unstable stretch of depth and outline it; closed islands show as such."""
    crossings = diagram.limits.crossings
    depth = (np.arange(_FILL_ROWS) + 0.5) * top / _FILL_ROWS
    passed = np.array([np.searchsorted(found, depth) for found in crossings]).T
    axes.imshow(
        passed % 2 == 1,
        extent=(speed[0], speed[-1], 0.0, top * 1e3),
        cmap=ListedColormap([style.STABLE_FILL, style.UNSTABLE_FILL]),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        vmin=0,
        vmax=1,
        zorder=0.5,
    )
    most = max((len(found) for found in crossings), default=0)
    for place in range(1, most):
        edge = np.array([d[place] if len(d) > place else np.nan for d in crossings])
        axes.plot(speed, edge * 1e3, color=style.BLUE, linewidth=0.8, zorder=1.5)


def _mark_flips(axes: Axes, speed: NDArray[np.float64], diagram: LobeDiagram) -> None:
    flip = np.array(diagram.limits.bifurcation) == "flip"
    if flip.any():
        depth = np.where(flip, diagram.limits.critical_depth, np.nan)
        axes.plot(speed, depth * 1e3, color=style.RED, linewidth=2.0, label="limit by flip")


def _mark_pockets(axes: Axes, diagram: LobeDiagram) -> None:
    for number, pocket in enumerate(diagram.pockets, start=1):
        x, y = rpm(pocket.spindle_speed), pocket.axial_depth * 1e3
        label = "pocket, with margin" if number == 1 else None
        axes.plot(x, y, "o", color=style.GREEN, markersize=11, linestyle="none", label=label)
        axes.annotate(
            str(number), (x, y), color="white", fontsize=8, ha="center", va="center", weight="bold"
        )


def _pocket_list(diagram: LobeDiagram) -> str:
    """Say below the picture what the numbers in it stand for."""
    lines = [
        f"{number}: {rpm(pocket.spindle_speed):.0f} rpm, {pocket.axial_depth * 1e3:.3g} mm, "
        f"{pocket.removal_rate * 6e7:.3g} cm³/min"
        for number, pocket in enumerate(diagram.pockets, start=1)
    ]
    rows = ["     ".join(lines[k : k + 2]) for k in range(0, len(lines), 2)]
    margin = f"pockets ({DEPTH_MARGIN:.0%} below the limit, speed off by {SPEED_MARGIN:.1%}):"
    return "\n".join([margin, *rows]) if rows else "no pocket between these speeds"


def _mark_operating_point(axes: Axes, diagram: LobeDiagram) -> None:
    cut = diagram.case.cut
    stable = diagram.operating_is_stable
    axes.plot(
        rpm(cut.spindle_speed),
        cut.axial_depth * 1e3,
        marker="o" if stable else "X",
        markersize=9,
        markeredgecolor="black",
        color=style.GREEN if stable else style.RED,
        linestyle="none",
        label=f"operating point, {'stable' if stable else 'chatter'}",
        zorder=5,
    )


def draw_chatter_frequency(axes: Axes, diagram: LobeDiagram) -> None:
    """Draw the chatter frequency at the limit, with the modes and tooth-passing harmonics."""
    speed = rpm(diagram.limits.spindle_speed)
    flip = np.array(diagram.limits.bifurcation) == "flip"
    heard = diagram.limits.chatter_frequency
    axes.plot(speed[~flip], heard[~flip], ".", markersize=3, color=style.BLUE, label="Hopf")
    if flip.any():
        axes.plot(speed[flip], heard[flip], ".", markersize=3, color=style.RED, label="flip")
    low, high = _frequency_range(heard)
    for number, natural in enumerate(diagram.natural_frequencies):
        shown = np.where((natural >= low) & (natural <= high), natural, np.nan)
        if np.isfinite(shown).any():
            axes.plot(
                speed,
                shown,
                color=style.GREY,
                linewidth=0.8,
                linestyle=":",
                label="natural frequency" if number == 0 else None,
            )
    axes.set_ylim(low, high)
    axes.set_xlabel("spindle speed [rpm]")
    axes.set_ylabel("chatter\nfrequency [Hz]")
    style.finish(axes)
    # above the panel: within it there are points everywhere
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=7.5, frameon=False, ncols=3,
        borderaxespad=0.1,
    )  # fmt: skip


def _frequency_range(heard: NDArray[np.float64]) -> tuple[float, float]:
    finite = heard[np.isfinite(heard)]
    if finite.size == 0:
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    room = max(0.15 * (high - low), 0.02 * high)
    return max(0.0, low - room), high + room
