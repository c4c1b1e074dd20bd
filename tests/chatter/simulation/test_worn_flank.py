"""Worn land: edge forces against closed forms; what limits and life have to do with it."""

import math

import pytest

import chatter
from chatter.description.case import loads

CASE = """
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
[material]
law = "linear"
Ktc = "1900 MPa"
Krc = "700 MPa"
Kte = "25 N/mm"
Kre = "40 N/mm"
[cut]
mode = "down"
spindle_speed = "1200 rpm"
feed_per_tooth = "0.08 mm"
axial_depth = "0.5 mm"
radial_depth = "8 mm"
[[structure.mode]]
frequency = "900 Hz"
damping = 0.03
stiffness = "4000 N/um"
direction = [0, 1, 0]
[simulation]
revolutions = 6
"""
LAND, DEPTH = 0.2e-3, 0.5e-3


def mean_forces(case):
    return chatter.simulate(case).mean_force


@pytest.mark.parametrize(("pressure", "friction"), [(300e6, 0.4), (None, None)])
def test_mean_forces_grow_by_pressure_and_friction_of_the_land(pressure, friction):
    sharp = loads(CASE)
    worn = sharp.patch({"tool.flank_wear": LAND})
    if pressure is not None:
        worn = worn.patch({"wear.flank_pressure": pressure, "wear.flank_friction": friction})
    radial = (pressure or 0.1 * 1900e6) * LAND * DEPTH
    tangential = (friction or 0.3) * radial
    # one of four teeth is always in the quarter turn from 90 to 180 deg: means of -cos and sin
    share = 2.0 / math.pi
    change = mean_forces(worn) - mean_forces(sharp)
    assert change[0] == pytest.approx(share * (tangential - radial), rel=2e-3)
    assert change[1] == pytest.approx(share * (tangential + radial), rel=2e-3)


def test_the_power_grows_by_the_friction_alone():
    sharp = loads(CASE)
    worn = sharp.patch({"tool.flank_wear": LAND, "wear.flank_pressure": 300e6})
    added = 0.3 * 300e6 * LAND * DEPTH * 0.008 * sharp.cut.spindle_speed
    more = chatter.simulate(worn).mean_power - chatter.simulate(sharp).mean_power
    assert more == pytest.approx(added, rel=2e-3)


def test_the_assumed_pressure_is_said():
    worn = loads(CASE).patch({"tool.flank_wear": LAND})
    (note,) = [one for one in chatter.simulate(worn).notes if "flank_wear" in one]
    # a tenth of 1900 MPa; 190 MPa times 0.2 mm
    assert "190 MPa" in note
    assert "38 N/mm radial" in note
    stated = worn.patch({"wear.flank_pressure": "300 MPa"})
    assert not [one for one in chatter.simulate(stated).notes if "flank_wear" in one]


def test_limits_stay_and_that_is_said():
    sharp = loads(CASE)
    worn = sharp.patch({"tool.flank_wear": LAND})
    assert chatter.check(worn).critical_depth == chatter.check(sharp).critical_depth
    assert any("no limit of the linear methods" in one for one in chatter.check(worn).notes)
    damped = worn.patch(
        {"tool.clearance_angle": "6 deg", "process_damping.indentation_force": "2e13 N/m^3"}
    )
    assert not any("no limit of the linear" in one for one in chatter.check(damped).notes)


def test_a_land_beyond_the_end_of_life_is_said():
    worn = loads(CASE).patch({"tool.flank_wear": "0.4 mm"})
    assert any("beyond the usual end of life, 0.3 mm" in one for one in chatter.check(worn).notes)
    worn = loads(CASE).patch({"tool.flank_wear": "0.3 mm"})
    assert not any("end of life" in one for one in chatter.check(worn).notes)
