"""A picture to zoom and hover in: what a matplotlib figure shows, drawn again by Bokeh."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection, PathCollection, PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

_TOOLS = "pan,box_zoom,wheel_zoom,reset,save"
_PIXELS = 96.0  # of a page, per inch
#: room of axes and title around a panel, pixels
_BESIDE, _BELOW = 90, 90
#: the script looks for BokehJS every 10 ms and gives up after a second; a busy browser takes longer
_GIVES_UP = "attempts > 100"
#: entries of a legend side by side
_LEGEND_COLUMNS = 3
_DASHES = {"-": "solid", "--": "dashed", ":": "dotted", "-.": "dashdot"}
#: a line of more points than four for each of so many parts is thinned: pages stay below some MB
_PARTS = 1000
_SHOWN = (LineCollection, PathCollection, PolyCollection)


def interactive_picture(figure: Figure) -> str | None:
    """HTML and script of a figure, for a page that holds BokehJS; None where it cannot be drawn.

    Lines, areas, points and images are taken up; maps by contours or meshes are not.
    """
    from bokeh.document import Document
    from bokeh.embed import components
    from bokeh.io.doc import patch_curdoc
    from bokeh.layouts import column

    if any(_is_beyond(axes) for axes in figure.axes):
        return None
    figure.canvas.draw()  # places the panels
    panels = [_panel(axes, figure) for axes in figure.axes if axes.get_visible()]
    if not panels:
        return None
    own = Document()
    # the current one may be that of a page whose session has ended
    with patch_curdoc(own):
        script, place = components(column(panels))
    return place + script.replace(_GIVES_UP, "attempts > 3000")


def _is_beyond(axes: Axes) -> bool:
    others = [one for one in axes.collections if not isinstance(one, _SHOWN)]
    return axes.name != "rectilinear" or bool(others)


def _panel(axes: Axes, figure: Figure) -> Any:
    from bokeh.plotting import figure as bokeh_figure

    share, (width, height) = axes.get_position(), figure.get_size_inches()
    drawn = bokeh_figure(
        width=round(share.width * width * _PIXELS) + _BESIDE,
        height=round(share.height * height * _PIXELS) + _BELOW,
        x_axis_type=axes.get_xscale(), y_axis_type=axes.get_yscale(),
        x_range=axes.get_xlim(), y_range=axes.get_ylim(), tools=_TOOLS,
        title=axes.get_title() or axes.get_title(loc="left"),
        x_axis_label=axes.get_xlabel(), y_axis_label=axes.get_ylabel(),
    )  # fmt: skip
    drawn.xaxis.visible, drawn.yaxis.visible = (
        len(axes.get_xticks()) > 0,
        len(axes.get_yticks()) > 0,
    )
    for image in axes.images:
        _draw_image(drawn, image)
    for area in (*axes.collections, *axes.patches):
        if area.get_visible():
            _draw_area(drawn, axes, area)
    for line in axes.get_lines():
        if line.get_visible():
            _draw_line(drawn, axes, line)
    _hover(drawn, axes)
    for legend in list(drawn.legend):
        legend.update(click_policy="hide", label_text_font_size="8pt", orientation="horizontal")
        if len(legend.items) > _LEGEND_COLUMNS:
            legend.ncols = _LEGEND_COLUMNS
        drawn.center.remove(legend)  # it would cover curves
        drawn.add_layout(legend, "above")
    return drawn


def _draw_image(drawn: Any, image: Any) -> None:
    shades = image.to_rgba(image.get_array(), bytes=True)
    if image.origin == "upper":
        shades = shades[::-1]
    colours = np.ascontiguousarray(shades).view(np.uint32)[:, :, 0]
    left, right, bottom, top = image.get_extent()
    if image.origin == "upper":
        bottom, top = min(bottom, top), max(bottom, top)
    drawn.image_rgba([colours], x=left, y=bottom, dw=right - left, dh=top - bottom)


def _draw_line(drawn: Any, axes: Axes, line: Any) -> None:
    x, y = _in_data(axes, line.get_transform(), line.get_xydata()).T
    colour, named = to_hex(line.get_color()), _named(line)
    dash = _DASHES.get(line.get_linestyle())
    if dash is not None:
        thin = _thinned(x, y)
        drawn.line(*thin, color=colour, line_dash=dash, line_width=line.get_linewidth(), **named)
    if line.get_marker() not in ("", "None", None):
        drawn.scatter(x, y, color=colour, size=line.get_markersize(), **named)


def _thinned(x: Any, y: Any) -> tuple[Any, Any]:
    """Points of a line with the extremes of each of its parts; gaps are kept with all points."""
    if len(x) <= 4 * _PARTS or not np.isfinite(x + y).all():
        return x, y
    parts = np.array_split(np.arange(len(x)), _PARTS)
    kept = {0, len(x) - 1}
    for part in parts:
        for values in (x[part], y[part]):
            kept |= {int(part[values.argmin()]), int(part[values.argmax()])}
    rows = np.array(sorted(kept))
    return x[rows], y[rows]


def _draw_area(drawn: Any, axes: Axes, area: Any) -> None:
    named = _named(area)
    if isinstance(area, PathCollection):
        at = _in_data(axes, area.get_offset_transform(), np.ma.getdata(area.get_offsets()))
        size = float(np.sqrt(np.mean(area.get_sizes()))) if len(area.get_sizes()) else 5.0
        drawn.scatter(*at.T, size=size, color=_colour(area.get_facecolor()), **named)
        return
    xs, ys = [], []
    for corners in _outlines(axes, area):
        xs.append(corners[:, 0])
        ys.append(corners[:, 1])
    if isinstance(area, LineCollection):
        drawn.multi_line(xs, ys, color=_colour(area.get_edgecolor()), **named)
    else:
        shade = np.atleast_2d(area.get_facecolor())
        alpha = float(shade[0][3]) if len(shade) else 0.0
        drawn.patches(xs, ys, color=_colour(shade), fill_alpha=alpha, line_alpha=0.0, **named)


def _outlines(axes: Axes, area: Any) -> Iterator[Any]:
    paths = area.get_paths() if isinstance(area, Collection) else [area.get_path()]
    for path in paths:
        for corners in path.to_polygons(closed_only=False):
            yield _in_data(axes, area.get_transform(), corners)


def _in_data(axes: Axes, transform: Any, points: Any) -> Any:
    """Points (n, 2) in the data of the axes: some stand at shares of the panel."""
    points = np.asarray(points, dtype=float)
    if transform == axes.transData:
        return points
    return axes.transData.inverted().transform(transform.transform(points))


def _colour(rows: Any) -> str:
    rows = np.atleast_2d(rows)
    return to_hex(rows[0][:3]) if len(rows) and rows.size else "#000000"


def _named(artist: Any) -> dict[str, str]:
    label = str(artist.get_label() or "")
    return {} if not label or label.startswith("_") else {"legend_label": label}


def _hover(drawn: Any, axes: Axes) -> None:
    from bokeh.models import HoverTool

    names = (axes.get_xlabel() or "x", axes.get_ylabel() or "y")
    told = [(name, f"${coordinate}") for name, coordinate in zip(names, "xy", strict=True)]
    drawn.add_tools(HoverTool(tooltips=told, mode="mouse"))
