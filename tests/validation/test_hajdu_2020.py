"""Measured parameters against 85 real cutting tests (Hajdu et al. 2020; validation 6.1)."""

import csv
import math
import shutil

import numpy as np
import pytest

import chatter
from benchmarks.learning_real import STATED
from chatter.stability.methods.semi_discretization.arrays import milling_arrays
from chatter.stability.methods.semi_discretization.multipliers import limit_curve, multipliers
from chatter.stability.model import milling_model
from tests.places import DATA

FOLDER = DATA / "stability-hajdu-2020"
RPM = math.pi / 30.0

MEASUREMENT = 'kind = "stability"\ncase = "case.toml"\npoints = "points.csv"\n'

REFITTED = {
    "structure.mode[0].frequency": 764.53644,
    "structure.mode[1].frequency": 714.21176,
    "structure.mode[0].damping": 0.0329363,
    "structure.mode[1].damping": 0.02266012,
    "structure.mode[0].stiffness": 6.555309e6,
    "structure.mode[1].stiffness": 4.8723407e6,
    "material.Ktc": 10.952098e8,
    "material.Krc": 1.7610455e8,
}


def judged(case):
    """Points judged rightly, of those that are not marginal."""
    with (FOLDER / "points.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["stable"]]
    speed = np.array([float(row["spindle_speed [rpm]"]) * RPM for row in rows])
    depth = np.array([float(row["axial_depth [mm]"]) * 1e-3 for row in rows])
    stable = np.array([row["stable"] == "1" for row in rows])
    radius = np.abs(multipliers(milling_arrays(milling_model(case)), speed, depth))
    return int(np.sum((radius < 1.0) == stable)), len(rows)


def test_limits_with_declared_and_refitted_parameters():
    case = chatter.load(FOLDER / "case.toml")
    depths = np.linspace(0.0, 4e-3, 161)[1:]
    rpms = (5000, 6000, 7000, 7200, 8000, 9000, 10000, 10500, 11000, 12000, 13000)
    declared = (0.40355, 0.56184, 0.56715, 0.79920, 0.71424, 0.40306)
    declared += (0.56534, 0.90671, 1.87905, 1.06049, 0.51214)
    refitted = (0.70722, 0.60371, 1.26777, 1.86858, 0.63279, 0.68226)
    refitted += (1.16564, 1.95751, 2.82364, 0.79817, 0.60553)
    for patched, expected in ((case, declared), (case.patch(REFITTED), refitted)):
        arrays = milling_arrays(milling_model(patched))
        curve = limit_curve(arrays, np.array(rpms) * RPM, depths)
        assert curve.critical_depth * 1e3 == pytest.approx(expected, rel=2e-4)


def test_score_of_declared_and_refitted_parameters():
    # all 127 points: 87 and 98 of 118; two thirds of them are here
    case = chatter.load(FOLDER / "case.toml")
    right, count = judged(case)
    better, _ = judged(case.patch(REFITTED))
    assert count >= 75
    assert right / count == pytest.approx(87 / 118, abs=0.05)
    assert better / count == pytest.approx(98 / 118, abs=0.05)
    assert better > right


@pytest.mark.nightly
def test_nothing_is_missing_within_the_deviations_that_the_authors_state(tmp_path):
    case = chatter.load(FOLDER / "case.toml").patch(STATED)
    for name, text in (("case.toml", case.to_toml()), ("measurement.toml", MEASUREMENT)):
        (tmp_path / name).write_text(text)
    shutil.copy(FOLDER / "points.csv", tmp_path)
    found = chatter.explain(tmp_path)
    assert found.verdict == "nothing-missing"
    right, count = judged(found.refitted)
    # of all 118 tests 106 are asked for
    assert right / count >= 106 / 118 * 0.99
    for path, stated in STATED.items():
        middle, deviation = (float(part.split()[0]) for part in stated.split("+-"))
        scale = 1e6 if stated.endswith("MPa") else 1.0
        assert abs(found.refitted.get(path) / scale - middle) < 2.0 * deviation
