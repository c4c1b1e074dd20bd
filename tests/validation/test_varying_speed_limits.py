"""Limits under a varying speed: periods that nearly fit, and limits between two of them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chatter.description.case import Case
from chatter.description.errors import RunError
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import growth_rate_at
from chatter.stability.methods.collocation.varying_limits import limits_of_varying_speed
from chatter.stability.model import milling_model
from chatter.stability.spindle_rotation import (
    PeriodFit,
    SpeedVariation,
    angle_at,
    spindle_rotation_at,
    time_at,
)

TOOTH = math.pi / 2.0


@given(
    ratio=st.floats(0.02, 600.0),
    least=st.sampled_from([20, 40, 150]),
    near=st.sampled_from([None, 1.0, 1.0 + 1e-6, 1.0 - 1e-4]),
)
@settings(max_examples=300, deadline=None)
def test_the_true_ratio_lies_between_two_that_meet_the_teeth_at_all_phases(ratio, least, near):
    if near:
        ratio = max(1, round(ratio)) * near
    speed = 300.0
    variation = SpeedVariation(0.1, speed / (ratio * TOOTH), 0)
    fit = PeriodFit(least_periods=least)
    fewer = spindle_rotation_at(variation, fit, speed, TOOTH)
    more = spindle_rotation_at(variation, fit._replace(beyond=1), speed, TOOTH)
    for turn in (fewer, more):
        assert turn.patterns >= 1
        assert math.gcd(turn.patterns, turn.cycles) == 1
        assert turn.frequency * turn.patterns * TOOTH == pytest.approx(turn.cycles * speed)
    low, high = (turn.patterns / turn.cycles for turn in (fewer, more))
    if near == 1.0:
        assert low == high == pytest.approx(ratio)
    else:
        assert low <= ratio * (1.0 + 1e-9) or fewer.patterns == 1
        assert high >= ratio * (1.0 - 1e-9)
        assert more.patterns >= least or low == high


@pytest.mark.parametrize("triangle", [0, 1])
@pytest.mark.parametrize("amplitude", [0.02, 0.3, 0.9])
def test_time_and_angle_are_inverse(triangle, amplitude):
    turn = spindle_rotation_at(SpeedVariation(amplitude, 7.0, triangle), PeriodFit(), 200.0, TOOTH)
    for angle in np.linspace(-3.0, 40.0, 301):
        assert angle_at(turn, time_at(turn, angle)) == pytest.approx(angle, abs=1e-12)


def varied(frequency, shape):
    def mode(hertz, damping, stiffness, direction):
        return {
            "frequency": hertz,
            "damping": damping,
            "stiffness": stiffness,
            "direction": direction,
        }

    return Case.from_dict(
        {
            "tool": {"teeth": 4, "diameter": "16 mm", "helix": "30 deg"},
            "material": {"Ktc": "1800 MPa", "Krc": "700 MPa", "Kac": "200 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": "2000 rpm",
                "feed_per_tooth": "0.08 mm",
                "axial_depth": "2 mm",
                "radial_depth": "8 mm",
                "speed_variation": {"amplitude": 0.1, "frequency": frequency, "shape": shape},
            },
            "structure": {
                "mode": [mode(900.0, 0.02, 2e7, [1, 0, 0]), mode(1010.0, 0.03, 2.2e7, [0, 1, 0])]
            },
        }
    )


def off_at(ratio, shape):
    """Stated error of a limit, and what a period that fits the true ratio says of it."""
    speed = 200.0
    model = milling_model(varied(speed / (ratio * TOOTH), shape))
    found = limits_of_varying_speed(
        lambda points, waves: element_cut(model, 4e-3, points, waves),
        np.array([speed]),
        np.linspace(0.0, 4e-3, 21)[1:],
        lambda done, total: None,
        1e-3,
    )
    limit = found.critical_depth[0]
    fitting = element_cut(model, 4e-3, 8, 1.0).with_fit(PeriodFit(tuning=1e-6))
    at = [
        growth_rate_at(fitting, np.array([speed]), np.array([limit * by]))[0]
        for by in (0.98, 1.0, 1.02)
    ]
    assert at[0] < 0.0 < at[2]
    return found.error, abs(at[1]) / ((at[2] - at[0]) / 0.04)


@pytest.mark.parametrize("shape", [pytest.param("triangle", marks=pytest.mark.nightly), "sine"])
def test_limits_are_those_of_a_period_that_fits(shape):
    """Next to ten tool periods a variation, growth is not that of just ten of them.

    In narrow windows of the ratio twice the chatter frequency is a combination of tooth passing and
    variation, and growth a little larger (9.955 to 9.98 for the triangle): of 6 ratios, 5.
    """
    ratios = [9 + 15 / 16, 10 + 1 / 16, 10.2, 12 + 5 / 13, 13 + 3 / 8, 16 + 3 / 17]
    stated, off = np.array([off_at(ratio, shape) for ratio in ratios]).T
    assert np.count_nonzero(off < np.maximum(1.5 * stated, 3e-4)) >= 5
    assert np.all(off < 5e-3)


def test_a_spindle_that_hardly_turns_is_refused():
    """1212 Hz, an element's wave, at a tooth a second."""
    model = milling_model(varied(2.0, "sine"))
    with pytest.raises(RunError, match=r"15 rpm .* 1.21e\+03 vibrations of 1212 Hz"):
        growth_rate_at(element_cut(model, 4e-3), np.array([2.0 * math.pi / 4.0]), np.array([1e-3]))


def test_a_variation_that_hardly_repeats_is_refused():
    model = milling_model(varied(0.05, "sine"))
    with pytest.raises(RunError, match=r"speed_variation.frequency: at 0.05 Hz .* constant speeds"):
        growth_rate_at(element_cut(model, 4e-3), np.array([200.0]), np.array([1e-3]))
