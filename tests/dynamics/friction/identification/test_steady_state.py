"""Friction curves from moves at constant speed, and their two shares."""

import math

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.shares import referred_to_slide, split_about_shaft
from dynamics.friction.identification.steady_state import (
    SteadyPoint,
    constant_speed_points,
    fit_steady_state,
)
from dynamics.friction.lugre import LuGre
from dynamics.friction.tanh_hysteresis import TanhHysteresis
from tests.dynamics.friction.identification.made_up_records import back_and_forth, noisy

#: coupled-milling paper, Table 1: X-axis, rotational and translational
SCREW = TanhHysteresis(0.188, 3.2e-3, 0.03, 2.0, 1.15e4)
GUIDE = TanhHysteresis(98.6, 856.2, 3000.0, 500.0, 1.15e4)
SPEEDS = np.geomspace(0.05, 200.0, 16)  # rad/s


def points(curve, noise=0.0):
    rng = np.random.default_rng(4)
    speeds = np.concatenate((SPEEDS, -SPEEDS))
    efforts = curve(np.abs(speeds)) * np.sign(speeds) + noise * rng.standard_normal(len(speeds))
    return [SteadyPoint(v, f, 0.0, 0.0, 1.0) for v, f in zip(speeds, efforts, strict=True)]


def test_speed_part_of_the_published_torque_curve():
    """Eq. 1 in full sliding, X-axis, with noise of 1 mN m in each mean torque."""
    curve = points(lambda w: 0.188 + (3.2e-3 + 0.03 * np.exp(-2.0 * w)) * w, noise=2e-4)
    guess = TanhHysteresis(0.3, 1e-3, 0.1, 1.0, 1.15e4)
    names = ("coulomb", "viscous", "low_speed_viscous", "low_speed_decay")
    fit = fit_steady_state(curve, guess, names)
    assert fit.law.coulomb == pytest.approx(0.188, rel=2e-3)
    assert fit.law.viscous == pytest.approx(3.2e-3, rel=2e-3)
    assert fit.law.low_speed_viscous == pytest.approx(0.03, rel=0.15)
    assert fit.law.low_speed_decay == pytest.approx(2.0, rel=0.15)
    for name, true in (("low_speed_viscous", 0.03), ("low_speed_decay", 2.0)):
        assert fit.estimates[name].lower < true < fit.estimates[name].upper
    assert fit.law.hysteresis_slope == 1.15e4  # not asked for


def test_lugre_curve_with_logarithmic_part():
    """g(v) of eq. 18 of the test machine's paper and s2 v, exact."""

    def curve(w):
        stribeck = np.exp(-((w / 1.5) ** 1.3))
        return 3.0 + 2.0 * stribeck + 0.4 * np.log(w / 8.0 + 1.0) + 0.02 * w

    guess = LuGre(1e6, 0.0, 0.01, 2.0, 4.0, 1.0, 2.0, 0.1, 5.0)
    free = ("coulomb", "static", "stribeck_velocity", "stribeck_shape", "viscous",
            "logarithmic", "logarithmic_velocity")  # fmt: skip
    fit = fit_steady_state(points(curve), guess, free)
    truth = (3.0, 5.0, 1.5, 1.3, 0.02, 0.4, 8.0)
    for name, true in zip(free, truth, strict=True):
        assert getattr(fit.law, name) == pytest.approx(true, rel=1e-3)


def test_weight_is_told_from_friction():
    curve = points(lambda w: 5.0 + 3.0 * np.exp(-((w / 2.0) ** 2)) + 0.1 * w)
    lifted = [SteadyPoint(p.velocity, p.effort + 1.7, 0.0, 0.0, 1.0) for p in curve]
    guess = CoulombStribeck(4.0, 6.0, 1.0, 0.05)
    free = ("coulomb", "static", "stribeck_velocity", "viscous", "offset")
    fit = fit_steady_state(lifted, guess, free)
    found = (fit.law.coulomb, fit.law.static, fit.law.stribeck_velocity, fit.law.viscous)
    assert found == pytest.approx((5.0, 8.0, 2.0, 0.1), rel=1e-4)
    assert fit.offset == pytest.approx(1.7, rel=1e-4)
    with pytest.raises(MeasurementError, match="both directions"):
        fit_steady_state(lifted[:16], guess, free)
    with pytest.raises(MeasurementError, match="more points"):
        fit_steady_state(lifted[:4], guess, free[:4])


