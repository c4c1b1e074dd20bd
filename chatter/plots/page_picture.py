"""A picture of the page drawn again: what a Bokeh figure shows, for a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from bokeh.core.property.vectorization import Value
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from chatter.plots import style

_INCH = 96.0  # pixels of a page


def drawn_again(figure: Any) -> Figure:
    """Matplotlib figure of the lines, areas, points and images that a Bokeh figure shows."""
    drawing = style.new_figure(figure.width / _INCH, figure.height / _INCH)
    axes = drawing.subplots()
    axes.set_xscale(_scale(figure.x_scale))
    axes.set_yscale(_scale(figure.y_scale))
    legend = figure.legend[0].items if figure.legend else []
    labels = {one.id: item.label.value for item in legend if item.visible for one in item.renderers}
    for renderer in figure.renderers:
        draw = _GLYPHS.get(type(renderer.glyph).__name__)
        if renderer.visible and draw is not None:
            draw(axes, renderer.glyph, renderer.data_source, labels.get(renderer.id))
    axes.set(xlabel=figure.xaxis[0].axis_label or "", ylabel=figure.yaxis[0].axis_label or "")
    for drawn, axis in ((axes.xaxis, figure.xaxis[0]), (axes.yaxis, figure.yaxis[0])):
        drawn.set_visible(axis.visible)
    axes.set_title(figure.title.text or "", fontsize=10)
    _limit(axes.set_xlim, figure.x_range)
    _limit(axes.set_ylim, figure.y_range)
    style.finish(axes)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)
    return drawing


def _scale(scale: Any) -> str:
    return "log" if type(scale).__name__ == "LogScale" else "linear"


def _limit(set_limits: Callable[..., Any], ends: Any) -> None:
    if getattr(ends, "factors", None):
        return  # categories, which matplotlib numbers by itself
    start, end = getattr(ends, "start", None), getattr(ends, "end", None)
    plain = all(isinstance(one, (int, float)) and one == one for one in (start, end))
    if plain and start != end:
        set_limits(start, end)


def _column(source: Any, given: Any) -> Any:
    """Values that a property of a glyph has: a column of the source, or a constant."""
    if isinstance(given, str):
        return np.asarray(source.data[given], dtype=float)
    field = getattr(given, "field", None)
    value = source.data[field] if field else getattr(given, "value", given)
    return np.asarray(value, dtype=float)


def _constant(given: Any) -> Any:
    """Value of a property that a copied glyph holds as a constant."""
    return given.value if isinstance(given, Value) else given


def _line(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    axes.plot(
        _column(source, glyph.x), _column(source, glyph.y), color=_constant(glyph.line_color),
        linewidth=_constant(glyph.line_width), linestyle={"dashed": "--", "dotted": ":"}.get(
            glyph.line_dash if isinstance(glyph.line_dash, str) else "", "-"), label=label,
    )  # fmt: skip


def _area(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    x = _column(source, glyph.x)
    low, high = (np.broadcast_to(_column(source, one), x.shape) for one in (glyph.y1, glyph.y2))
    axes.fill_between(
        x,
        low,
        high,
        color=_constant(glyph.fill_color),
        alpha=_constant(glyph.fill_alpha),
        linewidth=0.0,
        label=label,
    )


def _points(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    x = _column(source, glyph.x)
    given = _constant(glyph.fill_color)
    field = getattr(given, "field", None) or (given if given in source.data else None)
    colour = list(source.data[field]) if field else given
    if x.size:
        axes.scatter(x, _column(source, glyph.y), s=14.0, c=colour, label=label)


def _image(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    del label
    if not len(source.data["image"]):
        return
    x, y, dw, dh = (
        float(_column(source, one)[0]) for one in (glyph.x, glyph.y, glyph.dw, glyph.dh)
    )
    axes.imshow(
        source.data["image"][0], origin="lower", extent=(x, x + dw, y, y + dh), aspect="auto",
        cmap="viridis",
    )  # fmt: skip


def _lines(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    pairs = zip(source.data[_name(glyph.xs)], source.data[_name(glyph.ys)], strict=True)
    for number, (x, y) in enumerate(pairs):
        axes.plot(
            x, y, color=glyph.line_color, linewidth=glyph.line_width,
            label=label if number == 0 else None,
        )  # fmt: skip


def _bars(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    categories = list(source.data[_name(glyph.x)])
    shift = float(getattr(getattr(glyph.x, "transform", None), "value", 0.0) or 0.0)
    places = np.arange(len(categories))
    axes.bar(places + shift, _column(source, glyph.top), float(glyph.width),
             color=glyph.fill_color, label=label)  # fmt: skip
    axes.set_xticks(places, categories)


def _cells(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    """Cells of one colour, or of a map; those of one row are as high as each other."""
    del label
    left, right, low, high = (
        _column(source, one) for one in (glyph.left, glyph.right, glyph.bottom, glyph.top)
    )
    corners = np.stack([left, low, right, low, right, high, left, high], axis=-1).reshape(-1, 4, 2)
    if isinstance(glyph.fill_color, str):
        axes.add_collection(
            PolyCollection(
                corners, facecolors=glyph.fill_color, alpha=glyph.fill_alpha, linewidths=0.0
            )
        )
        return
    mapper = glyph.fill_color.transform
    drawn = PolyCollection(corners, cmap=ListedColormap(mapper.palette))
    drawn.set_array(np.asarray(source.data[glyph.fill_color.field], dtype=float))
    drawn.set_clim(mapper.low, mapper.high)
    axes.add_collection(drawn)
    axes.autoscale_view()
    axes.figure.colorbar(drawn, ax=axes)


def _faces(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    """Faces of a surface in the order of the source, coloured by a value."""
    del label
    if not len(source.data[_name(glyph.xs)]):
        return
    columns = (np.array(source.data[_name(one)], dtype=float) for one in (glyph.xs, glyph.ys))
    mapper = glyph.fill_color.transform
    drawn = PolyCollection(
        np.stack(list(columns), axis=-1), cmap=ListedColormap(mapper.palette),
        edgecolors=glyph.line_color, linewidths=glyph.line_width,
    )  # fmt: skip
    drawn.set_array(_column(source, glyph.fill_color))
    drawn.set_clim(mapper.low, mapper.high)
    axes.add_collection(drawn)
    axes.figure.colorbar(drawn, ax=axes)


def _texts(axes: Any, glyph: Any, source: Any, label: str | None) -> None:
    del label
    columns = (source.data[_name(one)] for one in (glyph.x, glyph.y, glyph.text))
    for x, y, text in zip(*columns, strict=True):
        axes.text(x, y, text, ha="center", va="center", fontsize=8)


def _name(given: Any) -> str:
    return given if isinstance(given, str) else given.field


_GLYPHS: dict[str, Callable[..., None]] = {
    "Line": _line,
    "VArea": _area,
    "Scatter": _points,
    "Image": _image,
    "MultiLine": _lines,
    "Quad": _cells,
    "Patches": _faces,
    "Text": _texts,
    "VBar": _bars,
}
