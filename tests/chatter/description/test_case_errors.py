"""Wrong case files: every message names file, key and value, and what is allowed."""

# ruff: noqa: E501 (a table of sentences is read a line at a time)

import math
import re
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chatter.description.case import Case, load, loads
from chatter.description.errors import InputError

GOOD = """
title = "good"
[tool]
kind = "end mill"
teeth = 4
diameter = "20 mm"
helix = "30 deg"
[material]
law = "linear"
Ktc = "1650 MPa"
[cut]
mode = "up"
spindle_speed = "840 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "2 mm"
radial_depth = "5 mm"
[[structure.mode]]
frequency = "922 Hz"
damping = 0.03
mass = "0.5 kg"
direction = [1, 0, 0]
[lobes]
speeds = { from = "600 rpm", to = "1200 rpm", count = 50 }
depths = { to = "5 mm", count = 20 }
"""
JARGON = re.compile(
    r"pydantic|validation|Traceback|BaseModel|ValueError|type=|input_value|literal_error|\bNone\b"
    r"|Error\b|dict|tuple|\bstr\b|\bint\b|float"
)


def messages(text, name="case.toml"):
    with pytest.raises(InputError) as caught:
        loads(text, name)
    for message in caught.value.messages:
        assert message.startswith(f"{name}: ")
        assert not JARGON.search(message), message
        assert message.isprintable()
        assert len(message) < 400
    return caught.value.messages


def message(old, new):
    assert GOOD.count(old) == 1
    (only,) = messages(GOOD.replace(old, new))
    return only


