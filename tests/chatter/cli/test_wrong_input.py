"""Wrong input on the command line: exit code 2, one clear message, never a traceback or a NaN."""

import json

import pytest

from tests.cases import TOOL_OF_922_HERTZ
from tests.command_line import chatter_command

GOOD = f"""{TOOL_OF_922_HERTZ}
[lobes]
speeds = {{ from = "9000 rpm", to = "11000 rpm", count = 3 }}
depths = {{ to = "4 mm", count = 8 }}
"""

FRF_STRUCTURE = '[[structure.frf]]\nfile = "tap.csv"\ndirection = "x"\n'


def run(*arguments):
    return chatter_command(*arguments)


def refused(result, *words):
    assert result.exit_code == 2, result.output
    assert "Traceback" not in result.output
    assert "fault in chatter" not in result.output
    for word in words:
        assert word in result.stderr
    assert result.stdout == ""


def write(tmp_path, text, name="case.toml"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_the_good_case_is_good(tmp_path):
    result = run("check", write(tmp_path, GOOD), "--json")
    assert result.exit_code == 0, result.output
    summary = json.loads(result.stdout)
    # validation 2.3: first limit 2.104690 mm, a flip
    assert summary["critical_depth_mm"] == pytest.approx(2.104690, rel=2e-4)
    assert summary["stable"] is True


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[tool]", "[tool", ["TOML", "line"]),
        ("diameter =", "diamter =", ["tool.diamter", "unknown key", '"diameter"']),
        ("[cut]", "[cutt]", ["cutt", '"cut"']),
        ('"16 mm"', '"16 kg"', ["tool.diameter", "16 kg", "length"]),
        ('"16 mm"', '"16"', ["tool.diameter", "no unit"]),
        ('"16 mm"', '"16 furlongz"', ["tool.diameter", "furlongz"]),
        ('"16 mm"', '"-16 mm"', ["tool.diameter", "greater than 0"]),
        ('"16 mm"', "true", ["tool.diameter"]),
        ('"16 mm"', "nan", ["tool.diameter", "finite"]),
        ("teeth = 2", "teeth = 0", ["tool.teeth", "0"]),
        ("teeth = 2", "teeth = -3", ["tool.teeth"]),
        ("teeth = 2", "teeth = 2.5", ["tool.teeth", "whole"]),
        ("teeth = 2", "teeth = 1000000000", ["tool.teeth", "200"]),
        ("teeth = 2", "teeth = 2\nteeth = 3", ["TOML"]),
        ("teeth = 2", 'teeth = 2\nkind = "drill"', ["tool.kind", "drill", "end mill"]),
        ("teeth = 2", 'teeth = 2\npitch = ["100 deg", "100 deg"]', ["tool.pitch", "360"]),
        ("teeth = 2", 'teeth = 2\nhelix = "95 deg"', ["tool.helix", "90 deg"]),
        (
            "teeth = 2",
            'teeth = 2\nserration = { depth = "9 mm", wavelength = "3 mm" }',
            ["tool.serration.depth", "9 mm", "the radius of the tool, 8 mm"],
        ),
        (
            "teeth = 2",
            'teeth = 2\nserration = { depth = "0.2 mm", wavelength = "1 um" }',
            ["tool.serration.wavelength", "4e+03 waves", "200"],
        ),
        ('radial_depth = "8 mm"', 'radial_depth = "17 mm"', ["cut.radial_depth", "16 mm"]),
        ('radial_depth = "8 mm"', "", ["cut.radial_depth", "missing"]),
        ('feed_per_tooth = "0.1 mm"', "", ["cut.feed_per_tooth", "missing"]),
        ('axial_depth = "1 mm"', 'axial_depth = "0 mm"', ["cut.axial_depth"]),
        ('"10000 rpm"', '"10000 mm"', ["cut.spindle_speed", "spindle speed"]),
        ('"10000 rpm"', '"0 rpm"', ["cut.spindle_speed"]),
        ('mode = "down"', 'mode = "climb"', ["cut.mode", "climb", '"down"']),
        ("damping = 0.011", "damping = -0.01", ["structure.mode[0].damping"]),
        ("damping = 0.011", "damping = 1.2", ["structure.mode[0].damping", "less than 1"]),
        ("damping = 0.011", "damping = inf", ["structure.mode[0].damping", "finite"]),
        ("damping = 0.011\n", "", ["structure.mode[0].damping", "missing"]),
        ("[1, 0, 0]", "[0, 0, 0]", ["structure.mode[0].direction", "unit vector"]),
        ("[1, 0, 0]", "[1, 1]", ["structure.mode[0].direction"]),
        ("[1, 0, 0]", "[0, 0, 1]", ["tool axis"]),
        ('mass = "0.03993 kg"', "", ["structure.mode[0]", "mass or stiffness"]),
        ('y = "922 Hz"', 'y = "922 m"', ["structure.mode[0].frequency", "frequency"]),
        ('Ktc = "600 MPa"', "", ["material.Ktc", "missing"]),
        ('Ktc = "600 MPa"', 'name = "Al7075T6"', ["material.name", "Al7075-T6"]),
        ("count = 3", "count = 2000000000", ["lobes.speeds.count"]),
        ("count = 3", "count = 1", ["lobes.speeds.count"]),
        ('from = "9000 rpm"', 'from = "12000 rpm"', ["lobes.speeds", "from"]),
        ("[lobes]", '[lobes]\nmethod = "magic"', ["magic", "semi-discretization"]),
        ("[lobes]", "[lobes]\nsteps = 10000000", ["lobes.steps"]),
        ('title = "922 Hz"', "title = 3", ["title"]),
        ("[tool]", "tool = 1\n[toolz]", ["tool", "table"]),
    ],
)
@pytest.mark.parametrize("command", ["check", "lobes"])
def test_wrong_cases(tmp_path, command, old, new, words):
    assert old in GOOD
    path = write(tmp_path, GOOD.replace(old, new, 1))
    refused(run(command, path, "--out", tmp_path / "out"), *words)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["check", "lobes"])
