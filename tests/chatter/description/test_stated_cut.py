"""Cuts as a shop states them: cutting speed, feed rate, lengths of the tool; slips in units."""

import math
import re

import numpy as np
import pytest

import chatter
from chatter import InputError
from chatter.description.case import loads
from cutting.tool.cutter import Cutter, edge_slices
from tests.command_line import chatter_command

CASE = """
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "250 MPa"
[cut]
mode = "down"
{speed}
{feed}
axial_depth = "0.5 mm"
radial_depth = "8 mm"
[[structure.mode]]
frequency = "900 Hz"
damping = 0.03
stiffness = "12 N/um"
direction = [0, 1, 0]
"""
SPEED, FEED = 'spindle_speed = "6000 rpm"', 'feed_per_tooth = "0.1 mm"'


def text(speed=SPEED, feed=FEED):
    return CASE.format(speed=speed, feed=feed)


def test_cutting_speed_is_pi_diameter_speed():
    # n = 1000 v/(pi D): 60 m/min at 16 mm
    cut = loads(text(speed='cutting_speed = "60 m/min"')).cut
    assert cut.spindle_speed_rpm == pytest.approx(1000.0 * 60.0 / (math.pi * 16.0), rel=1e-12)


def test_feed_rate_is_feed_teeth_speed():
    # f_z = v_f/(z n): 2400 mm/min by 4 teeth at 6000 rpm
    cut = loads(text(feed='feed_rate = "2400 mm/min"')).cut
    assert cut.feed_per_tooth == pytest.approx(0.1e-3, rel=1e-12)


def test_both_together():
    cut = loads(text('cutting_speed = "60 m/min"', 'feed_rate = "380 mm/min"')).cut
    turns = 1000.0 * 60.0 / (math.pi * 16.0)
    assert 1e3 * cut.feed_per_tooth == pytest.approx(380.0 / (4.0 * turns), rel=1e-12)


def test_a_patch_of_one_takes_the_other_away(tmp_path):
    case = loads(text('cutting_speed = "60 m/min"'))
    faster = case.patch({"cut.spindle_speed": "9000 rpm"})
    assert faster.cut.cutting_speed is None
    faster.save(tmp_path / "case.toml")
    assert chatter.load(tmp_path / "case.toml").cut.spindle_speed_rpm == pytest.approx(9000.0)
    # the statement holds for another tool
    larger = case.patch({"tool.diameter": "32 mm"})
    assert larger.cut.spindle_speed == pytest.approx(0.5 * case.cut.spindle_speed, rel=1e-12)
    # and the feed rate at another speed
    fed = loads(text(feed='feed_rate = "2400 mm/min"')).patch({"cut.spindle_speed": "12000 rpm"})
    assert fed.cut.feed_per_tooth == pytest.approx(0.05e-3, rel=1e-12)


def test_both_of_a_pair_are_refused():
    with pytest.raises(InputError, match=r"cut.cutting_speed: cut.spindle_speed is given as well"):
        loads(text(speed=SPEED + '\ncutting_speed = "60 m/min"'))


@pytest.mark.parametrize("key", ['cutting_speed = "3000 m/s"', 'feed_rate = "380 m/min"'])
def test_speeds_that_nothing_has_are_refused(key):
    given = {"speed": key} if key.startswith("cutting") else {"feed": key}
    with pytest.raises(InputError, match="out of"):
        loads(text(**given))


def test_a_bare_spindle_speed_is_refused_with_the_units_it_could_have(tmp_path):
    with pytest.raises(InputError, match=r'14000 has no unit; write "14000 rpm", or "14000 rad/s"'):
        loads(text(speed="spindle_speed = 14000"))
    (tmp_path / "case.toml").write_text(text())
    result = chatter_command("check", tmp_path / "case.toml", "--set", "cut.spindle_speed=14000")
    assert result.exit_code == 2
    assert '"14000 rpm", or "14000 rad/s"' in result.stderr
    varied = chatter_command(
        "whatif", tmp_path / "case.toml", "--vary", "cut.spindle_speed=1000..2000:3"
    )
    assert varied.exit_code == 2
    assert "has no unit" in varied.stderr


