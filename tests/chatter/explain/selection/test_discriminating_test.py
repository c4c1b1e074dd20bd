"""What would tell apart explanations that fit alike."""

from __future__ import annotations

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.kinds.axis import Axis
from chatter.explain.kinds.milling import Milling
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection.discriminating_test import discriminating_test, in_words

AXIS = loads("""
title = "an axis"
[axis]
moving_mass = "150 kg"
viscous_friction = "800 N*s/m"
coulomb_friction = "60 N"
""")
CUT = """
title = "a cut"
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
helix = "30 deg"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "200 MPa"
[cut]
mode = "down"
spindle_speed = "6000 rpm"
feed_per_tooth = "0.05 mm"
axial_depth = "0.5 mm"
radial_depth = "6 mm"
[[structure.mode]]
frequency = "700 Hz"
damping = 0.03
mass = "0.6 kg"
direction = [1, 0, 0]
"""


def of(kind, case, signals):
    run = Run("run01.csv", {}, signals)
    return Measurement(kind, "made up", None, case, (run,))


def test_an_offset_and_an_asymmetry_are_told_apart_at_rest():
    measurement = of("axis", AXIS, {"velocity": np.array([0.1, -0.1])})
    noise = {"run01.csv": {"force": 2.0}}
    one, other = AXIS.patch({"axis.asymmetry": 20.0}), AXIS.patch({"axis.offset": 20.0})
    found = discriminating_test(measurement, Axis(), noise, one, other)
    assert "at rest" in found["description"]
    # at rest the offset is held and the asymmetry is not: 20 N over 2 N
    assert found["over_noise"] == pytest.approx(10.0, rel=1e-3)
    assert "at rest" in in_words("offset", found)


def test_edge_forces_are_told_from_thicker_chips_by_another_feed():
    case = loads(CUT)
    # both give 40 N/mm at the mean chip of the feed that was cut
    edge = case.patch({"material.Kte": 40e3})
    stiff = case.patch({"material.Ktc": 800e6 + 40e3 / (0.05e-3 * 0.6)})
    time = np.arange(0.0, 0.1, 1.0 / 12800.0)
    signals = {"time": time, "Fx": np.ones(time.size)}
    measurement = of("milling", case, signals)
    found = discriminating_test(measurement, Milling(), {"run01.csv": {"Fx": 1.0}}, edge, stiff)
    assert "feed per tooth" in found["description"] or "depth" in found["description"]
    assert found["over_noise"] > 2.0


def test_what_no_trial_tells_is_said():
    measurement = of("axis", AXIS, {"velocity": np.array([0.1, -0.1])})
    assert (
        discriminating_test(measurement, Axis(), {"run01.csv": {"force": 2.0}}, AXIS, AXIS) is None
    )
    assert "no test among those considered" in in_words("offset", None)
