"""One patch mechanism: dotted paths, tables, lists, removals, the command line."""

# ruff: noqa: E501 (a table of sentences is read a line at a time)

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chatter.description.assignments import parse_assignments
from chatter.description.case import loads
from chatter.description.errors import InputError

TEXT = """\
title = "patched"

[tool]
teeth = 4
diameter = "20 mm"
helix = ["30 deg", "35 deg", "30 deg", "35 deg"]

[material]
Ktc = "1650 +- 80 MPa"

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

[[structure.mode]]
frequency = "1000 Hz"
damping = 0.02
stiffness = "12 N/um"
direction = [0, 1, 0]

[lobes]
speeds = { from = "600 rpm", to = "1200 rpm", count = 50 }
"""
CASE = loads(TEXT, "case.toml")


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("cut.axial_depth", "3 mm", 3e-3),
        ("cut.axial_depth", 0.003, 3e-3),
        ("cut.spindle_speed", "14 Hz", 28 * math.pi),
        ("cut.spindle_speed", 100.0, 100.0),
        ("cut.mode", "down", "down"),
        ("title", "new", "new"),
        ("tool.teeth", 4, 4),
        ("tool.helix", "20 deg", math.radians(20)),
        ("tool.helix", 0.3, 0.3),
        ("tool.helix[2]", "20 deg", math.radians(20)),
        ("tool.helix.2", 0.3, 0.3),
        ("tool.helix", [0.1, 0.2, 0.3, 0.4], (0.1, 0.2, 0.3, 0.4)),
        ("structure.mode[0].damping", 0.05, 0.05),
        ("structure.mode.0.damping", "5 %", 0.05),
        ("structure.mode[1].direction", [0, 0, 1], (0.0, 0.0, 1.0)),
        ("lobes.speeds.from", "10 Hz", 20 * math.pi),
        ("lobes.speeds.count", 7, 7),
        # sections and tables that are not there
        ("tool.runout.offset", "5 um", 5e-6),
        ("process_damping.coefficient", "2e4 N/m", 2e4),
        ("friction.guide.coulomb", "3 N", 3.0),
        ("lobes.depths.to", "4 mm", 4e-3),
        ("lobes.method", "zero-order", "zero-order"),
    ],
)
def test_what_is_patched_is_there(path, value, expected):
    before = CASE.to_toml()
    patched = CASE.patch({path: value})
    wanted = expected if isinstance(expected, str) else pytest.approx(expected, rel=1e-12)
    assert patched.get(path) == wanted
    assert CASE.to_toml() == before == TEXT
    assert patched == loads(patched.to_toml())


def test_all_places_of_a_list():
    patched = CASE.patch({"structure.mode[*].damping": 0.04})
    assert patched.get("structure.mode[*].damping") == (0.04, 0.04)
    assert CASE.get("structure.mode.*.damping") == (0.03, 0.02)


def test_whole_tables():
    runout = {"offset": "5 um", "angle": "30 deg"}
    assert CASE.patch({"tool.runout": runout}).tool.runout.offset == 5e-6
    mode = {"frequency": 500.0, "damping": 0.01, "mass": 2, "direction": [0, 1, 0]}
    one = CASE.patch({"structure.mode": [mode]})
    assert len(one.structure.mode) == 1
    replaced = CASE.patch({"structure.mode[0]": mode})
    assert [entry.frequency for entry in replaced.structure.mode] == [500.0, 1000.0]
    appended = CASE.patch({"structure.mode[2]": mode})
    assert [entry.frequency for entry in appended.structure.mode] == [922.0, 1000.0, 500.0]
    assert loads(appended.to_toml()) == appended
    first = loads("[tool]\nteeth = 2\ndiameter = 0.01").patch({"structure.mode[0]": mode})
    assert first.structure.mode[0].mass == 2.0
    assert loads(first.to_toml()) == first


def test_removing():
    assert CASE.patch({"lobes": None}).lobes is None
    assert CASE.patch({"tool.helix": None}).tool.helix == 0.0
    assert len(CASE.patch({"structure.mode[0]": None}).structure.mode) == 1
    # what is not there is not there: nothing is made on the way
    assert CASE.patch({"process_damping.coefficient": None}) == CASE
    with pytest.raises(InputError, match=r"cut.axial_depth: is missing"):
        CASE.patch({"cut.axial_depth": None})


def test_mass_and_stiffness_take_each_others_place():
    stiff = CASE.patch({"structure.mode[0].stiffness": "20 N/um"})
    assert (stiff.structure.mode[0].mass, stiff.structure.mode[0].stiffness) == (None, 2e7)
    heavy = stiff.patch({"structure.mode[0].mass": 0.5})
    assert heavy == CASE
    assert CASE.patch({"simulation.duration": "1 s"}).patch({"simulation.revolutions": 3})


