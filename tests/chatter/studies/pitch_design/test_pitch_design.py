"""Pitch angles: the rule, published limits, the search, and another method."""

import json
import math

import numpy as np
import pytest

import chatter
from chatter import InputError
from chatter.io.shipped_examples import example
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from chatter.studies.optimisation.stable_depths import first_limits
from chatter.studies.pitch_design.families import alternating, families, linear, regeneration
from chatter.studies.pitch_design.pitch_search import rounded_pitch
from tests.command_line import chatter_command

RPM = math.pi / 30.0


def tool_of_1999(**changes):
    """Altintas, Engin and Budak 1999, as in validation 4."""
    case = chatter.load(example("pitch-design").folder / "case.toml")
    return case.patch(changes)


def test_angles_of_a_family_make_a_turn():
    for teeth in (2, 3, 4, 5, 6):
        for family in families(teeth):
            angles = family.angles(teeth, 0.1)
            assert angles.sum() == pytest.approx(2.0 * math.pi)
            widest = angles.max() - 2.0 * math.pi / teeth
            assert widest == pytest.approx(0.1 * family.widest(teeth))
    assert [one.name for one in families(3)] == ["linear"]
    assert np.degrees(alternating(4, math.radians(40))) == pytest.approx([70, 110, 70, 110])
    assert np.degrees(linear(3, math.radians(10))) == pytest.approx([110, 120, 130])


@pytest.mark.parametrize("teeth", [2, 3, 4, 5, 6])
def test_the_rule_leaves_no_regeneration(teeth):
    speed, frequency = 520.0, 3400.0
    for family in families(teeth):
        for difference in family.cancelling(teeth, speed, frequency, 5):
            assert regeneration(family.angles(teeth, difference), speed, frequency) < 1e-9
    assert regeneration(alternating(4, 0.0), speed, frequency) == pytest.approx(1.0)
    # Slavicek: half a wave between neighbours
    first = families(4)[0].cancelling(4, speed, frequency, 1)[0]
    assert first == pytest.approx(math.pi * speed / frequency)


def test_limits_of_the_published_cutter():
    # validation 4: exact limits without helix, mm
    pitch = ["70 deg", "110 deg", "70 deg", "110 deg"]
    case = tool_of_1999(**{"tool.pitch": pitch, "tool.helix": "0 deg"})
    speeds = np.array([3000.0, 4000.0, 5000.0, 6000.0, 8000.0]) * RPM
    depths = np.linspace(0.0, 8e-3, 41)[1:]
    found = first_limits(element_cut(milling_model(case), 8e-3), speeds, depths)
    assert found * 1e3 == pytest.approx([3.9037, 1.7965, 6.1649, 3.0954, 4.9829], rel=1e-3)


@pytest.fixture(scope="module")
def designed():
    section = {
        "speeds": {"from": "4500 rpm", "to": "6500 rpm"},
        "count": 4,
        "depths": {"to": "6 mm", "count": 12},
    }
    return chatter.pitch(tool_of_1999(pitch_design=section))


def test_the_search_finds_what_the_rule_says(designed):
    curve = next(one for one in designed.curves if one.name == "alternating")
    # half a wave at 5500 rpm and the chatter frequency of the uniform-pitch tool
    rule = math.pi * 5500.0 * RPM / (2.0 * math.pi * designed.chatter_frequency)
    assert curve.rule == pytest.approx([rule])
    assert 500.0 < designed.chatter_frequency < 600.0
    lowest = [one.lowest_limit for one in curve.designs]
    best = float(curve.differences[int(np.argmax(lowest))])
    step = float(curve.differences[1])
    assert best == pytest.approx(rule, abs=1.5 * step)
    # the paper's 40 degrees lie half a wave apart at 7 050 rpm
    paper = math.radians(40.0) * designed.chatter_frequency * 2.0
    assert paper / RPM == pytest.approx(7050.0, rel=0.03)


def test_the_gain_is_that_of_another_method(designed):
    assert designed.is_better
    assert designed.best.lowest_limit > 2.0 * designed.original.lowest_limit
    assert designed.best.max_pitch_ratio <= 1.25 + 1e-9
    assert sum(designed.best.pitch) == pytest.approx(360.0)
    # cuts simulated in time, which knows no multipliers
    depth, lowest = 0.85 * designed.best.lowest_limit, int(designed.best.limits.argmin())
    verdicts = {}
    for case, name in ((designed.case, "before"), (designed.best_case, "after")):
        for speed in (4700.0, 5100.0, designed.speeds[lowest] / RPM):
            cut = {"cut.spindle_speed": speed * RPM, "cut.axial_depth": depth}
            run = chatter.simulate(case.patch(cut))
            verdicts.setdefault(name, set()).add(run.detection.verdict)
    assert verdicts == {"before": {"chatter"}, "after": {"stable"}}
    deeper = {
        "cut.spindle_speed": float(designed.speeds[lowest]),
        "cut.axial_depth": 1.2 * designed.best.lowest_limit,
    }
    assert chatter.simulate(designed.best_case.patch(deeper)).detection.verdict == "chatter"


def test_angles_in_tenths_make_a_turn():
    for angles in ([360 / 7.0] * 7, [75.03, 104.97, 75.03, 104.97], [119.96, 120.02, 120.02]):
        found = rounded_pitch(angles)
        assert sum(found) == pytest.approx(360.0, abs=1e-9)
        assert found == pytest.approx(angles, abs=0.11)


def test_the_command_writes_a_case_that_others_accept(tmp_path):
    section = {
        "speeds": {"from": "5400 rpm", "to": "5600 rpm"},
        "count": 2,
        "depths": {"to": "6 mm", "count": 10},
        "max_pitch_ratio": 1.1,
        "goal": "removal rate",
    }
    case = tool_of_1999(**{"tool.helix": "0 deg", "tool.teeth": 2}).patch({"pitch_design": section})
    path, out = tmp_path / "case.toml", tmp_path / "out"
    case.save(path)
    answer = chatter_command("pitch", path, "--out", out, "--json")
    assert answer.exit_code == 0, answer.stderr
    summary = json.loads((out / "summary.json").read_text())
    assert summary["best"]["max_pitch_ratio"] <= 1.1 + 1e-9
    found = chatter.load(out / "case-pitch.toml")
    assert np.degrees(found.tool.pitch) == pytest.approx(summary["best"]["pitch_deg"])
    assert (out / "pitch.png").stat().st_size > 10_000


def test_one_tooth_has_no_pitch():
    with pytest.raises(InputError, match=r"tool\.teeth"):
        chatter.pitch(tool_of_1999(**{"tool.teeth": 1}))
