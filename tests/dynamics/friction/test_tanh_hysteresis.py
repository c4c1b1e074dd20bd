"""Presliding hysteresis: the published branch, memory, loop areas, dissipation."""

import math

import numpy as np
import pytest

from dynamics.friction.tanh_hysteresis import (
    TanhHysteresis,
    tanh_advance,
    tanh_force,
    tanh_stored,
    tanh_table,
)

#: Table 1, X axis: linear guides and ball screw
GUIDE = TanhHysteresis(98.6, 856.2, 3000.0, 500.0, 1.15e4)
SCREW = TanhHysteresis(0.188, 3.2e-3, 0.03, 2.0, 1.15e4)
QUIET = TanhHysteresis(10.0, 0.0, 0.0, 0.0, 1.15e4)
A = QUIET.hysteresis_slope


def advance(law, *motions):
    for motion in motions:
        tanh_advance(law, 0, motion, 1.0)
    return law


def force(law):
    """Force now of a law without viscous part."""
    return tanh_force(law, 0, 0.0, 1.0)


def fresh(spec=QUIET):
    return tanh_table([spec], [0])


def log_cosh(u):
    return abs(u) + math.log1p(math.exp(-2.0 * abs(u))) - math.log(2.0)


def test_curve_from_rest_is_half_a_branch():
    for x in (-2e-4, -1e-6, 1e-6, 3e-5, 1e-4):
        assert force(advance(fresh(), x)) == pytest.approx(10.0 * math.tanh(2.0 * A * x), rel=1e-13)


def test_branch_after_sliding_is_the_published_one():
    """Equation 2: (2 tanh(ah x') - 1) sgn(v), nearly constant after some 300 um."""
    for way in (1e-6, 4e-5, 1e-4, 3e-4):
        law = advance(fresh(), 0.01, -way)
        expected = -10.0 * (2.0 * math.tanh(A * way) - 1.0)
        assert force(law) == pytest.approx(expected, abs=1e-12)
    assert force(advance(fresh(), 0.01, -3e-4)) == pytest.approx(-10.0, rel=5e-3)
    assert abs(force(advance(fresh(), 0.01, -1e-4))) < 7.0


@pytest.mark.parametrize(("spec", "speed"), [(GUIDE, 7e-3), (GUIDE, 0.1), (SCREW, 2.0)])
def test_sliding_force_is_the_published_curve(spec, speed):
    law = advance(fresh(spec), 0.01)
    decay = spec.low_speed_viscous * math.exp(-spec.low_speed_decay * speed)
    expected = spec.coulomb + (spec.viscous + decay) * speed
    assert tanh_force(law, 0, speed * 1e-3, 1e-3) == pytest.approx(expected, rel=1e-13)
    assert spec.steady_state_force(speed) == pytest.approx(expected, rel=1e-13)
    assert spec.steady_state_force(-speed) == pytest.approx(-expected, rel=1e-13)


def test_force_is_continuous_at_reversals():
    rng = np.random.default_rng(2)
    law = fresh()
    for motion in rng.normal(0.0, 5e-5, 500):
        advance(law, motion)
        for away in (1e-13, -1e-13):
            assert tanh_force(law, 0, away, 1.0) == pytest.approx(force(law), abs=1e-7)


def test_inner_loop_closes_and_is_forgotten():
    """The outer branch goes on as if the loop had never been run (return-point memory)."""
    plain = advance(fresh(), 1e-4, -3e-5)
    looped = advance(fresh(), 1e-4, -3e-5, 2e-5, -1e-5, 4e-6, -4e-6 - 1e-18, 1e-5, -2e-5)
    assert force(looped) == pytest.approx(force(plain), abs=1e-12)
    for _ in range(10):
        advance(plain, -7e-6)
        advance(looped, -7e-6)
        assert force(looped) == pytest.approx(force(plain), abs=1e-10)


