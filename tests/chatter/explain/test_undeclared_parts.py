"""What a case leaves out as a whole: the structure of a tool, the axial coefficients."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.blind_sets.milling_physics import TURN, Cut, Plant, run
from chatter.description.case import loads
from chatter.explain.effects.missing_mode import MissingMode
from chatter.explain.effects.structure import ModeShift
from chatter.explain.effects.tool import Runout
from chatter.explain.explanation import explain
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection import candidates

RADIUS, HELIX, SLICES = 5e-3, math.radians(30.0), 100
CASE = """
title = "a slot"
[tool]
teeth = 2
diameter = "10 mm"
helix = "30 deg"
[material]
Ktc = "810 MPa"
Krc = "196 MPa"
Kte = "20.5 N/mm"
Kre = "29.5 N/mm"
[cut]
mode = "slot"
spindle_speed = "6000 rpm"
feed_per_tooth = "0.06 mm"
axial_depth = "0.5 mm"
[simulation]
steps = 480
"""
#: speed, rpm, axial depth, m, and feed, m
CUTS = ((5100.0, 0.5e-3, 0.06e-3), (6350.0, 0.4e-3, 0.08e-3), (8600.0, 0.6e-3, 0.05e-3))


def explained_of(runs, folder):
    case = loads(CASE, "case.toml")
    return explain(Measurement("milling", "cuts", folder, case, tuple(runs)))


@pytest.fixture
def modes_alone(monkeypatch):
    """A structure, and runout beside it."""
    effects = (*MissingMode().variants, Runout())

    def of(measurement):
        return [one for one in effects if one.applies(measurement)]

    monkeypatch.setattr(candidates, "candidates", of)


@pytest.mark.usefixtures("modes_alone")
def test_modes_of_a_tool_that_was_taken_as_rigid(tmp_path):
    """Forces alone, of another program, at three speeds."""
    random, runs = np.random.default_rng(4), []
    plant = Plant(
        RADIUS, math.tan(HELIX) / RADIUS, np.arange(2) * TURN / 2, np.ones(2),
        np.array([640.0, 870.0]), np.array([0.03, 0.04]), np.array([0.5, 0.3]), np.eye(2),
        800e6, 200e6, 20e3, 30e3,
    )  # fmt: skip
    for number, (rpm, depth, feed) in enumerate(CUTS):
        speed = rpm * TURN / 60.0
        made = run(plant, Cut(speed, feed, depth, 2 * RADIUS, 0.0, math.pi, 0.0), 6 * TURN / speed)
        forces = made.channels[:2]
        forces = forces + 0.005 * np.std(forces) * random.standard_normal(forces.shape)
        signals = {"time": made.time, "spindle_angle": made.angle, "Fx": forces[0], "Fy": forces[1]}
        overrides = {
            "cut.spindle_speed": f"{rpm} rpm",
            "cut.axial_depth": depth,
            "cut.feed_per_tooth": feed,
        }
        runs.append(Run(f"run{number + 1}.csv", overrides, signals))
    found = explained_of(runs, tmp_path).summary()
    (effect,) = found["effects"]
    assert (found["verdict"], effect["name"]) == ("explained", "missing_mode")
    numbers = {name: one["value"] for name, one in effect["parameters"].items()}
    assert numbers["frequency_x"] == pytest.approx(640.0, rel=0.02)
    assert numbers["frequency_y"] == pytest.approx(870.0, rel=0.02)
    assert numbers["mass_x"] == pytest.approx(0.5, rel=0.1)
    assert numbers["mass_y"] == pytest.approx(0.3, rel=0.1)


def axial_runs(cutting, edge):
    """Forces of a rigid tool in a slot, by hand: sums over slices of the edge."""
    random, runs = np.random.default_rng(9), []
    for number, (rpm, depth, feed) in enumerate(CUTS):
        speed = rpm * TURN / 60.0
        time = np.arange(0.0, 8 * TURN / speed, 1e-4)
        # heights along the edge lag; two teeth: one cuts at every height
        height = (np.arange(SLICES)[:, None] + 0.5) / SLICES * depth
        angle = (speed * time - height * math.tan(HELIX) / RADIUS) % math.pi
        chip = feed * np.sin(angle)
        tangential, radial = 800e6 * chip + 20e3, 200e6 * chip + 30e3
        per_depth = np.array([
            -tangential * np.cos(angle) - radial * np.sin(angle),
            tangential * np.sin(angle) - radial * np.cos(angle),
            cutting * chip + edge,
        ])  # fmt: skip
        forces = depth * per_depth.mean(axis=1)
        forces += 0.02 * np.std(forces[:2]) * random.standard_normal(forces.shape)
        signals = {"time": time, "spindle_angle": speed * time}
        signals |= dict(zip(("Fx", "Fy", "Fz"), forces, strict=True))
        overrides = {
            "cut.spindle_speed": f"{rpm} rpm",
            "cut.axial_depth": depth,
            "cut.feed_per_tooth": feed,
        }
        runs.append(Run(f"run{number + 1}.csv", overrides, signals))
    return runs


def test_axial_coefficients_that_nobody_declared_are_fitted(tmp_path):
    explained = explained_of(axial_runs(250e6, 12e3), tmp_path)
    found = explained.summary()
    assert found["verdict"] == "nothing-missing"
    assert any("material.Kac and material.Kae" in one["description"] for one in found["checks"])
    assert explained.case.material.Kac == pytest.approx(250e6, rel=0.03)
    assert explained.case.material.Kae == pytest.approx(12e3, rel=0.05)


def test_an_axial_channel_that_holds_noise_asks_for_no_coefficients(tmp_path):
    found = explained_of(axial_runs(0.0, 0.0), tmp_path).summary()
    assert found["verdict"] == "nothing-missing"
    assert not any("Kac" in one["description"] for one in found["checks"])


def test_a_shift_with_the_speed_asks_for_speeds_that_are_apart(tmp_path):
    """Speeds found in records of one nominal speed differ by some hundredths of an rpm."""
    mode = '[[structure.mode]]\nfrequency = "800 Hz"\ndamping = 0.03\nmass = "0.5 kg"\n'
    case = loads(CASE + mode + "direction = [1, 0, 0]\n", "case.toml")

    def applies(*speeds):
        runs = [Run(f"{rpm}.csv", {"cut.spindle_speed": f"{rpm} rpm"}, {}) for rpm in speeds]
        return ModeShift().applies(Measurement("milling", "m", tmp_path, case, tuple(runs)))

    assert not applies(5999.79, 5999.75, 5999.57)
    assert not applies(6000.0, 6003.0, 8000.0)
    assert applies(5000.0, 6000.0, 8000.0)
