"""Case files: what every section holds, in SI, and where it is found."""

import copy
import math
import pickle

import pytest

from chatter.description.case import Case, load, loads
from chatter.description.errors import InputError
from chatter.description.law_section import FRICTION_LAWS
from chatter.description.sections.friction import Friction
from chatter.stability.case_schema import schema
from chatter.stability.registry import AUTO, METHODS
from cutting.material.table import MATERIALS
from tests.places import DATA, EXAMPLES

CASES = sorted([*EXAMPLES.glob("*/case.toml"), *DATA.rglob("case.toml")])

FULL = """
title = "everything"

[tool]
kind = "bull nose"
teeth = 4
diameter = "20 mm"
helix = ["30 deg", "35 deg", "30 deg", "35 deg"]
pitch = ["70 deg", "110 deg", "70 deg", "110 deg"]
runout = { offset = "5 um", angle = "45 deg" }
corner_radius = "2 mm"
edge_radius = "10 um"
taper_angle = "3 deg"

[material]
law = "exponential"
Ktc = "1650 +- 80 MPa"
Krc = "700 MPa"
Kac = "200 MPa"
Kte = "27.4 N/mm"
Kre = "30 N/mm"
Kae = "-3 N/mm"
h0 = "0.1 mm"
exponent = 0.75

[cut]
mode = "down"
spindle_speed = "840 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "2 mm"
radial_depth = "5 mm"

[[structure.mode]]
frequency = "922 Hz"
damping = "2 %"
stiffness = "12 N/um"
direction = [0.6, 0.8, 0]

[[structure.mode]]
frequency = "628.3185307179586 rad/s"
damping = 0.03
mass = "500 g"
direction = [0, 1.004, 0]
side = "workpiece"

[process_damping]
coefficient = "2e4 N/m"
friction = 0.3

[contact]
stiffness = "100 N/um"
damping = "200 N*s/m"

[friction.guide]
law = "lugre"
bristle_stiffness = "1e5 N/m"
bristle_damping = "316 N*s/m"
viscous = "0.4 N*s/m"
coulomb = "1 N"
static = "1.5 N"
stribeck_velocity = "1 mm/s"

[axis]
moving_mass = "154.14 kg"
viscous_friction = "758.371 N*s/m"
coulomb_friction = "104.6 N"

[simulation]
chip = "dexel"
revolutions = 20
resolution = "10 um"

[lobes]
speeds = { from = "600 rpm", to = "1200 rpm", count = 50 }
depths = { to = "5 mm", count = 20 }
method = "zero-order"
steps = 40
"""


@pytest.fixture(scope="module")
def full():
    return loads(FULL)


def test_tool(full):
    tool = full.tool
    assert (tool.kind, tool.teeth, tool.diameter) == ("bull nose", 4, 0.02)
    assert tool.helix == pytest.approx([math.radians(angle) for angle in (30, 35, 30, 35)])
    assert tool.pitch == pytest.approx([math.radians(angle) for angle in (70, 110, 70, 110)])
    assert (tool.runout.offset, tool.runout.angle) == pytest.approx((5e-6, math.pi / 4))
    assert (tool.corner_radius, tool.edge_radius) == (2e-3, 1e-5)
    assert tool.taper_angle == pytest.approx(math.radians(3))


def test_material(full):
    material = full.material
    assert material.force_law(0.0).cutting == (1.65e9, 7e8, 2e8)
    assert material.force_law(0.0).edge == (27400.0, 30000.0, -3000.0)
    assert (material.law, material.h0, material.exponent) == ("exponential", 1e-4, 0.75)
    assert full.deviations() == {"material.Ktc": 8e7}


def test_cut(full):
    cut = full.cut
    # 14 turns a second
    assert cut.spindle_speed == pytest.approx(28.0 * math.pi)
    assert cut.spindle_speed_rpm == pytest.approx(840.0)
    assert (cut.feed_per_tooth, cut.axial_depth, cut.radial_depth) == (1e-4, 2e-3, 5e-3)


def test_modes(full):
    first, second = full.structure.mode
    assert (first.frequency, first.damping, first.stiffness) == (922.0, 0.02, 1.2e7)
    assert first.modal_mass == pytest.approx(1.2e7 / (2 * math.pi * 922) ** 2)
    assert first.direction == pytest.approx((0.6, 0.8, 0.0))
    assert second.frequency == pytest.approx(100.0)
    assert second.modal_mass == 0.5
    # within a percent of unit length: normalised
    assert second.direction == (0.0, 1.0, 0.0)
    assert (first.side, second.side) == ("tool", "workpiece")


