"""Runs so near to their limit that two settled cuts are beside each other."""

import math

import numpy as np

from benchmarks.blind_sets.milling_physics import TURN, Cut, Plant, arc_of, run
from chatter.description.case import loads
from chatter.explain.checking import checked
from chatter.explain.data_checks.finding import RUN
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.description import RecordDescription

CASE = """
[tool]
teeth = 2
diameter = "12 mm"
helix = "30 deg"
[material]
Ktc = "754 MPa"
Krc = "212 MPa"
Kte = "11.8 N/mm"
Kre = "10.2 N/mm"
[cut]
mode = "down"
spindle_speed = "10943 rpm"
feed_per_tooth = "0.064 mm"
axial_depth = "0.54 mm"
radial_depth = "10.35 mm"
[[structure.mode]]
frequency = "927.9 Hz"
damping = 0.0241
mass = "0.1286 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "856.6 Hz"
damping = 0.0251
mass = "0.1237 kg"
direction = [0, 1, 0]
"""
PLANT = Plant(
    6e-3, math.tan(math.radians(30.0)) / 6e-3, np.arange(2) * math.pi, np.ones(2),
    np.array([927.9, 856.6]), np.array([0.0241, 0.0251]), np.array([0.1286, 0.1237]), np.eye(2),
    754e6, 212e6, 11.8e3, 10.2e3,
)  # fmt: skip
SPEED = 10943.0 * TURN / 60.0


def last_revolution(signals):
    """Displacement along y at even angles of the last whole revolution."""
    turn = TURN / SPEED
    start = math.floor(signals.time[-1] / turn - 1.0) * turn
    return np.interp(start + turn * np.arange(500) / 500.0, signals.time, signals.y)


def test_a_cut_that_settles_otherwise_after_an_entry_is_set_aside(tmp_path):
    """By the independent integration: from rest the tool moves half as far again."""
    runs, swings = [], []
    for number, depth in enumerate((0.54e-3, 0.3e-3, 0.2e-3)):
        cut = Cut(SPEED, 64e-6, depth, 10.35e-3, *arc_of("down", 10.35e-3, 6e-3), 0.0)
        rest, entered = (run(PLANT, cut._replace(touches=one), 0.5) for one in (-np.inf, 0.012))
        swings.append(np.ptp(last_revolution(rest)) / np.ptp(last_revolution(entered)))
        rows = dict(zip(("Fx", "Fy", "x", "y"), entered.channels, strict=True))
        rows["time"] = entered.time
        runs.append(Run(f"run{number + 1}.csv", {"cut.axial_depth": depth}, rows))
    assert swings[0] > 1.5
    assert np.allclose(swings[1:], 1.0, atol=0.01)
    record = RecordDescription("air", "unknown", 0.005)
    case = loads(CASE, "case.toml")
    made = Measurement("milling", "records", tmp_path, case, tuple(runs), {}, record=record)
    found = [one for one in checked(made).findings if one.severity == RUN]
    assert [one.run for one in found] == ["run1.csv"]
    assert "after another entry" in found[0].description
