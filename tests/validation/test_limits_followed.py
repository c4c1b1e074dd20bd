"""Limits that `lobes` finds by following the boundary: islands, stated error, tolerance."""

import math

import numpy as np
import pytest

from chatter.description.progress import no_progress
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from chatter.stability.registry import COLLOCATION
from tests.cases import tool_of_922_hertz

RPM = math.pi / 30.0


def island_case(helix_deg=45.0, **lobes):
    """validation 3.1: 922 Hz, one direction, two flutes of 8 mm, up-milling of 5 % immersion."""
    diameter = 8e-3
    return tool_of_922_hertz(
        tool={"diameter": diameter, "helix": math.radians(helix_deg)},
        cut={"mode": "up", "spindle_speed": "19000 rpm", "radial_depth": 0.05 * diameter},
        lobes=lobes,
    )


def limits(case, rpm, deepest, count):
    depths = np.linspace(0.0, deepest, count + 1)[1:]
    return COLLOCATION.limits(milling_model(case), np.asarray(rpm) * RPM, depths, None, no_progress)


def test_both_closed_islands_at_every_speed_of_a_diagram():
    """The speeds of the benchmark lie between others: nothing of the net is set for them."""
    rpm = np.unique(np.append(np.linspace(17500.0, 21000.0, 120), [18800, 19000, 19500, 20000]))
    found = limits(island_case(), rpm, 9e-3, 60)
    expected = {
        18800: [1.14676, 1.98935, 4.62804],
        19000: [1.60997, 2.50485, 5.17385],
        19500: [6.51482],
        20000: [5.46111, 6.56189, 8.03844],
    }
    for speed, depths in expected.items():
        crossings = found.crossings[int(np.searchsorted(rpm, speed))]
        assert crossings * 1e3 == pytest.approx(depths, rel=2e-3)


def test_the_same_as_on_a_net_without_gaps():
    case = island_case()
    rpm = np.linspace(17500.0, 21000.0, 60)
    depths = np.linspace(0.0, 9e-3, 61)[1:]
    cut = element_cut(milling_model(case), 9e-3)
    followed = collocation.limit_curve(cut, rpm * RPM, depths, stride=8)
    full = collocation.limit_curve(cut, rpm * RPM, depths, stride=1)
    for one, other in zip(followed.crossings, full.crossings, strict=True):
        assert one == pytest.approx(other, rel=3e-6)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
def test_the_stated_error_is_kept(tolerance):
    found = limits(island_case(0.0, tolerance=tolerance), [18800.0, 20500.0], 6e-3, 60)
    exact = limits(island_case(0.0, tolerance=1e-6), [18800.0, 20500.0], 6e-3, 60)
    assert found.error <= tolerance
    off = np.abs(found.critical_depth / exact.critical_depth - 1.0)
    assert off.max() <= max(2.0 * found.error, 2e-6)
