"""Forces seen through the resonance of a dynamometer; wear and frequencies that shift."""

from __future__ import annotations

import numpy as np
import pytest

import chatter
from chatter.compile.structure import structure_of
from chatter.description.case import loads
from chatter.simulation.simulate import through_resonance

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