def test_constant_stretches_are_found_and_averaged():
    t, x, v, a = back_and_forth((0.01, 0.05, 0.2), 1.0, 1.0, 1e-3)
    ripple = 3.0 * np.sin(2 * math.pi * 17.0 * t)
    force = 40.0 * np.sign(np.round(v, 9)) + 100.0 * v + 200.0 * a + ripple
    record = noisy(t, x, v, force, np.random.default_rng(0), effort_noise=2.0, velocity_noise=2e-4)
    found = constant_speed_points(
        record, low_pass=LowPass(20.0), minimum_duration=0.5, settling=0.1, minimum_speed=5e-3
    )
    speeds = [0.01, -0.01, 0.05, -0.05, 0.2, -0.2]
    assert [p.velocity for p in found] == pytest.approx(speeds, rel=5e-3)
    expected = [40.0 * np.sign(s) + 100.0 * s for s in speeds]
    for point, effort in zip(found, expected, strict=True):
        assert point.effort == pytest.approx(effort, abs=0.5)
        assert point.end - point.start >= 0.5
        assert 0.0 < point.standard_error < 1.0
    with pytest.raises(MeasurementError, match="no segment of 5 s"):
        constant_speed_points(
            record, low_pass=LowPass(20.0), minimum_duration=5.0, settling=0.1, minimum_speed=5e-3
        )


def test_equal_share_gives_the_published_translational_friction():
    """X-axis: with equal shares, fct = fcb / lead and Ct = Cb / lead^2 at a pitch of 12 mm."""
    whole = TanhHysteresis(2 * SCREW.coulomb, 2 * SCREW.viscous, 0.06, 2.0, 1.15e4)
    screw, guide = split_about_shaft(whole, 12e-3 / (2 * math.pi))
    assert (screw.coulomb, screw.viscous) == pytest.approx((SCREW.coulomb, SCREW.viscous))
    assert guide.coulomb == pytest.approx(GUIDE.coulomb, rel=0.02)
    assert guide.viscous == pytest.approx(GUIDE.viscous, rel=0.03)


@pytest.mark.parametrize("law", [SCREW, LuGre(1e5, 3.0, 0.02, 2.0, 3.0, 0.1, 1.4, 0.2, 0.5),
                                 CoulombStribeck(2.0, 3.0, 0.1, 0.02)])  # fmt: skip
def test_both_shares_add_up_about_the_shaft(law):
    lead = 20e-3 / (2 * math.pi)
    screw, guide = split_about_shaft(law, lead, 0.3)
    speed = np.array([-20.0, 0.01, 3.0])
    together = screw.steady_state_force(speed) + lead * guide.steady_state_force(lead * speed)
    assert together == pytest.approx(law.steady_state_force(speed), rel=1e-12)
    assert screw.steady_state_force(speed) == pytest.approx(0.3 * law.steady_state_force(speed))
    if not isinstance(law, CoulombStribeck):
        at_rest = screw.stiffness_at_rest(5.0) + lead**2 * guide.stiffness_at_rest(5.0)
        assert at_rest == pytest.approx(law.stiffness_at_rest(5.0), rel=1e-12)


def test_shares_out_of_range():
    with pytest.raises(ValueError, match="rotational share"):
        split_about_shaft(SCREW, 1e-3, 1.0)
    with pytest.raises(ValueError, match="lead"):
        referred_to_slide(SCREW, 0.0)
