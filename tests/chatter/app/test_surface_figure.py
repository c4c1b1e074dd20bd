"""Surface of a wall in three dimensions."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from bokeh.events import Pan, PanStart

from chatter.app.workbench.picture_files import picture_file
from chatter.app.workbench.surface_figure import SurfaceFigure, faces, projected
from chatter.simulation.reconstruction import WallProfiles


def wall(side, deviation, height=(0.0, 1e-3, 2e-3)):
    deviation = np.asarray(deviation, dtype=float)
    x = np.linspace(0.01, 0.014, deviation.shape[1])
    profiles = WallProfiles(side, x, np.array(height), deviation, np.ones(len(height)))
    return SimpleNamespace(profiles=profiles)


WAVES = 1e-6 * np.array([[0.0, 2.0, 0.0, 2.0], [0.0, 3.0, 0.0, 3.0], [1.0, 5.0, 1.0, 5.0]])


def test_seen_from_the_front_from_above_and_from_the_side():
    # along the feed, into the work, up
    feed, into, up = np.eye(3)
    assert np.allclose(projected(feed, 0, 0), (1, 0, 0))
    assert np.allclose(projected(into, 0, 0), (0, 0, 1))
    assert np.allclose(projected(up, 0, 0), (0, 1, 0))
    # from above, what is further into the work is higher on the screen, what is high is nearer
    assert np.allclose(projected(into, 0, 90), (0, 1, 0))
    assert np.allclose(projected(up, 0, 90), (0, 0, -1))
    # turned by a quarter, the feed goes into the distance
    assert np.allclose(projected(feed, 90, 0), (0, 0, 1))
    assert np.allclose(projected(into, 90, 0), (-1, 0, 0))


def test_the_furthest_face_is_drawn_first():
    corners, order = faces(np.array([[0.0, 1.0, 5.0], [0.0, 1.0, 5.0]]))
    assert order.tolist() == [1, 0]
    assert sorted(corners[0]) == [1, 2, 4, 5]


def test_a_wall_is_drawn_in_micrometres_and_turned():
    surface = SurfaceFigure()
    surface.show([wall("+y", WAVES), wall("-y", 2.0 * WAVES)], 0.01)
    assert len(surface.faces.data["xs"]) == 2 * 3
    # mean of the corners of the face with the largest deviations, um
    assert max(surface.faces.data["deviation"]) == pytest.approx(0.25 * (0 + 3 + 5 + 1))
    assert surface._colour.high == pytest.approx(5.0)
    assert "feed 0 to 4 mm" in surface.marks.data["text"]
    assert "height 0 to 2 mm" in surface.marks.data["text"]
    assert "0 to 5 µm" in surface.figure.title.text
    before = np.array(surface.faces.data["xs"])
    surface.azimuth.value = 40
    assert not np.allclose(before, surface.faces.data["xs"])
    surface.wall.value = "-y"
    assert surface._colour.high == pytest.approx(10.0)


def test_dragging_turns_it_within_its_range():
    surface = SurfaceFigure()
    surface.show([wall("+y", WAVES)], 0.01)
    azimuth, elevation = surface.azimuth.value, surface.elevation.value
    surface._hold(PanStart(surface.figure, sx=300, sy=200))
    surface._dragged(Pan(surface.figure, sx=350, sy=175))
    # what is near goes along with the mouse: to the right, and up, seen less from above
    assert (surface.azimuth.value, surface.elevation.value) == (azimuth + 20, elevation - 10)
    near = np.array([0.0, -1.0, 0.0])
    assert projected(near, azimuth + 20, elevation)[0] > projected(near, azimuth, elevation)[0]
    assert projected(near, azimuth, elevation - 10)[1] > projected(near, azimuth, elevation)[1]
    surface._dragged(Pan(surface.figure, sx=1e4, sy=1e4))
    assert (surface.azimuth.value, surface.elevation.value) == (
        surface.azimuth.end,
        surface.elevation.end,
    )


def test_only_the_last_revolutions_are_drawn():
    surface = SurfaceFigure()
    # eight revolutions of 0.25 mm: the last two of four millimetres
    surface.show([wall("+y", np.tile(np.arange(5.0) * 1e-6, (3, 1)))], 0.25e-3)
    assert "feed 0 to 2 mm" in surface.marks.data["text"]
    assert "2 to 4 µm" in surface.figure.title.text


def test_one_height_flat_walls_and_none():
    surface = SurfaceFigure()
    surface.show([wall("+y", np.full((1, 5), 2e-6), height=(0.0,))], 0.01)
    assert len(surface.faces.data["xs"]) == 4
    assert np.all(np.isfinite(np.array(surface.faces.data["ys"])))
    assert "one height" in surface.figure.title.text
    surface.show([], 0.01)
    assert len(surface.faces.data["xs"]) == 0
    assert "no finished wall" in surface.figure.title.text


@pytest.mark.parametrize(("form", "head"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_it_is_exported(form, head):
    surface = SurfaceFigure()
    surface.show([wall("+y", WAVES)], 0.01)
    assert picture_file(surface.figure, form).read(5).startswith(head)
