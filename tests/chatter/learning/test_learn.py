"""Learning from tests whose verdicts come from another method than the one that learns."""

import json

import numpy as np
import pytest

import chatter
from chatter import InputError
from chatter.description.units import rpm
from chatter.learning.cuts import read_cuts
from tests.command_line import chatter_command

TRUE_FREQUENCY, DECLARED_FREQUENCY = 900.0, 945.0
CASE = """
title = "One mode, half immersion"
[tool]
kind = "end mill"
teeth = 2
diameter = "16 mm"
[material]
law = "linear"
Ktc = "800 +- 80 MPa"
Krc = "240 +- 24 MPa"
[cut]
mode = "down"
spindle_speed = "9000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"
[[structure.mode]]
frequency = "{frequency} +- 40 Hz"
damping = "0.02 +- 0.004"
stiffness = "6 +- 0.6 N/um"
direction = [0, 1, 0]
[lobes]
speeds = {{ from = "6000 rpm", to = "15000 rpm", count = 40 }}
depths = {{ to = "8 mm", count = 40 }}
"""
SPEEDS = np.linspace(6000.0, 15000.0, 19)


def case_of(tmp_path, frequency, name="case.toml"):
    path = tmp_path / name
    path.write_text(CASE.format(frequency=frequency))
    return path


def limits_of(path):
    """Critical depths in mm by semi-discretization."""
    case = chatter.load(path).patch(
        {"lobes.speeds": {"from": "6000 rpm", "to": "15000 rpm", "count": SPEEDS.size}}
    )
    return 1e3 * np.asarray(chatter.lobes(case, method="semi-discretization").limits.critical_depth)


@pytest.fixture(scope="module")
def tests_of_true_case(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cuts")
    limits = limits_of(case_of(folder, TRUE_FREQUENCY))
    rows = [
        (SPEEDS[k], share * limits[k], int(share < 1.0))
        for k in range(1, SPEEDS.size, 2)
        for share in (0.8, 1.25)
        if np.isfinite(limits[k])
    ]
    lines = [f"{speed:.0f},{depth:.4f},{stable}" for speed, depth, stable in rows]
    text = "\n".join(["spindle_speed [rpm],axial_depth [mm],stable", *lines]) + "\n"
    (folder / "cuts.csv").write_text(text)
    return folder, limits


def test_the_true_frequency_and_limits_are_learnt(tests_of_true_case):
    folder, true = tests_of_true_case
    path = case_of(folder, DECLARED_FREQUENCY, "declared.toml")
    found = chatter.learn(path, folder / "cuts.csv", particles=96)
    frequency = found.after.columns()["structure.mode[0].frequency"]
    assert frequency.mean() == pytest.approx(TRUE_FREQUENCY, abs=12.0)
    assert frequency.std() < 0.5 * 40.0
    limits = found.summary()["limits"]["critical_depth_mm"]["last"]
    speeds = rpm(found.diagram.speeds)
    shared = [k for k, speed in enumerate(SPEEDS) if np.isfinite(true[k])]
    # a limit below the diagram counts as its end
    deep = np.nan_to_num(np.array(limits[1], dtype=float), nan=8.0)
    learnt = np.interp(SPEEDS[shared], speeds, deep)
    declared = np.interp(SPEEDS[shared], SPEEDS, np.minimum(limits_of(path), 8.0))
    before, after = (np.median(np.abs(one / true[shared] - 1.0)) for one in (declared, learnt))
    assert after < 0.07
    assert after < 0.5 * before
    verdicts = found.summary()["verdicts"]
    assert verdicts["right"] >= verdicts["judged"] - 1
    assert found.updated.get("structure.mode[0].frequency") == pytest.approx(
        np.median(frequency), rel=1e-9
    )


def test_command_writes_what_can_be_used_again(tests_of_true_case, tmp_path):
    folder, _ = tests_of_true_case
    path = case_of(folder, DECLARED_FREQUENCY, "declared.toml")
    asked = ["learn", str(path), str(folder / "cuts.csv"), "--particles", "32", "--aim", "metal"]
    result = chatter_command(*asked, "--risk", "0.1", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    written = {one.name for one in (tmp_path / "out").iterdir()}
    assert written == {
        "posterior.json", "learn.csv", "learn.png", "case-updated.toml", "next-cut.toml",
    }  # fmt: skip
    summary = json.loads((tmp_path / "out" / "posterior.json").read_text())
    assert summary["next_cut"]["probability_of_stability"] >= 0.9
    cut = chatter.load(tmp_path / "out" / "next-cut.toml").cut
    assert 1e3 * cut.axial_depth == pytest.approx(summary["next_cut"]["axial_depth_mm"], rel=1e-5)
    assert chatter.check(chatter.load(tmp_path / "out" / "next-cut.toml")).stable
    rows = (tmp_path / "out" / "learn.csv").read_text().splitlines()
    assert rows[0] == "spindle_speed [rpm],axial_depth [mm],probability_of_stability"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("axial_depth [mm],stable\n1,1\n", "column spindle_speed is missing"),
        ("spindle_speed [rpm],axial_depth [mm]\n8000,1\n", "no column stable"),
        ("spindle_speed [rpm],axial_depth [mm],stable\n8000,-1,1\n", "axial_depth, row 1: -0.001"),
    ],
)
def test_tests_that_cannot_be_used_are_refused(tmp_path, text, message):
    (tmp_path / "cuts.csv").write_text(text)
    case = chatter.load(case_of(tmp_path, 900.0))
    with pytest.raises(InputError, match=message):
        read_cuts(tmp_path / "cuts.csv", case)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"aim": "fun"}, "none of information, metal"),
        ({"risk": 0.0}, "--risk 0.0: a probability"),
        ({"particles": 3}, "--particles 3: a number from 32"),
    ],
)
def test_options_out_of_range_are_refused(tests_of_true_case, options, message):
    folder, _ = tests_of_true_case
    with pytest.raises(InputError, match=message):
        chatter.learn(folder / "case.toml", folder / "cuts.csv", **options)