def test_the_good_case_is_good():
    assert loads(GOOD).tool.teeth == 4


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        # unknown keys
        ('diameter = "20 mm"', 'diamter = "20 mm"', 'tool.diamter: unknown key; did you mean "diameter"?'),
        ("[cut]", "[cutt]", 'cutt: unknown key; did you mean "cut"?'),
        ("teeth = 4", "Teeth = 4", 'tool.Teeth: unknown key; did you mean "teeth"?'),
        ("from =", "from_ =", 'lobes.speeds.from_: unknown key; did you mean "from"?'),
        ('mass = "0.5 kg"', 'stifness = "5 N/um"', 'structure.mode[0].stifness: unknown key; did you mean "stiffness"?'),
        # dimensions
        ('"2 mm"', '"2 kg"', 'cut.axial_depth: "2 kg" is a mass; a length is required, such as "2 mm"'),
        ('"840 rpm"', '"840 mm"', 'cut.spindle_speed: "840 mm" is a length; a spindle speed is required, such as "12000 rpm"'),
        ('"1650 MPa"', '"27 N/mm"', 'material.Ktc: "27 N/mm" is a force per length; a pressure (force per area) is required, such as "1650 MPa"'),
        ('"922 Hz"', '"922 N"', 'structure.mode[0].frequency: "922 N" is a force; a frequency is required, such as "922 Hz"'),
        ('"2 mm"', '"2"', 'cut.axial_depth: "2" has no unit; a length is required, such as "2 mm"'),
        ('"2 mm"', '"2 mmm"', 'cut.axial_depth: "2 mmm" has the unknown unit "mmm"; a length is required, such as "2 mm"'),
        ('"2 mm"', '"two mm"', 'cut.axial_depth: "two mm" is not a quantity; a length is required, such as "2 mm"'),
        ('"2 mm"', '"1,5 mm"', 'cut.axial_depth: "1,5 mm" has a decimal comma; write a decimal point'),
        # ranges
        ('"2 mm"', '"-2 mm"', 'cut.axial_depth: "-2 mm" is out of range; it must be greater than 0'),
        ('"0.1 mm"', "-1e-4", "cut.feed_per_tooth: -0.0001 (a bare number is in m) is out of range; it must be greater than 0"),
        ('"0.1 mm"', "0.1", "cut.feed_per_tooth: 0.1 (a bare number is in m) is out of range; it must be at most 20 mm; is \"0.1 mm\" meant?"),
        ('"20 mm"', "20", "tool.diameter: 20 (a bare number is in m) is out of range; it must be at most 2 m; is \"20 mm\" meant?"),
        ('"20 mm"', '"0 mm"', 'tool.diameter: "0 mm" is out of range; it must be greater than 0'),
        ("teeth = 4", "teeth = 0", "tool.teeth: 0 is out of range; numbers of teeth go from 1 to 200"),
        ("teeth = 4", "teeth = 201", "tool.teeth: 201 is out of range; numbers of teeth go from 1 to 200"),
        ("teeth = 4", "teeth = 2.5", "tool.teeth: 2.5 is not a whole number"),
        ("teeth = 4", "teeth = true", "tool.teeth: true is not a whole number"),
        ('"30 deg"', '"90 deg"', 'tool.helix: "90 deg" is out of range; it must be less than 90 deg'),
        ('"30 deg"', "30", "tool.helix: 30 (a bare number is in rad) is out of range; it must be less than 90 deg; is \"30 deg\" meant?"),
        ("0.03", "-0.03", "structure.mode[0].damping: -0.03 is out of range; it must be greater than 0"),
        ("0.03", "1.0", "structure.mode[0].damping: 1.0 is out of range; it must be less than 1; is \"1 %\" meant?"),
        ("0.03", "nan", "structure.mode[0].damping: nan is not a finite number"),
        ("0.03", "inf", "structure.mode[0].damping: inf is not a finite number"),
        ('"1650 MPa"', '"1e400 MPa"', 'material.Ktc: "1e400 MPa" is not a finite number'),
        ("count = 50", "count = 3000000000", "lobes.speeds.count: 3000000000 is out of range; counts go from 2 to 20000"),
        ('"600 rpm"', '"1200 rpm"', "lobes.speeds: the range is empty: from (1200 rpm) is not less than to (1200 rpm)"),
        # geometry
        ('"5 mm"\n[[', '"21 mm"\n[[', "cut.radial_depth: 21 mm is more than the diameter of the tool, 20 mm"),
        ('mode = "up"', 'mode = "slot"', 'cut.radial_depth: 5 mm is not the diameter, 20 mm, that mode = "slot" cuts; leave it out, or choose "up" or "down"'),
        ("teeth = 4", 'teeth = 4\npitch = ["90 deg", "90 deg", "180 deg"]', "tool.pitch: 3 angles for 4 teeth; give one for each tooth"),
        ("teeth = 4", 'teeth = 4\npitch = ["90 deg", "90 deg", "90 deg", "80 deg"]', "tool.pitch: the angles add up to 350 deg, not to 360 deg"),
        ("teeth = 4", 'teeth = 4\npitch = "90 deg"', 'tool.pitch: "90 deg" is not a list; a list of angles is required, such as ["90 deg", ...]'),
        ('"30 deg"', '["30 deg", "35 deg"]', "tool.helix: 2 angles for 4 teeth; give one for each tooth"),
        ("teeth = 4", 'teeth = 4\ncorner_radius = "11 mm"', "tool.corner_radius: 11 mm is more than the radius of the tool, 10 mm"),
        ("[1, 0, 0]", "[0, 0, 0]", "structure.mode[0].direction: [0, 0, 0] has length 0; a unit vector is required"),
        ("[1, 0, 0]", "[1, 1, 0]", "structure.mode[0].direction: [1, 1, 0] has length 1.414; a unit vector is required"),
        ("[1, 0, 0]", "[1, 0]", 'structure.mode[0].direction: [1, 0] is not a direction; "x", "y", "z" or three numbers are required, such as [1, 0, 0]'),
        ("[1, 0, 0]", '["x", 0, 0]', 'structure.mode[0].direction: ["x", 0, 0] is not a direction; "x", "y", "z" or three numbers are required, such as [1, 0, 0]'),
        ("[1, 0, 0]", "[nan, 0, 0]", 'structure.mode[0].direction: [nan, 0, 0] is not a direction; "x", "y", "z" or three numbers are required, such as [1, 0, 0]'),
        # what is missing, what is too much
        ('axial_depth = "2 mm"\n', "", 'cut.axial_depth: is missing; a length is required, such as "2 mm"'),
        ('mode = "up"\n', "", 'cut.mode: is missing; allowed are "up", "down", "slot", "face"'),
        ("teeth = 4\n", "", "tool.teeth: is missing; give, for example, 4"),
        ('radial_depth = "5 mm"\n', "", 'cut.radial_depth: is missing; mode = "up" needs a length, such as radial_depth = "4 mm", or a stepover'),
        ('mass = "0.5 kg"\n', "", "structure.mode[0]: either mass or stiffness is needed"),
        ('mass = "0.5 kg"', 'mass = "0.5 kg"\nstiffness = "5 N/um"', "structure.mode[0]: give mass or stiffness, not both"),
        ('Ktc = "1650 MPa"\n', "", 'material.Ktc: is missing; law = "linear" needs it; a pressure (force per area), such as "1650 MPa"'),
        ('Ktc = "1650 MPa"', 'Ktc = "1650 MPa"\nh0 = "1 mm"', 'material.h0: does not belong to law = "linear"; known are Ktc, Krc, Kac, Kte, Kre, Kae'),
        ('law = "linear"', 'law = "exponential"\nh0 = "1 mm"', 'material.exponent: is missing; law = "exponential" needs it; a plain number, such as 0.03'),
        ("[lobes]", "[simulation]\nduration = 1\nrevolutions = 3\n[lobes]", "simulation: give duration or revolutions, not both"),
        ("[lobes]", '[friction.guide]\nlaw = "coulomb-stribeck"\ncoulomb = 1\nbristle_stiffness = 3\n[lobes]', 'friction.guide.bristle_stiffness: does not belong to law = "coulomb-stribeck"; known are coulomb, static, stribeck_velocity, viscous, stribeck_shape'),
        # choices
        ('"end mill"', '"endmill"', 'tool.kind: "endmill" is not allowed; it is "end mill" here; allowed are "end mill", "ball", "bull nose", "taper" or "inserted"'),
        ('"end mill"', '"Face mill"', 'tool.kind: "Face mill" is not allowed; it is "inserted" here; allowed are "end mill", "ball", "bull nose", "taper" or "inserted"'),
        ('mode = "up"', 'mode = "climb"', 'cut.mode: "climb" is not allowed; it is "down" here; allowed are "up", "down", "slot" or "face"'),
        # types
        ('title = "good"', "title = 3", "title: 3 is given, text in quotes is required"),
        ('{ to = "5 mm", count = 20 }', '"5 mm"', 'lobes.depths: "5 mm" is no range with units; FROM..TO:COUNT is required, such as "0..5 mm:50"'),
        ("0.03", "2020-01-01", "structure.mode[0].damping: 2020-01-01 is not a quantity; a plain number is required, such as 0.03"),
        ('"2 mm"', "{ value = 2 }", 'cut.axial_depth: a table is not a quantity; a length is required, such as "2 mm"'),
        ("[[structure.mode]]", "[structure.mode]", "structure.mode: a table is given, a list is required; write [[structure.mode]], not [structure.mode]"),
        ("[tool]", "[[tool]]", "tool: [a table] is given, a table is required; write [tool], not [[tool]]"),
    ],
)  # fmt: skip
def test_one_clear_sentence(old, new, expected):
    assert message(old, new) == f"case.toml: {expected}"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('tool = "x"', 'tool: "x" is given, a table is required'),
        ("friction = 3", "friction: 3 is given, a table is required"),
        ("structure = []", "structure: [] is given, a table is required"),
        ("[structure]", "structure: is empty; give [[structure.mode]], structure.frf or machine"),
        (
            '[structure]\nfrf = "a.uff"\nmachine = "b.toml"',
            "structure: frf and machine are both given; the structure comes from one of them",
        ),
        (
            "[structure]\nfrf = 3",
            "structure.frf: 3 is not a measured FRF; a file name is required, or a table with file",
        ),
        (
            '[structure]\nfrf = ""',
            'structure.frf[0].file: "" is not a file name; one is required, such as "tap.uff"',
        ),
        (
            '[[structure.frf]]\nfile = "a"\ndirection = "up"',
            'structure.frf[0].direction: "up" is not a direction; "x", "y", "z" or two of them are '
            "required",
        ),
        ('[[structure.frf]]\nfil = "a"', 'structure.frf[0].fil: unknown key; did you mean "file"?'),
        (
            '[material]\nname = "Al7075-T6"\nlaw = "oblique"',
            'material.name: "Al7075-T6" has coefficients of the linear law, not of law = "oblique"',
        ),
        (
            '[lobes]\nspeeds = { from = "1 rpm", to = "2 rpm", count = 20000 }\n'
            "depths = { to = 0.1, count = 20000 }",
            "lobes: 400000000 points in all; at most 20000000 are allowed",
        ),
    ],
)
def test_one_clear_sentence_about_a_section(text, expected):
    assert messages(text) == (f"case.toml: {expected}",)