def test_a_width_rounded_to_a_hair_above_the_diameter_is_a_slot(tmp_path, command):
    wide = GOOD.replace('radial_depth = "8 mm"', "radial_depth = 0.01600000000000001")
    slot = GOOD.replace('mode = "down"', 'mode = "slot"').replace('radial_depth = "8 mm"\n', "")
    found = []
    for name, text in (("wide", wide), ("slot", slot)):
        result = run(command, write(tmp_path, text), "--json", "--out", tmp_path / name)
        assert result.exit_code == 0, result.output
        found.append(json.loads(result.stdout))
    key = "lowest_limit" if command == "lobes" else "critical_depth_mm"
    assert found[0][key] == pytest.approx(found[1][key])


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"", "empty"),
        (b"   \n", "empty"),
        (b"\x00\x01\x02\xff" * 50, "binary"),
        (b'title = "\xff\xfe"', "UTF-8"),
        (b"just words", "TOML"),
        (b"a = " + b"[" * 3000, "TOML"),
    ],
)
@pytest.mark.parametrize("command", ["check", "lobes"])
def test_files_that_are_no_case(tmp_path, command, content, word):
    refused(run(command, write(tmp_path, content)), "case.toml", word)


@pytest.mark.parametrize("command", ["check", "lobes"])
def test_missing_file_and_folder(tmp_path, command):
    refused(run(command, tmp_path / "none.toml"), "none.toml", "no such file")
    refused(run(command, tmp_path), "folder")


def test_sections_that_a_command_needs(tmp_path):
    result = run("check", write(tmp_path, "[axis]\nmoving_mass = 3"))
    refused(result, "[tool]", "[material]", "[cut]", "[structure]")
    assert len(result.stderr.strip().splitlines()) == 4


def test_several_problems_are_told_together(tmp_path):
    text = GOOD.replace("teeth = 2", "teeth = 0").replace('y = "922 Hz"', 'y = "922 m"')
    result = run("check", write(tmp_path, text))
    refused(result, "tool.teeth", "structure.mode[0].frequency")
    assert len(result.stderr.strip().splitlines()) == 2


@pytest.mark.parametrize(
    ("assignment", "word"),
    [
        ("cut.axial_depth", "PATH=VALUE"),
        ("=3", "PATH=VALUE"),
        ("cut.axial_dept=2 mm", "axial_depth"),
        ("cut.axial_depth=2 kg", "mass"),
        ("structure.mode[7].damping=0.1", "structure.mode"),
        ("cut.axial_depth.x=3", "not a table"),
        ("nothing=3", "nothing"),
        ("cut..x=3", "not a path"),
    ],
)
def test_wrong_assignments(tmp_path, assignment, word):
    refused(run("check", write(tmp_path, GOOD), "--set", assignment), word)