def test_the_smaller_sections(full):
    assert (full.process_damping.coefficient, full.process_damping.friction) == (2e4, 0.3)
    assert (full.contact.stiffness, full.contact.damping) == (1e8, 200.0)
    assert full.friction["guide"].stribeck_velocity == 1e-3
    assert full.axis.moving_mass == 154.14
    assert (full.simulation.revolutions, full.simulation.resolution) == (20.0, 1e-5)
    assert full.lobes.speeds.from_ == pytest.approx(20 * math.pi)
    assert (full.lobes.speeds.count, full.lobes.depths.to) == (50, 5e-3)
    assert (full.lobes.method, full.lobes.steps) == ("zero-order", 40)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.parent.name)
def test_cases_of_examples_and_sets(path):
    case = load(path)
    assert case.title
    assert case.to_toml() == path.read_text(encoding="utf-8")
    assert loads(case.to_toml(), folder=path.parent) == case


def test_the_case_of_a_set_by_hand():
    case = load(DATA / "measurements/set-105/case.toml")
    assert case.tool.teeth == 5
    assert case.tool.helix == pytest.approx(math.radians(14))
    assert case.material.Ktc == pytest.approx(1.8962e9)
    assert case.material.Kre == pytest.approx(46685.7)
    assert case.cut.spindle_speed * 60 / (2 * math.pi) == pytest.approx(804)
    assert [mode.mass for mode in case.structure.mode] == [493.268, 67.3029, 56.6391]


def test_sections_are_optional_until_a_command_asks():
    case = loads('[axis]\nmoving_mass = "24.7 kg"\n', "axis.toml")
    case.require("axis")
    with pytest.raises(InputError) as caught:
        case.require("tool", "axis", "structure")
    assert caught.value.messages == (
        "axis.toml: [tool] is missing; this command needs it",
        "axis.toml: [structure] is missing; this command needs it",
    )


def test_a_slot_needs_no_radial_depth():
    text = FULL.replace('"down"', '"slot"').replace('radial_depth = "5 mm"', "")
    assert loads(text).cut.radial_depth is None


def test_radial_depth_may_be_the_diameter():
    text = FULL.replace('radial_depth = "5 mm"', 'radial_depth = "20 mm"')
    assert loads(text).cut.radial_depth == 0.02


@pytest.mark.parametrize(
    ("frf", "expected"),
    [
        ('"tap.uff"', [("tap.uff", None, "tool", None)]),
        ('["x.uff", "y.csv"]', [("x.uff", None, "tool", None), ("y.csv", None, "tool", None)]),
        (
            '[{ file = "x.frf", direction = "x" }, { file = "w.uff", direction = "yx", '
            'side = "workpiece", node = 7 }]',
            [("x.frf", "x", "tool", None), ("w.uff", "yx", "workpiece", "7")],
        ),
        ('{ file = "x.frf" }', [("x.frf", None, "tool", None)]),
    ],
)
def test_measured_frfs_are_found_from_the_folder_of_the_case(tmp_path, frf, expected):
    path = tmp_path / "case.toml"
    path.write_text(f"[structure]\nfrf = {frf}\n")
    entries = load(path).structure.frf
    found = [(entry.file, entry.direction, entry.side, entry.node) for entry in entries]
    assert found == [(tmp_path / name, *rest) for name, *rest in expected]


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("case.toml", "mill/machine.toml"),
        ("jobs/one/case.toml", "jobs/one/mill/machine.toml"),
        ("/home/somebody/jobs/case.toml", "mill/machine.toml"),
    ],
)
def test_a_machine_is_called_by_a_name_that_a_reader_elsewhere_knows(tmp_path, name, told):
    """Notes and reports held the whole path of the machine file."""
    (tmp_path / "mill").mkdir()
    block = 'mass = "10 kg", size = ["1 m", "1 m", "1 m"], centre = [0, 0, 0]'
    text = f'title = "m"\nbody.bed = {{ {block} }}'
    (tmp_path / "mill" / "machine.toml").write_text(text)
    case = loads('[structure]\nmachine = "mill/machine.toml"', name, tmp_path)
    assert case.machine_file().name == told


