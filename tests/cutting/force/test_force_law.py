"""Force laws: published oblique coefficients, slopes against differences, limits."""

import math

import numpy as np
import pytest

from cutting.force.exponential import ExponentialLaw
from cutting.force.linear import LinearLaw
from cutting.force.oblique import oblique_cutting_coefficients

MPA = 1e6


def titanium(rake_deg: float, chip_mm: float, inclination_deg: float):
    """Ti6Al4V orthogonal data of Budak, Altintas, Armarego 1996, as in validation 8."""
    rake = math.radians(rake_deg)
    ratio = (1.755 - 0.028 * rake_deg) * chip_mm ** (0.331 - 0.0082 * rake_deg)
    shear = math.atan2(ratio * math.cos(rake), 1.0 - ratio * math.sin(rake))
    friction = math.radians(19.1 + 0.29 * rake_deg)
    return oblique_cutting_coefficients(613e6, friction, shear, rake, math.radians(inclination_deg))


@pytest.mark.parametrize(
    ("rake", "chip", "inclination", "expected"),
    [
        (0, 0.05, 30, (1774.9, 558.7, 652.2)),
        (5, 0.05, 30, (1655.5, 398.7, 590.5)),
        (10, 0.05, 30, (1549.3, 263.1, 535.4)),
        (10, 0.1, 30, (1541.4, 261.8, 532.7)),
        (15, 0.1, 30, (1448.3, 146.4, 483.7)),
        (0, 0.05, 0, (1730.9, 599.4, 0.0)),
        (10, 0.1, 0, (1540.5, 327.4, 0.0)),
    ],
)
def test_oblique_coefficients_of_titanium(rake, chip, inclination, expected):
    # printed to 0.1 MPa
    got = np.array(titanium(rake, chip, inclination)) / MPA
    assert got == pytest.approx(expected, abs=0.06)


def test_orthogonal_limit_is_merchant():
    # i = 0: Kt = tau cos(beta - alpha) / (sin(phi) cos(phi + beta - alpha))
    tau, beta, phi, alpha = 500e6, 0.5, 0.4, 0.1
    kt, kr, ka = oblique_cutting_coefficients(tau, beta, phi, alpha, 0.0)
    below = math.sin(phi) * math.cos(phi + beta - alpha)
    assert kt == pytest.approx(tau * math.cos(beta - alpha) / below)
    assert kr == pytest.approx(tau * math.sin(beta - alpha) / below)
    assert ka == 0.0


def test_linear_law_with_edges():
    law = LinearLaw((600e6, 200e6, 50e6), (10e3, 20e3, 1e3))
    assert law.force(0.1e-3) == pytest.approx([70e3, 40e3, 6e3])
    assert law.force(-1e-6) == pytest.approx([0.0, 0.0, 0.0])
    assert law.slope(np.array([1e-5, 1e-4])) == pytest.approx(
        np.array([[600e6] * 2, [200e6] * 2, [50e6] * 2])
    )


def test_exponential_law_meets_linear_at_exponent_one():
    linear = LinearLaw((600e6, 200e6, 50e6), (10e3, 20e3, 1e3))
    power = ExponentialLaw((600e6, 200e6, 50e6), 0.1e-3, 1.0, (10e3, 20e3, 1e3))
    h = np.geomspace(1e-6, 1e-3, 7)
    assert power.force(h) == pytest.approx(linear.force(h))
    assert power.slope(h) == pytest.approx(linear.slope(h))


def test_exponential_law_value_at_reference_and_slope():
    law = ExponentialLaw((600e6, 200e6, 50e6), 0.1e-3, 0.75)
    assert law.force(0.1e-3) == pytest.approx([60e3, 20e3, 5e3])
    # twice the chip: 2^0.75 of the force
    assert law.force(0.2e-3)[0] / 60e3 == pytest.approx(2**0.75)
    h = np.geomspace(1e-6, 1e-3, 9)
    step = 1e-6 * h
    difference = (law.force(h + step) - law.force(h - step)) / (2 * step)
    assert law.slope(h) == pytest.approx(difference, rel=1e-7)


def test_each_direction_of_the_exponential_law_has_its_own_exponent():
    law = ExponentialLaw((600e6, 200e6, 50e6), 0.1e-3, (0.9, 0.5, 1.0), (10e3, 20e3, 1e3))
    cutting = law.force(0.4e-3) - np.array([10e3, 20e3, 1e3])
    assert cutting == pytest.approx([60e3 * 4**0.9, 20e3 * 2.0, 5e3 * 4.0])
    h = np.geomspace(1e-6, 1e-3, 9)
    step = 1e-6 * h
    difference = (law.force(h + step) - law.force(h - step)) / (2 * step)
    assert law.slope(h) == pytest.approx(difference, rel=1e-6)
    # the slope that grows without bound is that of a direction that acts
    assert law.slope_power.lowest_exponent == pytest.approx(-0.5)
    silent = ExponentialLaw((600e6, 0.0, 50e6), 0.1e-3, (0.9, 0.5, 1.0))
    assert silent.slope_power.lowest_exponent == pytest.approx(-0.1)
    assert silent.slope_power.above_lowest == pytest.approx([0.0, 0.0, 0.1])
