"""Entry and exit angles against the drawing, removal rate against a catalogue formula."""

import math

import pytest

from cutting.engagement.immersion import cutting_speed, engagement, removal_rate


def test_half_immersion():
    assert engagement("up", 5e-3, 10e-3) == pytest.approx((0.0, math.pi / 2))
    assert engagement("down", 5e-3, 10e-3) == pytest.approx((math.pi / 2, math.pi))


def test_quarter_radius_immersion():
    # a_e = R/2: cos(arc) = 1 - a_e/R = 1/2
    assert engagement("up", 2.5e-3, 10e-3).exit == pytest.approx(math.pi / 3)
    assert engagement("down", 2.5e-3, 10e-3).entry == pytest.approx(2 * math.pi / 3)


def test_full_width_is_a_slot():
    assert engagement("up", 10e-3, 10e-3) == pytest.approx(engagement("slot", 10e-3, 10e-3))


@pytest.mark.parametrize("width", [0.0, -1e-3, 10.1e-3])
def test_impossible_width(width):
    with pytest.raises(ValueError, match="radial depth"):
        engagement("down", width, 10e-3)


def test_removal_rate_and_cutting_speed():
    # 10 000 rpm, 2 teeth, 0.1 mm: table feed 2000 mm/min; times 2 mm by 8 mm
    omega = 10_000 * math.pi / 30
    assert removal_rate(2e-3, 8e-3, 2, 1e-4, omega) * 6e7 == pytest.approx(32.0)
    assert cutting_speed(16e-3, omega) == pytest.approx(math.pi * 16e-3 * 10_000 / 60)
