"""What cuts of another program lack is named, and nothing beside it; few effects are asked for.

What searches have failed at: a shift of one mode by the square of the speed, a missing mode with
runout or alone, wear of everything, runout of two teeth.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.blind_sets.milling_physics import TURN, Cut, Plant, arc_of, run
from chatter.description.case import loads
from chatter.explain.effects.cutting_force import ProcessDamping
from chatter.explain.effects.missing_mode import MissingMode
from chatter.explain.effects.structure import ModeShift
from chatter.explain.effects.tool import Runout, Wear
from chatter.explain.explanation import explain
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection import candidates

RADIUS, LAG = 5e-3, math.tan(math.radians(30.0)) / 5e-3
MODES = (700.0, 820.0)
#: speed, rpm, radial and axial depth, feed, m, and cut time before, s
CUTS = (
    (5000.0, 3e-3, 0.8e-3, 0.06e-3, 0.0),
    (8000.0, 5e-3, 0.5e-3, 0.05e-3, 5.0),
    (6100.0, 2e-3, 1.0e-3, 0.08e-3, 10.0),
    (9500.0, 4e-3, 0.5e-3, 0.07e-3, 15.0),
    (7200.0, 6e-3, 0.4e-3, 0.06e-3, 20.0),
)
REVOLUTIONS, NOISE = 6.0, 0.02
CASE = """
title = "a cut"
[tool]
teeth = {teeth}
diameter = "10 mm"
helix = "30 deg"
[material]
Ktc = "815 MPa"
Krc = "196 MPa"
Kte = "20.5 N/mm"
Kre = "29 N/mm"
[cut]
mode = "down"
spindle_speed = "7000 rpm"
feed_per_tooth = "0.06 mm"
axial_depth = "0.6 mm"
radial_depth = "4 mm"
[simulation]
steps = 480
[[structure.mode]]
frequency = "704 Hz"
damping = 0.031
mass = "0.49 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "815 Hz"
damping = 0.03
mass = "0.51 kg"
direction = [0, 1, 0]
"""


def plant(teeth=3, **changes) -> Plant:
    """Tool, material and structure as they are: a few percent off what is declared."""
    whole = Plant(
        RADIUS, LAG, np.arange(teeth) * TURN / teeth, np.ones(teeth), np.array(MODES),
        np.array([0.03, 0.03]), np.array([0.5, 0.5]), np.eye(2), 800e6, 200e6, 20e3, 30e3,
    )  # fmt: skip
    return whole._replace(**changes)


def with_mode(frequency, damping, mass, direction):
    """Changes of a plant with another mode."""
    own = plant()
    return {
        "frequency": np.append(own.frequency, frequency),
        "damping": np.append(own.damping, damping),
        "mass": np.append(own.mass, mass),
        "direction": np.vstack([own.direction, direction]),
    }


def explained(true: Plant, folder):
    """Summary of what is made of cuts of a plant from rest."""
    noise, runs = np.random.default_rng(6), []
    for number, (rpm, radial, depth, feed, cut_time) in enumerate(CUTS):
        speed = rpm * TURN / 60.0
        cut = Cut(speed, feed, depth, radial, *arc_of("down", radial, RADIUS), cut_time)
        made = run(true, cut, REVOLUTIONS * TURN / speed)
        level = NOISE * np.sqrt(np.mean(made.channels**2, axis=1))
        level = np.repeat([level[:2].max(), level[2:].max()], 2)
        rows = made.channels + level[:, None] * noise.standard_normal(made.channels.shape)
        signals = {"time": made.time, "spindle_angle": made.angle}
        signals |= dict(zip(("Fx", "Fy", "x", "y"), rows, strict=True))
        overrides = {
            "cut.spindle_speed": f"{rpm} rpm",
            "cut.radial_depth": radial,
            "cut.axial_depth": depth,
            "cut.feed_per_tooth": feed,
            "cut.cut_time": cut_time,
        }
        runs.append(Run(f"run{number + 1}.csv", overrides, signals, cut_time=cut_time))
    case = loads(CASE.format(teeth=len(true.tooth_angle)), "case.toml")
    return explain(Measurement("milling", "cuts", folder, case, tuple(runs))).summary()


@pytest.fixture(autouse=True)
def few_effects(monkeypatch):
    """Those that stood beside or in the place of others."""
    shifts = ModeShift().variants
    # of all modes alike, and of the second by the square of the speed
    effects = (Runout(), ProcessDamping(), MissingMode(), shifts[0], shifts[4], Wear())

    def of(measurement):
        return [one for one in effects if one.applies(measurement)]

    monkeypatch.setattr(candidates, "candidates", of)


def named(summary):
    return {one["name"]: one["parameters"] for one in summary["effects"]}


@pytest.mark.nightly
def test_a_shift_of_one_mode_by_the_square_of_the_speed(tmp_path):
    speed = 7000.0 * TURN / 60.0
    summary = explained(plant(square_slope=-0.08 / speed**2, square_mode=1), tmp_path)
    assert summary["verdict"] == "explained"
    found = named(summary)
    assert set(found) == {"mode_shift"}
    numbers = found["mode_shift"]
    assert (numbers["mode"]["value"], numbers["power"]["value"]) == (2.0, 2.0)
    assert numbers["change"]["value"] == pytest.approx(-0.08, rel=0.05)


@pytest.mark.nightly
def test_a_missing_mode_and_runout_together(tmp_path):
    changes = with_mode(1150.0, 0.03, 0.3, [1.0, 0.0])
    summary = explained(plant(runout_offset=9e-6, runout_angle=1.1, **changes), tmp_path)
    assert summary["verdict"] == "explained"
    found = named(summary)
    assert set(found) == {"missing_mode", "runout"}
    assert found["runout"]["offset"]["value"] == pytest.approx(9e-6, rel=0.03)
    assert found["missing_mode"]["frequency"]["value"] == pytest.approx(1150.0, rel=0.01)
    assert found["missing_mode"]["mass"]["value"] == pytest.approx(0.3, rel=0.1)


def test_a_missing_mode_alone_has_no_process_damping_beside_it(tmp_path):
    summary = explained(plant(**with_mode(480.0, 0.035, 1.2, [0.0, 1.0])), tmp_path)
    assert summary["verdict"] == "explained"
    found = named(summary)
    assert set(found) == {"missing_mode"}
    assert found["missing_mode"]["frequency"]["value"] == pytest.approx(480.0, rel=0.01)


def test_wear_of_every_coefficient(tmp_path):
    """All forces and the process damping grow over five cuts."""
    rates = {
        "wear_tangential": 800.0, "wear_radial": 1500.0, "wear_cutting": 0.012,
        "wear_ploughing": 1500.0,
    }  # fmt: skip
    summary = explained(plant(**rates), tmp_path)
    assert summary["verdict"] == "explained"
    found = named(summary)
    assert set(found) == {"wear"}
    assert found["wear"]["edge_tangential"]["value"] == pytest.approx(800.0, rel=0.1)
    assert found["wear"]["cutting"]["value"] == pytest.approx(0.012, rel=0.1)


@pytest.mark.nightly
def test_runout_of_two_teeth_is_what_can_be_seen_of_it(tmp_path):
    """Two teeth show the difference of their radii alone: the offset along them."""
    offset, angle = 10e-6, 0.9
    true = plant(2, runout_offset=offset, runout_angle=angle)
    found = named(explained(true, tmp_path))
    assert set(found) == {"runout"}
    numbers = found["runout"]
    # the smallest that explains it, and an interval that holds the true one
    assert numbers["offset"]["value"] == pytest.approx(offset * math.cos(angle), rel=0.05)
    assert numbers["offset"]["ci95"][1] > offset
    along = numbers["along"]
    assert along["value"] == pytest.approx(offset * math.cos(angle), rel=0.05)
