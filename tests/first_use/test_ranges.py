"""Ranges are FROM..TO:COUNT in every command, and what is wrong with one is said at its place."""

import math
import re

import pytest

import chatter
from chatter import InputError
from chatter.description.case import loads
from chatter.description.machine.machine_file import load_machine
from chatter.description.material_table import read_material_table
from chatter.studies.whatif.whatif_study import whatif
from tests.command_line import chatter_command
from tests.first_use.shop import CUT, cut, written
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


RANGED = CUT.replace(
    'speeds = { from = "1000 rpm", to = "2000 rpm", count = 30 }',
    'speeds = "1000..2000 rpm:30"  # of our spindle\ndepths = "0..4 mm:20"',
)


def test_a_range_is_stated_as_text_in_a_file():
    """A case file took a table alone, the command line the text alone."""
    case = loads(
        RANGED + '[optimum]\nspeeds = "1000..3000 rpm"\ndepths = "0..4 mm"\nfeeds = '
        '"0.05..0.2 mm:3"\n[pitch_design]\nspeeds = "100 rad/s..2000 rpm"\n'
    )
    rpm = math.pi / 30.0
    assert (case.lobes.speeds.from_, case.lobes.speeds.to) == pytest.approx((1e3 * rpm, 2e3 * rpm))
    assert (case.lobes.speeds.count, case.lobes.depths.count) == (30, 20)
    assert case.optimum.speeds.to == pytest.approx(3000.0 * rpm)
    assert (case.optimum.depths.from_, case.optimum.depths.to) == (None, pytest.approx(4e-3))
    assert (case.optimum.feeds.from_, case.optimum.feeds.count) == (pytest.approx(5e-5), 3)
    assert case.pitch_design.speeds.from_ == pytest.approx(100.0)
    # beside the table it is one case
    assert loads(RANGED) == cut(lobes__depths={"to": "4 mm", "count": 20})


def test_a_file_keeps_its_range_and_a_value_within_it_opens_it():
    case = loads(RANGED)
    assert 'speeds = "1000..2000 rpm:30"  # of our spindle' in case.to_toml()
    faster = case.patch({"lobes.speeds.to": "2500 rpm"})
    assert faster.lobes.speeds.to == pytest.approx(2500.0 * math.pi / 30.0)
    assert faster.lobes.speeds.count == 30
    assert loads(faster.to_toml()) == faster


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("1000..2000:30", '"1000..2000:30" is no range with units; FROM..TO:COUNT is required'),
        ("1000 rpm", '"1000 rpm" is no range with units'),
        ("1000..2000 rpm:two", '"two" is no count; behind the colon'),
        ("2000..1000 rpm", "the range is empty: from (2000 rpm) is not less than to (1000 rpm)"),
        ("1..2 mm", 'lobes.speeds.from: "1 mm" is a length'),
    ],
)
def test_a_wrong_range_of_a_file_is_told_with_its_key(given, told):
    with pytest.raises(InputError) as found:
        loads(RANGED.replace("1000..2000 rpm:30", given), "shop.toml")
    assert told in str(found.value)
    assert str(found.value).startswith("shop.toml: lobes.speeds")


def test_a_band_has_no_count_and_depths_of_a_diagram_begin_at_zero():
    with pytest.raises(InputError, match="has a count, which does not belong here"):
        loads(CUT + '[pitch_design]\nspeeds = "1000..2000 rpm:30"\n')
    with pytest.raises(InputError, match="it begins at 0"):
        loads(RANGED.replace('"0..4 mm:20"', '"1..4 mm:20"'))


def test_the_schema_takes_a_range_either_way():
    table, text = chatter.schema()["$defs"]["SpeedRange"]["anyOf"]
    assert table["required"] == ["from", "to"]
    assert re.match(text["pattern"], "1000 rpm..2000 rpm:30")
    assert re.match(text["pattern"], text["examples"][0])
    assert not re.match(text["pattern"], "1000..2000")


def test_a_new_case_shows_how_a_range_is_written(tmp_path):
    path = tmp_path / "new.toml"
    answers = ("12 mm, 4", "Al7075-T6", "8000 rpm, 0.05 mm, 1 mm", "slot", "900 Hz, 0.03, 15 N/um")
    names = ("tool", "material", "cut", "engagement", "dynamics")
    given = [word for name, one in zip(names, answers, strict=True) for word in (f"--{name}", one)]
    assert chatter_command("new", path, *given).exit_code == 0
    text = path.read_text(encoding="utf-8")
    line = '# [lobes]\n# speeds = "4000..16000 rpm:400"\n'
    assert line in text
    case = loads(text.replace(line, line.replace("# ", "")))
    assert case.lobes.speeds.to == pytest.approx(16000.0 * math.pi / 30.0)


def test_a_band_of_a_machine_and_a_chip_of_a_material_are_ranges_too(tmp_path):
    machine = (EXAMPLES / "machine-gantry" / "machine-of-beams.toml").read_text(encoding="utf-8")
    text = '[frf.mine]\nexcite = "head:x"\nband = "5..400 Hz"\n'
    path = tmp_path / "machine.toml"
    path.write_text(re.split(r"^\[frf\.", machine, flags=re.MULTILINE)[0] + text, encoding="utf-8")
    assert load_machine(path).frf["mine"].band == pytest.approx((5.0, 400.0))
    table = tmp_path / "own.toml"
    table.write_text('["a"]\nKtc = "1 GPa"\nKrc = "1 GPa"\nsource = "s"\n'
                     'chip_thickness = "0.02..0.2 mm"\n', encoding="utf-8")  # fmt: skip
    (row,) = read_material_table(table).values()
    assert row.chip_thickness == pytest.approx((2e-5, 2e-4))