@pytest.mark.parametrize(
    ("key", "path", "units"),
    [
        ({"speed": "cutting_speed = 180"}, "cut.cutting_speed=180", '"180 m/min", or "180 m/s"'),
        ({"feed": "feed_rate = 900"}, "cut.feed_rate=900", '"900 mm/min", or "900 m/s"'),
    ],
)
def test_other_bare_speeds_of_a_cut_are_refused_as_well(tmp_path, key, path, units):
    # 180 m/s were 10 800 m/min, and the cut stable at a speed that no spindle has
    with pytest.raises(InputError, match=re.escape(f"has no unit; write {units}")):
        loads(text(**key))
    (tmp_path / "case.toml").write_text(text())
    result = chatter_command("check", tmp_path / "case.toml", "--set", path)
    assert result.exit_code == 2
    assert units in result.stderr
    varied = chatter_command("whatif", tmp_path / "case.toml", "--vary", path.replace("=", "=1,"))
    assert varied.exit_code == 2
    assert "has no unit" in varied.stderr


def test_speeds_of_python_are_written_with_their_unit(tmp_path):
    case = loads(text()).patch({"lobes.speeds": {"from": 300.0, "to": 700.0, "count": 9}})
    case.save(tmp_path / "case.toml")
    again = chatter.load(tmp_path / "case.toml")
    assert (again.lobes.speeds.from_, again.lobes.speeds.to) == (300.0, 700.0)


@pytest.mark.parametrize("key", ["flute_length", "stick_out", "maximum_depth"])
def test_no_search_is_deeper_than_the_tool_can_cut(key):
    case = loads(text()).patch({f"tool.{key}": "1 mm", "material.Ktc": "80 MPa"})
    found = chatter.check(case)
    assert found.max_depth == pytest.approx(1e-3)
    assert math.isinf(found.critical_depth)
    assert f"no limit up to 1 mm, tool.{key}" in [row[1] for row in found.rows()]
    diagram = chatter.lobes(case.patch({"lobes.depths": {"to": "20 mm"}}), grid=True)
    assert np.max(diagram.max_depth) == pytest.approx(1e-3)
    limits = np.asarray(diagram.limits.critical_depth)
    assert np.all(limits[np.isfinite(limits)] <= 1e-3 * (1.0 + 1e-9))
    assert all(pocket.axial_depth <= 1e-3 * (1.0 + 1e-9) for pocket in diagram.pockets)


def test_a_search_ends_at_the_longest_usual_flutes_and_names_the_keys():
    """A thin wall without a key that ends it was searched down to 105 mm with a tool of 12 mm."""
    # edge forces of many times the chip's, so that no pocket is named
    material = {"Ktc": "10 MPa", "Krc": "3 MPa", "Kte": "20 N/mm", "Kre": "20 N/mm"}
    case = loads(text()).patch({"material": material, "lobes.speeds": "3000..9000 rpm:20"})
    diagram = chatter.lobes(case)
    assert np.max(diagram.max_depth) == pytest.approx(8.0 * case.tool.diameter)
    (told,) = [one for one in diagram.notes if "maximum axial depth searched" in one]
    assert "8 diameters of the tool: state tool.flute_length" in told
    assert "lobes.depths.to" in told
    for key, value in (("lobes.depths.to", "60 mm"), ("tool.flute_length", "60 mm")):
        ended = chatter.lobes(case.patch({key: value}))
        assert np.max(ended.max_depth) == pytest.approx(60e-3)
        assert not any("maximum axial depth searched" in one for one in ended.notes)


def test_a_cut_deeper_than_the_flutes_is_refused():
    with pytest.raises(InputError, match=r"0.5 mm is more than tool.flute_length, 0.4 mm"):
        loads(text()).patch({"tool.flute_length": "0.4 mm"})


def test_a_slot_needs_no_second_change():
    case = loads(text()).patch({"cut.mode": "slot"})
    assert case.width_of_cut == case.tool.diameter


