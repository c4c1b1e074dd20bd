"""Verdicts on settled records: runout alone, and a rigid tool whose helix nobody knows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.blind_sets.milling_physics import SAMPLING, TURN, Cut, arc_of, run
from chatter.description.case import loads
from chatter.explain.explanation import explain
from chatter.explain.measurement import Measurement, Run
from tests.chatter.explain.records.test_records import CASE, plant

#: the noise hides what a sampling without a filter folds back
OFFSET, ANGLE, NOISE = 15e-6, 0.4, 0.05
#: speed, rpm, radial depth, m, feed per tooth, m, of cuts; revolutions that nobody kept
CUTS = ((2000.0, 6e-3, 0.08e-3), (2270.0, 9e-3, 0.06e-3), (1710.0, 4.5e-3, 0.1e-3))
LEFT_OUT = 5.31


def settled(true, case, tolerances, folder) -> Measurement:
    """Second halves of runs from rest by another program; of their beginning nothing is told."""
    noise = np.random.default_rng(5)
    runs = []
    for number, (rpm, radial, feed) in enumerate(CUTS):
        speed = rpm * TURN / 60.0
        cut = Cut(speed, feed, case.cut.axial_depth, radial, *arc_of("down", radial, 10e-3), 0.0)
        made = run(true, cut, (LEFT_OUT + 7.0) * TURN / speed)
        first = int(LEFT_OUT * TURN / speed * SAMPLING)
        rows = made.channels[:2, first:]
        rows = rows + NOISE * rows.std(axis=1)[:, None] * noise.standard_normal(rows.shape)
        signals = {"time": made.time[first:] - made.time[first], "Fx": rows[0], "Fy": rows[1]}
        overrides = {
            "cut.spindle_speed": f"{rpm} rpm",
            "cut.radial_depth": radial,
            "cut.feed_per_tooth": feed,
        }
        runs.append(Run(f"run{number + 1}.csv", overrides, signals))
    return Measurement("milling", "settled", folder, case, tuple(runs), tolerances)


@pytest.mark.nightly
def test_runout_alone_in_settled_records_is_runout_alone(tmp_path):
    """From rest the declared case, of one mode, leaves not twice what it does as a settled cut."""
    true = plant()._replace(mass=np.array([1.15, 1e4]), runout_offset=OFFSET, runout_angle=ANGLE)
    text = CASE[: CASE.rindex("[[structure.mode]]")]
    found = explain(settled(true, loads(text, "case.toml"), {}, tmp_path))
    assert found.verdict == "explained"
    (effect,) = found.summary()["effects"]
    assert effect["name"] == "runout"
    numbers = effect["parameters"]
    assert numbers["offset"]["value"] == pytest.approx(OFFSET, rel=0.03)
    # nobody can tell which of three teeth is the first
    apart = math.remainder(numbers["angle"]["value"] - ANGLE, TURN / 3.0)
    assert abs(apart) < math.radians(6.0)


def test_a_rigid_tool_of_unknown_helix(tmp_path):
    """No structure is declared; the helix of 30 degrees is guessed as 24."""
    stiff = plant()._replace(mass=np.full(2, 1e4))
    text = (
        CASE[: CASE.index("[[structure.mode]]")]
        .replace("30 deg", "24 deg")
        .replace("0.6 mm", "3 mm")
    )
    found = explain(settled(stiff, loads(text, "case.toml"), {"tool.helix": 0.3}, tmp_path))
    assert found.verdict == "nothing-missing"
    assert found.case.tool.helix == pytest.approx(math.radians(30.0), abs=math.radians(0.5))
    assert found.case.structure is None