@pytest.mark.parametrize(
    "assignments",
    [
        ["cut.spindle_speed=0.001 rpm"],
        ["structure.mode[0].damping=1e-300"],
        ["structure.mode[0].stiffness=1e300"],
        ["structure.mode[0].mass=1e-300"],
        ["material.Ktc=1e300"],
        ["tool.diameter=1e-300", "cut.radial_depth=1e-301"],
        ["cut.axial_depth=1e9"],
        ["cut.spindle_speed=1e15"],
        ["structure.mode[0].frequency=1e-200"],
        ["tool.helix=89.999999 deg"],
    ],
)
def test_absurd_values_give_a_message_or_a_number(tmp_path, assignments):
    options = [part for text in assignments for part in ("--set", text)]
    result = run("check", write(tmp_path, GOOD), *options)
    assert "Traceback" not in result.output
    assert "fault in chatter" not in result.output
    assert result.exit_code in (0, 1, 2)
    if result.exit_code == 0:

        def no_constant(name):
            raise AssertionError(f"{name} in the output")

        json.loads(result.stdout, parse_constant=no_constant)


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"", "empty"),
        (b"\x00\xff\x00" * 100, ""),
        (b"some words\nand more\n", ""),
        (b"frequency [Hz],real [m/N],imag [m/N]\n1,2,3\n2,nan,1\n3,1,1\n", "3"),
        (b"frequency [Hz],real [m/N],imag [m/N]\n1,2,3\n", ""),
        (b"frequency [Hz],real [m/N],imag [m/N]\n2,2,3\n1,2,2\n", ""),
        (b"1,2,3\n2,3,4\n3,4,5\n", ""),
        (b"frequency [Hz],real [mm],imag [mm]\n1,2,3\n2,3,4\n3,4,5\n", ""),
    ],
)
def test_wrong_frf_files(tmp_path, content, word):
    path = write(tmp_path, content, "tap.csv")
    refused(run("modes", path, "--out", tmp_path / "out"), "tap.csv", word)
    text = GOOD[: GOOD.index("[[structure.mode]]")] + FRF_STRUCTURE
    refused(run("lobes", write(tmp_path, text), "--out", tmp_path / "out"), "tap.csv", word)


def test_frf_that_is_missing_or_a_folder(tmp_path):
    text = GOOD[: GOOD.index("[[structure.mode]]")] + FRF_STRUCTURE
    path = write(tmp_path, text)
    refused(run("check", path), "tap.csv")
    (tmp_path / "tap.csv").mkdir()
    refused(run("check", path), "tap.csv")
    refused(run("modes", tmp_path / "none.uff"), "none.uff")
    refused(run("modes", path), "case.toml")


def test_wrong_options(tmp_path):
    path = write(tmp_path, GOOD)
    refused(run("lobes", path, "--method", "nonsense"), "nonsense", "zero-order")
    (tmp_path / "file").write_text("x")
    assert run("lobes", path, "--out", tmp_path / "file").exit_code == 2
    refused(run("examples", "one-degree-of-freedm"), "one-degree-of-freedom")
    assert run("check").exit_code == 2
    assert run("check", path, "--nonsense").exit_code == 2


def test_json_and_repeated_assignments(tmp_path):
    path = write(tmp_path, GOOD)
    result = run(
        "lobes", path, "--json", "--out", tmp_path / "out",
        "--set", "lobes.speeds.count=2", "--set", "cut.axial_depth=3 mm",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    summary = json.loads(result.stdout)
    assert summary["operating_point"]["axial_depth_mm"] == pytest.approx(3.0)
    # beyond the flip limit of 2.10 mm and beyond the narrow stable stretch above it
    assert summary["operating_point"]["stable"] is False


def test_examples_and_schema(tmp_path):
    listed = run("examples")
    assert "flexible-workpiece" in listed.stdout
    assert run("examples", "slotting", "--out", tmp_path / "mine").exit_code == 0
    assert (tmp_path / "mine/case.toml").exists()
    refused(run("examples", "slotting", "--out", tmp_path / "mine"), "mine")
    assert json.loads(run("schema").stdout)["properties"]["tool"]


def test_a_value_on_the_command_line_mends_the_one_of_the_file(tmp_path):
    path = write(tmp_path, GOOD.replace('diameter = "', 'diameter = "many ', 1))
    refused(run("check", path), "tool.diameter")
    mended = run("check", path, "--set", "tool.diameter=12 mm")
    assert mended.exit_code == 0, mended.output
    # what is still wrong is told, with the file
    refused(run("check", path, "--set", "cut.axial_depth=1 mm"), "case.toml: tool.diameter")
    refused(run("check", path, "--set", "cut.axail_depth=1 mm"), "case.toml: cut.axail_depth")