def test_modes_give_way_to_measured_frfs():
    patched = CASE.patch({"structure.mode": None, "structure.frf": "tap.uff"})
    assert patched.structure.frf[0].file.name == "tap.uff"
    assert loads(patched.to_toml()) == patched


def test_several_at_once_are_checked_together():
    # alone, either would be wrong
    patched = CASE.patch({"tool.teeth": 2, "tool.helix": ["30 deg", "35 deg"]})
    assert patched.tool.teeth == 2
    slot = CASE.patch({"cut.mode": "slot", "cut.radial_depth": None})
    assert slot.cut.radial_depth is None


def test_patches_of_patches():
    twice = CASE.patch({"tool.diameter": "30 mm"}).patch({"cut.radial_depth": "25 mm"})
    both = CASE.patch({"cut.radial_depth": "25 mm", "tool.diameter": "30 mm"})
    assert twice == both
    assert CASE.patch({}) == CASE


def test_numbers_of_numpy():
    np = pytest.importorskip("numpy")
    patched = CASE.patch(
        {
            "tool.teeth": np.int64(4),
            "cut.axial_depth": np.float64(0.003),
            "structure.mode[0].direction": np.array([0.0, 1.0, 0.0]),
            "lobes.speeds.count": np.int32(9),
        }
    )
    assert patched.cut.axial_depth == 0.003
    assert patched.to_toml().count("3 mm") == 1


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("cut.axial_dept", "2 mm", 'cut.axial_dept: unknown key; did you mean "axial_depth"?'),
        ("tol.teeth", 3, 'tol.teeth: unknown key; did you mean "tool"?'),
        ("lobes.speeds.fro", 3, 'lobes.speeds.fro: unknown key; did you mean "from"?'),
        ("structure.mode[0].dampin", 3, 'unknown key; did you mean "damping"?'),
        ("structure.mode[*].x", 3, "structure.mode[*].x: unknown key; known are frequency"),
        ("structure.mode[3].damping", 3, "structure.mode has 2 entries; the last is structure.mode[1]"),
        ("structure.mode.damping", 3, "structure.mode is not a table"),
        ("cut[0]", 3, "cut is not a list"),
        ("tool.teeth.x", 3, "tool.teeth is not a table"),
        ("structure.frf[1]", "a.uff", "structure.frf has no entries"),
        ("structure.frf[*].side", "tool", "structure.frf has no entries"),
        ("", 3, '"" is not a path into a case, such as cut.axial_depth'),
        ("cut..x", 3, '"cut..x" is not a path'),
        ("cut.axial_depth.", 3, "is not a path"),
        ("structure.mode[-1].damping", 3, "is not a path"),
        ("[0].x", 3, "is not a path"),
        ("cut axial_depth", 3, "is not a path"),
        (3, 3, "3 is not a path"),
        ("cut.axial_depth", "2 kg", 'cut.axial_depth: "2 kg" is a mass; a length is required, such as "2 mm"'),
        ("cut.axial_depth", -0.001, "cut.axial_depth: -0.001 (a bare number is in m) is out of range; it must be greater than 0"),
        ("cut.axial_depth", math.nan, "cut.axial_depth: nan is not a finite number"),
        ("cut.axial_depth", True, "cut.axial_depth: true is not a quantity"),
        ("cut.axial_depth", [1], "cut.axial_depth: [1] is not a quantity"),
        ("cut.axial_depth", {"a": 1}, "cut.axial_depth: a table is not a quantity"),
        ("cut.axial_depth", object(), "cut.axial_depth: <object object at"),
        ("cut.radial_depth", "25 mm", "cut.radial_depth: 25 mm is more than the diameter of the tool, 20 mm"),
        ("tool.teeth", 0, "tool.teeth: 0 is out of range"),
        ("tool.teeth", 3, "tool.helix: 4 angles for 3 teeth"),
        ("process_damping.friction", 0.3, "process_damping.coefficient: is missing"),
        ("structure.frf", "tap.uff", "structure: mode and frf are both given"),
        ("tool", 3, "tool: 3 is given, a table is required"),
    ],
)  # fmt: skip
def test_wrong_patches_name_file_path_and_value(path, value, expected):
    with pytest.raises(InputError) as caught:
        CASE.patch({path: value})
    (only,) = caught.value.messages
    assert only.startswith("case.toml: ")
    assert expected in only


