"""Power that a spindle takes in the air and that no table states is told from that of the cut."""

import numpy as np
import pytest

import chatter
from chatter.learning.cuts import read_cuts
from chatter.learning.idle_power import IDLE_POWER
from tests.chatter.learning.test_learn import case_of

IDLE, CUTTING, UNIT = 400.0, 860e6, 1e-3
SPEEDS = np.array([6000.0, 9000.0, 12000.0, 15000.0])
DEPTHS = np.array([0.3e-3, 0.6e-3, 0.9e-3, 1.2e-3])
FEED, WIDTH, TEETH = 0.1e-3, 8e-3, 2


def powers(speeds, depths):
    """Power of the chips (removed volume a second by Ktc) and of the spindle in the air, W."""
    return CUTTING * depths * WIDTH * FEED * TEETH * speeds / 60.0 + IDLE


def table(folder, scale):
    speeds, depths = (grid.ravel() for grid in np.meshgrid(SPEEDS, DEPTHS))
    rows = [
        f"{speed:.0f},{1e3 * depth:.2f},{scale * power:.6g}"
        for speed, depth, power in zip(speeds, depths, powers(speeds, depths), strict=True)
    ]
    heading = "spindle_speed [rpm],axial_depth [mm],spindle_power [W]"
    (folder / "cuts.csv").write_text("\n".join([heading, *rows]) + "\n")
    return folder / "cuts.csv"


def test_coefficients_and_idle_power_are_learnt(tmp_path):
    found = chatter.learn(case_of(tmp_path, 900.0), table(tmp_path, 1.0), particles=64)
    learnt = found.after.columns()
    assert np.median(learnt["material.Ktc"]) == pytest.approx(CUTTING, rel=0.03)
    assert np.median(learnt[IDLE_POWER]) == pytest.approx(IDLE, abs=15.0)


def test_readings_in_another_unit_than_their_heading_says(tmp_path):
    case = chatter.load(case_of(tmp_path, 900.0))
    (run,) = read_cuts(table(tmp_path, UNIT), case).runs
    speeds, depths = (grid.ravel() for grid in np.meshgrid(SPEEDS, DEPTHS))
    assert run.signals["spindle_power"] == pytest.approx(powers(speeds, depths), rel=1e-5)
