"""Residuals on the page: records, errors and diagnostics of a comparison."""

from __future__ import annotations

import shutil

import numpy as np
import panel as pn
import pytest

import chatter
from chatter.app.workbench.diagnostic_figure import diagnostic_figure
from chatter.app.workbench.picture_files import picture_file
from chatter.app.workbench.residual_file import RESIDUALS, read_residuals, write_residuals
from chatter.app.workbench.residual_view import ResidualView
from chatter.explain.residuals.by_channel import short_name
from chatter.io.signals import read_signals
from tests.places import EXAMPLES

SET = EXAMPLES / "explain-frf" / "measurement"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    copied = tmp_path_factory.mktemp("residuals")
    write_residuals(chatter.compare(SET), copied)
    return copied


def test_a_record_is_drawn_as_it_was_measured(folder):
    view = ResidualView()
    view.show(folder)
    view.run.value, view.channel.value = "idle_x1.npz", "real"
    measured = read_signals(SET / "idle_x1.npz")
    order = np.argsort(measured["frequency"])
    # of a long record the ends of every part are drawn
    drawn = np.interp(measured["frequency"][order], view.record.data["x"],
                      view.record.data["measured"])  # fmt: skip
    far = 0.02e6 * np.ptp(measured["real"])
    assert np.max(view.record.data["measured"]) == pytest.approx(
        1e6 * measured["real"].max(), rel=1e-4
    )
    assert np.median(np.abs(drawn - 1e6 * measured["real"][order])) < far
    assert np.isfinite(view.record.data["declared"]).all()
    assert np.isnan(view.record.data["repaired"]).all()
    legend = view._drawn.legend[0].items
    assert [item.label.value for item in legend if item.visible] == [
        "measured", "residual, declared"
    ]  # fmt: skip


def test_residual_over_noise_is_that_of_the_table(folder):
    told = {(one.run, one.channel): one.over_noise for one in chatter.compare(SET).errors}
    records = read_residuals(folder)["records"]
    assert len(records) == len(told)
    for one in records:
        assert one["over_noise"]["declared"] == pytest.approx(
            told[one["run"], one["channel"]], rel=0.02
        )


def test_every_diagnostic_is_drawn_and_saved(folder):
    view = ResidualView()
    view.show(folder)
    assert len(view.diagnostic.options) >= 2
    for place in view.diagnostic.options.values():
        view.diagnostic.value = place
        assert view.told.object.endswith(".") or "no more than chance" in "".join(
            name for name, one in view.diagnostic.options.items() if one == place
        )
        drawn = view._panel.select(pn.pane.Bokeh)[0].object
        assert picture_file(drawn, "png").getvalue().startswith(b"\x89PNG")


def test_a_map_and_points_have_cells_and_classes():
    cells = {
        "kind": "Map", "x_edges": [0.0, 1.0, 2.0], "y_edges": [0.0, 1.0], "values": [[-3.0, None]],
        "x_label": "speed [rpm]", "y_label": "depth [mm]", "label": "error", "logarithmic": "",
    }  # fmt: skip
    drawn = diagnostic_figure(cells, "map")
    source = drawn.renderers[0].data_source.data
    assert list(source["left"]) == [0.0]
    assert list(source["value"]) == [-3.0]
    points = {
        "kind": "Points", "classes": {"stable": [[1.0, 2.0], [3.0, 4.0]]}, "x_label": "x",
        "y_label": "y", "logarithmic": "y",
        "curve": {"x": [1.0, 2.0], "y": [1.0, 1.0], "label": "limit", "spread": None},
    }  # fmt: skip
    drawn = diagnostic_figure(points, "points")
    assert [item.label.value for item in drawn.legend[0].items] == ["stable (2)", "limit"]
    for one in (drawn, diagnostic_figure(cells, "map")):
        assert picture_file(one, "svg").getvalue().startswith(b"<?xml")


def test_a_folder_without_residuals_shows_nothing(folder, tmp_path):
    view = ResidualView()
    view.show(folder)
    view.show(tmp_path)
    assert not view._view.visible
    shutil.copy(folder / RESIDUALS, tmp_path)
    (tmp_path / RESIDUALS).write_text("{ half of a")
    view.show(tmp_path)
    assert not view._view.visible


def test_bars_of_parts_of_one_record_have_names_of_their_own():
    """All were "move01", which no axis of categories takes: the picture stayed empty."""
    names = ["move01.csv, part 1 of 12", "move01.csv, part 12 of 12", "rec.1.csv"]
    assert list(map(short_name, names)) == ["move01, part 1", "move01, part 12", "rec.1"]
    panel = {"kind": "Bars", "categories": ["a", "a"], "series": {"force": [1.0, 2.0]},
             "label": "residual over noise", "floor": 1.0}  # fmt: skip
    assert diagnostic_figure(panel, "").x_range.factors == ["a", "a (2)"]