def test_materials_that_are_not_in_the_table():
    (near,) = messages('[material]\nname = "Al7075T6"')
    assert near.startswith('case.toml: material.name: "Al7075T6" is not in the table of materials;')
    assert 'did you mean "Al7075-T6"?' in near
    (far,) = messages('[material]\nname = "zzz"')
    assert "did you mean" not in far
    assert "`chatter materials` lists all" in far


def test_several_problems_are_reported_together():
    text = (
        GOOD.replace("teeth = 4", "teeth = 0")
        .replace('"20 mm"', '"20 kg"')
        .replace('"840 rpm"', '"-840 rpm"')
        .replace("0.03", "3")
        .replace('title = "good"', 'titel = "good"')
    )
    keys = [text.split(": ")[1] for text in messages(text)]
    assert sorted(keys) == [
        "cut.spindle_speed",
        "structure.mode[0].damping",
        "titel",
        "tool.diameter",
        "tool.teeth",
    ]


def test_impossible_geometry_is_told_beside_other_problems():
    text = GOOD.replace("teeth = 4", 'teeth = 4\npitch = ["180 deg", "180 deg"]\nx = 1')
    found = messages(text.replace('"5 mm"\n[[', '"21 mm"\n[['))
    assert len(found) == 3
    assert {line.split(": ")[1] for line in found} == {"tool.pitch", "tool.x", "cut.radial_depth"}


