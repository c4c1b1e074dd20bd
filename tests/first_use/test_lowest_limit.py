"""What is stable at any speed is a bound, not the least of some samples."""

import pytest

import chatter
from tests.cases import tool_of_922_hertz
from tests.command_line import chatter_command
from tests.first_use.shop import cut, written


def test_it_does_not_depend_on_the_count_of_speeds():
    """It was 2.145 mm of 200 speeds, 2.108 of another count."""
    found = []
    for count in (37, 60):
        speeds = {"from": "9000 rpm", "to": "12000 rpm", "count": count}
        diagram = chatter.lobes(tool_of_922_hertz(lobes={"speeds": speeds}), "collocation")
        assert diagram.lowest.critical_depth <= diagram.limits.critical_depth.min()
        found.append(diagram.lowest.critical_depth)
    assert found[0] == pytest.approx(found[1], rel=2e-4)


@pytest.fixture(scope="module")
def designed():
    design = {"speeds": "1000..1500 rpm", "count": 4, "depths": "0..4 mm:10"}
    case = cut(tool__helix="0 deg", tool__teeth=2, pitch_design=design)
    return chatter.pitch(case)


def test_the_lowest_limit_of_pitch_angles_is_that_of_speeds_between_too(designed):
    """It was the least of samples, and was only said to be."""
    for one, case in ((designed.best, designed.best_case), (designed.original, designed.case)):
        fine = {"from": "1000 rpm", "to": "1500 rpm", "count": 801}
        limits = chatter.lobes(case.patch({"lobes.speeds": fine}), "collocation").limits
        least = float(limits.critical_depth.min())
        assert one.lowest_limit <= float(one.limits.min())
        assert one.lowest_limit == pytest.approx(least, rel=2e-3)


def test_pitch_angles_say_below_which_depth_any_speed_is_stable(designed):
    told = designed.sentences()
    assert any(line.startswith("stable at any of these speeds below") for line in told)
    assert "at 16 speeds" not in " ".join(told)
    # as `lobes` of the same tool says it
    speeds = {"lobes.speeds": "1000..1500 rpm:200"}
    diagram = chatter.lobes(designed.best_case.patch(speeds), "collocation")
    assert designed.best.stable_below == pytest.approx(diagram.lowest_depth, rel=5e-3)
    assert designed.best.stable_below < designed.best.lowest_limit
    # and no more of it: modes alone have no frictions of axes
    assert "edge forces that set in at a chip of zero)" in " ".join(told)


@pytest.mark.parametrize("method", ["semi-discretization", "multi-frequency"])
def test_it_is_a_bound_by_every_method(method):
    """Methods but collocation gave the least of their samples."""
    found = []
    for count in (9, 40):
        speeds = {"from": "9500 rpm", "to": "11500 rpm", "count": count}
        diagram = chatter.lobes(tool_of_922_hertz(lobes={"speeds": speeds}), method)
        found.append(diagram.lowest.critical_depth)
    assert found[0] == pytest.approx(found[1], rel=2e-3)


def test_where_no_speed_has_a_limit_it_is_said(tmp_path):
    """Nothing was printed of it, beside a pocket that is no better than any other speed."""
    path = written(tmp_path)
    stiff = ("--set", "structure.mode[*].stiffness=400 N/um", "--set", "tool.flute_length=6 mm")
    told = chatter_command("lobes", path, *stiff, "--out", tmp_path / "out").stdout
    assert "no limit at any of these speeds up to 6 mm, tool.flute_length" in told
