"""Whole laws recovered along the motion, from forces made by other numerics."""

import math

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.identification.dynamic_fit import (
    AxisModel,
    fit_axis,
    friction_along,
    friction_over_position,
)
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.first_guess import guess_lugre, reversal_distance
from dynamics.friction.identification.linear_fit import fit_linear
from dynamics.friction.lugre import LuGre
from dynamics.friction.tanh_hysteresis import TanhHysteresis
from tests.dynamics.friction.identification.made_up_records import (
    lugre_friction,
    noisy,
    sine_motion,
)

GUIDE = LuGre(1.2e7, 0.0, 900.0, 120.0, 165.0, 4e-3)
MASS = 300.0
AMPLITUDE = 15e-3  # of the test machine's friction measurements
FEEDS = (1000.0, 3000.0)  # mm/min, at their peak
LOW_PASS = LowPass(100.0)


@pytest.fixture(scope="module")
def sine_records():
    rng = np.random.default_rng(1)
    records = []
    for feed in FEEDS:
        t, x, v, a = sine_motion(AMPLITUDE, feed / 60e3, 2, 1e-3)
        force = lugre_friction(GUIDE, AMPLITUDE, feed / 60e3, t) + MASS * a
        x = x + 1e-8 * rng.standard_normal(len(t))
        records.append(noisy(t, x, v, force, rng, effort_noise=2.0, velocity_noise=1e-5))
    return records


def test_lugre_is_recovered_from_sine_moves(sine_records):
    """Guess and all: linear fit, way of the reversal, then the whole law."""
    linear = fit_linear(sine_records, low_pass=LOW_PASS, minimum_speed=8e-3)
    way = reversal_distance(sine_records[0], linear, LOW_PASS)
    assert way == pytest.approx(GUIDE.static / GUIDE.bristle_stiffness * math.log(2.0), rel=0.5)
    guess = AxisModel(guess_lugre(linear, way, 1e-2), linear.value("inertia"))
    of_law = ("bristle_stiffness", "viscous", "coulomb", "static", "stribeck_velocity")
    fit = fit_axis(
        sine_records, guess, (*of_law, "inertia", "offset"), low_pass=LOW_PASS, settling=0.3
    )
    for name in of_law:
        assert getattr(fit.model.law, name) == pytest.approx(getattr(GUIDE, name), rel=0.02)
        assert fit.estimates[name].relative_error < 0.03
    assert fit.model.inertia == pytest.approx(MASS, rel=5e-3)
    assert fit.model.offset == pytest.approx(0.0, abs=0.1)
    assert fit.unsupported == ()
    assert fit.agreeing_starts >= 2


def test_friction_curve_over_position_has_the_sliding_force(sine_records):
    """Mid-stroke of the faster move: FC + s2 v."""
    position, friction = friction_over_position(sine_records[1], MASS, LOW_PASS)
    middle = np.abs(position) < 1e-3
    sliding = GUIDE.coulomb + GUIDE.viscous * 0.05
    assert np.mean(np.abs(friction[middle])) == pytest.approx(sliding, rel=5e-3)


def test_what_a_record_does_not_show_is_named():
    """Fast moves only, coarsely sampled: no word on the Stribeck velocity of a slow guide."""
    law = LuGre(1e9, 0.0, 200.0, 100.0, 100.0, 1e-5)
    t, x, v, a = sine_motion(AMPLITUDE, 0.2, 4, 2e-3)
    force = 100.0 * np.sign(v) + 200.0 * v + 50.0 * a
    rng = np.random.default_rng(2)
    record = noisy(t, x, v, force, rng, effort_noise=5.0, velocity_noise=1e-4)
    fit = fit_axis(
        [record],
        AxisModel(law, 50.0),
        ("coulomb", "viscous", "bristle_stiffness"),
        low_pass=LOW_PASS,
        minimum_speed=0.02,
        starts=2,
    )
    assert "bristle_stiffness" in fit.unsupported
    assert fit.model.law.coulomb == pytest.approx(100.0, rel=0.02)


#: coupled-milling paper, Table 1 (b), Y-axis
TABLE = TanhHysteresis(99.2, 426.7, 6000.0, 500.0, 1.15e4)


def test_hysteresis_slope_from_a_small_slow_circle():
    """Axis of a circle of 0.2 mm radius at 5 mm/min; force is the paper's eq. 2 itself."""
    feed, radius, step = 5.0 / 60e3, 0.2e-3, 5e-3
    t, x, v, a = sine_motion(radius, feed, 2, step)
    turned = np.where(v > 0, x + radius, radius - x)  # way since the reversal
    speed = np.abs(v)
    sliding = 99.2 + (426.7 + 6000.0 * np.exp(-500.0 * speed)) * speed
    force = sliding * (2.0 * np.tanh(1.15e4 * turned) - 1.0) * np.sign(v)
    rng = np.random.default_rng(5)
    record = noisy(t, x, v, force + 200.0 * a, rng, effort_noise=2.0, velocity_noise=1e-6)
    low_pass = LowPass(20.0)
    linear = fit_linear([record], ("coulomb",), low_pass=low_pass, minimum_speed=5e-5)
    way = reversal_distance(record, linear, low_pass)
    assert way == pytest.approx(math.atanh(0.5) / 1.15e4, rel=0.1)
    low = TABLE.viscous, TABLE.low_speed_viscous, 500.0
    guess = TanhHysteresis(linear.value("coulomb"), *low, math.atanh(0.5) / way)
    half = 0.5 * (t[-1] - t[0])  # the paper's branch begins at full sliding
    fit = fit_axis(
        [record],
        AxisModel(guess, 200.0),
        ("coulomb", "hysteresis_slope"),
        low_pass=low_pass,
        settling=half,
    )
    assert fit.model.law.hysteresis_slope == pytest.approx(TABLE.hysteresis_slope, rel=0.02)
    assert fit.model.law.coulomb == pytest.approx(TABLE.coulomb, rel=0.01)
    assert fit.unsupported == ()


def test_kernels_agree_with_a_stiff_integrator():
    t, x, _, _ = sine_motion(AMPLITUDE, 1000.0 / 60e3, 1, 1e-3)
    expected = lugre_friction(GUIDE, AMPLITUDE, 1000.0 / 60e3, t)
    found = friction_along(GUIDE, x, 1e-3)
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.02  # N, of 165


def test_bad_requests_are_told(sine_records):
    model = AxisModel(CoulombStribeck(1.0, 1.0, 1e-3, 0.0), MASS)
    with pytest.raises(ValueError, match="has no parameter 'bristle_stiffness'"):
        fit_axis(sine_records, model, ("bristle_stiffness",), low_pass=LOW_PASS)
    with pytest.raises(ValueError, match="viscous is to be fitted and needs a guess above 0"):
        fit_axis(sine_records, model, ("viscous",), low_pass=LOW_PASS)
    with pytest.raises(ValueError, match="no parameter is free"):
        fit_axis(sine_records, model, (), low_pass=LOW_PASS)
    with pytest.raises(MeasurementError, match="0 samples are judged"):
        fit_axis(sine_records, model, ("coulomb",), low_pass=LOW_PASS, minimum_speed=1.0)
    with pytest.raises(MeasurementError, match="none given"):
        fit_axis([], model, ("coulomb",), low_pass=LOW_PASS)
