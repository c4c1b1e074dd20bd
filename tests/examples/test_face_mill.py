"""The face mill enters a block: vibration grows with the engagement, in the published order."""

import numpy as np
import pytest

import chatter
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "face-mill-chatter"


@pytest.fixture(scope="module")
def example():
    return example_module("face-mill-chatter")


@pytest.fixture(scope="module")
def entering(example):
    case = chatter.load(EXAMPLE / "case.toml")
    runs = {name: example.RUNS[name] for name in ("neither", "friction", "friction and contact")}
    return example.simulated(case, runs, {**example.ENTRY, "simulation.duration": "3.4 s"})


def test_the_tool_comes_from_the_air(entering):
    result = entering["neither"]
    # the corner of the block is 0.5 mm before the circle of the cutter: 0.07 s at 7 mm/s
    circle = np.sqrt(25.0**2 - 20.0**2)
    first = result.time[np.argmax(np.abs(result.force[:, 1]) > 1.0)]
    assert (15.5 - circle) / 7.0 <= first < (15.5 - circle) / 7.0 + 60.0 / 840.0


def test_vibration_grows_in_the_published_order(example, entering):
    grown = {}
    for name, result in entering.items():
        time, change = example.turn_to_turn(result)
        # nothing yet at 1 s, when the tool is half way in
        assert change[np.searchsorted(time, 1.0)] < 5.0
        grown[name] = change[-3:].mean()
    assert grown["neither"] > example.CHATTERING
    assert grown["friction"] < 0.2 * grown["neither"]
    assert grown["friction and contact"] < 0.2 * grown["friction"]
    assert entering["neither"].detection.chatter_frequency == pytest.approx(50.0, rel=0.05)
