"""Dry friction against Den Hartog's and Lorenz' results for an oscillator, and its own curve."""

import math

import numpy as np
import pytest

from dynamics.friction.coulomb_stribeck import (
    CoulombStribeck,
    coulomb_stribeck_advance,
    coulomb_stribeck_force,
    coulomb_stribeck_step,
    coulomb_stribeck_table,
)

MASS, SPRING, DRY = 2.0, 800.0, 4.0
OMEGA = math.sqrt(SPRING / MASS)


def swing(spec, h, count, place, rate=0.0, load=0.0):
    """Mass on a spring: exact step under held forces."""
    law = coulomb_stribeck_table([spec], [0])
    c, s = math.cos(OMEGA * h), math.sin(OMEGA * h) / OMEGA
    gx, g = (1.0 - c) / SPRING, s / MASS
    out = np.empty((count, 3))
    for j in range(count):
        free = place * c + rate * s + gx * load
        end = rate * c - place * OMEGA**2 * s + g * load
        force, motion = coulomb_stribeck_step(law, 0, free - place, gx, end, g, h)
        coulomb_stribeck_advance(law, 0, motion, h)
        place, rate = free - gx * force, end - g * force
        out[j] = place, rate, force
    return out


def test_amplitude_falls_by_the_same_amount_every_cycle():
    """4 FC / k a cycle, in the undamped period (Lorenz 1924)."""
    n = 400
    h = 2.0 * math.pi / OMEGA / n
    out = swing(CoulombStribeck(DRY, DRY, 1e-3), h, 5 * n, 0.12)
    peaks = out[n - 1 :: n, 0]
    np.testing.assert_allclose(peaks, 0.12 - 4.0 * DRY / SPRING * np.arange(1, 6), atol=3e-6)


@pytest.mark.parametrize("h", [1e-4, 1e-3, 1e-2, 0.1])
def test_oscillator_comes_to_rest_within_the_dead_zone(h):
    out = swing(CoulombStribeck(DRY, DRY, 1e-3), h, int(3.0 / h), 0.0437)
    assert abs(out[-1, 0]) <= DRY / SPRING * (1.0 + 1e-9)
    assert abs(out[-1, 1]) < 1e-12
    assert out[-1, 2] == pytest.approx(-SPRING * out[-1, 0], rel=1e-6)


def test_rest_place_of_fine_steps():
    """From 0.0437: turns at -0.0337, 0.0237, -0.0137, then stops at 0.0037."""
    out = swing(CoulombStribeck(DRY, DRY, 1e-3), 1e-4, 15000, 0.0437)
    assert out[-1, 0] == pytest.approx(0.0037, abs=2e-6)


@pytest.mark.parametrize("h", [1e-6, 1e-4, 1e-2])
def test_force_below_breakaway_moves_nothing(h):
    spec = CoulombStribeck(2.0, 3.0, 1e-3)
    held = swing(spec, h, 500, 0.0, load=2.999)
    np.testing.assert_allclose(held[:, :2], 0.0, atol=1e-17)
    np.testing.assert_allclose(held[:, 2], 2.999, rtol=1e-12)
    assert swing(spec, h, 500, 0.0, load=3.001)[-1, 0] > 0.0


def test_sliding_mass_keeps_sliding_where_rest_would_also_be_an_answer():
    """A falling force has two answers in a coarse step; the motion goes on."""
    spec = CoulombStribeck(1.0, 5.0, 1e-3)
    law = coulomb_stribeck_table([spec], [0])
    coulomb_stribeck_advance(law, 0, 1e-3, 1e-3)
    gx, g = 1e-4, 0.2
    force, motion = coulomb_stribeck_step(law, 0, 4e-4, gx, 1.0, g, 1e-3)
    assert force == pytest.approx(1.0, rel=1e-9)
    assert motion == pytest.approx(3e-4, rel=1e-9)
    coulomb_stribeck_advance(law, 0, 0.0, 1e-3)
    force, motion = coulomb_stribeck_step(law, 0, 4e-4, gx, 0.8, g, 1e-3)
    assert force == pytest.approx(4.0, rel=1e-9)
    assert motion == 0.0


def test_sliding_on_a_slope_that_friction_balances_later():
    """Free mass under friction alone stops after M v^2 / (2 FC) and M v / FC."""
    law = coulomb_stribeck_table([CoulombStribeck(3.0, 3.0, 1e-3)], [0])
    h, mass, place, rate = 1e-3, 0.5, 0.0, 0.37
    for _ in range(200):
        force, motion = coulomb_stribeck_step(
            law, 0, rate * h, 0.5 * h * h / mass, rate, h / mass, h
        )
        coulomb_stribeck_advance(law, 0, motion, h)
        place += rate * h - 0.5 * h * h / mass * force
        rate -= h / mass * force
    assert rate == pytest.approx(0.0, abs=1e-15)
    assert place == pytest.approx(mass * 0.37**2 / 6.0, abs=0.5 * h * h * 3.0 / mass)


def test_curve_and_its_slope():
    spec = CoulombStribeck(1.0, 1.5, 2e-3, 30.0, 1.3)
    v = 3e-3
    expected = 1.0 + 0.5 * math.exp(-(1.5**1.3)) + 30.0 * v
    assert spec.steady_state_force(v) == pytest.approx(expected, rel=1e-14)
    assert spec.steady_state_force(-v) == pytest.approx(-expected, rel=1e-14)
    assert spec.steady_state_force(0.0) == 0.0
    law = coulomb_stribeck_table([spec], [0])
    assert coulomb_stribeck_force(law, 0, v * 0.1, 0.1) == pytest.approx(expected, rel=1e-14)
    d = 1e-9
    slope = (spec.steady_state_force(v + d) - spec.steady_state_force(v - d)) / (2.0 * d)
    assert spec.stiffness_in_motion(5.0, v).imag == pytest.approx(10.0 * math.pi * slope, rel=1e-6)


def test_describing_function():
    """4 FC / (pi A w) + c, and no stiffness (Den Hartog 1931)."""
    amplitude, frequency = 0.02, 3.0
    stiffness, damping = CoulombStribeck(5.0, 5.0, 1e-3, 7.0).describing_function(
        amplitude, frequency
    )
    peak = 2.0 * math.pi * frequency * amplitude
    assert stiffness == 0.0
    assert damping == pytest.approx(20.0 / (math.pi * peak) + 7.0, rel=1e-6)


@pytest.mark.parametrize(("name", "value"), [("coulomb", -1.0), ("stribeck_velocity", 0.0)])
def test_bad_parameter_is_named(name, value):
    given = {"coulomb": 1.0, "static": 1.0, "stribeck_velocity": 1e-3, name: value}
    with pytest.raises(ValueError, match=f"{name} must be"):
        CoulombStribeck(**given)
