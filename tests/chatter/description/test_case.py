"""The case file: read, checked, written back with comments and units."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import chatter
from chatter import Case, InputError, load
from chatter.description.case import loads
from chatter.description.file_access import VARIABLE
from tests.places import DATA, EXAMPLES

TEXT = """# my case, with care
title = "Étude"   # as in the report

[tool]
teeth    = 2          # carbide
diameter = "16 mm"
helix = ["30 deg", "30 deg"]

[material]
Ktc = "600 +- 30 MPa"   # from the catalogue
Krc = "2.0e8 Pa"
Kte = 25e3

# the operation
[cut]
mode = "down"
spindle_speed = "10_000 rpm"
feed_per_tooth = "100 um"
axial_depth = "1 mm"
radial_depth = "0.25 inch"

[[structure.mode]]    # bending
frequency = "922 Hz"
damping = "1.1 %"
mass = "39.93 g"
direction = [1, 0, 0]

[[structure.mode]]
frequency = "700 Hz"
damping = 0.02
stiffness = "1 N/um"
direction = [0.0, 1.0, 0.0]
side = "workpiece"

[friction."x guide"]
coulomb = "80 N"

[lobes]
speeds = { from = "9000 rpm", to = "11000 rpm", count = 3 }
"""


@pytest.fixture
def case():
    return loads(TEXT)


def test_values_in_si(case):
    assert case.title == "Étude"
    assert case.tool.diameter == 16e-3
    assert case.tool.helix == pytest.approx((math.pi / 6.0, math.pi / 6.0))
    assert case.material.Ktc == 600e6
    assert case.material.Kte == 25e3
    assert case.cut.spindle_speed == pytest.approx(10_000.0 * math.pi / 30.0)
    assert case.cut.feed_per_tooth == 1e-4
    assert case.cut.radial_depth == pytest.approx(6.35e-3)
    first, second = case.structure.mode
    assert (first.frequency, first.side) == (922.0, "tool")
    assert first.damping == pytest.approx(0.011, rel=1e-14)
    assert first.modal_mass == 0.03993
    assert second.modal_mass == pytest.approx(1e6 / (2.0 * math.pi * 700.0) ** 2)
    assert second.side == "workpiece"
    assert case.friction["x guide"].coulomb == 80.0
    assert case.lobes.speeds.from_ == pytest.approx(300.0 * math.pi)


def test_get(case):
    assert case.get("cut.axial_depth") == 1e-3
    assert case.get("structure.mode[1].direction[1]") == 1.0
    assert case.get("structure.mode[*].frequency") == (922.0, 700.0)
    assert case.get("lobes.speeds.from") == case.lobes.speeds.from_
    assert case.get("tool").teeth == 2


@pytest.mark.parametrize("path", ["cut.depth", "structure.mode[2].mass", "", "tool.teeth.x", "a b"])
def test_get_of_what_is_not_there(case, path):
    with pytest.raises(InputError):
        case.get(path)


def test_deviations(case):
    assert case.deviations() == {"material.Ktc": 30e6}


def test_is_immutable_hashable_and_comparable(case):
    with pytest.raises(Exception, match="frozen"):
        case.tool.teeth = 3
    with pytest.raises(Exception, match="frozen"):
        case.title = "other"
    assert case == loads(TEXT.replace("39.93 g", "0.03993 kg").replace("# bending", ""))
    assert hash(case) == hash(loads(TEXT))
    assert case != loads(
        TEXT.replace("teeth    = 2", "teeth    = 3").replace(', "30 deg"]', ', "30 deg", "30 deg"]')
    )
    assert case != "case"


def test_written_back_as_it_was(case, tmp_path):
    assert case.to_toml() == TEXT
    case.save(tmp_path / "new" / "case.toml")
    assert (tmp_path / "new/case.toml").read_bytes() == TEXT.encode()
    assert load(tmp_path / "new/case.toml") == case


def test_windows_line_ends_stay(tmp_path):
    (tmp_path / "case.toml").write_bytes(TEXT.replace("\n", "\r\n").encode())
    case = load(tmp_path / "case.toml").patch({"cut.axial_depth": "2 mm"})
    case.save(tmp_path / "other.toml")
    expected = TEXT.replace('axial_depth = "1 mm"', 'axial_depth = "2 mm"')
    assert (tmp_path / "other.toml").read_bytes() == expected.replace("\n", "\r\n").encode()


def test_byte_order_mark(tmp_path):
    (tmp_path / "case.toml").write_bytes(b"\xef\xbb\xbf" + TEXT.encode())
    assert load(tmp_path / "case.toml") == loads(TEXT)


def test_a_case_without_a_file(case, tmp_path):
    made = Case.from_dict(
        {
            "title": "made",
            "tool": {"teeth": 4, "diameter": "20 mm", "pitch": None},
            "cut": {
                "mode": "slot", "spindle_speed": "5000 rpm", "feed_per_tooth": "0.1 mm",
                "axial_depth": np.float64(2e-3),
            },
            "structure": {
                "mode": [
                    {"frequency": 500, "damping": 0.03, "mass": 1, "direction": np.array([1, 0, 0])}
                ]
            },
            "lobes": {"speeds": {"from": "1000 rpm", "to": "2000 rpm"}},
        }
    )  # fmt: skip
    assert made.cut.axial_depth == 2e-3
    made.save(tmp_path / "made.toml")
    assert load(tmp_path / "made.toml") == made
    assert made.patch({"tool.teeth": 3}).tool.teeth == 3


@pytest.mark.parametrize(
    "data", [3, [1], {"tool": {"teeth": {1, 2}}}, {"tool": 3}, {"nothing": {}}, {"title": object()}]
)
def test_from_dict_refuses(data):
    with pytest.raises(InputError):
        Case.from_dict(data)


def test_from_dict_of_a_loop_is_refused():
    loop = {}
    loop["tool"] = loop
    with pytest.raises(InputError, match="nested"):
        Case.from_dict(loop)


FRF_FORMS = [
    'frf = "tap.uff"',
    'frf = ["tap.uff", "sub/other.csv"]',
    'frf = [{ file = "tap.uff", direction = "x" }, "b.csv"]',
    'frf = { file = "tap.uff", direction = "xy" }',
    'machine = "../machine.toml"',
]


def files_of(case):
    structure = case.structure
    names = [entry.file for entry in structure.frf]
    return [*names, structure.machine] if structure.machine else names


@pytest.mark.parametrize("form", FRF_FORMS)
def test_file_names_hold_after_saving_elsewhere(tmp_path, form, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    here = tmp_path / "here"
    here.mkdir()
    (here / "case.toml").write_text(f"[structure]\n{form}  # measured on Monday\n")
    case = load(here / "case.toml")
    assert files_of(case)[0].resolve().parent in (here, tmp_path)
    for folder in ("there/deep", "here", "."):
        case.save(tmp_path / folder / "copy.toml")
        text = (tmp_path / folder / "copy.toml").read_text()
        again = load(tmp_path / folder / "copy.toml")
        assert [f.resolve() for f in files_of(again)] == [f.resolve() for f in files_of(case)]
        assert "# measured on Monday" in text
        assert str(tmp_path) not in text
        assert again == case
    # the case in memory is as it was
    assert case.to_toml() == (here / "case.toml").read_text()


def test_file_names_as_tables(tmp_path):
    (tmp_path / "case.toml").write_text('[[structure.frf]]\nfile = "tap.csv"\ndirection = "y"\n')
    load(tmp_path / "case.toml").save(tmp_path / "a" / "case.toml")
    assert load(tmp_path / "a/case.toml").structure.frf[0].file.resolve() == tmp_path / "tap.csv"


def test_absolute_file_names_stay(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "/data")
    (tmp_path / "case.toml").write_text('[structure]\nfrf = "/data/tap.uff"\n')
    load(tmp_path / "case.toml").save(tmp_path / "a" / "case.toml")
    assert (tmp_path / "a/case.toml").read_text() == '[structure]\nfrf = "/data/tap.uff"\n'


def test_relative_file_names_do_not_depend_on_the_current_folder(tmp_path, monkeypatch):
    (tmp_path / "in").mkdir()
    (tmp_path / "in/case.toml").write_text('[structure]\nfrf = "tap.uff"\n')
    monkeypatch.chdir(tmp_path)
    case = load("in/case.toml")
    case.save("out.toml")
    assert (tmp_path / "out.toml").read_text() == '[structure]\nfrf = "in/tap.uff"\n'


def test_save_where_nothing_may_be_written(case, tmp_path, monkeypatch):
    # permissions do not bind an administrator
    def refused(self, *_, **__):
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "mkdir", refused)
    with pytest.raises(InputError, match="cannot be written"):
        case.save(tmp_path / "a" / "case.toml")


def test_save_below_a_file(case, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="cannot be written"):
        case.save(tmp_path / "file" / "case.toml")
    with pytest.raises(InputError, match="cannot be written"):
        case.save(tmp_path)


def case_files():
    return sorted([*EXAMPLES.glob("*/case.toml"), *DATA.rglob("case.toml")])


@pytest.mark.parametrize("path", case_files(), ids=lambda path: path.parent.name)
def test_shipped_case_files(path, tmp_path):
    case = load(path)
    assert case.to_toml() == path.read_text(encoding="utf-8")
    case.save(tmp_path / "case.toml")
    assert load(tmp_path / "case.toml") == case
    # in the same folder nothing at all changes
    assert Case.from_dict(case._source().unwrap(), folder=path.parent) == case


LENGTHS = st.floats(1e-6, 1e-2).map(lambda value: f"{value * 1e3!r} mm")


@given(
    teeth=st.integers(1, 200),
    depth=LENGTHS,
    speed=st.floats(1.0, 1e6).map(lambda value: f"{value!r} rpm"),
    damping=st.floats(1e-6, 0.99),
    angle=st.floats(0.0, 2.0 * math.pi),
    title=st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=20),
)
def test_made_cases_survive_writing(teeth, depth, speed, damping, angle, title):
    case = Case.from_dict(
        {
            "title": title,
            "tool": {"teeth": teeth, "diameter": "20 mm"},
            "cut": {
                "mode": "up", "spindle_speed": speed, "feed_per_tooth": "0.1 mm",
                "axial_depth": depth, "radial_depth": "3 mm",
            },
            "structure": {
                "mode": [
                    {
                        "frequency": "500 Hz", "damping": damping, "stiffness": "1 N/um",
                        "direction": [math.cos(angle), math.sin(angle), 0.0],
                    }
                ]
            },
        }
    )  # fmt: skip
    assert loads(case.to_toml()) == case


def test_schema_and_public_names():
    assert chatter.schema()["title"]
    assert set(chatter.__all__) <= set(dir(chatter))
    with pytest.raises(AttributeError, match="nothing"):
        _ = chatter.nothing
