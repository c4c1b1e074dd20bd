"""Ranges are FROM..TO:COUNT in every command, and what is wrong with one is said at its place."""

import pytest

from chatter.studies.whatif.whatif_study import whatif
from tests.command_line import chatter_command
from tests.first_use.shop import cut, written

DEPTH = "cut.axial_depth"
WIDTH = "cut.radial_depth"
RANGES = [("bifurcation", "--vary", DEPTH), ("whatif", "--vary", WIDTH), ("lobes", "--x", WIDTH)]


@pytest.mark.parametrize(("command", "option", "path"), RANGES)
@pytest.mark.parametrize(
    ("span", "told"),
    [
        # it blamed "--count", which was not typed
        ("1 mm..2 mm:0", "a count of 0 is given; 2 to "),
        ("1 mm..2 mm:-3", "a count of -3 is given; 2 to "),
        # it said `has the unknown unit "mm:two"`
        ("1 mm..2 mm:two", '"two" is no count; behind the colon of FROM..TO:COUNT'),
    ],
)
def test_a_wrong_count_is_said_at_the_range(command, option, path, span, told, tmp_path):
    result = chatter_command(command, written(tmp_path), option, f"{path}={span}")
    assert result.exit_code == 2
    assert f"{option} {path}: {told}" in result.stderr


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("cut.axial_depht=1 mm..2 mm:5", 'did you mean "axial_depth"?'),
        ("cut.mode=up..down:3", "there is no such quantity in a case; a path to one is wanted"),
        # three cuts alike, and a warning of the library that draws
        ("cut.axial_depth=1 mm..1 mm:3", "the range is empty; two different ends are required"),
        ("cut.axial_depth=1 mm, 2 mm", "FROM..TO"),
        ("cut.spindle_speed=1000..2000:3", "has no unit"),
    ],
)
def test_a_wrong_range_of_a_bifurcation(given, told, tmp_path):
    result = chatter_command("bifurcation", written(tmp_path), "--vary", given)
    assert result.exit_code == 2
    assert told in result.stderr


def test_one_unit_is_enough_in_bifurcation_as_in_whatif(tmp_path):
    """ "1..4 mm" was taken by `whatif` and refused by `bifurcation`."""
    result = chatter_command("bifurcation", written(tmp_path), "--vary", f"{DEPTH}=1..4 mm:1")
    assert "a count of 1 is given" in result.stderr


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("+-10", 'has no unit; a change is written in percent of what stands, "+-10%"'),
        # it said that the radial depth has no effect
        ("+-0%", "a change of 0 % varies nothing"),
    ],
)
def test_a_wrong_change(change, told, tmp_path):
    result = chatter_command("whatif", written(tmp_path), "--vary", f"{WIDTH}={change}")
    assert result.exit_code == 2
    assert told in result.stderr


def test_one_value_alone_is_answered():
    """It wrote its files, and printed no number."""
    found = whatif(cut(), [f"{WIDTH}=8 mm"], "critical depth")
    (sentence,) = found.sentences()
    depth = found.outcomes[0].numbers["critical_depth_mm"]
    assert sentence == f"critical depth at 1194 rpm: {depth:.4g} mm at {WIDTH} = 8 mm"
