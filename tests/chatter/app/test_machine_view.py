"""Machine in the workbench, driven in process."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

from chatter.app.workbench.diagnostic_figure import MODEL_COLOURS, diagnostic_figure
from chatter.app.workbench.page import Workbench
from tests.chatter.simulation.virtual_tests.test_mode_shapes import BLOCK
from tests.places import EXAMPLES

PATIENCE = 600.0


@pytest.fixture
def workbench(tmp_path):
    shutil.copy(EXAMPLES / "two-degrees-of-freedom" / "case.toml", tmp_path / "case.toml")
    (tmp_path / "machine.toml").write_text(BLOCK)
    page = Workbench(tmp_path)
    yield page
    page.end()


def test_mode_shapes_swing(workbench):
    view = workbench.machine
    view.refresh()
    assert view.file.value == "machine.toml"
    view.start("mode_shapes")
    assert view.work.computations.wait(PATIENCE)
    assert len(view.rest.data["xs"]) == 12
    view.player.value = 0
    assert np.allclose(view.moved.data["xs"], view.rest.data["xs"])
    view.player.value = 6  # a quarter of the period
    assert not np.allclose(view.moved.data["xs"], view.rest.data["xs"])
    told = view.call.objects[0].object
    assert told.splitlines() == [
        "chatter mode-shapes machine.toml",
        "chatter.mode_shapes(chatter.load_machine('machine.toml'))",
    ]


def test_results_of_a_machine_stay_beside_one_another(workbench, tmp_path):
    """FRFs were gone from the page once a move was made."""
    view = workbench.machine
    view.refresh()
    for name in ("frf", "move"):
        folder = view._folder(name)
        folder.mkdir(parents=True)
        (folder / "call.json").write_text(json.dumps({"title": f"heading {name}"}))
        view._done(name)
    headings = [one.object for one in view._results if "heading" in str(getattr(one, "object", ""))]
    assert [text.count("heading move") for text in headings] == [1, 0]
    assert "heading frf" in headings[1]


def test_a_case_on_a_machine_leaves_no_path_of_this_computer(tmp_path):
    """Notes and files of results held the whole path of the machine file."""
    folder = tmp_path / "jobs"
    shutil.copytree(EXAMPLES / "solid-crossbeam", folder / "crossbeam")
    page = Workbench(folder)
    try:
        assert page.session.name == "crossbeam/case.toml"
        page.sheet.choice.value = "check"
        page.sheet.start()
        assert page.sheet.work.computations.wait(PATIENCE)
        results = page.session.results("check")
        notes = json.loads((results / "call.json").read_text())["notes"]
        assert any("dynamics of crossbeam/machine.toml" in note for note in notes)
        for path in results.iterdir():
            assert str(tmp_path).encode() not in path.read_bytes(), path.name
        page.stability.refresh()
        diagram = page.stability.diagram
        assert diagram.computations.wait(PATIENCE)
        assert "crossbeam/machine.toml" in diagram.message.object
        assert str(tmp_path) not in diagram.message.object
    finally:
        page.end()


def test_a_machine_without_a_move_says_so(workbench):
    view = workbench.machine
    view.refresh()
    view.start("move")
    assert "no [move.NAME]" in view.work.message.object


def test_bars_of_a_model_have_the_colour_of_its_curve():
    """The refitted case was orange in the curves and blue in the bars, the repaired one so too."""
    panel = {"kind": "Bars", "categories": ["run01"], "label": "residual over noise",
             "series": {"refitted": [9.0], "repaired": [1.0]}, "floor": 1.0}  # fmt: skip
    bars = {one.glyph.top: one.glyph.fill_color for one in diagnostic_figure(panel, "").renderers}
    assert bars == {name: MODEL_COLOURS[name] for name in ("refitted", "repaired")}