def test_a_virtual_machine_is_found_from_the_folder_of_the_case(tmp_path):
    case = loads('[structure]\nmachine = "mill/machine.toml"', folder=tmp_path)
    assert case.structure.machine == tmp_path / "mill/machine.toml"


def test_equality_is_by_content(full):
    same = loads(FULL.replace('axial_depth = "2 mm"', "axial_depth = 0.002 # bare"))
    assert same == full
    assert hash(same) == hash(full)
    other = loads(FULL.replace('"840 rpm"', '"841 rpm"'))
    assert other != full
    assert full != FULL
    assert len({full, same, other}) == 2


def test_cases_are_immutable_and_travel(full):
    with pytest.raises(ValueError, match="frozen"):
        full.tool.teeth = 3
    for twin in (pickle.loads(pickle.dumps(full)), copy.deepcopy(full)):
        assert twin == full
        assert twin.to_toml() == full.to_toml()


def test_from_dict_takes_what_a_file_takes():
    np = pytest.importorskip("numpy")
    mode = {"frequency": "100 Hz", "damping": 0.03, "mass": 1, "direction": np.array([0.0, 1, 0])}
    tool = {"teeth": np.int64(3), "diameter": np.float64(0.02), "runout": None}
    case = Case.from_dict({"title": None, "tool": tool, "structure": {"mode": (mode,)}})
    assert (case.tool.teeth, case.tool.diameter, case.tool.runout) == (3, 0.02, None)
    assert case.structure.mode[0].direction == (0.0, 1.0, 0.0)
    assert loads(case.to_toml()) == case


def test_a_case_made_of_sections_can_be_written(full):
    made = Case(title="made", tool=full.tool, lobes=full.lobes)
    assert loads(made.to_toml()) == made
    assert made.patch({"tool.diameter": "21 mm"}).tool.diameter == 0.021


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_by_name(name):
    material = loads(f"[material]\nname = '{name}'").material
    row = MATERIALS[name]
    assert material.force_law(0.5).cutting == row.cutting
    assert material.force_law(0.0).edge == row.edge
    assert row.source
    # pressures of a few hundred to a few thousand MPa, edge forces of at most some 100 N/mm
    assert 1e8 < row.cutting[0] < 5e9
    assert all(abs(value) < 2e5 for value in row.edge)


def test_coefficients_override_those_of_the_table():
    material = loads('[material]\nname = "Al7075-T6"\nKtc = "800 MPa"').material
    assert material.Ktc == 8e8
    assert material.Krc == 168.8e6


def test_published_rows():
    # as tabled in 10.1186/s10033-021-00536-9
    row = MATERIALS["Al7075 (Altintas)"]
    assert row.cutting == (1319.41e6, 788.83e6, 48.75e6)
    assert row.edge == (19.65e3, 26.77e3, 2.05e3)
    # given as specific force and angle: 2160 MPa and 50 N/mm at 68 degrees
    steel, angle = MATERIALS["steel (Cornelius)"], math.radians(68)
    across = (math.sin(angle), math.cos(angle))
    assert steel.cutting[:2] == pytest.approx([2160e6 * part for part in across], rel=1e-6)
    assert steel.edge[:2] == pytest.approx([50e3 * part for part in across], rel=1e-5)


def test_oblique_law():
    text = (
        '[material]\nlaw = "oblique"\nshear_stress = "613 MPa"\nfriction_angle = "19.1 deg"\n'
        'shear_angle = "33.067 deg"\nrake_angle = "0 deg"'
    )
    # validation 8: orthogonal, rake 0, h = 0.05 mm: 1730.9 and 599.4 MPa
    tangential, radial, axial = loads(text).material.force_law(0.0).cutting
    assert (tangential, radial) == pytest.approx((1730.9e6, 599.4e6), rel=1e-4)
    assert axial == pytest.approx(0.0, abs=1.0)


def test_friction_laws_name_their_keys():
    for law in FRICTION_LAWS:
        assert {key.name for key in law.keys} <= set(Friction.model_fields)


def test_methods_of_the_case_file_are_those_there_are():
    method = schema()["$defs"]["Lobes"]["properties"]["method"]
    assert set(method["enum"]) == {AUTO, *METHODS.names()}
