"""The diagram of the workbench in chromium: zoomed into, and beside another."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

import chatter
from tests.chatter.app.browser_tab import shot
from tests.places import EXAMPLES

pytestmark = [
    pytest.mark.browser,
    # Bokeh says so of a model that dynamic tabs send again; as an error it would drop the message
    pytest.mark.filterwarnings("ignore:reference already known"),
    # a tab that is closed leaves what was to be sent to it
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

#: ranges of the first diagram, or of the second, in the place of those that stand; box of its
#: frame. What has one point is a sample of the legend.
FRAME = """
(() => {
  const drawn = [...Bokeh.documents[0]._all_models.values()]
    .filter(one => one.data && "stable" in one.data && one.data.stable.length > 1)[NUMBER];
  const plot = [...Bokeh.documents[0]._all_models.values()].find(one =>
    Array.isArray(one.renderers) && one.renderers.some(part => part.data_source === drawn));
  const ranges = RANGES;
  if (ranges) {
    [plot.x_range.start, plot.x_range.end, plot.y_range.start, plot.y_range.end] = ranges;
  }
  const view = Bokeh.index.find_one(plot);
  const box = view.canvas_view.el.getBoundingClientRect(), {bbox} = view.frame;
  return [box.left + bbox.left, box.top + bbox.top, box.left + bbox.right, box.top + bbox.bottom];
})()
"""


def frame(tab, ranges=None, number=0):
    """Box of the frame of a diagram in the window, after its ranges were set."""
    expression = FRAME.replace("NUMBER", str(number)).replace("RANGES", json.dumps(ranges))
    return [round(one) for one in tab.value(expression)]


def green(path, box):
    """Count of the pixels of a box that have the colour of stable cuts."""
    left, top, right, bottom = box
    part = np.asarray(Image.open(path).convert("RGB"), dtype=int)[top:bottom, left:right]
    red, middle, blue = np.moveaxis(part, -1, 0)
    return int(((middle > red + 15) & (middle > blue + 15)).sum())


@pytest.fixture
def opened(tab, served):
    folder, server = served
    case = chatter.load(EXAMPLES / "two-degrees-of-freedom" / "case.toml")
    case.save(folder / "case.toml")
    case.patch({"material.Ktc": "200 MPa", "material.Krc": "70 MPa"}).save(folder / "soft.toml")
    tab.open(server.url)
    drawn = "one => one.data && 'stable' in one.data && one.data.stable.length === 200"
    tab.wait(f"[...Bokeh.documents[0]._all_models.values()].some({drawn})")
    return tab


def test_a_diagram_that_is_zoomed_into_stays_in_its_frame(opened, tmp_path):
    """The curves ran over the axes and the buttons, up to the sliders."""
    frame(opened, [14000.0, 17000.0, 0.0, 1.0])
    shot(opened, tmp_path, "zoomed")
    left, top, right, bottom = frame(opened)
    assert green(tmp_path / "zoomed.png", (left + 2, top + 2, right - 2, bottom - 2)) > 10_000
    assert green(tmp_path / "zoomed.png", (left - 30, top, left - 2, bottom)) == 0
    # below the logo of the tools
    assert green(tmp_path / "zoomed.png", (right + 2, top + 60, right + 15, bottom)) == 0
    # whole again, it is the fast way of painting again
    frame(opened, [5000.0, 25000.0, 0.0, 10.0])
    limits = "one => one.glyph && (one.data_source.data.stable ?? []).length > 1"
    limits = f"[...Bokeh.documents[0]._all_models.values()].filter({limits})"
    opened.wait(f"{limits}.length && {limits}.every(one => one.level === 'overlay')")


def test_a_deeper_case_beside_stays_in_its_frame_and_in_the_window(opened, tmp_path):
    opened.choose("Case beside it", "soft.toml")
    opened.wait("[...Bokeh.documents[0]._all_models.values()].filter(one => one.data"
                " && 'stable' in one.data && one.data.stable.length > 1).length === 2")  # fmt: skip
    frame(opened, [5000.0, 25000.0, 0.0, 4.0])
    shot(opened, tmp_path, "beside")
    left, top, right, _ = frame(opened, number=1)
    assert left > frame(opened)[2]
    assert right < opened.value("window.innerWidth")
    assert green(tmp_path / "beside.png", (left, top, right, top + 20)) > 1000
    assert green(tmp_path / "beside.png", (left, top - 12, right, top - 2)) == 0
