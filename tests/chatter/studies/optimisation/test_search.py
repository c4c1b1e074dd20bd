"""The best cut: where theory gives it, against points at random, and with what is uncertain."""

import json
import math

import numpy as np
import pytest

import chatter
from chatter import InputError
from chatter.io.shipped_examples import example
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from chatter.studies.optimisation.steady_cut import SteadyModel
from tests.chatter.studies.optimisation.cuts import end_mill
from tests.command_line import chatter_command

RPM = math.pi / 30.0
STIFF = [
    {"frequency": "1200 Hz", "damping": 0.05, "stiffness": "2000 N/um", "direction": axis}
    for axis in ([1, 0, 0], [0, 1, 0])
]
NARROW = {"from": "7600 rpm", "to": "9600 rpm"}
SMALL = {"speeds": NARROW, "depths": {"to": "4 mm", "count": 20}}


def stable(case, speed, depth):
    cut = element_cut(milling_model(case), depth * 1.01)
    return abs(collocation.multipliers(cut, np.array([speed]), np.array([depth]))[0]) < 1.0


@pytest.mark.parametrize(
    ("limit", "value", "removal"),
    [
        # without edge forces the power is K_tc times the volume removed per time
        ("max_power", "400 W", 400.0 / 800e6),
        # and the torque K_tc b a f N / 2 pi, so that the highest speed is best
        ("max_torque", "0.5 N*m", 0.5 * 9600.0 * RPM / 800e6),
    ],
)
def test_a_stiff_machine_is_limited_by_its_spindle_alone(limit, value, removal):
    changes = {"structure.mode": STIFF, "material.Kte": 0.0, "material.Kre": 0.0}
    section = {"speeds": {"from": "9200 rpm", "to": "9600 rpm"}, "depths": {"to": "4 mm"}}
    radial_depths = {"from": "4 mm", "to": "8 mm", "count": 2}
    case = end_mill(
        {**changes, "optimum": {**section, "radial_depths": radial_depths, limit: value}}
    )
    found = chatter.optimum(case)
    # a depth step of the last refinement, and whole micrometres
    assert found.best.removal_rate == pytest.approx(removal, rel=3e-3)
    assert found.best.removal_rate <= removal * (1.0 + 1e-9)
    assert limit in found.best.active
    assert found.best.usage[limit] == pytest.approx(1.0, abs=3e-3)
    assert found.best.verification.verified
    if limit == "max_torque":
        assert "speeds.to" in found.best.active
    # the picture fills what is kept up to there at every speed, between the points of the grid too
    depths = np.linspace(0.0, 4e-3, 2001)[1:]
    kept = found.grid_slice.feasible_between(found.limits, depths)
    speeds, cut = found.grid_slice.stable.speeds, found.grid_slice.case.cut
    inside = (speeds > 9200.0 * RPM) & (speeds < 9600.0 * RPM)
    area = 3.0 * cut.feed_per_tooth * cut.radial_depth * speeds[inside] / (2.0 * math.pi)
    highest = 400.0 / 800e6 if limit == "max_power" else 0.5 * speeds[inside] / 800e6
    tops = depths[kept[:, inside].sum(axis=0) - 1]
    assert tops == pytest.approx(np.minimum(highest / area, 4e-3), rel=0.01)


@pytest.fixture(scope="module")
def limited():
    """Search over speed, depth and radial depth with every kind of limit."""
    limits = {"max_power": "1.5 kW", "max_deflection": "40 um", "max_surface_error": "8 um"}
    radial_depths = {"from": "2 mm", "to": "6 mm", "count": 3}
    case = end_mill({"optimum": {**SMALL, "radial_depths": radial_depths, **limits}})
    return chatter.optimum(case)


def test_the_best_cut_keeps_its_limits_and_its_margins(limited):
    best, case = limited.best, limited.case
    assert best.active
    point = best.point
    here = limited.best_case
    assert here.cut.spindle_speed == pytest.approx(point.spindle_speed, rel=1e-9)
    assert here.width_of_cut == pytest.approx(point.radial_depth, rel=1e-9)
    for speed in point.spindle_speed * np.array([0.985, 0.99, 1.0, 1.01, 1.015]):
        assert stable(here, speed, point.axial_depth / 0.85 * 0.999)
    run = chatter.simulate(here)
    assert run.detection.verdict == "stable"
    assert run.power[run.settled].mean() < 1.5e3
    assert np.linalg.norm(run.displacement[run.settled], axis=1).max() < 1.03 * 40e-6
    assert abs(run.finish.walls[0].largest_location_error) < 1.03 * 8e-6
    rate = point.axial_depth * here.width_of_cut * 0.08e-3 * 3 * point.spindle_speed
    assert best.removal_rate == pytest.approx(rate / (2.0 * math.pi), rel=1e-9)
    assert case.cut.axial_depth == 1e-3


