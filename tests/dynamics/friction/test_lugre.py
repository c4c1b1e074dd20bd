"""LuGre against published values, closed forms and the linearised law."""

import math

import numpy as np
import pytest

from dynamics.friction.lugre import LuGre, lugre_advance, lugre_energy, lugre_force, lugre_table

#: Canudas de Wit, Olsson, Astrom and Lischinsky 1995, Table I
PAPER = LuGre(1e5, math.sqrt(1e5), 0.4, 1.0, 1.5, 1e-3)
#: second published set, with a wide Stribeck curve
WIDE = LuGre(133.3e3, 600.0, 35.0, 5.0, 20.0, 0.07)
GUIDE = LuGre(4e7, 2e4, 300.0, 90.0, 140.0, 2e-3, 1.4, 8.0, 5e-3)


def slide(spec, motions, h, bent=0.0):
    law = lugre_table([spec], [0])
    law.deflection[0] = bent
    force = []
    for motion in motions:
        force.append(lugre_force(law, 0, motion, h))
        lugre_advance(law, 0, motion, h)
    return np.array(force), law


def test_steady_state_force_of_the_published_set():
    expected = {1e-4: 1.495064917, 1e-3: 1.184339721, 2e-3: 1.009957819, 5e-3: 1.002000000}
    for velocity, force in expected.items():
        assert PAPER.steady_state_force(velocity) == pytest.approx(force, abs=1e-9)
        assert PAPER.steady_state_force(-velocity) == pytest.approx(-force, abs=1e-9)
        reached, _ = slide(PAPER, [velocity * 1e-2] * 600, 1e-2)
        assert reached[-1] == pytest.approx(force, abs=1e-9)


def test_logarithmic_part_of_the_feed_axis_curve():
    v = 0.03
    expected = 90.0 + 50.0 * math.exp(-(15.0**1.4)) + 8.0 * math.log(7.0) + 300.0 * v
    assert GUIDE.steady_state_force(v) == pytest.approx(expected, rel=1e-13)
    reached, _ = slide(GUIDE, [v * 1e-3] * 5, 1e-3)
    assert reached[-1] == pytest.approx(expected, rel=1e-12)


def test_presliding_stiffness_is_that_of_the_bristle():
    force, law = slide(GUIDE, [1e-11] * 10, 1.0)
    assert force[-1] == pytest.approx(GUIDE.bristle_stiffness * 9.5e-11, rel=1e-3)
    assert lugre_energy(law, 0) == pytest.approx(0.5 * GUIDE.bristle_stiffness * 1e-20, rel=1e-3)


def test_presliding_curve_at_constant_speed():
    """z = g (1 - exp(-x / g)) (Dahl's curve), its mean over a step."""
    v, h = 1e-3, 1e-5
    g = GUIDE.sliding_force(v) / GUIDE.bristle_stiffness
    x = v * h * np.arange(2000)
    z = g * (1.0 - np.exp(-x / g))
    mean = g - g**2 / (v * h) * (np.exp(-x[:-1] / g) - np.exp(-x[1:] / g))
    expected = GUIDE.bristle_stiffness * mean + GUIDE.bristle_damping * np.diff(z) / h
    expected += GUIDE.viscous * v
    force, _ = slide(GUIDE, [v * h] * 1999, h)
    np.testing.assert_allclose(force, expected, rtol=1e-9)


def test_describing_function_of_small_motion_is_the_linearised_law():
    stiffness, damping = WIDE.describing_function(1e-9, 40.0)
    linear = WIDE.stiffness_at_rest(40.0)
    assert stiffness == pytest.approx(linear.real, rel=1e-3)
    # with the bristle's own slip, |v| z / g, of third order in the amplitude
    assert damping == pytest.approx(linear.imag / (80.0 * math.pi), rel=1e-3)


def test_describing_function_of_wide_motion_is_that_of_dry_friction():
    spec = LuGre(1e9, 0.0, 5.0, 10.0, 10.0, 1e-3)
    amplitude, frequency = 1e-2, 3.0
    omega = 2.0 * math.pi * frequency
    stiffness, damping = spec.describing_function(amplitude, frequency)
    assert damping == pytest.approx(40.0 / (math.pi * amplitude * omega) + 5.0, rel=1e-4)
    assert abs(stiffness) < 1e-3 * damping * omega


@pytest.mark.parametrize("spec", [WIDE, GUIDE])
@pytest.mark.parametrize("frequency", [2.0, 30.0])
def test_dynamic_stiffness_in_motion(spec, frequency):
    speed, count, cycles = 0.01, 2000, 3
    h = 1.0 / (frequency * count)
    t = h * np.arange(cycles * count + 1)
    small = 1e-4 * speed / (2.0 * math.pi * frequency)
    x = speed * t + small * np.sin(2.0 * np.pi * frequency * t)
    bent = float(spec.sliding_force(speed)) / spec.bristle_stiffness
    force, _ = slide(spec, np.diff(x), h, bent)
    middle = t[(cycles - 1) * count : -1] + 0.5 * h
    turn = np.exp(-2j * np.pi * frequency * middle)
    measured = 2j * np.mean(force[(cycles - 1) * count :] * turn) / small
    expected = spec.stiffness_in_motion(frequency, speed)
    assert abs(measured - expected) < 2e-3 * abs(expected)


def test_slow_dynamic_stiffness_in_motion_is_the_slope_of_the_curve():
    v, d = 0.02, 1e-7
    slope = (WIDE.steady_state_force(v + d) - WIDE.steady_state_force(v - d)) / (2.0 * d)
    low = WIDE.stiffness_in_motion(1e-6, v)
    assert low.imag / (2e-6 * math.pi) == pytest.approx(slope, rel=1e-5)
    assert slope < 0.0


@pytest.mark.parametrize("spec", [PAPER, WIDE, GUIDE, LuGre(1e9, 1e6, 0.0, 1.0, 5.0, 1e-3)])
def test_no_energy_comes_out_of_random_motion(spec):
    rng = np.random.default_rng(11)
    law = lugre_table([spec], [0])
    for _ in range(3000):
        h = 10.0 ** rng.uniform(-6, -2)
        motion = rng.choice([-1, 1]) * 10.0 ** rng.uniform(-12, -2)
        before = lugre_energy(law, 0)
        work = lugre_force(law, 0, motion, h) * motion
        lugre_advance(law, 0, motion, h)
        assert work - (lugre_energy(law, 0) - before) >= -1e-14 * (abs(work) + before)
        largest = spec.sliding_force([0.0, 1e4]).max() / spec.bristle_stiffness
        assert abs(law.deflection[0]) <= 2.0 * largest


def test_far_bent_bristle_never_pushes_along_a_sudden_motion():
    spec = LuGre(1e5, 1e5, 0.0, 1.0, 1.5, 1e-3)
    _, law = slide(spec, [1e-6] * 1000, 1.0)
    assert lugre_force(law, 0, 1e-5, 1e-5) == 0.0


@pytest.mark.parametrize(
    ("name", "value"),
    [("bristle_stiffness", 0.0), ("coulomb", -1.0), ("viscous", -0.1), ("static", math.nan)],
)
def test_bad_parameter_is_named(name, value):
    given = {
        "bristle_stiffness": 1e5,
        "bristle_damping": 0.0,
        "viscous": 0.0,
        "coulomb": 1.0,
        "static": 1.5,
        "stribeck_velocity": 1e-3,
        name: value,
    }
    with pytest.raises(ValueError, match=f"{name} must be"):
        LuGre(**given)