def test_thousands_of_problems_are_cut_short():
    found = messages("\n".join(f"key{k} = {k}" for k in range(3000)))
    assert len(found) == 21
    assert found[-1] == "case.toml: and 2980 more of this kind"


def test_monstrous_values_make_no_monstrous_messages():
    assert "..." in message("teeth = 4", "teeth = 1" + "0" * 4000)
    assert "..." in message("[1, 0, 0]", "[1" + "0" * 4000 + ", 0, 0]")
    assert "..." in message('"2 mm"', '"' + "9" * 4000 + ' mm"')
    assert "..." in message('title = "good"', "x" * 4000 + " = 1")
    assert "?[31m" in message('"end mill"', '"\\u001b[31mred"')
    assert "?[31m" in message('title = "good"', '"\\u001b[31m" = 1')


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (GOOD.replace("teeth = 4", "teeth = 4\nteeth = 5"), ["twice", "line 6"]),
        (GOOD.replace("[cut]", "[tool]"), ["twice", "tool", "line 11"]),
        (GOOD.replace("teeth = 4", "teeth 4"), ["line 5"]),
        (GOOD.replace('"20 mm"', '"20 mm'), ["line 6"]),
        (GOOD.replace('"20 mm"', "20 mm"), ["line 6", "column 15"]),
        ("a = " + "[" * 5000 + "]" * 5000, ["nested"]),
        ("a." * 300 + "b = 1", [""]),
        ("just words", ["line 1"]),
    ],
)
@pytest.mark.skipif(sys.version_info < (3, 11), reason="the older parser names fewer lines")
def test_no_toml(text, words):
    (only,) = messages(text)
    assert only.startswith("case.toml: is no valid TOML: ")
    for word in words:
        assert word in only


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b" \n\t\n", "is empty"),
        (b"\xef\xbb\xbf", "is empty"),
        (bytes(range(256)) * 20, "is a binary file"),
        (b"\x7fELF\x02\x01\x01\x00\x00", "is a binary file"),
        ('title = "Fräser"'.encode("latin-1"), "is not UTF-8 text (byte 11)"),
        (b"# comment\n" * 100_000, "has more than 262144 bytes"),
        (b"PK\x03\x04 not toml", "is no valid TOML"),
        (b"<html></html>", "is no valid TOML"),
    ],
)
def test_files_that_are_no_case(tmp_path, content, words):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        load(path)
    (only,) = caught.value.messages
    assert only.startswith(f"{path}: ")
    assert words in only


