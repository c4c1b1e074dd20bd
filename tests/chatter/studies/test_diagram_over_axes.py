"""Limits and maps over any path of a case: against checks and limits over speed, and refusals."""

import csv
import json
import math

import numpy as np
import pytest

import chatter
from chatter import InputError, RunError
from chatter.io.result_tables import csv_text
from tests.cases import tool_of_922_hertz
from tests.command_line import chatter_command

RPM = math.pi / 30.0
MODE = {"frequency": "922 Hz", "damping": 0.011, "mass": "0.03993 kg"}


def two_degrees_of_freedom(**cut):
    """Cut of a tool that is alike along the feed and across it."""
    small = {"mode": "up", "spindle_speed": "20000 rpm", "axial_depth": "2.5 mm"}
    return tool_of_922_hertz(
        ((1, 0, 0), (0, 1, 0)),
        cut={**small, "radial_depth": "0.8 mm", **cut},
        lobes={
            "speeds": {"from": "15000 rpm", "to": "20000 rpm", "count": 6},
            "depths": {"to": "10 mm", "count": 60},
        },
    )


@pytest.fixture(scope="module")
def over_radial_depth():
    return chatter.lobes_over(two_degrees_of_freedom(), "cut.radial_depth=0.8 mm..4 mm:3")


def test_limits_over_radial_depth_are_those_of_checks(over_radial_depth):
    found = over_radial_depth
    assert found.axis.values == pytest.approx([0.8, 2.4, 4.0])
    assert found.axis.unit == "mm"
    for place, depth in enumerate(("0.8 mm", "2.4 mm", "4 mm")):
        checked = chatter.check(two_degrees_of_freedom(radial_depth=depth))
        assert found.limits.critical_depth[place] == pytest.approx(checked.critical_depth, rel=1e-9)
        assert found.limits.bifurcation[place] == checked.limit.bifurcation[0]
        assert found.limits.crossings[place] == pytest.approx(checked.limit.crossings[0], rel=1e-9)
    # validation 2.3: 3.250386 mm by flip at 20 000 rpm; a flip is heard at half the tooth
    # frequency, or an odd multiple of it
    assert found.limits.critical_depth[0] == pytest.approx(3.250386e-3, rel=2e-4)
    assert found.limits.bifurcation[0] == "flip"
    half = 2 * 20000 / 60.0 / 2.0
    assert (found.limits.chatter_frequency[0] / half) % 2.0 == pytest.approx(1.0, abs=1e-6)


def test_limits_over_speed_are_those_of_the_diagram():
    case = two_degrees_of_freedom()
    found = chatter.lobes_over(case, "cut.spindle_speed=15000 rpm..20000 rpm:6")
    diagram = chatter.lobes(case)
    assert found.axis.values * RPM == pytest.approx(diagram.limits.spindle_speed)
    assert found.limits.critical_depth == pytest.approx(diagram.limits.critical_depth, rel=1e-6)
    assert found.limits.bifurcation == diagram.limits.bifurcation


def test_limits_scale_with_the_material_and_the_modes():
    case = two_degrees_of_freedom()
    values = [300e6, 600e6, 1200e6]
    # forces k times as high leave a limit of 1/k
    limits = []
    for value in values:
        patched = case.patch({"material.Krc": value / 3.0})
        found = chatter.lobes_over(patched, ("material.Ktc", [value, 2.0 * value]))
        limits.append(found.limits.critical_depth[0])
    assert np.array(limits) * values == pytest.approx(limits[0] * values[0], rel=1e-5)
    # up and down milling of a full slot are the same cut
    slot = "cut.feed_per_tooth=0.05 mm..0.2 mm:3"
    limits = [
        chatter.lobes_over(two_degrees_of_freedom(mode=mode, radial_depth="16 mm"), slot)
        for mode in ("up", "down")
    ]
    assert limits[0].limits.critical_depth == pytest.approx(
        limits[1].limits.critical_depth, rel=1e-6
    )
    # with a linear force law the feed does not matter
    assert np.ptp(limits[0].limits.critical_depth) <= 1e-6 * limits[0].limits.critical_depth[0]


def test_boundary_of_a_map_over_speed_and_depth_is_the_limit():
    case = two_degrees_of_freedom()
    mapped = chatter.lobes_over(case, y="cut.axial_depth=0.5 mm..5 mm:46")
    limits = chatter.lobes(case).limits
    assert mapped.x_axis.values * RPM == pytest.approx(limits.spindle_speed)
    assert mapped.spectral_radius.shape == (46, 6)
    for boundary, crossings in zip(mapped.boundary, limits.crossings, strict=True):
        inside = crossings[(crossings > 0.5e-3) & (crossings < 5e-3)]
        assert len(boundary) == len(inside)
        # as fine as the map: 0.1 mm apart
        assert boundary * 1e-3 == pytest.approx(inside, abs=0.02e-3)


