"""Pictures of stability diagrams: critical depth over an axis, spectral radius over two."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from chatter.description.arrays import Array, IntegerArray
from chatter.description.formatting import to_digits
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.plots import style
from chatter.plots.depth_axis import ABOVE_CUT, end_of_depth_axis
from chatter.stability.limit_curve import with_limits_between
from chatter.stability.neglected_effects import highest_factor, lowest_factor
from chatter.stability.pockets import SPEED_MARGIN
from chatter.stability.registry import METHODS
from chatter.stability.search_range import known_to

if TYPE_CHECKING:
    from chatter.description.sections.cut import Cut
    from chatter.stability.diagram import StabilityDiagram, StabilityMap

_FILL_ROWS, _FILL_COLUMNS = 1000, 1000
#: values that a map of the spectral radius is drawn with, at the least
_MAP_ROWS, _MAP_COLUMNS = 300, 400
#: beside 0 stable, 1 chatter
_NOT_SEARCHED = 2
_FILLS = (style.STABLE_FILL, style.UNSTABLE_FILL, style.NOT_SEARCHED_FILL)
#: letters of a line below the picture
_LINE_LENGTH = 100
_NO_POCKET = "no pocket between these speeds"
#: height of that mark and of the foot of its arrow, in that of the picture
_EDGE, _FOOT = 0.9, 0.92
#: more values than this make a line without markers
_FEW_VALUES = 150
#: spectral radii beyond this look the same
_HIGHEST_RADIUS = 2.0
_RADIUS_COLOURS = LinearSegmentedColormap.from_list(
    "spectral radius",
    [(0.0, "#5AB08F"), (0.5, style.STABLE_FILL), (0.5, style.UNSTABLE_FILL), (1.0, "#D9905F")],
)


def plot_limits(diagram: StabilityDiagram) -> Figure:
    """Draw critical depth and chatter frequency over the axis of a diagram."""
    figure = style.new_figure(8.0, 7.0 if diagram.is_over_speed else 6.4)
    limit, frequency = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
    draw_limits(limit, diagram)
    _draw_frequency(frequency, diagram)
    if diagram.is_over_speed:
        frequency.text(
            0.0, -0.42, _pocket_list(diagram), transform=frequency.transAxes,
            fontsize=8.5, va="top", linespacing=1.5,
        )  # fmt: skip
    limit.set_title(diagram.case.title or "Critical depth", pad=52.0, **style.TITLE)
    return figure


def draw_limits(axes: Axes, diagram: StabilityDiagram) -> None:
    """Draw critical depths, what is stable below them, and the operating point."""
    drawn = _with_named_limits(diagram)
    x, top, limits = drawn.axis.values, _top(drawn), drawn.limits
    length = diagram.units.length
    unit, factor = length
    _fill(axes, drawn, top)
    # where stable intervals come or go the limit jumps: no line across
    jumps = np.flatnonzero(np.diff([len(found) for found in limits.crossings])) + 1
    across = np.insert(x, jumps, x[jumps])
    marker = "." if x.size <= _FEW_VALUES else ""

    def draw(depth: Array, colour: str, width: float, label: str | None) -> None:
        broken = np.insert(np.where(np.isfinite(depth), depth * factor, math.nan), jumps, math.nan)
        axes.plot(
            across, broken, "-", marker=marker, markersize=3.5, color=colour, linewidth=width,
            label=label,
        )  # fmt: skip

    for index in range(1, max((len(found) for found in limits.crossings), default=0)):
        further = [d[index] if len(d) > index else math.nan for d in limits.crossings]
        draw(np.array(further), style.BLUE, 0.8, None)
    draw(limits.critical_depth, style.BLUE, 1.6, f"limit, {METHODS[diagram.method].label}")
    _draw_across_jumps(axes, x, [factor * found for found in limits.crossings], jumps)
    if diagram.is_over_speed and diagram.method != "zero-order":
        zero_order = diagram.zero_order.critical_depth
        axes.plot(
            diagram.axis.values, np.where(np.isfinite(zero_order), zero_order, math.nan) * factor,
            color=style.GREY, linewidth=1.0, linestyle=(0, (4, 2)),
            label=f"limit, {METHODS['zero-order'].label}",
        )  # fmt: skip
    _hatch_what_is_not_certain(axes, drawn, top)
    none = np.isinf(limits.critical_depth)
    if none.any():
        searched = length.text(float(np.nanmax(diagram.max_depth)), ".3g")
        axes.plot(
            x, np.where(none, 0.985 * top * factor, math.nan), marker="^", markersize=4.0,
            linestyle="none", color=style.BLUE, label=f"no limit up to {searched}",
        )  # fmt: skip
    flip = np.array(limits.bifurcation) == "flip"
    if flip.any():
        draw(np.where(flip, limits.critical_depth, math.nan), style.RED, 2.0, "limit by flip")
    if diagram.is_over_speed:
        _mark_pockets(axes, diagram)
        word, look = "chatter", {"marker": "X", "color": style.RED}
        if diagram.operating_is_stable:
            word, look = "stable", {"marker": "o", "color": style.GREEN}
        if diagram.deciding:
            word, look = "not certain", {"marker": "o", "color": style.ORANGE}
        cut = diagram.case.cut
        if cut.axial_depth > top:
            _point_above(axes, cut, top * factor, look["color"], length)
            cut = cut.model_copy(update={"axial_depth": _EDGE * top})
        style.mark_cut(axes, cut, f"operating point, {word}", length, **look)
    else:
        _mark_case(axes, diagram.axis.case_value, diagram.case.cut.axial_depth * factor, x)
    _name_sides(axes)
    axes.set(xlim=(x[0], x[-1]), ylim=(0.0, top * factor), ylabel=f"axial depth [{unit}]")
    style.finish(axes)


def _with_named_limits(diagram: StabilityDiagram) -> StabilityDiagram:
    """Diagram that has the limits that the words name between its own speeds as well.

    Those at the operating speed, by which the operating point is judged, and the lowest ones.
    """
    limits = diagram.limits
    for other in (diagram.operating, diagram.at_lowest):
        if other is not None:
            limits = with_limits_between(limits, other)
    if limits is diagram.limits:
        return diagram
    return replace(
        diagram,
        axis=replace(diagram.axis, values=rpm(limits.spindle_speed)),
        limits=limits,
        max_depth=np.interp(limits.spindle_speed, diagram.limits.spindle_speed, diagram.max_depth),
    )


def _draw_across_jumps(axes: Axes, x: Array, crossings: Sequence[Array], jumps: Array) -> None:
    """Draw limits that go on where stable intervals come or go beside them, and lone values.

    The limits are in the unit of the picture.
    """
    for right in jumps:
        before, after = crossings[right - 1], crossings[right]
        for low, high in zip(*_kept(before, after), strict=True):
            axes.plot(x[right - 1 : right + 1], [low, high], color=style.BLUE, lw=0.8)
        if right + 1 in jumps:
            # a value of its own, between jumps: no line shows its limits
            axes.plot(
                np.full(len(after), x[right]), np.asarray(after), ".", markersize=3.5,
                color=style.BLUE,
            )  # fmt: skip


def _kept(before: Array, after: Array) -> tuple[Array, Array]:
    """Limits of two neighbouring values that go on from one to the other.

    Stable intervals come and go in pairs of limits that follow each other: the pair without which
    the others are nearest. None where the numbers differ by anything but a pair, or one is zero.
    """
    few, many = sorted((np.asarray(before), np.asarray(after)), key=len)
    if len(few) == 0 or len(many) - len(few) != 2:
        return np.empty(0), np.empty(0)
    without = [np.delete(many, [first, first + 1]) for first in range(len(many) - 1)]
    nearest = min(without, key=lambda kept: float(np.abs(kept - few).sum()))
    return (few, nearest) if len(before) < len(after) else (nearest, few)


def _top(diagram: StabilityDiagram) -> float:
    """Highest depth shown, m; over other parameters than the speed the cut is always in it."""
    cut = diagram.case.cut.axial_depth
    shown = end_of_depth_axis(diagram.limits.crossings, float(np.nanmax(diagram.max_depth)), cut)
    return shown if diagram.is_over_speed else max(shown, ABOVE_CUT * cut)


def _point_above(axes: Axes, cut: Cut, top: float, colour: str, length: UsualUnit) -> None:
    """Draw an arrow from the mark of a cut at the upper edge to its depth above the picture."""
    x, depth = rpm(cut.spindle_speed), to_digits(cut.axial_depth * length.factor, 3)
    axes.annotate(
        "", (x, top), (x, _FOOT * top), zorder=5,
        arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.6},
    )  # fmt: skip
    axes.annotate(
        f"at {depth} {length.name}", (x, _EDGE * top), (9.0, 0.0),
        textcoords="offset points", va="center", fontsize=8.5, zorder=5,
        bbox={"facecolor": "white", "alpha": 0.8, "linewidth": 0.0, "pad": 1.0},
    )  # fmt: skip


def _fill(axes: Axes, diagram: StabilityDiagram, top: float) -> None:
    """Fill every stable and unstable interval of depth; closed islands show as such.

    Between values the limits are straight lines, as the curves are drawn.
    """
    depth = (np.arange(_FILL_ROWS) + 0.5) * top / _FILL_ROWS
    x, left, share = _columns(diagram.axis.values)
    crossings = [_between(diagram.limits.crossings, *one) for one in zip(left, share, strict=True)]
    chatter = np.array([np.searchsorted(found, depth) % 2 for found in crossings]).T
    # nothing is known beyond the search, and where there was none
    beyond = ~(depth[:, None] <= _searched(diagram, left, share)[None, :])
    if diagram.is_over_speed:
        beyond[:] = False
    shown = top * diagram.units.length.factor
    _paint(axes, x, np.where(beyond, _NOT_SEARCHED, chatter), shown)
    if beyond.any():
        axes.fill_between(
            [], [], facecolor=style.NOT_SEARCHED_FILL, edgecolor=style.GREY, label="not searched"
        )


def _paint(axes: Axes, x: Array, kinds: IntegerArray, top: float) -> None:
    """Paint kinds of points (rows, columns) from zero to the top, each column about its x.

    An image is drawn many times faster than a mesh of the same cells.
    """
    if x[0] == x[-1]:
        return
    colours = to_rgba_array(_FILLS)
    pixels = np.linspace(x[0], x[-1], x.size)
    half = 0.5 * (pixels[1] - pixels[0])
    sign = math.copysign(1.0, x[-1] - x[0])
    nearest = np.searchsorted(sign * 0.5 * (x[1:] + x[:-1]), sign * pixels)
    axes.imshow(
        (255.0 * colours).round().astype(np.uint8)[kinds[:, nearest]],
        extent=(x[0] - half, x[-1] + half, 0.0, top), origin="lower", aspect="auto",
        interpolation="nearest", zorder=0.5,
    )  # fmt: skip


def _columns(x: Array) -> tuple[Array, IntegerArray, Array]:
    """Columns of the fill: x, the value to the left of each, and the share of the way to the next.

    Every value is a column, as many are between any two.
    """
    between = max(1, math.ceil(_FILL_COLUMNS / x.size))
    place = np.linspace(0.0, x.size - 1.0, between * (x.size - 1) + 1)
    left = np.minimum(place.astype(np.int64), max(x.size - 2, 0))
    share = place - left
    right = np.minimum(left + 1, x.size - 1)
    return x[left] + share * (x[right] - x[left]), left, share


def _between(crossings: Sequence[Array], left: int, share: float) -> Array:
    """Limits between two values; where intervals come or go, they are those of the nearer one."""
    before, after = crossings[left], crossings[min(left + 1, len(crossings) - 1)]
    if len(before) == len(after):
        return before + share * (after - before)
    nearer = np.asarray(before if share < 0.5 else after)
    low, high = _kept(before, after)
    kept = low if share < 0.5 else high
    coming = np.setdiff1d(nearer, kept)
    return np.sort(np.concatenate([low + share * (high - low), coming])) if low.size else nearer


def _searched(diagram: StabilityDiagram, left: IntegerArray, share: Array) -> Array:
    """Depth to which was searched in each column, m; zero where there is no cut."""
    known = np.isfinite(diagram.max_depth)
    depth = np.where(known, np.maximum(diagram.max_depth, 0.0), 0.0)
    right = np.minimum(left + 1, depth.size - 1)
    found = depth[left] + share * (depth[right] - depth[left])
    nearer = np.where(share < 0.5, left, right)
    return np.where(known[left] & known[right], found, depth[nearer])


def _hatch_what_is_not_certain(axes: Axes, diagram: StabilityDiagram, top: float) -> None:
    """Hatch, about each limit, how far edge forces that are left out may lower or raise it.

    As `deciding` judges a point: of a limit that was not found it is known above what it lies.
    """
    effects = diagram.neglected_at_all_speeds
    low, high = lowest_factor(effects), highest_factor(effects)
    if low == high == 1.0:
        return
    # between values as the fill: where intervals come or go limits jump
    x, left, share = _columns(diagram.axis.values)
    refused = np.isnan(diagram.limits.critical_depth)
    nearer = np.where(share < 0.5, left, np.minimum(left + 1, refused.size - 1))
    if low == 0.0:
        bands = [(np.zeros(x.size), np.full(x.size, top))]
    else:
        between = [
            _between(diagram.limits.crossings, *one) for one in zip(left, share, strict=True)
        ]
        searched = _searched(diagram, left, share)
        known = np.array([known_to(one, diagram.zero_order) for one in searched.tolist()])
        bands = _not_certain(between, known, low, high)
    factor = diagram.units.length.factor
    for number, (first, last) in enumerate(bands):
        axes.fill_between(
            x, factor * first, factor * np.minimum(last, top),
            where=~refused[nearer] & (first < top), facecolor="none",
            edgecolor=style.ORANGE, hatch="///", linewidth=0.0, alpha=0.55, zorder=0.8,
            label="not certain: edge forces" if number == 0 else None,
        )  # fmt: skip


def _not_certain(
    crossings: Sequence[Array], known: Array, low: float, high: float
) -> list[tuple[Array, Array]]:
    """Bands (lower and upper ends, m, nan where there is none) about limits that may be elsewhere.

    A limit at which stability is lost lies between the factors `low` and `high` of itself; the
    limits next to it bound the band. One that was not found lies above a known depth, m.
    """
    crossings = [
        found if len(found) % 2 else np.append(found, end)
        for found, end in zip(crossings, known, strict=True)
    ]
    bands = []
    for index in range(0, max((len(found) for found in crossings), default=0), 2):
        ends = np.full((len(crossings), 2), math.nan)
        for column, found in enumerate(crossings):
            if index < len(found):
                before = found[index - 1] if index else 0.0
                after = found[index + 1] if index + 1 < len(found) else math.inf
                ends[column] = max(before, low * found[index]), min(after, high * found[index])
        bands.append((ends[:, 0], ends[:, 1]))
    return bands


def _mark_case(axes: Axes, x: float, y: float, inside: Array) -> None:
    if math.isfinite(x) and math.isfinite(y) and inside[0] <= x <= inside[-1]:
        axes.plot(
            x, y, marker="D", markersize=7, markeredgecolor="black", color="white",
            linestyle="none", label="the case", zorder=5,
        )  # fmt: skip


def _mark_pockets(axes: Axes, diagram: StabilityDiagram) -> None:
    for number, pocket in enumerate(diagram.pockets, start=1):
        x, y = rpm(pocket.spindle_speed), pocket.axial_depth * diagram.units.length.factor
        label = "pocket, with margin" if number == 1 else None
        axes.plot(x, y, "o", color=style.GREEN, markersize=11, linestyle="none", label=label)
        axes.annotate(
            str(number), (x, y), color="white", fontsize=8, ha="center", va="center", weight="bold"
        )


def _pocket_list(diagram: StabilityDiagram) -> str:
    """List below the picture what the numbers in it stand for."""
    length, rate = diagram.units.length, diagram.units.removal_rate
    lines = [
        f"{number}: {rpm(pocket.spindle_speed):.0f} rpm, "
        f"{length.text(pocket.axial_depth, '.3g')}, "
        f"{to_digits(pocket.removal_rate * rate.factor, 3)} {rate.name.replace('^3', '³')}"
        for number, pocket in enumerate(diagram.pockets, start=1)
    ]
    rows = ["     ".join(lines[k : k + 2]) for k in range(0, len(lines), 2)]
    margin = (
        f"pockets ({diagram.depth_margin:.0%} below the limit, speed off by {SPEED_MARGIN:.1%}):"
    )
    if rows:
        return "\n".join([margin, *rows])
    if not diagram.why_no_pocket:
        return _NO_POCKET
    # one long line would make the picture wider and squeeze its panels
    return textwrap.fill("no pocket: " + diagram.why_no_pocket, _LINE_LENGTH)


def _draw_frequency(axes: Axes, diagram: StabilityDiagram) -> None:
    """Draw the chatter frequency at the limit, with the natural frequencies.

    Over spindle speed the speed of the cut is marked.
    """
    drawn = _with_named_limits(diagram)
    kinds, frequency = np.array(drawn.limits.bifurcation), drawn.limits.chatter_frequency
    for kind, name, colour in (("hopf", "Hopf", style.BLUE), ("flip", "flip", style.RED)):
        of_kind = kinds == kind
        if of_kind.any():
            x = drawn.axis.values[of_kind]
            axes.plot(x, frequency[of_kind], ".", markersize=3.5, color=colour, label=name)
    ends, speed = drawn.axis.values[[0, -1]], diagram.axis.case_value
    if diagram.is_over_speed and ends[0] <= speed <= ends[1]:
        axes.axvline(speed, color=style.GREY, linewidth=0.8, label="operating speed")
    low, high = _frequency_range(frequency)
    label: str | None = "natural frequency"
    for values in diagram.natural_frequencies:
        shown = np.where((values >= low) & (values <= high), values, math.nan)
        if np.isfinite(shown).any():
            axes.plot(
                diagram.axis.values, shown, color=style.GREY, linewidth=0.8, linestyle=":",
                label=label,
            )  # fmt: skip
            label = None
    axes.set_ylim(low, high)
    axes.set_xlabel(diagram.axis.heading.replace("spindle_speed", "spindle speed"))
    axes.set_ylabel("chatter\nfrequency [Hz]")
    style.finish(axes)
    if axes.get_legend_handles_labels()[0]:
        # above the panel: within it there are points everywhere
        axes.legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=7.5, frameon=False, ncols=4,
            borderaxespad=0.1,
        )  # fmt: skip


def _frequency_range(frequency: Array) -> tuple[float, float]:
    finite = frequency[np.isfinite(frequency)]
    if finite.size == 0:
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    room = max(0.15 * (high - low), 0.02 * high)
    return max(0.0, low - room), high + room


def _name_sides(axes: Axes) -> None:
    """Legend above the axes, with the fills of both sides."""
    lines, labels = axes.get_legend_handles_labels()
    fills = [
        Patch(facecolor=style.STABLE_FILL, edgecolor=style.GREY, label="stable"),
        Patch(facecolor=style.UNSTABLE_FILL, edgecolor=style.GREY, label="chatter"),
    ]
    axes.legend(
        [*lines, *fills],
        [*labels, "stable", "chatter"],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.02),
        ncols=4,
        fontsize=8.5,
        frameon=False,
        borderaxespad=0.0,
    )


def _finer_map(x: Array, y: Array, radius: Array) -> tuple[Array, Array, Array]:
    """Axes and spectral radius (y, x) with values between those computed, as the boundary has them.

    Colours of few values are blocks beside a smooth boundary. Where a value is missing, all stay
    as they are: nothing is known between it and its neighbours.
    """
    if np.ma.count_masked(radius) or min(x.size, y.size) < 2:
        return x, y, radius
    across = np.linspace(x[0], x[-1], max(x.size, _MAP_COLUMNS))
    up = np.linspace(y[0], y[-1], max(y.size, _MAP_ROWS))
    growth_rate = np.log(np.maximum(np.ma.getdata(radius), 1e-300))
    rows = np.array([np.interp(across, x, row) for row in growth_rate])
    columns = np.array([np.interp(up, y, column) for column in rows.T])
    return across, up, np.exp(columns.T)


def plot_map(diagram: StabilityMap) -> Figure:
    """Draw the spectral radius over two axes, with the boundary of stability."""
    figure = style.new_figure(8.0, 5.6)
    axes = figure.subplots()
    x, y = diagram.x_axis.values, diagram.y_axis.values
    radius = np.ma.masked_invalid(diagram.spectral_radius)
    lowest = min(float(radius.min()), 0.99)
    highest = min(max(float(radius.max()), 1.01), _HIGHEST_RADIUS)
    mesh = axes.pcolormesh(
        *_finer_map(x, y, radius),
        cmap=_RADIUS_COLOURS,
        norm=TwoSlopeNorm(1.0, lowest, highest),
        shading="nearest",
        rasterized=True,
    )
    if radius.min() < 1.0 < radius.max():
        growth_rate = np.ma.log(np.ma.maximum(radius, 1e-300))
        axes.contour(x, y, growth_rate, levels=[0.0], colors=[style.BLUE], linewidths=1.6)
        axes.plot([], [], color=style.BLUE, linewidth=1.6, label="|µ| = 1")
    if y[0] <= diagram.y_axis.case_value <= y[-1]:
        _mark_case(axes, diagram.x_axis.case_value, diagram.y_axis.case_value, x)
    axes.set_xlim(x[0], x[-1])
    axes.set(ylim=(y[0], y[-1]), xlabel=diagram.x_axis.heading, ylabel=diagram.y_axis.heading)
    axes.set_title(diagram.case.title or "Spectral radius", pad=28.0, **style.TITLE)
    _name_sides(axes)
    style.finish(axes)
    extend = "max" if radius.max() > _HIGHEST_RADIUS else "neither"
    bar = figure.colorbar(mesh, ax=axes, extend=extend)
    bar.set_label("spectral radius |µ|, stable below 1")
    return figure
