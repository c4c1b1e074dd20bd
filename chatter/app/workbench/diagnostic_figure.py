"""Panel of a residual diagnostic as a figure of the page."""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle
from typing import Any

import numpy as np
from bokeh.models import ColorBar, ColumnDataSource, FactorRange, LinearColorMapper, Span
from bokeh.plotting import figure
from bokeh.transform import dodge

from chatter.app.workbench.picture_files import legend_above
from chatter.plots import style

#: colours of a model's residual, in every picture of them
MODEL_COLOURS = {"declared": style.RED, "refitted": style.RED, "repaired": style.BLUE}
_COLOURS = (style.BLUE, style.ORANGE, style.GREEN, style.RED, style.GREY, "#56B4E9")
_CLASS_COLOURS = (style.GREEN, style.GREY, style.BLUE, style.RED)
#: from violet over white to orange
_DIVERGING = ("#5e3c99", "#9e8ec6", "#cbc6e0", "#f0f0f0", "#fad3a2", "#f0a24f", "#e66101")
_WIDTH, _HEIGHT = 620, 340
_FEW = 40


def diagnostic_figure(panel: dict[str, Any], title: str) -> Any:
    """Figure of a panel as `residual_file` has written it."""
    drawn = _DRAWN[panel["kind"]](panel)
    drawn.title.text = title
    legend_above(drawn)
    return drawn


def _figure(panel: dict[str, Any], **given: Any) -> Any:
    logarithmic = panel.get("logarithmic", "")
    for name in ("x", "y"):
        if name in logarithmic:
            given[f"{name}_axis_type"] = "log"
    drawn = figure(width=_WIDTH, height=_HEIGHT, tools="pan,wheel_zoom,box_zoom,reset", **given)
    drawn.xaxis.axis_label, drawn.yaxis.axis_label = panel["x_label"], panel["y_label"]
    return drawn


def _values(given: list[Any]) -> Any:
    return np.array(given, dtype=np.float64)


def _floor(drawn: Any, panel: dict[str, Any]) -> None:
    if panel.get("floor") is not None:
        drawn.add_layout(Span(location=panel["floor"], dimension="width", line_dash="dashed"))


def _bars(panel: dict[str, Any]) -> Any:
    names = list(map(str, panel["categories"]))
    # of two alike, the second has its number
    categories = [name if names.index(name) == k else f"{name} ({k + 1})"
                  for k, name in enumerate(names)]  # fmt: skip
    labelled = {"x_label": "", "y_label": panel["label"]}
    drawn = _figure(labelled, x_range=FactorRange(*categories))
    width = 0.8 / max(1, len(panel["series"]))
    columns = {name: _values(one) for name, one in panel["series"].items()}
    source = ColumnDataSource({"category": categories, **columns})
    for number, name in enumerate(panel["series"]):
        at = (number - 0.5 * (len(panel["series"]) - 1)) * width
        drawn.vbar(
            dodge("category", at, range=drawn.x_range), top=name, width=0.9 * width, source=source,
            color=MODEL_COLOURS.get(name, _COLOURS[number % len(_COLOURS)]), legend_label=name,
        )  # fmt: skip
    drawn.xaxis.major_label_orientation = 0.6 if len(categories) > 5 else "horizontal"
    _floor(drawn, panel)
    return drawn


def _curve(drawn: Any, curve: dict[str, Any], colour: str, joined: bool) -> None:
    x, y = _values(curve["x"]), _values(curve["y"])
    label = {"legend_label": curve["label"]} if curve["label"] else {}
    if joined:
        drawn.line(x, y, color=colour, line_width=1.5, **label)
    if x.size <= _FEW or not joined:
        drawn.scatter(x, y, color=colour, size=5, **({} if joined else label))
    if curve.get("spread") is not None:
        spread = 2.0 * np.nan_to_num(_values(curve["spread"]))
        drawn.varea(x, y - spread, y + spread, color=colour, fill_alpha=0.2)


def _curves(panel: dict[str, Any]) -> Any:
    drawn = _figure(panel)
    for curve, colour in zip(panel["curves"], cycle(_COLOURS), strict=False):
        _curve(drawn, curve, colour, panel["joined"])
    for places in panel["marks"].values():
        for place in places:
            drawn.add_layout(Span(location=place, dimension="height", line_dash="dotted",
                                  line_color=style.GREY))  # fmt: skip
    _floor(drawn, panel)
    return drawn


def _map(panel: dict[str, Any]) -> Any:
    drawn = _figure(panel)
    x, y = _values(panel["x_edges"]), _values(panel["y_edges"])
    values = np.array([_values(row) for row in panel["values"]])
    row, column = np.nonzero(np.isfinite(values))
    most = float(np.quantile(np.abs(values[row, column]), 0.98)) if row.size else 1.0
    mapper = LinearColorMapper(_DIVERGING, low=-most, high=most)
    cells = ColumnDataSource({
        "left": x[column], "right": x[column + 1], "bottom": y[row], "top": y[row + 1],
        "value": values[row, column],
    })  # fmt: skip
    drawn.quad("left", "right", "bottom", "top", source=cells, line_color=None,
               fill_color={"field": "value", "transform": mapper})  # fmt: skip
    drawn.add_layout(ColorBar(color_mapper=mapper, title=panel["label"]), "right")
    return drawn


def _points(panel: dict[str, Any]) -> Any:
    drawn = _figure(panel)
    for (name, (x, y)), colour in zip(panel["classes"].items(), cycle(_CLASS_COLOURS),
                                      strict=False):  # fmt: skip
        drawn.scatter(_values(x), _values(y), size=7, color=colour, fill_alpha=0.4,
                      legend_label=f"{name} ({len(x)})")  # fmt: skip
    if panel.get("curve"):
        _curve(drawn, panel["curve"], "black", True)
    return drawn


_DRAWN: dict[str, Callable[[dict[str, Any]], Any]] = {
    "Bars": _bars,
    "Curves": _curves,
    "Map": _map,
    "Points": _points,
}
