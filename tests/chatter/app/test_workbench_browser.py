"""The workbench in headless chromium: from hammer files to the operator's sheet, by hand."""

from __future__ import annotations

import shutil
import time

import pytest

import chatter
from benchmarks.workbench_in_browser import TIME
from tests.chatter.app.browser_tab import shot
from tests.chatter.simulation.virtual_tests.test_mode_shapes import BLOCK
from tests.chatter.studies.test_modal_test import write_set
from tests.places import EXAMPLES

pytestmark = [
    pytest.mark.browser,
    # Bokeh says so of a model that dynamic tabs send again; as an error it would drop the message
    pytest.mark.filterwarnings("ignore:reference already known"),
    # a tab that is closed leaves what was to be sent to it
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

#: s, from the empty page to the sheet
FIVE_MINUTES = 300.0
ANSWERS = {
    "Tool: diameter, teeth": "12 mm, 4",
    "Material: name of `chatter materials`, or Ktc and Krc": "Al7075-T6",
    "Cut: spindle speed, feed per tooth, axial depth": "8000 rpm, 0.05 mm, 1 mm",
    'Engagement: "slot", or "up" or "down" and the radial depth': "down, 6 mm",
}


def test_hammer_files_to_the_sheet_within_five_minutes(tab, served, tmp_path):
    folder, _ = served
    taps = tmp_path / "taps"
    taps.mkdir()
    write_set(taps, 0)
    begun = time.monotonic()
    tab.upload(sorted(taps.iterdir()))
    tab.wait_for_text("1479")
    tab.wait_for_text("double hit")
    shot(tab, tmp_path, "tap-test")
    tab.click_on("Modes into the case")
    for label, answer in ANSWERS.items():
        tab.type_into(label, answer)
    tab.click_on("Make the case")
    tab.wait_for_text("is made and saved")
    assert len(chatter.load(folder / "case.toml").structure.mode) == 3
    shot(tab, tmp_path, "case")
    tab.click_on("Stability", ".bk-tab")
    tab.wait_for_text("chatter lobes case.toml")
    shot(tab, tmp_path, "stability")
    tab.click_on("Operator's sheet", ".bk-tab")
    tab.click_on("Start")
    tab.wait_for_text("sheet.pdf")
    shot(tab, tmp_path, "sheet")
    assert time.monotonic() - begun < FIVE_MINUTES
    assert (folder / "results" / "case" / "sheet" / "sheet.pdf").is_file()
    # opened again, it is all there
    tab.open(served[1].url)
    tab.click_on("Operator's sheet", ".bk-tab")
    tab.wait_for_text("sheet.pdf")


def test_a_cut_a_machine_and_a_measurement_in_the_browser(tab, served, tmp_path):
    folder, server = served
    shutil.copy(EXAMPLES / "two-degrees-of-freedom" / "case.toml", folder / "case.toml")
    (folder / "machine.toml").write_text(BLOCK)
    shutil.copytree(EXAMPLES / "explain-milling" / "measurement", folder / "measurements" / "cuts")
    tab.open(server.url)
    tab.click_on("Cut", ".bk-tab")
    tab.click_on("Simulate")
    tab.wait_for_text("the motion repeats")
    shot(tab, tmp_path, "cut")
    tab.click_on("Machine", ".bk-tab")
    tab.click_on("Mode shapes")
    tab.wait_for_text("starting")
    tab.wait("!pageText().includes('starting')")
    shot(tab, tmp_path, "machine")
    tab.click_on("Measurement", ".bk-tab")
    tab.click_on("Explain")
    tab.click_on("Cancel")
    tab.wait_for_text("cancelled")
    tab.click_on("Compare")
    tab.wait_for_text("times the noise in")
    shot(tab, tmp_path, "measurement")
    tab.choose("Diagnostic", "frequency, declared case")
    tab.wait_for_text("Hz")
    shot(tab, tmp_path, "diagnostic")
    tab.click_on("Studies", ".bk-tab")
    shot(tab, tmp_path, "studies")


#: place in the window of a point of a diagram, and of the middle of a figure
POINT = """
(() => {
  const limits = [...Bokeh.documents[0]._all_models.values()]
    .find(one => one.data && "stable" in one.data && one.data.stable.length);
  const plot = [...Bokeh.documents[0]._all_models.values()].find(one => one.renderers
    && one.renderers.some(drawn => drawn.data_source === limits));
  const view = Bokeh.index.find_one(plot);
  view.el.scrollIntoView({block: "center"});
  const box = view.canvas_view.el.getBoundingClientRect();
  return [box.left + view.frame.x_scale.compute(SPEED),
          box.top + view.frame.y_scale.compute(DEPTH)];
})()
"""


def test_a_slider_moves_the_diagram_and_a_click_simulates(tab, served):
    folder, server = served
    shutil.copy(EXAMPLES / "two-degrees-of-freedom" / "case.toml", folder / "case.toml")
    tab.open(server.url)
    tab.wait_for_text("chatter lobes case.toml")
    models = "[...Bokeh.documents[0]._all_models.values()]"
    limit = f"{models}.find(one => one.data && 'stable' in one.data)"
    tab.wait(f"{limit} && {limit}.data.stable.length === 200")
    before = min(tab.value(f"[...{limit}.data.stable]"))
    # milliseconds until the diagram is painted; a loaded machine is slow
    assert tab.value(TIME.replace("VALUE", "900")) < 5000.0
    tab.wait(f"{limit}.data.stable.length === 200")
    tab.wait_for_text("material.Ktc=900 MPa")
    assert min(tab.value(f"[...{limit}.data.stable]")) < before
    tab.click(*tab.value(POINT.replace("SPEED", "16000").replace("DEPTH", "2")))
    tab.wait_for_text("largest force")
    assert "chatter (" in tab.value("pageText()")


def test_nothing_is_asked_of_the_network(tab, served):
    asked = tab.value("performance.getEntriesByType('resource').map(one => one.name)")
    own = served[1].url.split("/")[2]
    assert asked
    assert all(f"//{own}/" in one or one.startswith(("data:", "blob:")) for one in asked)
