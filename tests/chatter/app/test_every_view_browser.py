"""Views of the workbench driven by hand in chromium: pick, overrule, scrub, play, look at."""

from __future__ import annotations

import json
import math
import re
import time

import pytest

from tests.chatter.app.browser_tab import SHIFT, shot
from tests.chatter.simulation.virtual_tests.conftest import FILE
from tests.chatter.studies.test_modal_test import write_set
from tests.dynamics.frf.hammer.hammer_records import CLOSE
from tests.places import EXAMPLES

pytestmark = [
    pytest.mark.browser,
    # Bokeh says so of a model that dynamic tabs send again; as an error it would drop the message
    pytest.mark.filterwarnings("ignore:reference already known"),
    # a tab that is closed leaves what was to be sent to it
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

#: a small machine, at rest, moving and in the cut
MACHINE = (
    FILE
    + """
[contact]
stiffness = "50 N/um"
damping = "3 kN*s/m"
directions = ["y"]

[frf.moving]
excite = "table:y"
by = "linearised"
band = ["20 Hz", "120 Hz"]
lines = 100
moving = { Y = "1 m/min" }

[frf.in_cut]
excite = "table:y"
by = "linearised"
band = ["20 Hz", "120 Hz"]
lines = 100
friction = false
in_cut = true
"""
)

#: two axes that follow a circle without feedforward
TWO_AXES = """
title = "a table on a saddle"
tool_point = "tool"
workpiece = "table"
damping_ratio = 0.03
step = "100 us"
body.bed = { mass = "5000 kg", inertia = ["2000 kg*m^2", "2000 kg*m^2", "2000 kg*m^2"], centre = ["0 mm", "0 mm", "-300 mm"] }
body.saddle = { mass = "100 kg", size = ["600 mm", "400 mm", "100 mm"], centre = ["0 mm", "0 mm", "-150 mm"] }
body.table = { mass = "200 kg", size = ["600 mm", "600 mm", "100 mm"], centre = ["0 mm", "0 mm", "-50 mm"] }
point.tool = { on = "bed", at = ["0 mm", "0 mm", "0 mm"] }
point.table = { on = "table", at = ["0 mm", "0 mm", "0 mm"] }

[connector.feet]
between = ["bed", "ground"]
at = ["0 mm", "0 mm", "-300 mm"]
stiffness = { x = 1e10, y = 1e10, z = 1e10, rx = 1e10, ry = 1e10, rz = 1e10 }

[connector.guide_x]
between = ["saddle", "bed"]
at = ["0 mm", "0 mm", "-200 mm"]
stiffness = { y = 1e10, z = 1e10, rx = 1e9, ry = 1e9, rz = 1e9 }

[connector.guide_y]
between = ["table", "saddle"]
at = ["0 mm", "0 mm", "-100 mm"]
stiffness = { x = 1e10, z = 1e10, rx = 1e9, ry = 1e9, rz = 1e9 }

[axis.X]
direction = [1, 0, 0]
moving = "saddle"
carries = ["saddle", "table"]
carrying = "bed"
at = ["0 mm", "0 mm", "-200 mm"]
DRIVE

[axis.Y]
direction = [0, 1, 0]
moving = "table"
carrying = "saddle"
at = ["0 mm", "0 mm", "-100 mm"]
DRIVE

[move.circle]
kind = "circle"
axes = ["X", "Y"]
radius = "20 mm"
velocity = "50 mm/s"
revolutions = 1
""".replace(  # noqa: E501
    "DRIVE",
    """
drive = { kind = "ball screw", lead = "10 mm", motor_inertia = "0.004 kg*m^2", screw_inertia = "0.002 kg*m^2", nut_stiffness = "2000 N/um", axial_damping = "60 kN*s/m" }
control.position = { gain = "50 1/s", sample_time = "100 us" }
control.velocity = { proportional_gain = "5 N*m*s/rad", integral_time = "1 s", sample_time = "100 us" }
control.current = { sample_time = "100 us" }
""",  # noqa: E501
)

#: visible part of a player
PLAYER = "(part => deepAll(part).find(one => one.getClientRects().length))"
MODELS = "[...Bokeh.documents[0]._all_models.values()]"
#: pole of the highest order next to a frequency: its index, and its place in the window
POLE = """
(() => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const poles = models.find(one => one.data && "order" in one.data);
  const plot = models.find(one => one.x_range
    && one.renderers.some(drawn => drawn.data_source === poles));
  const view = Bokeh.index.find_one(plot);
  view.el.scrollIntoView({block: "center"});
  const {f, order} = poles.data;
  const near = [...f.keys()].filter(k => Math.abs(f[k] - FREQUENCY) < 0.01 * FREQUENCY);
  const k = near.reduce((a, b) => order[b] > order[a] ? b : a);
  const box = view.canvas_view.el.getBoundingClientRect();
  return [box.left + view.frame.x_scale.compute(f[k]),
          box.top + view.frame.y_scale.compute(order[k])];
})()
"""


def test_poles_are_picked_and_a_record_is_overruled_by_clicks(tab, served, tmp_path):
    folder, server = served
    taps = folder / "taps-tool-x"
    taps.mkdir()
    write_set(taps, 0)
    tab.open(server.url)
    tab.wait_for_text("double hit")
    assert "--keep" not in tab.value("pageText()")
    tab.tick("tap2.csv")
    tab.wait_for_text("--keep tap2.csv")
    tab.tick("tap2.csv")
    tab.wait("!pageText().includes('--keep')")
    chosen = (CLOSE.modes[0][0], CLOSE.modes[2][0])
    poles = f"{MODELS}.find(one => one.data && 'order' in one.data)"
    tab.wait(f"{poles}.data.f.length > 10")
    for number, (frequency, keys) in enumerate(zip(chosen, (0, SHIFT), strict=True), start=1):
        place = POLE.replace("FREQUENCY", json.dumps(frequency))
        tab.value(place)  # scrolls
        tab.click(*tab.value(place), keys)
        tab.wait(f"{poles}.selected.indices.length >= {number}")
        time.sleep(0.5)  # two clicks in a row are a double click
    shot(tab, tmp_path, "picked")
    tab.click_on("Fit the picked poles")
    tab.wait_for_text("--pole")
    told = re.findall(r"--pole (\S+)", tab.value("pageText()"))
    assert [float(one) for one in told] == pytest.approx(chosen, rel=0.01)


def test_a_machine_at_rest_moving_and_in_the_cut(tab, served, tmp_path):
    folder, server = served
    (folder / "machine.toml").write_text(MACHINE)
    tab.open(server.url)
    tab.click_on("Machine", ".bk-tab")
    for name in ("linear", "moving", "in_cut"):
        tab.choose("FRFs (none: all)", name)
    tab.click_on("FRFs")
    for name in ("linear.csv", "moving.csv", "in_cut.csv"):
        tab.wait_for_text(name)
    shot(tab, tmp_path, "responses")
    tab.choose("Move", "fast")
    tab.click_on("Move")
    tab.wait_for_text("move.csv")
    shot(tab, tmp_path, "move")
    tab.click_on("Mode shapes")
    moved = f"{MODELS}.filter(one => one.data && 'xs' in one.data)"
    tab.wait(f"{moved}.some(one => one.data.xs.length)")
    shot(tab, tmp_path, "shape")
    before = tab.value(f"JSON.stringify({moved}.map(one => one.data.xs))")
    tab.value(f"{PLAYER}('.play').click()")
    tab.wait(f"JSON.stringify({moved}.map(one => one.data.xs)) !== {json.dumps(before)}")
    # opened again, the results are there
    tab.open(server.url)
    tab.click_on("Machine", ".bk-tab")
    tab.wait(f"{moved}.some(one => one.data.xs.length)")


def test_the_contour_error_of_two_axes(tab, served, tmp_path):
    """A circle is too small by what a lag of 1/K_v leaves of it, and the view says so."""
    folder, server = served
    (folder / "machine.toml").write_text(TWO_AXES)
    tab.open(server.url)
    tab.click_on("Machine", ".bk-tab")
    tab.wait_for_text("chatter move machine.toml --only circle")
    tab.click_on("Move")
    tab.wait_for_text("largest contour error")
    tab.wait_for_text("move.csv")
    shot(tab, tmp_path, "contour")
    (told,) = set(re.findall(r"largest contour error ([\d.]+) um", tab.value("pageText()")))
    pulsation, inertia = 0.05 / 0.02, 0.006 + 200.0 * (10e-3 / (2.0 * math.pi)) ** 2
    loop = 5.0 / inertia  # 1/s, of the velocity
    answer = 1.0 / (1.0 - pulsation**2 / (50.0 * loop) + 1j * pulsation / 50.0)
    assert float(told) == pytest.approx(0.02e6 * (1.0 - abs(answer)), rel=0.1)


def test_a_workpiece_is_played_and_scrubbed_as_it_is_carved(tab, served, tmp_path):
    folder, server = served
    text = (EXAMPLES / "two-degrees-of-freedom" / "case.toml").read_text()
    (folder / "case.toml").write_text(text)
    tab.open(server.url)
    tab.click_on("Cut", ".bk-tab")
    tab.tick("carve the workpiece (dexels)")
    tab.wait_for_text("--set simulation.chip=dexel")
    tab.click_on("Simulate")
    image = f"{MODELS}.find(one => one.data && 'image' in one.data)"
    tab.wait(f"{image} && {image}.data.image.length === 1")
    shot(tab, tmp_path, "carved")
    left = f"[...{image}.data.image[0]].reduce((a, b) => a + b, 0)"
    at_the_end = tab.value(left)
    # to half of the time, by hand
    tab.value(
        f"(() => {{ const one = {PLAYER}('input[type=range]'); one.value = 50;"
        "one.dispatchEvent(new Event('change')); })()"
    )
    tab.wait(f"{left} > {at_the_end}")
    half = tab.value(left)
    tab.value(f"{PLAYER}('.first').click()")
    tab.wait(f"{left} > {half}")
    whole = tab.value(left)
    tab.value(f"{PLAYER}('.play').click()")
    tab.wait(f"{left} < {whole}")
    tab.wait(f"{left} === {at_the_end}")
