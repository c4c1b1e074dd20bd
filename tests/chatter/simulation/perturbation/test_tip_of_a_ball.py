"""Vibration along the axis of a ball whose tip cuts: growth in time is that of the linear analysis.

At the tip the chip is zero, so that any vibration takes a part of the lowest slice into the air.
"""

import pytest

import chatter
from chatter.simulation.perturbation.multiplier import simulated_multiplier
from chatter.simulation.structure_in_time import modes_of

CASE = """
title = "A ball that yields along its axis"
[tool]
kind = "ball"
teeth = 2
diameter = "10 mm"
helix = "30 deg"
[material]
Ktc = "800 MPa"
Krc = "300 MPa"
Kac = "200 MPa"
[cut]
mode = "slot"
spindle_speed = "2500 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "0.081 mm"
[[structure.mode]]
frequency = "2000 Hz"
damping = 0.03
stiffness = "5 N/um"
direction = [0, 0, 1]
"""


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("ball") / "case.toml"
    path.write_text(CASE)
    return chatter.load(path)


@pytest.mark.parametrize("helix", ["0 deg", "30 deg"])
@pytest.mark.parametrize("slices", [None, 4])
def test_growth_is_that_of_the_linear_analysis(case, helix, slices):
    changed = case.patch({"tool.helix": helix, "simulation.slices": slices})
    radius = chatter.check(changed).spectral_radius
    assert 0.9 < radius < 0.95
    found = simulated_multiplier(changed, modes_of(changed)[0])
    assert found.radius == pytest.approx(radius, abs=1e-3)


def test_a_stable_cut_repeats(case):
    found = chatter.simulate(case)
    assert found.detection.verdict == "stable"
    assert found.detection.metrics["deviation"] < 1e-4
