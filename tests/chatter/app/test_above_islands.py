"""Diagrams with islands: what is stable above them is drawn, as `check` judges it."""

import pytest

import chatter
from chatter.app.above_islands import above_islands
from chatter.app.live_case import LiveCase
from tests.places import EXAMPLES

#: limits in mm at three speeds: none, a lobe, and two islands of which the second is cut off
DIAGRAM = {
    "spindle_speed_rpm": [1000.0, 1500.0, 2000.0],
    "crossings_mm": [[], [2.0], [1.0, 3.0, 4.0]],
    "max_axial_depth_mm": 5.0,
}


def test_bars_are_between_islands_and_above_them():
    bars, limits = above_islands(DIAGRAM)
    assert bars == {"left": [1750.0], "right": [2250.0], "low": [3.0], "high": [4.0]}
    assert limits == {"speed": [2000.0, 2000.0], "depth": [3.0, 4.0]}
    open_above = {**DIAGRAM, "crossings_mm": [[], [2.0], [1.0, 3.0]]}
    assert above_islands(open_above)[0] == {
        "left": [1750.0], "right": [2250.0], "low": [3.0], "high": [5.0],
    }  # fmt: skip


@pytest.mark.nightly
def test_the_islands_of_an_example_are_those_of_check():
    case = chatter.load(EXAMPLES / "helix-islands" / "case.toml")
    drawn = LiveCase(case, None).diagram({}, "fine", lambda *_: None)
    bars, _ = above_islands(drawn)
    assert bars["left"], "the example has an island"
    for index in (0, len(bars["left"]) // 2):
        left, right, low, high = (bars[name][index] for name in bars)
        speed = 0.5 * (left + right)
        assert high > low
        at = {"cut.spindle_speed": f"{speed} rpm"}
        inside = {**at, "cut.axial_depth": f"{low + 0.05 * (high - low)} mm"}
        below = {**at, "cut.axial_depth": f"{0.98 * low} mm"}
        assert chatter.check(case.patch(inside)).summary()["stable"]
        assert not chatter.check(case.patch(below)).summary()["stable"]