def test_none_takes_a_key_away_everywhere(tmp_path):
    (tmp_path / "case.toml").write_text(text() + "[process_damping]\ncoefficient = 1e5\n")
    asked = ["check", tmp_path / "case.toml", "--json"]
    damped = chatter_command(*asked)
    without = chatter_command(*asked, "--set", "process_damping=none")
    (tmp_path / "plain.toml").write_text(text())
    plain = chatter_command("check", tmp_path / "plain.toml", "--json")
    assert without.stdout == plain.stdout != damped.stdout


def test_check_says_its_verdict_in_words_and_by_its_exit_code(tmp_path):
    (tmp_path / "case.toml").write_text(text())
    stable = chatter_command("check", tmp_path / "case.toml", "--exit-code")
    assert stable.exit_code == 0
    assert stable.stdout.startswith("stable: 0.5 mm at 6000 rpm")
    # 0.016 m pi 6000/min; 0.1 mm, 4 teeth
    assert "301.6 m/min" in stable.stdout
    assert "2400 mm/min" in stable.stdout
    deep = ["check", tmp_path / "case.toml", "--set", "cut.axial_depth=9 mm"]
    assert chatter_command(*deep, "--exit-code").exit_code == 3
    assert chatter_command(*deep).exit_code == 0
    assert chatter_command(*deep).stdout.startswith("chatter: 9 mm at 6000 rpm")


def test_one_syntax_of_ranges(tmp_path):
    (tmp_path / "case.toml").write_text(text() + "[simulation]\nrevolutions = 12\n")
    asked = [tmp_path / "case.toml", "--vary", "cut.axial_depth=0.2 mm..0.8 mm:4"]
    varied = chatter_command(
        "whatif", *asked, "--result", "critical depth", "--out", tmp_path / "w"
    )
    assert varied.exit_code == 0, varied.output
    assert len((tmp_path / "w" / "whatif.csv").read_text().splitlines()) == 5
    swept = chatter_command("bifurcation", *asked, "--out", tmp_path / "b", "--json")
    assert swept.exit_code == 0, swept.output
    assert swept.stdout.count('"verdict"') == 4
    words = chatter_command("bifurcation", *asked, "--out", tmp_path / "b").stdout
    assert "0.2 mm to 0.8 mm: " in words


BALL = text().replace('kind = "end mill"', 'kind = "ball"').replace('"16 mm"', '"10 mm"')


def test_the_effective_diameter_of_a_ball_is_shown(tmp_path):
    # D_eff = 2 sqrt(a_p (D - a_p)): 4.359 mm at 0.5 mm of 10 mm; pi D_eff n
    (tmp_path / "case.toml").write_text(BALL)
    shown = chatter_command("check", tmp_path / "case.toml").stdout
    effective = 2.0 * math.sqrt(0.5 * (10.0 - 0.5))
    assert f"{effective:.4g} mm" in shown
    assert f"{math.pi * effective * 6.0:.4g} m/min there" in shown


@pytest.mark.parametrize(
    ("corner", "edge", "height", "radius"),
    [
        # a ball of 10 mm at 0.5 mm; above its corner; a cone of 45 degrees; a bull nose of 2 mm
        (5e-3, 90.0, 0.5e-3, math.sqrt(0.5 * 9.5) * 1e-3),
        (5e-3, 90.0, 9e-3, 5e-3),
        (0.0, 45.0, 2e-3, 7e-3),
        (2e-3, 90.0, 0.5e-3, 3e-3 + math.sqrt(2.0**2 - 1.5**2) * 1e-3),
    ],
)
def test_radius_at_a_height(corner, edge, height, radius):
    cutter = Cutter(10e-3, (0.0,), (2.0 * math.pi,), corner, math.radians(edge))
    assert cutter.radius_at(height) == pytest.approx(radius, rel=1e-12)
    if height < 5e-3:
        # as the slices have it
        slices = edge_slices(cutter, 2.0 * height, (400 if corner else 0, 0 if corner else 400))
        at = np.interp(height, slices.height, slices.radius)
        assert at == pytest.approx(radius, rel=1e-4)
