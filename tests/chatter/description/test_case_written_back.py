"""Writing a case back: comments, order and units stay, values hold, file names still lead there."""

import math
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chatter.description.case import Case, load, loads
from chatter.description.errors import InputError
from cutting.material.table import MATERIALS

TEXT = """\
# written by hand
title = "commented"   # short

[tool]   # the cutter
teeth    = 4          # four
diameter = "20 mm"    # over the edges
# helix follows
helix    = "30 deg"

[cut]
mode = 'down'
spindle_speed = "14 Hz"   # rev/s
feed_per_tooth = 1e-4   # bare: m
axial_depth = "2 +- 0.1 mm"
radial_depth = '''5 mm'''

# first mode
[[structure.mode]]
frequency = "922 Hz"
damping = "3 %"   # of critical
mass = "500 g"
direction = [
    1,  # feed
    0,
    0,
]

[[structure.mode]]
frequency = "628 rad/s"
damping = 0.02
stiffness = "12 N/um"
direction = [0, 1, 0]
# the end
"""


def lines_changed(patched):
    old, new = TEXT.splitlines(), patched.to_toml().splitlines()
    assert len(old) == len(new)
    return [after for before, after in zip(old, new, strict=True) if before != after]


def test_unpatched_text_is_the_same_text(tmp_path):
    case = loads(TEXT)
    assert case.to_toml() == TEXT
    case.save(tmp_path / "again.toml")
    assert (tmp_path / "again.toml").read_text() == TEXT
    assert load(tmp_path / "again.toml") == case


@pytest.mark.parametrize(
    ("path", "value", "line"),
    [
        ("title", "new", 'title = "new"   # short'),
        ("tool.teeth", 3, "teeth    = 3          # four"),
        ("tool.diameter", "0.9 inch", 'diameter = "0.9 inch"    # over the edges'),
        ("tool.diameter", 0.0215, 'diameter = "21.5 mm"    # over the edges'),
        ("tool.helix", math.pi / 4, 'helix    = "45 deg"'),
        ("cut.mode", "up", 'mode = "up"'),
        ("cut.spindle_speed", 40 * math.pi, 'spindle_speed = "20 Hz"   # rev/s'),
        ("cut.feed_per_tooth", 2e-4, "feed_per_tooth = 0.0002   # bare: m"),
        ("cut.feed_per_tooth", "0.2 mm", 'feed_per_tooth = "0.2 mm"   # bare: m'),
        # what is known of a value does not hold for another
        ("cut.axial_depth", 0.003, 'axial_depth = "3 mm"'),
        ("cut.radial_depth", 0.006, 'radial_depth = "6 mm"'),
        ("structure.mode[0].damping", 0.05, 'damping = "5 %"   # of critical'),
        ("structure.mode[0].mass", 0.7, 'mass = "700 g"'),
        ("structure.mode[1].frequency", 500 / math.pi, 'frequency = "1000 rad/s"'),
        ("structure.mode[1].damping", 0.03, "damping = 0.03"),
    ],
)
def test_a_patch_changes_one_line_in_the_unit_that_stood_there(path, value, line):
    patched = loads(TEXT).patch({path: value})
    assert lines_changed(patched) == [line]
    assert loads(patched.to_toml()) == patched


@pytest.mark.parametrize(
    ("values", "added"),
    [
        ({"tool.runout.offset": "5 um"}, ['runout = {offset = "5 um"}']),
        (
            {"process_damping.coefficient": "2e4 N/m"},
            ["[process_damping]", 'coefficient = "2e4 N/m"'],
        ),
        (
            {"lobes": {"speeds": {"from": "10 Hz", "to": "20 Hz"}, "steps": 40}},
            ["[lobes]", "steps = 40", "[lobes.speeds]", 'from = "10 Hz"', 'to = "20 Hz"'],
        ),
    ],
)
def test_what_is_new_is_added_and_nothing_else_moves(values, added):
    patched = loads(TEXT).patch(values)
    new = [line for line in patched.to_toml().splitlines() if line]
    assert [line for line in new if line not in added] == [
        line for line in TEXT.splitlines() if line
    ]
    assert [line for line in new if line in added] == added
    assert loads(patched.to_toml()) == patched


