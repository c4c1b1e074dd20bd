"""Modes far above chatter: they add next to nothing to the limit, and no minutes to the answer."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import loads
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import points_of_periods
from chatter.stability.model import milling_model

CASE = """
title = "one soft mode"
[tool]
teeth = 2
diameter = "16 mm"
[material]
Ktc = "600 MPa"
Krc = "200 MPa"
[cut]
mode = "down"
spindle_speed = "600 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "0.01 mm"
radial_depth = "8 mm"
[[structure.mode]]
frequency = "10 Hz"
damping = 0.03
stiffness = "1e4 N/m"
direction = [1, 0, 0]
"""
FAR = """
[[structure.mode]]
frequency = "20 kHz"
damping = 0.03
stiffness = "1e9 N/m"
direction = [1, 0, 0]
"""


def limit_of(text):
    return chatter.check(loads(text)).summary()["critical_depth_mm"]


def test_a_mode_far_above_chatter_is_as_its_compliance():
    """A hundred thousandth of the compliance moves the limit by no more than about as much."""
    assert limit_of(CASE + FAR) == pytest.approx(limit_of(CASE), rel=1e-3)


def test_a_mode_farther_than_any_table_is_as_its_compliance():
    """A stiff slide on a free axis, 374 kHz beside 0.5 Hz, asked for a table of 174 GB."""
    farther = FAR.replace("20 kHz", "900 kHz")
    assert limit_of(CASE + farther) == pytest.approx(limit_of(CASE), rel=1e-3)
    # a quarter of the compliance of the soft mode is felt alike, however fast it follows
    near, far = (
        FAR.replace("20 kHz", f).replace("1e9", "4e4").replace("0.03", "0.9")
        for f in ("20 kHz", "900 kHz")
    )
    assert limit_of(CASE + far) == pytest.approx(limit_of(CASE + near), rel=3e-3)
    assert limit_of(CASE + far) != pytest.approx(limit_of(CASE), rel=0.02)


def test_its_table_does_not_hold_all_its_turns():
    """An element as long as a wavelength of the soft mode holds 2000 turns of the other."""
    cut = element_cut(milling_model(loads(CASE + FAR)), 1e-3)
    assert cut.response.furthest.max() < 2.0 * math.pi * 2000.0 / 10.0
    alone = element_cut(milling_model(loads(CASE)), 1e-3)
    assert cut.longest == pytest.approx(alone.longest / 16.0)


def test_a_coefficient_beyond_all_metals_asks_for_no_elements_without_end():
    """An axial coefficient moves no mode in the plane; 1e12 MPa filled the memory."""
    model, absurd = (
        milling_model(loads(CASE).patch({"material.Kac": kac})) for kac in ("0 MPa", "-1e12 MPa")
    )
    speed, depth = np.array([600.0 * math.pi / 30.0]), np.array([1e-3])
    points, more = (
        int(points_of_periods(element_cut(one, 1e-3), speed, depth)[0]) for one in (model, absurd)
    )
    assert points <= more <= 12 * points


def test_a_coefficient_that_acts_on_no_mode_leaves_the_limit():
    text = CASE.replace('Krc = "200 MPa"', 'Krc = "200 MPa"\nKac = "-1e6 MPa"')
    assert limit_of(text) == pytest.approx(limit_of(CASE), rel=1e-4)
