"""Ranges are FROM..TO:COUNT in every command, and what is wrong with one is said at its place."""

import pytest

import chatter
from chatter import InputError
from chatter.studies.whatif.whatif_study import whatif
from tests.command_line import chatter_command
from tests.first_use.shop import cut, written
from tests.places import EXAMPLES

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
        ("cut.mode=up..down:3", "is no quantity that varies smoothly, as an axis does"),
        ("tool.teeth=2..6", "`chatter whatif` compares its values"),
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


@pytest.mark.parametrize(
    ("path", "told"),
    [
        # in the unit of the file; it was -0.0005, "a bare number is in m"
        ("cut.axial_depth", '+-200% of 0.5 mm: "-0.5 mm" is out of range'),
        ("cut.cutting_speed", '+-200% of 60 m/min: "-60 m/min" is out of range'),
        ("tool.helix", '+-200% of 40 deg: "120 deg" is out of range; it must be less than 90 deg'),
        ("material.Ktc", '+-200% of 1900 MPa: "-1900 MPa" is out of range'),
        ("structure.mode[*].stiffness", '+-200% of 12 N/um: "-12 N/um" is out of range'),
        ("structure.mode[1].damping", "+-200% of 0.03: -0.03 is out of range"),
        # not in the file as it is: the usual unit
        ("cut.spindle_speed", 'rpm: "-1193.66207318922 rpm" is out of range'),
    ],
)
def test_a_change_beyond_what_a_quantity_may_be_is_told_in_the_unit_of_the_file(
    path, told, tmp_path
):
    result = chatter_command("whatif", written(tmp_path), "--vary", f"{path}=+-200%")
    assert result.exit_code == 2
    assert told in result.stderr
    assert "a bare number" not in result.stderr


def test_a_change_beyond_the_range_in_the_machine_is_told_in_its_unit(tmp_path):
    machine = EXAMPLES / "machine-gantry" / "machine-of-beams.toml"
    result = chatter_command("whatif", machine, "--vary", "body.head.mass=+-200%")
    assert result.exit_code == 2
    assert 'body.head.mass: +-200% of 47 kg: "-47 kg" is out of range' in result.stderr


def test_a_speed_that_no_spindle_has_is_told_in_rpm():
    """ "2.618e+06 rad/s is out of any plausible range" answered a speed in rpm."""
    with pytest.raises(InputError, match=r"2\.5e\+07 rpm is out of any plausible range, 0\.955 to"):
        chatter.check(cut(cut__spindle_speed="2.5e7 rpm"))


def test_one_value_alone_is_answered():
    """It wrote its files, and printed no number."""
    found = whatif(cut(), [f"{WIDTH}=8 mm"], "critical depth")
    (sentence,) = found.sentences()
    depth = found.outcomes[0].numbers["critical_depth_mm"]
    assert sentence == f"critical depth at 1194 rpm: {depth:.4g} mm at {WIDTH} = 8 mm"
