"""The one patch mechanism: values change, everything else of the file stays."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chatter import InputError
from chatter.description.assignments import parse_assignments
from chatter.description.case import loads

TEXT = """# head
[tool]
teeth = 2  # carbide
diameter = "16 mm"

[material]
Ktc = "600 MPa"

[cut]
mode = "down"
spindle_speed = "10000 rpm" # fast
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"

[[structure.mode]]
frequency = "922 Hz"
damping = "1.1 %"
mass = "40 g"
direction = [1, 0, 0]

[[structure.mode]]
frequency = "700 Hz"
damping = 0.02
mass = "40 g"
direction = [0, 1, 0]
# foot
"""


@pytest.fixture
def case():
    return loads(TEXT)


def changed(case, values, *replacements):
    """The patched case; its text must differ from TEXT by the replacements alone."""
    patched = case.patch(values)
    text = TEXT
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new, 1)
    assert patched.to_toml() == text
    assert case.to_toml() == TEXT
    assert loads(patched.to_toml()) == patched
    return patched


def test_quantity(case):
    patched = changed(
        case, {"cut.axial_depth": "2500 um"}, ('axial_depth = "1 mm"', 'axial_depth = "2500 um"')
    )
    assert patched.cut.axial_depth == 2.5e-3
    assert case.cut.axial_depth == 1e-3


def test_bare_numbers_are_written_in_the_unit_that_stood_there(case):
    changed(case, {"cut.axial_depth": 0.0025}, ('axial_depth = "1 mm"', 'axial_depth = "2.5 mm"'))
    patched = changed(
        case, {"cut.spindle_speed": 100.0 * math.pi}, ('"10000 rpm" # fast', '"3000 rpm" # fast')
    )
    assert patched.cut.spindle_speed == pytest.approx(100.0 * math.pi, rel=1e-14)
    changed(case, {"structure.mode[0].damping": 0.02}, ('"1.1 %"', '"2 %"'))
    changed(case, {"structure.mode[1].damping": np.float64(0.03)}, ("0.02", "0.03"))


def test_comment_of_a_changed_number_stays(case):
    changed(case, {"tool.teeth": 3}, ("teeth = 2  # carbide", "teeth = 3  # carbide"))


def test_every_place_of_a_list(case):
    patched = changed(
        case, {"structure.mode[*].mass": "50 g"}, ('"40 g"', '"50 g"'), ('"40 g"', '"50 g"')
    )
    assert patched.get("structure.mode[*].mass") == (0.05, 0.05)


def test_mass_and_stiffness_replace_each_other(case):
    mode = case.patch({"structure.mode[0].stiffness": "2 N/um"}).structure.mode[0]
    assert (mode.mass, mode.stiffness) == (None, 2e6)


def test_a_new_section_and_a_new_key(case):
    patched = case.patch(
        {"process_damping.coefficient": "0.2 N/mm", "tool.helix": "30 deg", "title": "new"}
    )
    assert patched.process_damping.coefficient == 200.0
    assert patched.tool.helix == pytest.approx(math.pi / 6.0)
    assert loads(patched.to_toml()) == patched
    for line in TEXT.splitlines():
        assert line in patched.to_toml()


def test_new_nested_tables(case):
    patched = case.patch(
        {
            "tool.runout.offset": "10 um",
            "lobes.speeds": {"from": "1000 rpm", "to": "2000 rpm"},
            "friction.guide.coulomb": "80 N",
        }
    )
    assert patched.tool.runout.offset == 1e-5
    assert patched.lobes.speeds.count == 400
    assert patched.friction["guide"].coulomb == 80.0
    assert loads(patched.to_toml()) == patched


def test_append_and_remove(case):
    new = {"frequency": "1.2 kHz", "damping": 0.01, "mass": "1 kg", "direction": [0, 0, 1]}
    patched = case.patch({"structure.mode[2]": new})
    assert len(patched.structure.mode) == 3
    assert loads(patched.to_toml()) == patched
    assert patched.patch({"structure.mode[2]": None}) == case
    assert len(case.patch({"structure.mode[0]": None}).structure.mode) == 1
    assert case.patch({"material.Krc": None}) == case
    assert case.patch({"process_damping.coefficient": None}) == case


def test_order_of_a_patch_and_two_patches(case):
    values = {"cut.axial_depth": "2 mm", "tool.teeth": 3, "structure.mode[1].damping": 0.1}
    one = case.patch(values)
    two = case
    for path, value in values.items():
        two = two.patch({path: value})
    assert one == two
    assert one.to_toml() == two.to_toml()
    assert case.patch({}) == case


def test_two_values_that_are_right_only_together(case):
    patched = case.patch({"cut.radial_depth": "20 mm", "tool.diameter": "25 mm"})
    assert patched.cut.radial_depth == 20e-3


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"cut.axial_dept": "1 mm"}, ["cut.axial_dept", '"axial_depth"']),
        ({"cutt.axial_depth": "1 mm"}, ["cutt", '"cut"']),
        ({"cut.axial_depth": "1 kg"}, ["cut.axial_depth", "1 kg", "length"]),
        ({"cut.axial_depth": math.nan}, ["cut.axial_depth", "finite"]),
        ({"cut.axial_depth": -1e-3}, ["cut.axial_depth", "greater than 0"]),
        ({"cut.axial_depth": [1, 2]}, ["cut.axial_depth"]),
        ({"cut.axial_depth": None}, ["cut.axial_depth", "missing"]),
        ({"cut.axial_depth": object()}, ["cut.axial_depth"]),
        ({"cut.radial_depth": "20 mm"}, ["cut.radial_depth", "16 mm"]),
        ({"structure.mode[5].mass": 1.0}, ["structure.mode", "2 entries"]),
        ({"structure.mode[3]": {"mass": 1.0}}, ["structure.mode", "2 entries"]),
        ({"structure.mode[-1].mass": 1.0}, ["not a path"]),
        ({"structure.mode.mass": 1.0}, ["structure.mode"]),
        ({"tool[0]": 1.0}, ["tool"]),
        ({"tool.teeth.x": 1.0}, ["tool.teeth"]),
        ({"tool": 3}, ["tool", "table"]),
        ({"structure.mode": []}, ["structure"]),
        ({"": 1.0}, ["not a path"]),
        ({"a b": 1.0}, ["not a path"]),
        ({"__class__": 1.0}, ["__class__", "unknown key"]),
        ({"model_config.frozen": 1.0}, ["model_config", "unknown key"]),
        ({3: 1.0}, ["not a path"]),
        ({"title": 3}, ["title"]),
        ({"tool.cutting_edge_angle": "45 deg"}, ["cutting_edge_angle", 'kind = "inserted"']),
    ],
)
def test_refusals(case, values, words):
    with pytest.raises(InputError) as caught:
        case.patch(values)
    assert len(caught.value.messages) == 1
    for word in words:
        assert word in caught.value.messages[0]
    assert case.to_toml() == TEXT


def test_all_problems_are_told(case):
    with pytest.raises(InputError) as caught:
        case.patch({"cut.x": 1, "tool.y": 2, "structure.mode[9].mass": 1})
    assert len(caught.value.messages) == 3


PATHS = {
    "cut.axial_depth": (1e-6, 0.1),
    "cut.spindle_speed": (1.0, 1e4),
    "material.Ktc": (1e6, 1e10),
    "material.Krc": (1e6, 1e10),
    "structure.mode[0].damping": (1e-4, 0.9),
    "structure.mode[1].frequency": (1.0, 1e4),
    "structure.mode[1].mass": (1e-4, 1e3),
    "tool.helix": (1e-3, 1.5),
    "process_damping.coefficient": (1e-3, 1e6),
}


@given(
    st.sampled_from(sorted(PATHS)).flatmap(
        lambda path: st.tuples(st.just(path), st.floats(*PATHS[path]))
    )
)
def test_get_returns_what_was_patched(pair):
    path, value = pair
    patched = loads(TEXT).patch({path: value})
    assert patched.get(path) == pytest.approx(value, rel=1e-12)
    assert loads(patched.to_toml()) == patched
    # the same again changes nothing
    assert patched.patch({path: patched.get(path)}).get(path) == pytest.approx(value, rel=1e-12)


@given(st.text(max_size=30), st.text(max_size=10) | st.floats() | st.integers())
def test_any_path_and_value_is_a_case_or_an_input_error(path, value):
    try:
        patched = loads(TEXT).patch({path: value})
    except InputError:
        return
    assert loads(patched.to_toml()) == patched


def test_assignments_of_the_command_line():
    read = parse_assignments(
        [
            "cut.axial_depth=2 mm", 'cut.mode="up"', "tool.teeth=3", "a = 1e-3", "b=[1, 0, 0]",
            "c={ x = 1 }", "d=true", "title=a=b", "e=1 # 2", "f=1\nevil = 2",
        ]
    )  # fmt: skip
    assert read == {
        "cut.axial_depth": "2 mm", "cut.mode": "up", "tool.teeth": 3, "a": 1e-3, "b": [1, 0, 0],
        "c": {"x": 1}, "d": True, "title": "a=b", "e": 1, "f": "1\nevil = 2",
    }  # fmt: skip


def test_wrong_assignments_are_told_together():
    with pytest.raises(InputError) as caught:
        parse_assignments(["x", "=3", "y="])
    assert len(caught.value.messages) == 3
