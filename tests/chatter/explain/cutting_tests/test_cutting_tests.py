"""Cutting tests: spindle power, wear from test to test, values refitted, chatter frequencies."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chatter.compile.cutter import force_law, process_damping_of
from chatter.description.case import Case, loads
from chatter.explain.checking import checked
from chatter.explain.cutting_tests.fit_to_tests import SearchOverTests, fit_tests, fit_tests_widely
from chatter.explain.cutting_tests.priors import prior_cost
from chatter.explain.cutting_tests.refitted import Refitted, in_words
from chatter.explain.cutting_tests.reliability import spread_of_margin
from chatter.explain.cutting_tests.spindle_power import cutting_power, readings
from chatter.explain.cutting_tests.wear import ChippedEdge, GradualWear, SaturatingWear
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.kinds.stability import Stability
from chatter.explain.measurement import Measurement, Run
from chatter.explain.measurement_file import read_measurement
from chatter.explain.parameters import Parameter
from chatter.explain.prediction import Predictions
from chatter.explain.selection.problem import Problem
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
    angle = np.array([0.4 * math.pi, 0.4 * math.pi])
    response = ResponseOfTests(np.zeros(2), angle, period, np.zeros(2))
    assert response.chatter_frequency(np.array([519.0, 684.0])) == pytest.approx([520.0, 680.0])


def test_what_was_refitted_is_told_by_how_much():
    moved = Refitted(Parameter("material.Ktc", 8e8, 8e7), 6.88e8, 2e7)
    kept = Refitted(Parameter("material.Krc", 2e8, 2e7), 2.01e8, 1e7)
    assert moved.change == pytest.approx(-0.14)
    assert in_words([moved, kept]) == (
        "Refitted to the tests: material.Ktc by -14 % (1.4 tolerances)."
    )
    assert "stay as they are" in in_words([kept])


def test_process_damping_is_known_by_a_factor_of_two():
    measurement = Measurement("stability", "", Path(), loads(CASE), ())
    (damping,) = [
        one
        for one in KINDS["stability"].nuisance_parameters(measurement)
        if one.name == "process_damping.coefficient"
    ]
    assert damping.counted(8e4) == pytest.approx(1.0)
    assert damping.counted(2e4) == pytest.approx(-1.0)
    assert damping.value(math.log2(3.3)) == pytest.approx(3.3 * 4e4)
    slope = (damping.value(1.001) - damping.value(0.999)) / 0.002
    assert damping.per_size(1.0) == pytest.approx(slope, rel=1e-5)


class PointedLimit(Stability):
    """Tests of a cut whose limit over the speed is a peak that bends: known in closed form."""

    def predict(self, case, run):
        peak, height = case["peak"], case["height"]
        limit = height * np.exp(-(((run.signals["spindle_speed"] - peak) / 0.3) ** 2))
        return {"margin": limit / run.signals["axial_depth"] - 1.0}

    def nuisance_parameters(self, measurement):
        return [Parameter("peak", 2.0, 0.5, 0.1, 9.0), Parameter("height", 1.0, 0.3, 0.01, 9.0)]


def pointed(peak: float, height: float) -> Problem:
    kind, random = PointedLimit(), np.random.default_rng(3)
    speed, depth = random.uniform(1.0, 3.0, 120), random.uniform(0.05, 1.6, 120)
    signals = {"spindle_speed": speed, "axial_depth": depth, "stable": np.ones(120)}
    run = Run("points", {}, signals, record="stable")
    margin = kind.predict({"peak": peak, "height": height}, run)["margin"]
    judged = replace(run, signals=signals | {"stable": (margin > 0.0).astype(float)})
    measurement = Measurement("stability", "", Path(), loads(CASE), (judged,))
    noise = {"points": {"stable": 0.06}}
    return DirectProblem(measurement, Predictions(kind), noise)


class DirectProblem(Problem):
    """Problem whose case is its values."""

    def case(self, values):
        return FrozenValues(values)


class FrozenValues(dict):
    """Values that predictions can be kept by."""

    @property
    def content(self):
        return tuple(self.items())


def test_a_fit_finds_the_limit_between_the_verdicts_with_few_predictions():
    problem = pointed(1.8, 1.3)
    runs = problem.measurement.runs
    fit = fit_tests_widely(problem, runs, {}, (0.25, 0.12))
    # the nearest verdicts leave the limit open by about as much
    assert fit.by_name["peak"] == pytest.approx(1.8, abs=0.02)
    assert fit.by_name["height"] == pytest.approx(1.3, rel=0.05)
    true = SearchOverTests(problem, runs, {"peak": 1.8, "height": 1.3})
    assert fit.cost + prior_cost(problem, fit) <= true.cost(true.predicted, true.x) + 1e-6
    assert problem.predictions.made < 60


def test_the_covariance_of_a_fit_is_that_of_the_curvature_of_its_cost():
    problem = pointed(1.9, 1.1)
    fit = fit_tests(problem, problem.measurement.runs, {})
    search = SearchOverTests(problem, problem.measurement.runs, fit.by_name)
    search.slopes = search.differences()
    residuals, slopes = search.linearised(search.predicted)
    step = 1e-5
    for index, one in enumerate(fit.parameters):
        moved = dict(fit.by_name) | {one.name: fit.values[index] + step * one.size}
        there = problem.residuals(moved, problem.measurement.runs)
        assert slopes[:, index] == pytest.approx((there - residuals) / step, rel=2e-2, abs=2e-2)


def test_margins_of_holdout_tests_scatter_as_parameters_drawn_from_the_fit_do():
    problem = pointed(1.9, 1.1)
    (run,) = problem.measurement.runs
    fit = fit_tests(problem, [run], {})
    margin = problem.kind.predict(fit.by_name, run)["margin"]
    spread = spread_of_margin(problem, fit, run, margin)
    drawn = np.random.default_rng(8).multivariate_normal(fit.values, fit.covariance, 4000)
    names = [one.name for one in fit.parameters]
    margins = [
        problem.kind.predict(dict(zip(names, one, strict=True)), run)["margin"] for one in drawn
    ]
    assert spread == pytest.approx(np.std(margins, axis=0), rel=0.1, abs=1e-4)
    assert spread.max() > 0.01


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
