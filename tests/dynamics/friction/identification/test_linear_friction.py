"""Linear least squares: the published table recovered from records with noise."""

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.linear_fit import fit_linear
from tests.dynamics.friction.identification.made_up_records import back_and_forth, noisy

#: "Towards digital twins through object-oriented modelling: a machine tool case study", Table 1:
#: static torque, N m; dynamic coefficient, N m s; inertia, kg m^2
TABLE = {"Y": (3.57, 0.0105, 0.192), "Z": (3.87, 0.075, 0.0272)}
WEIGHT = 0.6
LOW_PASS = LowPass(50.0)


def torque_record(axis, seed, **noise):
    static, viscous, inertia = TABLE[axis]
    t, x, v, a = back_and_forth((20.0, 60.0, 120.0), 400.0, 0.3, 1e-3)
    torque = static * np.sign(np.round(v, 9)) + viscous * v + inertia * a + WEIGHT
    rng = np.random.default_rng(seed)
    return noisy(t, x, v, torque, rng, **({"effort_noise": 0.3, "velocity_noise": 0.1} | noise))


@pytest.mark.parametrize("axis", TABLE)
def test_published_table_is_recovered_within_its_intervals(axis):
    inside, found = [], []
    truth = dict(zip(("coulomb", "viscous", "inertia"), TABLE[axis], strict=True))
    for seed in range(20):
        fit = fit_linear([torque_record(axis, seed)], low_pass=LOW_PASS, minimum_speed=1.0)
        inside += [
            fit.estimates[n].lower <= true <= fit.estimates[n].upper for n, true in truth.items()
        ]
        found.append([fit.value(name) / true for name, true in truth.items()])
        assert fit.value("offset") == pytest.approx(WEIGHT, abs=0.05)
    assert np.mean(inside) > 0.9  # of 95 % intervals
    assert np.all(np.abs(np.array(found) - 1.0) < 0.06)
    assert np.mean(found, axis=0) == pytest.approx(1.0, abs=0.01)  # no bias


def test_intervals_are_not_wide_for_nothing():
    fits = [
        fit_linear(
            [torque_record("Z", seed, velocity_noise=0.0)], low_pass=LOW_PASS, minimum_speed=1.0
        )
        for seed in range(30)
    ]
    for name in ("coulomb", "viscous", "inertia"):
        scatter = np.std([fit.value(name) for fit in fits], ddof=1)
        promised = np.mean([fit.estimates[name].standard_error for fit in fits])
        assert promised == pytest.approx(scatter, rel=0.4)


def test_effort_filtered_alone_would_bias_but_the_same_filter_does_not():
    """Without noise the same linear filter on both sides leaves the terms exact."""
    record = torque_record("Y", 0, effort_noise=0.0, velocity_noise=0.0)
    fit = fit_linear([record], low_pass=LowPass(8.0), minimum_speed=0.1)
    assert fit.value("coulomb") == pytest.approx(3.57, rel=2e-3)
    assert fit.value("viscous") == pytest.approx(0.0105, rel=1e-2)
    assert fit.value("inertia") == pytest.approx(0.192, rel=1e-3)


def test_noise_in_velocity_is_told_as_attenuation():
    """The inertia is too small by about the share of noise in the acceleration."""
    record = torque_record("Y", 3, velocity_noise=1.0)
    fit = fit_linear([record], low_pass=LowPass(100.0), minimum_speed=5.0)
    assert 0.05 < fit.attenuation < 0.9
    short = 1.0 - fit.value("inertia") / 0.192
    assert short == pytest.approx(fit.attenuation, rel=0.3)
    quiet = fit_linear([record], low_pass=LowPass(15.0), minimum_speed=5.0)
    assert quiet.attenuation < 0.01
    assert quiet.value("inertia") == pytest.approx(0.192, rel=0.02)


def test_each_direction_with_a_law_of_its_own():
    t, x, v, a = back_and_forth((20.0, 60.0), 400.0, 0.3, 1e-3)
    way = np.sign(np.round(v, 9))
    torque = np.where(way > 0, 3.0, 5.0) * way + 0.02 * v + 0.1 * a
    record = noisy(t, x, v, torque, np.random.default_rng(1), effort_noise=0.1, velocity_noise=0.0)
    fit = fit_linear(
        [record],
        ("inertia", "viscous", "coulomb_forward", "coulomb_backward"),
        low_pass=LOW_PASS,
        minimum_speed=1.0,
    )
    assert fit.value("coulomb_forward") == pytest.approx(3.0, rel=0.02)
    assert fit.value("coulomb_backward") == pytest.approx(5.0, rel=0.02)
    assert fit.effort(np.array([10.0]), np.zeros(1)) == pytest.approx(3.2, rel=0.02)


def test_terms_that_the_motion_cannot_tell_apart_are_named():
    record = torque_record("Z", 0).part(0.05, 0.3)  # one way only
    with pytest.raises(MeasurementError, match="coulomb and offset"):
        fit_linear([record], ("coulomb", "offset"), low_pass=LOW_PASS, minimum_speed=1.0)


def test_unknown_and_repeated_terms():
    record = torque_record("Z", 0)
    with pytest.raises(ValueError, match="no term 'mass'"):
        fit_linear([record], ("mass",), low_pass=LOW_PASS, minimum_speed=1.0)
    with pytest.raises(ValueError, match="each term once"):
        fit_linear(
            [record], ("inertia",), low_pass=LOW_PASS, minimum_speed=1.0, fixed={"inertia": 1.0}
        )
    with pytest.raises(MeasurementError, match="move faster"):
        fit_linear([record], low_pass=LOW_PASS, minimum_speed=1e3)
