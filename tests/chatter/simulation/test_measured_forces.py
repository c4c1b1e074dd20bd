"""Forces seen through the resonance of a dynamometer; wear and frequencies that shift."""

from __future__ import annotations

import numpy as np
import pytest

import chatter
from chatter.compile.structure import structure_of
from chatter.description.case import loads
from chatter.description.errors import InputError
from chatter.simulation.simulate import as_measured, through_resonance

CASE = """
[tool]
kind = "end mill"
teeth = 2
diameter = "10 mm"
helix = "30 deg"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "200 MPa"
Kte = "20 N/mm"
Kre = "10 N/mm"
[cut]
mode = "slot"
spindle_speed = "6000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
[simulation]
revolutions = 3
"""
RESONANCE = {"frequency": 800.0, "damping": 0.1}


def test_a_sine_through_a_resonance_has_its_amplitude_and_phase():
    step, frequency, natural, damping = 1e-5, 300.0, 500.0, 0.05
    time = step * np.arange(60_000)
    force = np.sin(2.0 * np.pi * frequency * time)
    measured = through_resonance(force[:, None], natural, damping, step)[:, 0]
    ratio = frequency / natural
    transfer = 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)
    settled = slice(40_000, None)
    expected = np.imag(transfer * np.exp(2j * np.pi * frequency * time))
    assert measured[settled] == pytest.approx(expected[settled], abs=2e-4)


def test_a_force_that_sets_in_at_once_meets_a_sensor_at_rest():
    """A step and a ramp from the first row on, against their closed forms."""
    step, natural, damping = 4e-5, 1600.0, 0.03
    time = step * np.arange(500)
    omega = 2.0 * np.pi * natural
    damped, decay = omega * np.sqrt(1.0 - damping**2), np.exp(-damping * omega * time)
    cosine, sine = np.cos(damped * time), np.sin(damped * time)
    of_step = 1.0 - decay * (cosine + damping * omega / damped * sine)
    lag = 2.0 * damping / omega
    of_ramp = time - lag + decay * (lag * cosine + (damping * omega * lag - 1.0) / damped * sine)
    force = np.column_stack([np.ones(500), 3.0 + 2e3 * time])
    measured = through_resonance(force, natural, damping, step)
    assert measured[:, 0] == pytest.approx(of_step, abs=1e-9)
    assert measured[:, 1] == pytest.approx(3.0 * of_step + 2e3 * of_ramp, abs=1e-9)


def test_a_stiff_sensor_shows_the_force_itself():
    rng = np.random.default_rng(1)
    force = np.cumsum(rng.normal(size=(400, 3)), axis=0) * 1e-2
    measured = through_resonance(force, 2e5, 0.7, 1e-4)
    assert measured[2:] == pytest.approx(force[2:], abs=3e-2)


def test_wear_adds_to_the_edge_forces_with_cutting_time():
    case = loads(CASE)
    worn = case.patch(
        {
            "wear": {"edge_tangential": "2 N/mm/s", "edge_radial": 0.0, "cutting": 0.0},
            "cut.cut_time": "5 s",
        }
    )
    same = case.patch({"material.Kte": "30 N/mm"})
    assert chatter.simulate(worn).force == pytest.approx(chatter.simulate(same).force, abs=1e-9)
    fresh = worn.patch({"cut.cut_time": 0.0})
    assert chatter.simulate(fresh).force == pytest.approx(chatter.simulate(case).force, abs=1e-9)


def test_a_frequency_moves_with_the_spindle_speed():
    case = loads(
        CASE
        + '[[structure.mode]]\nfrequency = "500 Hz"\ndamping = 0.03\nmass = "1 kg"\n'
        + "direction = [1, 0, 0]\nfrequency_slope = -1e-4\n"
    )
    (mode,) = structure_of(case).modes
    assert mode.frequency == pytest.approx(500.0 * (1.0 - 1e-4 * 2.0 * np.pi * 100.0))
    assert mode.mass == pytest.approx(1.0)


def test_axes_of_a_sensor_have_resonances_of_their_own():
    """Two along x share the static force, one along y takes all of it, z is seen as it is."""
    rng = np.random.default_rng(2)
    rows = np.zeros((4000, 7))
    rows[:, :3] = np.cumsum(rng.normal(size=(4000, 3)), axis=0)
    resonance = [
        {"frequency": "800 Hz", "damping": 0.05, "axis": "x", "share": 0.7},
        {"frequency": "3 kHz", "damping": 0.02, "axis": "x", "share": 0.3},
        {"frequency": "1000 Hz", "damping": 0.04, "axis": "y"},
    ]
    case = loads(CASE).patch({"dynamometer": {"resonance": resonance}})
    seen = as_measured(case, rows, 1e-4)
    x, y = rows[:, :1], rows[:, 1:2]
    both = 0.7 * through_resonance(x, 800.0, 0.05, 1e-4)
    both += 0.3 * through_resonance(x, 3000.0, 0.02, 1e-4)
    np.testing.assert_allclose(seen[:, :1], both, atol=1e-9)
    np.testing.assert_allclose(seen[:, 1:2], through_resonance(y, 1000.0, 0.04, 1e-4), atol=1e-9)
    np.testing.assert_array_equal(seen[:, 2:], rows[:, 2:])


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ({"frequency": "900 Hz"}, "dynamometer.damping: is missing"),
        ({"frequency": "900 Hz", "damping": 0.1, "resonance": [RESONANCE]},
         "dynamometer.frequency: is given beside resonance"),
        ({"resonance": [RESONANCE] * 2}, "more than 1 together along x"),
    ],
)  # fmt: skip
def test_resonances_that_contradict_each_other_are_refused(section, words):
    with pytest.raises(InputError) as refused:
        loads(CASE).patch({"dynamometer": section})
    assert words in str(refused.value)
