"""The blind generator of axis sets against the balance of forces."""

import numpy as np
import pytest

from benchmarks.blind_sets import axis as sets
from benchmarks.blind_sets.axis_physics import SAMPLING, Axis, resistance

PLAIN = Axis(mass=150.0, viscous=900.0, coulomb=100.0)
STEP = 1.0 / SAMPLING


def moved(axis, command):
    position, velocity, force = sets.motions(axis, [command])[0].T
    return position, velocity, force


def test_force_is_inertia_and_friction():
    position, velocity, force = moved(PLAIN, sets.sine(30e-3, 50e-3, 1.5))
    expected = 150.0 * np.gradient(velocity, STEP) + 900.0 * velocity + 100.0 * np.sign(velocity)
    steady = np.abs(velocity) > 1e-3
    # the acceleration is a difference over two samples
    np.testing.assert_allclose(force[steady], expected[steady], atol=1.0)
    np.testing.assert_allclose(np.gradient(position, STEP)[5:], velocity[5:], atol=5e-5)


def test_effects_of_steady_motion_by_hand():
    axis = PLAIN._replace(offset=7.0, asymmetry=5.0, quadratic_drag=1e4, above=50.0)
    axis = axis._replace(stribeck_velocity=0.01)
    bump = 50.0 * np.exp(-((0.02 / 0.01) ** 2))
    there = 900 * 0.02 + 100 + bump + 7 + 5 + 1e4 * 0.02**2
    back = -900 * 0.02 - 100 - bump + 7 + 5 - 1e4 * 0.02**2
    assert resistance(axis, 0.0, 0.02) == pytest.approx(there)
    assert resistance(axis, 0.0, -0.02) == pytest.approx(back)
    warm = PLAIN._replace(warm_up_share=0.5, warm_up_time=10.0)
    more = 0.5 * np.exp(-1.0) * 900 * 0.02
    assert resistance(warm, 0.0, 0.02, 10.0) == pytest.approx(900 * 0.02 + 100 + more)


def test_a_bristle_is_a_spring_before_it_slides():
    stiffness = 100.0 / 50e-6
    axis = PLAIN._replace(bristle_stiffness=stiffness, bristle_damping=2000.0, viscous=0.0)
    ramp = np.linspace(0.0, 3e-6, 1000)
    position, _, force = moved(axis, ramp)
    # dz/dx = 1 - sigma z / F: z = F/sigma (1 - exp(-sigma x/F)), and the damping adds little
    expected = 100.0 * (1.0 - np.exp(-position[500:] / 50e-6))
    np.testing.assert_allclose(force[500:], expected, atol=0.3)


def test_backlash_keeps_the_slide_behind_the_motor():
    axis = PLAIN._replace(backlash=40e-6)
    position, velocity, _ = moved(axis, sets.sine(10e-3, 20e-3, 2.0))
    motor = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * STEP)])
    behind = motor - position
    forth, back = behind[600], behind[1300]
    assert forth - back == pytest.approx(40e-6, abs=8e-6)  # and the spring beyond the gap


def test_a_set_holds_no_truth(tmp_path):
    sets.write_set(tmp_path, 1001, np.random.default_rng(4), "stribeck")
    place = tmp_path / "set-1001"
    assert {p.name for p in place.glob("*.toml")} == {"case.toml", "measurement.toml"}
    assert "stribeck" not in "".join(p.read_text() for p in place.glob("*.toml"))
    assert len(list(place.glob("move*.csv"))) == 8
    assert len(list((tmp_path / "truth/set-1001/unseen").glob("*.csv"))) == 2
