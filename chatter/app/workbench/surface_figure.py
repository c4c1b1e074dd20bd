"""Surface of a wall in three dimensions, turned by sliders or by dragging it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import panel as pn
from bokeh.events import Pan, PanStart
from bokeh.models import ColorBar, ColumnDataSource, LinearColorMapper
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from chatter.app.workbench.picture_files import picture
from chatter.description.arrays import Array, IntegerArray
from chatter.simulation.finish import WallFinish

_WIDTH, _HEIGHT = 760, 430  # pixels
#: lines of the surface over height and along the feed; revolutions that they show
_ROWS, _COLUMNS, _REVOLUTIONS = 12, 130, 8
#: half the sides of the box that it is drawn in: feed, normal of the wall, height
_BOX = (0.9, 0.3, 0.5)
_AZIMUTH, _ELEVATION = (-80, 80), (0, 85)
#: deg a pixel that the mouse is dragged by
_A_PIXEL = 0.4
_NONE = "surface: the run leaves no finished wall"


class SurfaceFigure:
    """Walls of a cut; nothing is drawn before `show`."""

    def __init__(self) -> None:
        self._walls: tuple[WallFinish, ...] = ()
        self._longest = math.inf
        self._waits = False
        self._drawn: tuple[Any, ...] = ()
        #: place of the mouse, pixels, and angles where dragging began
        self._held = (0.0, 0.0, 0, 0)
        self.wall = pn.widgets.Select(label="Wall", options=[], width=90)
        self.azimuth = pn.widgets.IntSlider(
            label="Azimuth [deg]", start=_AZIMUTH[0], end=_AZIMUTH[1], value=-30, width=230
        )
        self.elevation = pn.widgets.IntSlider(
            label="Elevation [deg]", start=_ELEVATION[0], end=_ELEVATION[1], value=30, width=230
        )
        self.faces = ColumnDataSource({"xs": [], "ys": [], "deviation": []})
        self.edges = ColumnDataSource({"xs": [], "ys": []})
        self.marks = ColumnDataSource({"x": [], "y": [], "text": []})
        self._colour = LinearColorMapper(palette=Viridis256, low=0.0, high=1.0)
        self.figure = self._make_figure()
        for widget in (self.wall, self.azimuth, self.elevation):
            widget.param.watch(lambda _: self.draw(), "value")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the picture with what turns it."""
        return pn.Column(
            picture(self.figure, "surface"), pn.Row(self.azimuth, self.elevation, self.wall)
        )

    def show(self, walls: Sequence[WallFinish], feed: float) -> None:
        """Draw the walls of another cut with a feed per revolution, m: the last revolutions."""
        self._walls, self._longest = tuple(walls), _REVOLUTIONS * feed
        self.wall.options = [one.profiles.side for one in self._walls]
        self.wall.value = next(iter(self.wall.options), None)
        self.draw()

    def draw(self) -> None:
        """Draw the wall from the angles that are chosen."""
        view = self._walls, self.wall.value, self.azimuth.value, self.elevation.value
        if self._waits or view == self._drawn:
            return
        self._drawn = view
        chosen = [one.profiles for one in self._walls if one.profiles.side == self.wall.value]
        if not chosen:
            self.faces.data = {"xs": [], "ys": [], "deviation": []}
            self.edges.data = {"xs": [], "ys": []}
            self.marks.data = {"x": [], "y": [], "text": []}
            self.figure.title.text = _NONE
            return
        x, z, deviation = _on_lines(chosen[0], self._longest)
        self._colour.update(low=float(deviation.min()), high=_above(deviation))
        box = [_within(values, half) for values, half in zip((x, deviation, z), _BOX, strict=True)]
        points = np.stack(np.broadcast_arrays(box[0][None, :], box[1], box[2][:, None]), axis=-1)
        across, up, depth = projected(points, self.azimuth.value, self.elevation.value)
        corners, order = faces(depth)
        value = _corner_mean(deviation)[order]
        self.faces.data = {
            # as plain lists: an array a face would be sent as a message part a face
            "xs": across.ravel()[corners].round(4).tolist(),
            "ys": up.ravel()[corners].round(4).tolist(),
            "deviation": value,
        }
        self._draw_box(x, z, deviation)
        self.figure.title.text = (
            f"wall {self.wall.value}: deviation {deviation.min():.3g} to {deviation.max():.3g} µm"
            + (", evaluated at one height" if len(chosen[0].height) == 1 else "")
        )

    def _draw_box(self, x: Array, z: Array, deviation: Array) -> None:
        """Three edges of the box with their ends."""
        a, b, c = _BOX
        ends = np.array([
            [[-a, -b, -c], [a, -b, -c]], [[a, -b, -c], [a, b, -c]], [[-a, -b, -c], [-a, -b, c]],
        ])  # fmt: skip
        across, up, _ = projected(ends, self.azimuth.value, self.elevation.value)
        self.edges.data = {"xs": list(across), "ys": list(up)}
        named = (("feed", "mm", x), ("deviation", "", deviation), ("height", "mm", z))
        outside = np.array([[0.0, -0.2, -0.12], [0.4, 0.0, -0.12], [-0.1, -0.1, 0.65]])
        middle, rise, _ = projected(
            ends.mean(axis=1) + outside, self.azimuth.value, self.elevation.value
        )
        texts = [
            f"{name} {v.min():.3g} to {v.max():.3g} {unit}" if unit else name
            for name, unit, v in named
        ]
        self.marks.data = {"x": middle, "y": rise, "text": texts}

    def _hold(self, event: PanStart) -> None:
        self._held = (event.sx, event.sy, self.azimuth.value, self.elevation.value)

    def _dragged(self, event: Pan) -> None:
        """Turn what is near along with the mouse."""
        x, y, azimuth, elevation = self._held
        turned, raised = azimuth + _A_PIXEL * (event.sx - x), elevation + _A_PIXEL * (event.sy - y)
        self._waits = True  # for both angles
        self.azimuth.value = round(min(max(turned, _AZIMUTH[0]), _AZIMUTH[1]))
        self._waits = False
        self.elevation.value = round(min(max(raised, _ELEVATION[0]), _ELEVATION[1]))
        self.draw()

    def _make_figure(self) -> Any:
        reach = 1.5 * math.hypot(*_BOX)
        up = 1.15 * reach * _HEIGHT / _WIDTH
        drawn = figure(
            width=_WIDTH, height=_HEIGHT, tools="wheel_zoom,reset",
            x_range=(-reach, reach), y_range=(-up, up),
        )  # fmt: skip
        drawn.xaxis.visible = drawn.yaxis.visible = False
        drawn.grid.visible = False
        drawn.patches("xs", "ys", source=self.faces, line_width=0.3, line_color="#555555",
                      fill_color={"field": "deviation", "transform": self._colour})  # fmt: skip
        drawn.multi_line("xs", "ys", source=self.edges, color="#000000", line_width=1.0)
        drawn.text("x", "y", "text", source=self.marks, text_align="center",
                   text_baseline="middle", text_font_size="9pt")  # fmt: skip
        drawn.add_layout(ColorBar(color_mapper=self._colour, title="deviation [µm]"), "right")
        drawn.title.text = _NONE
        drawn.on_event(PanStart, self._hold)
        drawn.on_event(Pan, self._dragged)
        return drawn