def test_no_cut_at_random_removes_more_within_the_limits(limited):
    draw, best = np.random.default_rng(7), limited.best
    base = best.removal_rate * 2.0 * math.pi / (0.08e-3 * 3)
    tried = 0
    while tried < 40:
        speed, radial_depth = draw.uniform(7600, 9600) * RPM, draw.uniform(2e-3, 6e-3)
        depth = base * draw.uniform(1.01, 1.5) / (speed * radial_depth)
        if depth > 4e-3:
            continue
        tried += 1
        here = limited.case.patch({"cut.radial_depth": radial_depth})
        margins = speed * np.array([0.985, 0.9925, 1.0, 1.0075, 1.015])
        if not all(stable(here, one, depth / 0.85) for one in margins):
            continue
        model = SteadyModel(milling_model(here), speed)
        cuts = model.cuts(np.array([speed]), depth)
        usage = [cuts.power / 1.5e3, cuts.deflection / 40e-6, np.abs(cuts.surface_error) / 8e-6]
        assert max(float(one[0]) for one in usage) > 1.0


def test_the_search_chooses_a_stretch_above_an_island():
    # a low-immersion cut with 45 degrees of helix is stable again above its flip island
    case = chatter.load(example("helix-islands").folder / "case.toml")
    section = {
        "speeds": {"from": "18900 rpm", "to": "19100 rpm"},
        "depths": {"to": "6 mm", "count": 40},
        "depth_margin": 0.02,
        "speed_margin": 0.002,
    }
    found = chatter.optimum(case.patch({"optimum": section}))
    crossings = chatter.check(found.best_case).limit.crossings[0]
    assert crossings[1] < found.best.point.axial_depth < crossings[2]
    assert found.best.critical_depth == pytest.approx(crossings[2], rel=3e-3)
    assert "stability" in found.best.active


def test_nothing_feasible_is_said_with_its_reason(tmp_path):
    section = {**SMALL, "depths": {"from": "2 mm", "to": "4 mm", "count": 8}}
    case = end_mill({"structure.mode": STIFF, "optimum": {**section, "max_torque": "0.1 N*m"}})
    found = chatter.optimum(case)
    assert found.best is None
    assert found.best_case is None
    assert "max_torque is held nowhere" in found.why_nothing
    # the least torque of the grid: K_tc f N b a / 2 pi + K_te b arc N / 2 pi
    arc = math.acos(1.0 - 5.0 / 8.0)
    least = 3 * 2e-3 / (2.0 * math.pi) * (800e6 * 0.08e-3 * 5e-3 + 12e3 * arc * 8e-3)
    assert f"{least:.4g} N m" in found.why_nothing
    path = tmp_path / "case.toml"
    case.save(path)
    answer = chatter_command("optimum", path, "--out", tmp_path / "out")
    assert answer.exit_code == 1
    assert "max_torque is held nowhere" in answer.stderr
    assert not (tmp_path / "out" / "case-optimum.toml").exists()


@pytest.mark.nightly
def test_uncertain_values_take_depth_away(tmp_path):
    changes = {"material.Ktc": "800 +- 60 MPa", "structure.mode[1].frequency": "1010 +- 15 Hz"}
    speeds = {"from": "7200 rpm", "to": "8000 rpm"}
    section = {"speeds": speeds, "depths": {"to": "9 mm", "count": 18}, "confidence": 0.9}
    case = end_mill({**changes, "optimum": section})
    found = chatter.optimum(case, samples=30)
    best = found.best
    assert best.probability.value >= 0.9
    # the start from rest may chatter below the linear limit
    assert {"confidence", "time domain"} & set(best.active)
    # other samples, one by one through the command that knows them
    again = chatter.uncertainty(found.best_case, 60, seed=5, speeds=2)
    assert again.probability > 0.8
    # nearly all of the nominal limit is not sure
    assert best.point.axial_depth < 0.97 * best.critical_depth