def test_wrong_patches_are_reported_together():
    with pytest.raises(InputError) as caught:
        CASE.patch({"cut.axial_dept": 1, "tol.x": 2, "cut.axial_depth": -1.0})
    assert len(caught.value.messages) == 3
    with pytest.raises(InputError) as caught:
        CASE.patch({"tool.teeth": 0, "cut.axial_depth": "2 kg", "structure.mode[*].damping": 2})
    assert len(caught.value.messages) == 4


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("cut.axial_dept", 'cut.axial_dept: unknown key; did you mean "axial_depth"?'),
        ("structure.mode[2].damping", "there is no structure.mode[2]"),
        ("process_damping.coefficient", "there is no process_damping.coefficient"),
        ("friction.guide", "there is no friction.guide"),
        ("tool.teeth.x", "there is no tool.teeth.x"),
        ("a b", "is not a path"),
    ],
)
def test_reading_what_is_not_there(path, expected):
    with pytest.raises(InputError) as caught:
        CASE.get(path)
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    ("assignment", "path", "value"),
    [
        ("cut.axial_depth=2 mm", "cut.axial_depth", "2 mm"),
        ('cut.axial_depth="2 mm"', "cut.axial_depth", "2 mm"),
        (" cut.axial_depth = 2 mm ", "cut.axial_depth", "2 mm"),
        ("cut.axial_depth=0.002", "cut.axial_depth", 0.002),
        ("cut.axial_depth=2e-3", "cut.axial_depth", 0.002),
        ("cut.mode=down", "cut.mode", "down"),
        ("tool.teeth=3", "tool.teeth", 3),
        ("tool.helix=[0.1, 0.2]", "tool.helix", [0.1, 0.2]),
        ('tool.helix=["30 deg", "35 deg"]', "tool.helix", ["30 deg", "35 deg"]),
        ('tool.runout={ offset = "5 um" }', "tool.runout", {"offset": "5 um"}),
        ("x=true", "x", True),
        ("title=a = b", "title", "a = b"),
        ("title=a\nb=3", "title", "a\nb=3"),
        ("title=1\nb=3", "title", "1\nb=3"),
        ("title='quoted", "title", "'quoted"),
        ("title=2 mm # two", "title", "2 mm # two"),
        ("x=08", "x", "08"),
        ("x=µm", "x", "µm"),
    ],
)
def test_assignments(assignment, path, value):
    assert parse_assignments([assignment]) == {path: value}


def test_assignments_make_patches():
    values = parse_assignments(
        ["structure.mode[0].damping=4 %", 'tool.runout={ offset = "5 um", angle = "30 deg" }']
    )
    patched = CASE.patch(values)
    assert patched.structure.mode[0].damping == pytest.approx(0.04)
    assert patched.tool.runout.angle == pytest.approx(math.pi / 6)


def test_wrong_assignments_are_reported_together():
    with pytest.raises(InputError) as caught:
        parse_assignments(["cut.axial_depth", "=3", "cut.mode=", "tool.teeth=3"])
    assert caught.value.messages == (
        '--set "cut.axial_depth": PATH=VALUE is required, such as cut.axial_depth="2 mm"',
        '--set "=3": PATH=VALUE is required, such as cut.axial_depth="2 mm"',
        '--set "cut.mode=": there is no value after the =',
    )


def lengths(largest):
    return st.floats(1e-6, largest, allow_subnormal=False)


@settings(deadline=None)
@given(
    axial_depth=lengths(1.0),
    radial_depth=lengths(0.02),
    spindle_speed=st.floats(0.1, 1e5),
    damping=st.floats(1e-6, 0.99),
    pressure=st.floats(1e6, 1e11),
)
def test_patch_then_get(axial_depth, radial_depth, spindle_speed, damping, pressure):
    values = {
        "cut.axial_depth": axial_depth,
        "cut.radial_depth": radial_depth,
        "cut.spindle_speed": spindle_speed,
        "structure.mode[1].damping": damping,
        "material.Ktc": pressure,
    }
    patched = CASE.patch(values)
    for path, value in values.items():
        assert patched.get(path) == pytest.approx(value, rel=1e-12, abs=0.0)
    # written in the units that stood there
    text = patched.to_toml()
    assert text.count(" mm") == TEXT.count(" mm")
    assert text.count(" rpm") == TEXT.count(" rpm")
    assert loads(text) == patched


@settings(deadline=None, max_examples=60)
@given(st.text(max_size=30), st.one_of(st.text(max_size=10), st.integers(), st.floats()))
def test_any_path_is_patched_or_refused(path, value):
    for candidate in (path, f"cut.{path}", f"structure.mode[0].{path}"):
        try:
            patched = CASE.patch({candidate: value})
        except InputError as error:
            lines = error.messages
        else:
            lines = ()
            assert loads(patched.to_toml()) == patched
        assert all(line.isprintable() for line in lines)