def projected(points: Array, azimuth: float, elevation: float) -> tuple[Array, Array, Array]:
    """Coordinates on the screen, and distance from the viewer, of points (..., 3).

    They are along the feed, along the normal of the wall into the work, and up. The wall is turned
    about the vertical and seen from above by the elevation, both in deg; parallel projection.
    """
    a, e = math.radians(azimuth), math.radians(elevation)
    x, y, z = np.moveaxis(points, -1, 0)
    across, away = x * math.cos(a) - y * math.sin(a), x * math.sin(a) + y * math.cos(a)
    up, distance = z * math.cos(e) + away * math.sin(e), away * math.cos(e) - z * math.sin(e)
    return across, up, distance


def faces(distance: Array) -> tuple[IntegerArray, IntegerArray]:
    """Corners (n, 4) of the faces of a grid of points, the furthest first, and their order (n,)."""
    index = np.arange(distance.size).reshape(distance.shape)
    corners = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    order = np.argsort(-_corner_mean(distance), kind="stable")
    return corners.reshape(-1, 4)[order], order


def _corner_mean(values: Array) -> Array:
    """Mean (n,) of the corners of every face."""
    return 0.25 * (values[:-1, :-1] + values[:-1, 1:] + values[1:, 1:] + values[1:, :-1]).ravel()


def _on_lines(profiles: Any, longest: float) -> tuple[Array, Array, Array]:
    """Feed and height, mm, and deviation, um, on the lines that are drawn.

    Of the wall its end is drawn, no longer than the length in m.
    """
    rows = _some(len(profiles.height), _ROWS)
    shown = np.flatnonzero(profiles.x >= profiles.x[-1] - longest)
    columns = shown[_some(len(shown), _COLUMNS)]
    x, z = (profiles.x[columns] - profiles.x[shown[0]]) * 1e3, profiles.height[rows] * 1e3
    deviation = profiles.deviation[np.ix_(rows, columns)] * 1e6
    if len(z) > 1:
        return x, z, deviation
    # one height stands for a strip
    return x, z[0] + np.array([0.0, 0.1 * max(float(np.ptp(x)), 1e-3)]), np.repeat(deviation, 2, 0)


def _some(count: int, most: int) -> IntegerArray:
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(np.int64))


def _within(values: Array, half: float) -> Array:
    """Values moved and scaled to reach from -half to half."""
    low, reach = float(values.min()), float(np.ptp(values))
    return half * (2.0 * (values - low) / reach - 1.0) if reach > 0.0 else 0.0 * values


def _above(values: Array) -> float:
    """Largest value, a little more where all are the same."""
    return float(values.max()) if np.ptp(values) > 0.0 else float(values.max()) + 1e-3