def test_a_map_does_not_depend_on_which_path_goes_across():
    case = two_degrees_of_freedom()
    depth, speed = "cut.axial_depth=1 mm..4 mm:4", "cut.spindle_speed=15000 rpm..20000 rpm:3"
    width = "cut.radial_depth=0.8 mm..3 mm:3"
    for first, second in (
        (depth, speed),
        (width, depth),
        (width, "structure.mode[0].damping=0.01..0.02:2"),
    ):
        one, other = (
            chatter.lobes_over(case, first, second),
            chatter.lobes_over(case, second, first),
        )
        assert one.spectral_radius == pytest.approx(other.spectral_radius.T, rel=1e-9)
    mapped = chatter.lobes_over(case, width, depth)
    checked = chatter.check(case.patch({"cut.radial_depth": "3 mm", "cut.axial_depth": "4 mm"}))
    assert mapped.spectral_radius[-1, -1] == pytest.approx(checked.spectral_radius, rel=1e-4)


def test_modes_that_depend_on_speed_are_taken_at_each_speed():
    case = two_degrees_of_freedom().patch({"structure.mode[0].frequency_slope": -5e-5})
    mapped = chatter.lobes_over(
        case, "cut.spindle_speed=15000 rpm..20000 rpm:2", "cut.radial_depth=0.8 mm..2 mm:2"
    )
    for place, speed in enumerate(("15000 rpm", "20000 rpm")):
        checked = chatter.check(case.patch({"cut.spindle_speed": speed}))
        assert mapped.spectral_radius[0, place] == pytest.approx(checked.spectral_radius, rel=1e-4)
    standing = chatter.check(two_degrees_of_freedom())
    assert abs(mapped.spectral_radius[0, 1] - standing.spectral_radius) > 1e-3


def test_closed_islands_leave_several_stable_intervals():
    # Zatarain et al. (2006): a helix closes the flip lobes into islands
    case = two_degrees_of_freedom(radial_depth="0.4 mm").patch(
        {
            "tool.helix": "45 deg",
            "structure.mode": [{**MODE, "direction": [1, 0, 0]}],
            "lobes.depths": {"to": "40 mm", "count": 200},
        }
    )
    found = chatter.lobes_over(case, "cut.spindle_speed=17000 rpm..21000 rpm:9")
    several = [crossings for crossings in found.limits.crossings if len(crossings) > 1]
    assert several
    assert found.summary()["values_with_several_stable_intervals"] == len(several)
    assert found.plot().axes


def ball():
    """Ball of 12 mm, 0.5 mm deep, where it reaches 2.4 mm from its axis."""
    return two_degrees_of_freedom(axial_depth="0.5 mm", radial_depth="6 mm").patch(
        {"tool.kind": "ball", "tool.diameter": "12 mm"}
    )


