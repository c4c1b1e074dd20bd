"""What a flank presses over the slope of its motion, against areas known by hand."""

import math

import numpy as np
import pytest

from cutting.process_damping.linear_flank import vibrating_land
from cutting.process_damping.ploughing import Ploughing

CLEARANCE = math.radians(7.0)
LAND = 80e-6


def worn(**given):
    return Ploughing(4e13, CLEARANCE, flank_wear=LAND, **given)


def at(pressing, values, slope):
    return float(np.interp(slope, pressing.slope, values))


@pytest.mark.parametrize("slope", [0.01, 0.03, 0.06])
def test_flat_land_presses_a_triangle_and_what_lies_behind_it(slope):
    pressing = worn().over_slope
    height = slope * LAND
    behind = height / (math.tan(CLEARANCE) - slope)
    wanted = 0.5 * height * (LAND + behind)
    assert at(pressing, pressing.area, slope) == pytest.approx(wanted, rel=2e-3)
    assert at(pressing, pressing.area, -slope) == pytest.approx(0.0, abs=1e-16)
    # the whole length that is pressed counts: d/dq of a triangle of the length l + behind
    rate = 0.5 * (LAND + behind) ** 2
    assert at(pressing, pressing.coefficient, slope) == pytest.approx(rate, rel=5e-3)


def test_describing_value_of_a_flat_land_about_a_still_tool_is_half():
    """max(0, q) has the describing value 1/2 (Gelb and Vander Velde 1968)."""
    small = 0.01 * math.tan(CLEARANCE)
    found = worn().over_slope.describing_coefficient(0.0, small)
    assert found == pytest.approx(0.25 * LAND**2, rel=0.02)


@pytest.mark.parametrize("share", [-1.2, -0.6, 0.3, 0.8, 1.5])
def test_describing_value_beside_a_slope(share):
    """Of max(0, q) for a sine of amplitude a about c: 1/2 + (asin x + x sqrt(1 - x^2))/pi."""
    swing = 0.02 * math.tan(CLEARANCE)
    x = min(max(share, -1.0), 1.0)
    wanted = 0.5 + (math.asin(x) + x * math.sqrt(1.0 - x * x)) / math.pi
    found = worn().over_slope.describing_coefficient(share * swing, swing) / (0.5 * LAND**2)
    assert found == pytest.approx(wanted, abs=0.08)


def test_rounded_edge_presses_alike_both_ways():
    law = Ploughing(4e13, CLEARANCE, edge_radius=40e-6)
    pressing, contact = law.over_slope, law.contact_length
    assert law.profile(np.array([contact])) == pytest.approx(0.0, abs=1e-12)
    small = 0.01 * math.tan(CLEARANCE)
    found = [at(pressing, pressing.coefficient, slope) for slope in (-small, 0.0, small)]
    assert found == pytest.approx([0.5 * contact**2] * 3, rel=0.03)
    assert law.small_vibration.coefficient == pytest.approx(0.5 * 4e13 * contact**2)


def test_still_flat_land_is_a_quarter():
    assert worn().small_vibration.coefficient == pytest.approx(0.25 * 4e13 * LAND**2)


@pytest.mark.parametrize("waves", [0.01, 0.05, 0.2])
def test_land_in_a_wave(waves):
    """Against the sum of 1 - exp(-i w s/V) over the land."""
    radius, speed = 8e-3, 150.0
    velocity = radius * speed
    frequency = 2.0 * math.pi * waves * velocity / LAND
    s = LAND * (np.arange(20000) + 0.5) / 20000
    force = np.mean(1.0 - np.exp(-1j * frequency * s / velocity)) * LAND
    found = vibrating_land(LAND, frequency, speed, radius)
    dashpot = 0.5 * LAND**2 * found.dashpot
    assert dashpot * frequency / velocity == pytest.approx(force.imag, rel=1e-6)
    assert found.stiffness * dashpot / radius == pytest.approx(force.real, rel=1e-6)