def test_inner_loop_stays_within_the_outer_one():
    """A small reversal leaves the outer branch and meets it again where it left."""
    law = advance(fresh(), 0.01, -8e-5)
    outer = force(law)
    advance(law, 1e-5)
    assert force(law) == pytest.approx(outer + 20.0 * math.tanh(A * 1e-5), rel=1e-12)
    advance(law, -1e-5)
    assert force(law) == pytest.approx(outer, abs=1e-12)


def test_loop_around_rest_runs_back_onto_the_first_curve():
    x = 3e-5
    law = advance(fresh(), x, -2.0 * x)
    assert force(law) == pytest.approx(-10.0 * math.tanh(2.0 * A * x), rel=1e-12)
    advance(law, -x)
    assert force(law) == pytest.approx(-10.0 * math.tanh(4.0 * A * x), rel=1e-12)


def test_speed_does_not_matter_without_viscous_part():
    rng = np.random.default_rng(3)
    slow, fast = fresh(), fresh()
    for motion in rng.normal(0.0, 4e-5, 300):
        assert tanh_force(slow, 0, motion, 1.0) == tanh_force(fast, 0, motion, 1e-6)
        tanh_advance(slow, 0, motion, 1.0)
        tanh_advance(fast, 0, motion, 1e-6)


def test_splitting_a_motion_changes_nothing():
    rng = np.random.default_rng(6)
    whole, split = fresh(), fresh()
    for motion in rng.normal(0.0, 6e-5, 300):
        work = tanh_force(whole, 0, motion, 1.0) * motion
        advance(whole, motion)
        parts = motion * rng.dirichlet(np.ones(7))
        done = 0.0
        for part in parts:
            done += tanh_force(split, 0, part, 1.0) * part
            advance(split, part)
        assert done == pytest.approx(work, abs=1e-15)
        assert force(split) == pytest.approx(force(whole), abs=1e-9)


@pytest.mark.parametrize("amplitude", [2e-6, 3e-5, 2e-4])
def test_loop_area(amplitude):
    """Area 4 fc (ln cosh(2 a A) / a - A tanh(2 a A)), between two branches of length 2 A."""
    u = 2.0 * A * amplitude
    expected = 40.0 * (log_cosh(u) / A - amplitude * math.tanh(u))
    law = advance(fresh(), amplitude)
    area = 0.0
    for motion in np.concatenate([np.full(50, -amplitude / 25.0), np.full(50, amplitude / 25.0)]):
        area += tanh_force(law, 0, motion, 1.0) * motion
        advance(law, motion)
    assert area == pytest.approx(expected, rel=1e-9)
    omega = 2.0 * math.pi * 7.0
    stiffness, damping = QUIET.describing_function(amplitude, 7.0)
    assert damping * math.pi * amplitude**2 * omega == pytest.approx(expected, rel=1e-5)
    assert 0.0 < stiffness < QUIET.stiffness_at_rest(1.0).real


def test_small_motion_is_elastic():
    stiffness, damping = QUIET.describing_function(1e-9, 50.0)
    assert stiffness == pytest.approx(2.0 * A * 10.0, rel=1e-4)
    assert QUIET.stiffness_at_rest(50.0) == pytest.approx(2.0 * A * 10.0)
    assert damping * 100.0 * math.pi < 1e-4 * stiffness


def test_wide_motion_is_dry_friction():
    stiffness, damping = QUIET.describing_function(0.05, 2.0)
    assert damping == pytest.approx(40.0 / (math.pi * 0.05 * 4.0 * math.pi), rel=3e-3)
    assert stiffness * 0.05 < 0.1 * 10.0


def test_dynamic_stiffness_in_motion_is_the_slope_of_the_curve():
    v, d = 7e-3, 1e-8
    slope = (GUIDE.steady_state_force(v + d) - GUIDE.steady_state_force(v - d)) / (2.0 * d)
    moving = GUIDE.stiffness_in_motion(50.0, v)
    assert moving.real == 0.0
    assert moving.imag == pytest.approx(100.0 * math.pi * slope, rel=1e-6)