def test_a_value_that_the_tool_does_not_reach_leaves_a_gap(tmp_path):
    found = chatter.lobes_over(ball(), "cut.radial_depth=2 mm..6 mm:5")
    # at a height h the ball reaches sqrt(2 R h - h^2) from its axis, and the work is R - a_e off
    reached = np.sqrt(2 * 6.0 * 0.5 - 0.25) > 6.0 - found.axis.values
    assert list(np.isfinite(found.max_depth)) == list(reached)
    assert reached.tolist() == [False, False, True, True, True]
    assert all(("not reach" in why) != ok for why, ok in zip(found.reasons, reached, strict=True))
    assert np.isnan(found.limits.critical_depth[:2]).all()
    assert list(found.excluded) == ["cut.radial_depth = 2 mm", "cut.radial_depth = 3 mm"]
    assert found.sentences()[0].startswith(
        "excluded, cut.radial_depth = 2 mm: cut.radial_depth: down"
    )
    alone = chatter.lobes_over(ball(), "cut.radial_depth=4 mm..6 mm:3")
    assert found.limits.critical_depth[2:] == pytest.approx(alone.limits.critical_depth)
    found.save(tmp_path)
    with (tmp_path / "lobes.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [bool(row["excluded"]) for row in rows] == [True, True, False, False, False]
    assert rows[0]["critical_depth [mm]"] == ""
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert set(summary["excluded"]) == set(found.excluded)


def test_values_that_the_tool_does_not_reach_leave_a_gap_in_a_map(tmp_path):
    width, speed = "cut.radial_depth=2 mm..6 mm:3", "cut.spindle_speed=9000 rpm..12000 rpm:2"
    found = chatter.lobes_over(ball(), speed, width)
    assert np.isnan(found.spectral_radius).tolist() == [[True] * 2, [False] * 2, [False] * 2]
    assert list(found.excluded) == ["cut.radial_depth = 2 mm"]
    assert np.isfinite(found.summary()["stable_share"])
    assert (found.save(tmp_path)[-1]).stat().st_size > 10_000


def test_nothing_is_drawn_where_no_value_is_reached():
    with pytest.raises(InputError, match=r"at cut.radial_depth = 1 mm, and at every other value"):
        chatter.lobes_over(ball(), "cut.radial_depth=1 mm..2 mm:2")
    with pytest.raises(InputError, match=r"at cut.radial_depth = 20 mm: .*more than the diameter"):
        chatter.lobes_over(ball(), "cut.radial_depth=5 mm..20 mm:2")


def write_case(folder):
    cut = {"mode": "up", "spindle_speed": "20000 rpm", "axial_depth": "2.5 mm"}
    path = folder / "case.toml"
    tool_of_922_hertz(cut={**cut, "radial_depth": "0.8 mm"}).save(path)
    return str(path)


def test_files_of_the_command(tmp_path):
    case, out = write_case(tmp_path), tmp_path / "out"
    width = 'cut.radial_depth="0.5 mm".."2 mm":3'
    done = chatter_command("lobes", case, "--x", width, "--out", out)
    assert done.exit_code == 0, done.output
    with (out / "lobes.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["cut.radial_depth [mm]"]) for row in rows] == [0.5, 1.25, 2.0]
    summary = json.loads((out / "summary.json").read_text())
    assert summary["x"]["path"] == "cut.radial_depth"
    assert summary["x"]["value_of_the_case"] == pytest.approx(0.8)
    assert (out / "lobes.png").stat().st_size > 10_000
    speed = "cut.spindle_speed=15000 rpm..20000 rpm:3"
    done = chatter_command("lobes", case, "--x", speed, "--y", width, "--out", out, "--json")
    assert done.exit_code == 0, done.output
    with (out / "lobes.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["cut.spindle_speed [rpm]", "cut.radial_depth [mm]", "spectral_radius"]
    assert len(rows) == 9


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--x", "cut.nothing=1 mm..2 mm"], "no such quantity"),
        (["--x", "title=1..2"], "no quantity that varies smoothly"),
        (["--x", "cut.mode=up..down"], "no quantity that varies smoothly"),
        (["--x", "cut.radial_depth=1 mm..1 mm"], "range is empty"),
        (["--x", "cut.radial_depth=1 mm..2 mm:1"], "count of 1"),
        (["--x", "cut.radial_depth=1 mm..2 mm:1e9"], "--x cut.radial_depth"),
        (["--x", "cut.radial_depth=1 mm"], "FROM..TO"),
        (["--x", "cut.radial_depth=1 mm..2 kg"], "--x cut.radial_depth"),
        (["--x", "cut.radial_depth=1 mm.."], "--x cut.radial_depth"),
        (["--x", "cut.radial_depth=1 mm..20 mm:3"], "radial_depth"),
        (["--x", "cut.axial_depth=1 mm..2 mm"], "axial depth itself"),
        (["--y", "cut.spindle_speed=9000 rpm..12000 rpm"], "two paths"),
        (["--x", "machine.body[0].mass=1 kg..2 kg"], "no machine"),
        (["--x", "cut.radial_depth=1 mm..2 mm", "--grid"], "--grid"),
        (["--x", "cut.radial_depth=1 mm..2 mm", "--live"], "--live"),
        (["--y", "cut.radial_depth=1 mm..2 mm", "--cluster", "nowhere"], "--cluster"),
    ],
)
def test_refusals(tmp_path, options, told):
    out = tmp_path / "out"
    done = chatter_command("lobes", write_case(tmp_path), *options, "--out", out)
    assert done.exit_code == 2, done.output
    assert told in done.output
    assert done.output.count("chatter: ") == 1
    assert "--vary" not in done.output
    assert not out.exists()


def test_refusals_in_python():
    case = two_degrees_of_freedom()
    with pytest.raises(InputError, match="a path is required"):
        chatter.lobes_over(case)
    with pytest.raises(InputError, match="range is empty"):
        chatter.lobes_over(case, ("cut.radial_depth", ["1 mm", "1 mm"]))
    with pytest.raises(InputError, match="no values"):
        chatter.lobes_over(case, ("cut.radial_depth", []))


def test_one_that_was_interrupted_goes_on_where_it_was(tmp_path):
    def give_up(done, total):
        if done == 2:
            raise KeyboardInterrupt

    given = ("cut.radial_depth", ["2 mm", "4 mm", "6 mm", "8 mm"])
    case = tool_of_922_hertz()
    with pytest.raises(RunError, match="interrupted: 2 of 4 values are finished"):
        chatter.lobes_over(case, given, folder=tmp_path, progress=give_up)
    done = []
    found = chatter.lobes_over(case, given, folder=tmp_path, progress=lambda at, _: done.append(at))
    assert done[0] >= 2
    undisturbed = chatter.lobes_over(case, given)
    assert csv_text(found.tables()["lobes"]) == csv_text(undisturbed.tables()["lobes"])