def test_the_command_writes_a_case_that_others_accept(tmp_path):
    path = tmp_path / "case.toml"
    speeds = {"from": "9000 rpm", "to": "9500 rpm"}
    section = {"speeds": speeds, "depths": {"to": "2 mm", "count": 8}, "max_power": "2 kW"}
    end_mill({"optimum": section}).save(path)
    out = tmp_path / "out"
    answer = chatter_command("optimum", path, "--out", out, "--json")
    assert answer.exit_code == 0, answer.stderr
    summary = json.loads((out / "summary.json").read_text())
    assert json.loads(answer.stdout) == summary
    assert summary["best"]["time_domain"]["verified"]
    assert (out / "optimum.png").stat().st_size > 10_000
    head, first = (out / "optimum.csv").read_text().splitlines()[:2]
    assert head.startswith("rank,spindle_speed [rpm],axial_depth [mm]")
    assert float(first.split(",")[2]) == pytest.approx(summary["best"]["axial_depth_mm"])
    case = chatter.load(out / "case-optimum.toml")
    assert chatter.check(case).stable
    assert case.cut.axial_depth * 1e3 == pytest.approx(summary["best"]["axial_depth_mm"])
    assert case.optimum.max_power == 2e3
    # the same bytes again
    again = chatter.optimum(chatter.load(path)).save(tmp_path / "again")
    for name in ("optimum.csv", "summary.json", "case-optimum.toml", "optimum.png"):
        assert (tmp_path / "again" / name).read_bytes() == (out / name).read_bytes()
    assert [one.name for one in again][-1] == "case-optimum.toml"


@pytest.mark.parametrize(
    ("changes", "report"),
    [
        ({"optimum": {"max_power": "3 N"}}, 'optimum.max_power: "3 N" is a force; a power'),
        (
            {"optimum": {"radial_depths": {"from": "2 mm", "to": "20 mm"}}},
            "optimum.radial_depths.to: 20 mm is",
        ),
        ({"optimum": {"speeds": {"from": "9 rpm", "to": "3 rpm"}}}, "optimum.speeds: the range"),
        ({"optimum": {"confidence": 1.0}}, "optimum.confidence: 1.0 is out of range"),
        ({"optimum": {"max_depth": "3 mm"}}, "optimum.max_depth: unknown key"),
        (
            {
                "cut.mode": "slot",
                "cut.radial_depth": None,
                "optimum": {"radial_depths": {"from": "2 mm", "to": "3 mm"}},
            },
            'optimum.radial_depths: mode = "slot" cuts the whole diameter',
        ),
    ],
)
def test_wrong_input_is_named(changes, report):
    with pytest.raises(InputError) as error:
        end_mill(changes)
    assert report in str(error.value)


def test_a_varying_speed_is_refused():
    case = end_mill({"cut.speed_variation": {"amplitude": 0.1, "frequency": "1 Hz"}})
    with pytest.raises(InputError, match=r"cut\.speed_variation"):
        chatter.optimum(case)


def test_a_ball_removes_what_it_sweeps_and_nothing_where_it_does_not_reach():
    radial_depths = {"from": "0.5 mm", "to": "8 mm", "count": 3}
    section = {
        "speeds": {"from": "9000 rpm", "to": "9300 rpm"},
        "depths": {"to": "1 mm", "count": 4},
    }
    changes = {"tool.kind": "ball", "cut.radial_depth": "8 mm"}
    found = chatter.optimum(
        end_mill({**changes, "optimum": {**section, "radial_depths": radial_depths}})
    )
    point = found.best.point
    # at 1 mm the ball of 16 mm reaches 3.87 mm from its axis, where half of its segment is cut
    segment = 64.0 * math.acos(7.0 / 8.0) - 7.0 * math.sqrt(15.0)
    wanted = 0.5 * segment * 1e-6 * 0.08e-3 * 3 * point.spindle_speed / (2.0 * math.pi)
    assert point[1:3] == pytest.approx((1e-3, 8e-3))
    assert found.best.removal_rate == pytest.approx(wanted, rel=1e-3)
    assert min(one.radial_depth for one in found.over_radial_depths) > 4e-3