@pytest.mark.parametrize("spec", [GUIDE, SCREW, QUIET])
def test_no_energy_comes_out_of_random_motion(spec):
    rng = np.random.default_rng(12)
    law, stored = fresh(spec), 0.0
    scale = spec.coulomb / spec.hysteresis_slope
    for _ in range(4000):
        motion = rng.choice([-1, 1]) * 10.0 ** rng.uniform(-9, -3)
        h = 10.0 ** rng.uniform(-6, 0)
        work = tanh_force(law, 0, motion, h) * motion
        change = tanh_stored(law, 0, motion)
        assert work - change >= -1e-12 * scale
        stored += change
        assert stored >= -1e-12 * scale
        tanh_advance(law, 0, motion, h)
        assert abs(tanh_force(law, 0, 0.0, 1.0)) <= spec.coulomb * (1.0 + 1e-12)


def test_stored_energy_is_what_springs_and_sliders_hold():
    """Iwan's parallel springs and sliders of the same curve from rest, some 4000 of them."""
    u = np.linspace(0.0, 14.0, 4001)
    yields = 0.5 * (u[1:] + u[:-1]) / (2.0 * A)
    # stiffness that yields at x is -x-derivative of the slope of the curve
    springs = -np.diff(20.0 * A / np.cosh(u) ** 2)
    elastic = np.zeros_like(yields)
    rng = np.random.default_rng(13)
    law, stored = fresh(), 0.0
    for motion in rng.normal(0.0, 5e-5, 60):
        stored += tanh_stored(law, 0, motion)
        advance(law, motion)
        elastic = np.clip(elastic + motion, -yields, yields)
        assert force(law) == pytest.approx(np.sum(springs * elastic), abs=1e-4)
        assert stored == pytest.approx(0.5 * np.sum(springs * elastic**2), abs=1e-8)


@pytest.mark.parametrize("decay", [0.99, 0.9])
def test_more_reversals_than_are_remembered(decay):
    """A long decaying swing: the force stays that of springs and sliders, nothing jumps."""
    u = np.linspace(0.0, 14.0, 40001)
    yields = 0.5 * (u[1:] + u[:-1]) / (2.0 * A)
    springs = -np.diff(20.0 * A / np.cosh(u) ** 2)
    elastic, place = np.zeros_like(yields), 0.0
    law = fresh()
    targets = 8e-5 * decay ** np.arange(200) * (-1.0) ** np.arange(200)
    for target in [*targets, 5e-5, -9e-5, 2e-4]:
        advance(law, target - place)
        elastic = np.clip(elastic + target - place, -yields, yields)
        place = target
        assert force(law) == pytest.approx(np.sum(springs * elastic), abs=0.02 * 10.0)
    assert law.count[0] <= law.value.shape[1]


def test_left_and_right_are_alike():
    rng = np.random.default_rng(14)
    one, other = fresh(GUIDE), fresh(GUIDE)
    for motion in rng.normal(0.0, 4e-5, 500):
        assert tanh_force(one, 0, motion, 1e-3) == -tanh_force(other, 0, -motion, 1e-3)
        tanh_advance(one, 0, motion, 1e-3)
        tanh_advance(other, 0, -motion, 1e-3)


@pytest.mark.parametrize(
    ("name", "value"), [("coulomb", 0.0), ("hysteresis_slope", math.inf), ("viscous", -1.0)]
)
def test_bad_parameter_is_named(name, value):
    given = {"coulomb": 1.0, "viscous": 0.0, "low_speed_viscous": 0.0, "low_speed_decay": 0.0}
    given |= {"hysteresis_slope": 1e4, name: value}
    with pytest.raises(ValueError, match=f"{name} must be"):
        TanhHysteresis(**given)
