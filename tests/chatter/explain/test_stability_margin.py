"""Margins of cutting tests: tests solved side by side, and limits between depths."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain import stability_margin
from chatter.explain.stability_margin import (
    CuttingTests,
    first_limits,
    margins_between,
    margins_over,
    response_of_tests,
)
from chatter.explain.tests_side_by_side import neighbouring_speeds

CASE = """
[tool]
kind = "end mill"
teeth = 3
diameter = "16 mm"
helix = "{helix} deg"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "200 MPa"
Kte = "20 N/mm"
Kre = "30 N/mm"
[cut]
mode = "down"
spindle_speed = "3000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"
[process_damping]
coefficient = "4e4 N/m"
friction = 0.3
[[structure.mode]]
frequency = "600 Hz"
damping = 0.03
mass = "0.5 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "660 Hz"
damping = 0.02
mass = "0.6 kg"
direction = [0, 1, 0]
"""
WEAR = "[wear]\ncutting = 4e-4\nprocess_damping = 2e-3\n"
RPM = np.array([1500.0, 1650.0, 2400.0, 2500.0, 2600.0, 5200.0, 9000.0])
TIMES = 100.0 * np.arange(RPM.size)


def case_of(helix: float, worn: bool, shifted: bool):
    text = CASE.format(helix=helix) + (WEAR if worn else "")
    if shifted:
        text = text.replace("direction = [1", "frequency_slope = -1e-4\ndirection = [1")
    return loads(text)


def of_tests() -> CuttingTests:
    depth = 1e-3 * np.array([3.0, 2.0, 1.5, 4.0, 2.2, 3.0, 2.5])
    return CuttingTests(RPM * math.pi / 30.0, depth, {"cut.cut_time": TIMES})


@pytest.mark.parametrize("helix", [0.0, 30.0])
@pytest.mark.parametrize(("worn", "shifted"), [(False, False), (True, False), (True, True)])
def test_tests_side_by_side_are_those_of_the_case_of_each(helix, worn, shifted, monkeypatch):
    case, tests = case_of(helix, worn, shifted), of_tests()
    found = response_of_tests(case, tests)
    # every test as a cut of its own, with the coefficients of its own time
    for k, time in enumerate(TIMES):
        own = case.patch({"cut.cut_time": float(time)})
        if worn:
            own = own.patch(
                {
                    "wear": None,
                    "material.Ktc": 8e8 * (1.0 + 4e-4 * time),
                    "material.Krc": 2e8 * (1.0 + 4e-4 * time),
                    "process_damping.coefficient": 4e4 * (1.0 + 2e-3 * time),
                }
            )
        if shifted:
            factor = 1.0 - 1e-4 * tests.speed[k]
            own = own.patch(
                {
                    "structure.mode[0].frequency": 600.0 * factor,
                    "structure.mode[0].frequency_slope": 0.0,
                }
            )
        alone = CuttingTests(tests.speed[[k]], tests.depth[[k]], {})
        monkeypatch.setattr(stability_margin, "can_be_scaled", lambda *_: False)
        expected = response_of_tests(own, alone)
        monkeypatch.undo()
        assert found.margin[k] == pytest.approx(expected.margin[0], abs=2e-3)
        assert found.angle[k] == pytest.approx(expected.angle[0], abs=2e-3)
        assert found.period[k] == pytest.approx(2.0 * math.pi / 3.0 / tests.speed[k])


def test_margins_over_depths_are_those_of_the_tests_there():
    """A margin at one depth alone, by its slope there, and by the limit between depths."""
    case = case_of(0.0, False, False)
    speeds, depths = RPM[[2, 4, 6]] * math.pi / 30.0, 1e-3 * np.geomspace(0.5, 8.0, 24)
    margins = margins_over(case, speeds, depths)
    limits = first_limits(margins, depths)
    at_limit = response_of_tests(case, CuttingTests(speeds, limits, {}))
    assert at_limit.margin == pytest.approx(0.0, abs=0.01)
    near = 1.05 * limits
    at_near = response_of_tests(case, CuttingTests(speeds, near, {}))
    assert at_near.margin == pytest.approx(1.0 / 1.05 - 1.0, abs=0.02)


def test_limits_between_depths_are_exact_where_rates_are_linear_in_the_logarithm():
    at, depths = np.geomspace(1.0, 16.0, 9), np.linspace(1.0, 16.0, 31)
    limits = np.array([2.3, 7.7, 40.0])
    rates = np.log(at) - np.log(limits)[:, None]
    margins = margins_between(rates, at, depths)
    expected = np.where(
        (limits < 16.0)[:, None], limits[:, None] / depths - 1.0, np.log(limits[:, None] / depths)
    )
    assert margins == pytest.approx(np.clip(expected, -3.0, 3.0), rel=1e-6, abs=1e-9)
    assert first_limits(margins, depths)[:2] == pytest.approx(limits[:2], rel=1e-9)
    assert first_limits(margins, depths)[2] == np.inf


def test_a_pocket_above_a_limit_is_stable_again():
    at = np.geomspace(1.0, 16.0, 9)
    rates = np.interp(np.log(at), np.log([1.0, 4.0, 16.0]), [-1.0, 1.0, -1.0])[None]
    margins = margins_between(rates, at, np.array([1.0, 2.0, 3.0, 8.0, 16.0]))[0]
    assert margins[0] == pytest.approx(1.0)
    assert margins[1] == pytest.approx(0.0, abs=1e-9)
    assert margins[2] == pytest.approx(2.0 / 3.0 - 1.0)
    assert margins[4] == pytest.approx(0.5)


def test_groups_of_speeds_are_neighbours():
    speed = np.array([100.0, 200.0, 101.0, 110.0, 130.0, 200.0])
    assert neighbouring_speeds(speed).tolist() == [0, 2, 0, 0, 1, 2]
