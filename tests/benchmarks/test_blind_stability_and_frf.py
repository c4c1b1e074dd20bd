"""The blind generators of stability and FRF sets against closed forms."""

import math

import numpy as np
import pytest

from benchmarks.blind_sets import frf, stability
from benchmarks.blind_sets.machines import draw_machine
from benchmarks.blind_sets.stability_physics import LinearCut, limit_depth

FREQUENCY, RATIO, MASS, KRC = 500.0, 0.03, 1.0, 400e6


def test_limit_depth_of_a_slot_with_four_straight_teeth():
    """Two teeth are always in the cut and add up to a force that does not vary: Fx = -Krc b dx.

    With one mode along x, Tlusty's least limit is b = 2 k D (1 + D)/Krc, at w = wn sqrt(1 + 2 D).
    """
    cut = LinearCut(
        4, 8e-3, 0.0, math.pi, 1000e6, KRC, 0.0, 0.0,
        np.array([FREQUENCY, 450.0]), np.array([RATIO, 0.05]), np.array([MASS, 1e6]), np.eye(2),
    )  # fmt: skip
    natural = 2.0 * math.pi * FREQUENCY
    least = 2.0 * MASS * natural**2 * RATIO * (1.0 + RATIO) / KRC
    w = natural * math.sqrt(1.0 + 2.0 * RATIO)
    answer = 1.0 / (MASS * (natural**2 - w**2 + 2j * RATIO * natural * w))
    # exp(-i w T) = 1 + 1/(b Krc G)
    turned = -np.angle(1.0 + 1.0 / (least * KRC * answer)) % (2.0 * math.pi)
    speed = 2.0 * math.pi / (4 * (turned + 2.0 * math.pi * 2) / w)
    start = np.array([1e-6, 0.0, 1e-9, 0.0])
    # halving stops within 0.2 %; the growth is looked at over a finite time
    assert limit_depth(cut, speed, 20e-3, start) == pytest.approx(least, rel=0.01)


def test_ploughing_raises_the_limit():
    rng = np.random.default_rng(1)
    machine = draw_machine(rng, ("steel",))
    start = np.array([1e-6, 0.0, 1e-6, 0.0])
    limits = []
    for coefficient in (0.0, 5e5):
        truth = stability.Truth("process_damping", ploughing=coefficient, highest=250.0)
        cut = stability.cut_at(machine, truth, "down", 10e-3, 120.0)
        limits.append(limit_depth(cut, 120.0, 80e-3, start))
    assert limits[1] > 1.3 * limits[0]


def test_receptance_at_rest_and_contact_as_a_spring_beside_it():
    machine = draw_machine(np.random.default_rng(2), ("face",))
    along = machine.direction[:, 1] > 0.5
    stiffness = machine.mass * (2.0 * np.pi * machine.frequency) ** 2
    flexibility = float(np.sum(1.0 / stiffness[along]))
    w = np.array([1e-6])
    values = {"stiffness": 5e6, "damping": 1e4}
    idle = frf.measured(w, machine, 1, False, "contact", values)[0]
    in_cut = frf.measured(w, machine, 1, True, "contact", values)[0]
    assert idle.real == pytest.approx(flexibility)
    assert in_cut.real == pytest.approx(1.0 / (1.0 / flexibility + 5e6))


def test_a_set_of_taps_holds_no_truth(tmp_path):
    frf.write_set(tmp_path, 3001, np.random.default_rng(4), "contact")
    place = tmp_path / "set-3001"
    assert {p.name for p in place.glob("*.toml")} == {"case.toml", "measurement.toml"}
    assert "contact" not in "".join(p.read_text() for p in place.glob("*.toml"))
    assert len(list(place.glob("*.csv"))) == 12
