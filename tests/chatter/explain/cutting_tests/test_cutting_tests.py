"""Cutting tests: spindle power, wear from test to test, values refitted, chatter frequencies."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from chatter.compile.cutter import force_law, process_damping_of
from chatter.description.case import Case, loads
from chatter.explain.checking import checked
from chatter.explain.cutting_tests.refitted import Refitted, in_words
from chatter.explain.cutting_tests.spindle_power import cutting_power, readings
from chatter.explain.cutting_tests.wear import ChippedEdge, GradualWear, SaturatingWear
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement_file import read_measurement
from chatter.explain.stability_margin import CuttingTests, ResponseOfTests

CASE = """
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "200 MPa"
Kte = "20 N/mm"
Kre = "30 N/mm"
[cut]
mode = "down"
spindle_speed = "3000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"
[process_damping]
coefficient = "4e4 N/m"
[[structure.mode]]
frequency = "600 Hz"
damping = 0.03
mass = "0.5 kg"
direction = [1, 0, 0]
"""
TIMES = 60.0 * np.arange(20)


def ordered(feed: float = 1e-4) -> CuttingTests:
    speed = np.full(TIMES.size, 100.0 * math.pi)
    depth = np.linspace(1e-3, 3e-3, TIMES.size)
    varied = {"cut.feed_per_tooth": np.full(TIMES.size, feed), "cut.cut_time": TIMES}
    return CuttingTests(speed, depth, varied)


def test_power_is_removal_times_coefficient_and_rubbing():
    case, tests = loads(CASE), ordered()
    removed = tests.depth * 8e-3 * 1e-4 * 4 * 50.0 * 8e8
    edge_speed = 8e-3 * tests.speed
    rubbed = 2e4 * tests.depth * edge_speed * 4 * 0.25
    assert cutting_power(case, tests) == pytest.approx(removed + rubbed, rel=1e-9)


def test_power_grows_with_a_tool_that_wears():
    worn = loads(CASE + '[wear]\ncutting = 5e-4\nedge_tangential = "10 N/m/s"\n')
    fresh, tests = loads(CASE), ordered()
    ratio = cutting_power(worn, tests) / cutting_power(fresh, tests)
    assert ratio == pytest.approx(1.0 + 5e-4 * TIMES, rel=1e-9)


@pytest.mark.parametrize(("factor", "expected"), [(1.0, 1.0), (1e-3, 1e3)])
def test_readings_are_taken_in_their_unit_without_idle_power(factor, expected):
    case, tests = loads(CASE), ordered()
    power = cutting_power(case, tests)
    found = readings(case, tests, (1.1 * power + 180.0) * factor, 180.0)
    assert found.factor == expected
    assert found.power == pytest.approx(1.1 * power)
    assert not found.out_of_line.any()


def test_idle_power_that_is_not_given_is_what_readings_have_in_common():
    case, tests = loads(CASE), ordered()
    found = readings(case, tests, 1.2 * cutting_power(case, tests) + 150.0, None)
    assert found.idle == pytest.approx(150.0, rel=1e-6)


def test_a_corrupt_reading_is_out_of_line_and_a_chipped_edge_is_not():
    case, tests = loads(CASE), ordered()
    grown = np.where(TIMES > 500.0, 1.5, 1.0)
    power = cutting_power(case, tests) * grown
    power[4] *= 3.0
    found = readings(case, tests, power, 0.0)
    assert np.flatnonzero(found.out_of_line).tolist() == [4]


@pytest.mark.parametrize("form", [GradualWear, SaturatingWear, ChippedEdge])
def test_every_form_of_wear_reaches_its_increase_at_the_last_test(form):
    case: Case = loads(CASE)
    values = {"cutting_increase": 0.3, "edge_increase": 0.5, "process_damping_increase": 2.0}
    shapes = {"saturation_time": 200.0, "chipping_time": 570.0}
    worn = case.patch(form(TIMES).patch(case, values | shapes))
    assert worn.cut.cut_time == TIMES[-1]
    law = force_law(worn, 0.0)
    assert law.cutting[0] == pytest.approx(8e8 * 1.3)
    assert law.edge[0] == pytest.approx(2e4 * 1.5)
    assert process_damping_of(worn).coefficient == pytest.approx(4e4 * 3.0)
    fresh = worn.patch({"cut.cut_time": 0.0})
    assert force_law(fresh, 0.0).cutting[0] == pytest.approx(8e8)


def test_chatter_frequency_is_that_of_the_motion_nearest_to_what_was_heard():
    period = np.array([0.01, 0.01])
    response = ResponseOfTests(np.zeros(2), np.array([0.4 * math.pi, 0.4 * math.pi]), period)
    assert response.chatter_frequency(np.array([519.0, 684.0])) == pytest.approx([520.0, 680.0])


def test_what_was_refitted_is_told_by_how_much():
    moved = Refitted("material.Ktc", 8e8, 6.88e8, 8e7, 2e7)
    kept = Refitted("material.Krc", 2e8, 2.01e8, 2e7, 1e7)
    assert moved.change == pytest.approx(-0.14)
    assert in_words([moved, kept]) == (
        "Refitted to the tests: material.Ktc by -14 % (1.4 tolerances)."
    )
    assert "stay as they are" in in_words([kept])


def test_a_corrupt_power_costs_the_reading_and_not_the_verdict(tmp_path: Path):
    (tmp_path / "case.toml").write_text(CASE)
    tests = ordered()
    power = cutting_power(loads(CASE), tests) + 180.0
    power[7] = 4.0
    rows = [
        f"3000,{1e3 * depth:.4f},{k % 2},0.1,{60 * k},,{watt:.3f}"
        for k, (depth, watt) in enumerate(zip(tests.depth, power, strict=True))
    ]
    heading = (
        "spindle_speed [rpm],axial_depth [mm],stable,feed_per_tooth [mm],cut_time [s],"
        "chatter_frequency [Hz],spindle_power [W]"
    )
    (tmp_path / "points.csv").write_text("\n".join([heading, *rows]) + "\n")
    (tmp_path / "measurement.toml").write_text(
        'kind = "stability"\ncase = "case.toml"\npoints = "points.csv"\nidle_power = "180 W"\n'
    )
    usable = checked(read_measurement(tmp_path))
    assert any("test 8" in one.description for one in usable.findings)
    runs = KINDS["stability"].prepared(usable.measurement).runs
    count = {
        channel: sum(run.signals[channel].size for run in runs if run.record == channel)
        for channel in ("stable", "spindle_power", "chatter_frequency")
    }
    assert count == {"stable": 20, "spindle_power": 19, "chatter_frequency": 0}
