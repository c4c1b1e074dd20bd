"""Stretches of depth that are stable, several of them, and what margins leave."""

import math

import numpy as np
import pytest

import chatter
from chatter.io.shipped_examples import example
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from chatter.studies.optimisation.stable_depths import (
    StableDepths,
    first_limits,
    is_inside,
    stable_depths,
)

RPM = math.pi / 30.0


def test_stability_that_comes_back_is_used():
    # validation 3.2: closed islands at 19 000 rpm leave stable depths above them
    case = chatter.load(example("helix-islands").folder / "case.toml")
    cut = element_cut(milling_model(case), 8e-3)
    speeds, depths = np.array([19000.0 * RPM]), np.linspace(0.0, 8e-3, 81)[1:]
    intervals = stable_depths(cut, speeds, depths).intervals(0)
    crossings = chatter.check(case).limit.crossings[0]
    assert intervals[:, 0] == pytest.approx([0.0, crossings[1]], rel=2e-3)
    assert intervals[:, 1] == pytest.approx([crossings[0], crossings[2]], rel=2e-3)
    assert first_limits(cut, speeds, depths) == pytest.approx(crossings[:1], rel=2e-3)


def test_margins_shrink_every_stretch_from_both_sides():
    found = StableDepths(
        np.array([98.0, 100.0, 102.0]),
        [np.array([2.0]), np.array([2.5, 4.0, 8.0]), np.array([3.0, 4.2])],
        10.0,
    )
    assert found.intervals(2).tolist() == [[0.0, 3.0], [4.2, 10.0]]
    assert found.within(100.0, 0.0, 0.0).tolist() == [[0.0, 2.5], [4.0, 8.0]]
    wide = found.within(100.0, 0.2, 0.0)
    assert wide == pytest.approx(np.array([[0.0, 2.0], [5.0, 6.4]]))
    # at 98 all above 2 is lost; where the search ends is no limit
    assert found.within(100.0, 0.0, 0.02).tolist() == [[0.0, 2.0]]
    assert found.within(102.0, 0.0, 0.0)[1, 1] == 10.0
    inside = is_inside(np.array([[0.0, 1.0], [3.0, 4.0]]), np.array([0.5, 1.0, 2.0, 3.5, 5.0]))
    assert inside.tolist() == [True, True, False, True, False]