def test_places_that_hold_no_file(tmp_path):
    with pytest.raises(InputError, match="there is no such file"):
        load(tmp_path / "none.toml")
    with pytest.raises(InputError, match="is a folder"):
        load(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        load(tmp_path / ("x" * 5000))
    with pytest.raises(InputError, match="the path of a case file is required"):
        load("a\0b")
    if Path("/dev/zero").exists():
        with pytest.raises(InputError, match="binary"):
            load("/dev/zero")


def test_a_mark_of_byte_order_does_no_harm(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.encode())
    assert load(path) == loads(GOOD)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ([1], "a table of sections is required"),
        ({"tool": {"teeth": object(), "diameter": 0.1}}, "tool.teeth"),
        ({"tool": {"teeth": 3, "diameter": None}}, "tool.diameter: is missing"),
        ({"tool": {"teeth": 10**5000, "diameter": 0.1}}, "thousands of digits"),
        ({"tool": {"teeth": 3, "diameter": 10**5000}}, "thousands of digits"),
        ({"tool": {"teeth": 3, "diameter": math.inf}}, "tool.diameter: inf is not a finite number"),
        ({3: 4}, "3: unknown key"),
    ],
)
def test_wrong_dicts(data, words):
    with pytest.raises(InputError) as caught:
        Case.from_dict(data, "made")
    assert words in caught.value.messages[0]
    assert caught.value.messages[0].startswith("made: ")


LEAVES = st.one_of(
    st.text(max_size=12),
    st.integers(),
    st.floats(),
    st.booleans(),
    st.dates(),
    st.just("20 mm"),
    st.lists(st.integers(), max_size=3),
)
KEYS = st.sampled_from(
    [
        *["tool", "cut", "structure", "mode", "frf", "teeth", "diameter", "lobes", "speeds"],
        *["from", "to", "friction", "damping", "mass", "direction", "name", "law", "material"],
        *["x", "helix"],
    ]
)
TABLES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(st.dictionaries(KEYS, inner, max_size=4), st.lists(inner, max_size=2)),
    max_leaves=12,
)


@settings(deadline=None, max_examples=150)
@given(st.dictionaries(KEYS, TABLES, max_size=4))
def test_any_dict_is_a_case_or_a_list_of_clear_messages(data):
    try:
        case = Case.from_dict(data, "made")
    except InputError as error:
        for text in error.messages:
            assert text.startswith("made: ")
            assert text.isprintable()
    else:
        assert loads(case.to_toml()) == case


@settings(deadline=None, max_examples=100)
@given(st.integers(0, len(GOOD) - 1), st.text(min_size=1, max_size=4), st.integers(0, 6))
def test_a_slip_of_the_keyboard_is_a_case_or_a_clear_message(place, inserted, removed):
    text = GOOD[:place] + inserted + GOOD[place + removed :]
    try:
        case = loads(text, "case.toml")
    except InputError as error:
        lines = error.messages
    else:
        lines = ()
        assert case.tool is None or math.isfinite(case.tool.diameter)
    assert all(line.startswith("case.toml: ") for line in lines)