def test_removing_leaves_the_rest():
    patched = loads(TEXT).patch({"tool.helix": None, "structure.mode[1]": None})
    text = patched.to_toml()
    assert "helix    =" not in text
    assert "628" not in text
    assert "# first mode" in text
    assert "922" in text


LAYOUTS = {
    "dotted keys": (
        'tool.teeth = 4 # four\ntool.diameter = "20 mm"\ntool.runout.offset = "1 um"\n',
        {"tool.teeth": 3, "tool.runout.angle": "3 deg", "tool.runout.offset": 2e-6},
    ),
    "table before its parent": (
        '[tool.runout]\noffset = "1 um"\n[axis]\nmoving_mass = 3\n[tool]\nteeth = 4\n'
        'diameter = "20 mm"\n',
        {"tool.teeth": 3, "tool.runout.angle": "3 deg", "axis.moving_mass": "4 kg"},
    ),
    "table in two places": (
        '[friction.a]\ncoulomb = "1 N"\n[axis]\nmoving_mass = "3 kg"\n[friction.b]\n'
        'coulomb = "2 N"\n',
        {"friction.b.coulomb": 3.0, "friction.c.coulomb": "4 N", "axis.moving_mass": 5.0},
    ),
    "section in two places": (
        '[lobes]\nsteps = 40\n[axis]\nmoving_mass = "3 kg"\n[lobes.speeds]\nfrom = "1 Hz"\n'
        'to = "9 Hz"\n',
        {"lobes.steps": 50, "lobes.speeds.to": "8 Hz", "lobes.method": "zero-order"},
    ),
    "list of tables in one line": (
        "[structure]\nmode = [{ frequency = 1, damping = 0.1, mass = 1, direction = [1, 0, 0] },\n"
        "  # second\n  { frequency = 2, damping = 0.1, mass = 1, direction = [0, 1, 0] }]\n",
        {"structure.mode[1].damping": 0.2, "structure.mode[0].stiffness": "3 N/m"},
    ),
    "quoted keys": ('"tool"."teeth" = 4\n"tool".diameter = 0.01\n', {"tool.teeth": 3}),
    "lines of Windows": (
        '[tool]\r\nteeth = 4 # four\r\ndiameter = "20 mm"\r\n',
        {"tool.diameter": 0.021, "tool.helix": 0.1},
    ),
    "no last line end": ('[tool]\nteeth = 4\ndiameter = "20 mm"', {"tool.helix": 0.1}),
    "text of several lines": ('title = """a\nb"""\n', {"axis.moving_mass": 3}),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_of_toml_takes_patches(layout, tmp_path):
    text, values = LAYOUTS[layout]
    case = loads(text)
    patched = case.patch(values)
    assert case.to_toml() == text
    assert loads(patched.to_toml()) == patched
    for path, value in values.items():
        if not isinstance(value, str):
            assert patched.get(path) == pytest.approx(value, rel=1e-12)
    patched.save(tmp_path / "case.toml")
    assert load(tmp_path / "case.toml") == patched
    for comment in ("# four", "# second"):
        assert (comment in text) == (comment in patched.to_toml())


def test_file_names_lead_to_the_same_files_from_another_folder(tmp_path):
    home = tmp_path / "home"
    home.mkdir()
    for name in ("a.uff", "b.csv", "machine.toml"):
        (home / name).write_text(name)
    absolute = (home / "b.csv").as_posix()
    for index, frf in enumerate(
        [
            'frf = "a.uff"',
            f'frf = ["a.uff", "{absolute}", {{ file = "b.csv", direction = "x" }}]',
            'frf = { file = "a.uff" }',
            'machine = "machine.toml"',
        ]
    ):
        (home / "case.toml").write_text(f"[structure]\n{frf} # measured\n")
        case = load(home / "case.toml")
        target = tmp_path / f"away/{index}/case.toml"
        case.save(target)
        moved = load(target)
        assert moved == case
        assert "# measured" in target.read_text()
        assert ("../../home/" in target.read_text()) or absolute in target.read_text()
        files = [entry.file for entry in moved.structure.frf] or [moved.structure.machine]
        assert all(path.exists() for path in files)
        # beside the old one the names stay as they were
        case.save(home / "twin.toml")
        assert (home / "twin.toml").read_text() == (home / "case.toml").read_text()


def test_a_copy_elsewhere_is_another_case(tmp_path):
    text = '[structure]\nfrf = "a.uff"\n'
    here, there = loads(text, folder=tmp_path / "here"), loads(text, folder=tmp_path / "there")
    assert here != there


def test_places_that_cannot_be_written(tmp_path):
    case = loads(TEXT)
    with pytest.raises(InputError, match="cannot be written"):
        case.save(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        case.save(tmp_path / "file/case.toml")


def quantity(units, low=1e-3, high=1e3):
    """Text in any of the units, a bare SI number or text with a deviation."""
    number = st.floats(low, high, allow_subnormal=False)
    return st.one_of(
        st.builds("{:.6g} {}".format, number, st.sampled_from(units)),
        st.builds("{!r} {}".format, number, st.sampled_from(units)),
        st.builds("{0:.4g} +- 0.1 {1}".format, number, st.sampled_from(units)),
    )


def optional(**entries):
    return {key: st.none() | entry for key, entry in entries.items()}


LENGTH = quantity(["mm", "um", "µm"], 1e-3, 20.0)
MODES = st.lists(
    st.fixed_dictionaries(
        {
            "frequency": quantity(["Hz", "kHz", "rad/s", "rpm"]) | st.floats(1, 1e4),
            "damping": st.floats(1e-6, 0.99) | st.just("3 %"),
            "direction": st.sampled_from([[1, 0, 0], [0.6, 0.8, 0.0], [0, 0, -1.0]]),
            "side": st.sampled_from(["tool", "workpiece"]),
        }
    ).flatmap(
        lambda mode: st.one_of(
            quantity(["kg", "g"]).map(lambda mass: {**mode, "mass": mass}),
            quantity(["N/um", "N/m"]).map(lambda stiffness: {**mode, "stiffness": stiffness}),
        )
    ),
    min_size=1,
    max_size=3,
)
CASES = st.fixed_dictionaries(
    {
        "title": st.text(st.characters(exclude_categories=["Cs"]), max_size=20),
        "tool": st.fixed_dictionaries(
            {
                "teeth": st.integers(1, 200),
                "diameter": st.just("41 mm"),
                "helix": quantity(["deg"], 1e-3, 80.0)
                | quantity(["deg"], -80.0, -1e-3)
                | st.floats(1e-3, 1.5),
                **optional(
                    kind=st.sampled_from(["end mill", "taper", "inserted"]),
                    corner_radius=LENGTH,
                    runout=st.fixed_dictionaries({"offset": LENGTH}),
                ),
            }
        ),
        "material": st.one_of(
            st.fixed_dictionaries({"name": st.sampled_from(sorted(MATERIALS))}),
            st.fixed_dictionaries(
                {
                    "law": st.just("linear"),
                    "Ktc": quantity(["MPa", "N/mm^2", "GPa"]),
                    "Kre": quantity(["N/mm", "kN/m"]),
                }
            ),
        ),
        "cut": st.fixed_dictionaries(
            {
                "mode": st.sampled_from(["up", "down"]),
                "spindle_speed": quantity(["rpm", "Hz", "rad/s"]) | st.floats(1, 1e4),
                "feed_per_tooth": LENGTH,
                "axial_depth": LENGTH,
                "radial_depth": LENGTH,
            }
        ),
        "structure": st.fixed_dictionaries({"mode": MODES}),
        **optional(
            process_damping=st.fixed_dictionaries({"coefficient": quantity(["N/m"])}),
            friction=st.dictionaries(
                st.sampled_from(["guide", "screw", "x-axis"]),
                st.fixed_dictionaries(
                    {"law": st.just("coulomb-stribeck"), "coulomb": quantity(["N"])}
                ),
                max_size=2,
            ),
            lobes=st.fixed_dictionaries(
                {"speeds": st.just({"from": "1 Hz", "to": 10.0, "count": 3})}
            ),
        ),
    }
)


@settings(deadline=None, max_examples=60)
@given(CASES)
def test_random_cases_come_back_the_same(data):
    case = Case.from_dict(data, "made")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.toml"
        case.save(path)
        again = load(path)
    assert again == case
    assert hash(again) == hash(case)
    assert again.deviations() == case.deviations()
    # and after a patch too
    patched = again.patch({"cut.axial_depth": 1.234567890123456e-3, "tool.teeth": 7})
    assert loads(patched.to_toml()) == patched
    assert patched.cut.axial_depth == pytest.approx(1.234567890123456e-3, rel=1e-12, abs=0.0)
