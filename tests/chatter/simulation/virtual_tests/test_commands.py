"""`chatter frf` and `chatter move`: files, exit codes, and what is refused in one sentence."""

import csv
import json

import numpy as np
import pytest

from tests.command_line import chatter_command

PNG = b"\x89PNG\r\n\x1a\n"


def chatter(command, file, *options, sets=()):
    words = [command, file, "--out", file.parent / "out", *options]
    words += [word for text in sets for word in ("--set", text)]
    return chatter_command(*words)


def refused(result, folder, *words, code=2):
    """Sentences on stderr that hold the words; nothing is written, nothing falls through."""
    assert result.exit_code == code, result.output
    assert "fault in chatter" not in result.output
    assert "Traceback" not in result.output
    for word in words:
        assert word in result.stderr
    for line in result.stderr.strip().splitlines():
        # a value that no machine has is asked about before, and a busy machine tells what it does
        assert line.startswith(("chatter: ", "note: ")) or line.endswith(" s so far")
    assert result.stdout == ""
    assert not (folder / "out").exists()


def strict(text):
    def no_constant(name):
        raise AssertionError(f"{name} in the output")

    return json.loads(text, parse_constant=no_constant)


def columns_of(path):
    with path.open() as file:
        header, *rows = csv.reader(file)
    return header, np.array([[float(cell) for cell in row] for row in rows])


def test_frf_of_all_tests(machine_file, tmp_path):
    result = chatter("frf", machine_file, "--json")
    assert result.exit_code == 0, result.output
    out = tmp_path / "out"
    names = {path.name for path in out.iterdir()}
    assert names == {"rest.csv", "rest-test.csv", "linear.csv", "frf.png", "summary.json"}
    assert (out / "frf.png").read_bytes()[:8] == PNG
    summary = strict(result.stdout)
    assert summary == strict((out / "summary.json").read_text())
    assert [curve["name"] for curve in summary["curves"]] == ["rest", "linear"]
    assert summary["curves"][1]["state"] == "no friction"
    header, linear = columns_of(out / "rest.csv")
    assert header == ["frequency [Hz]", "real [m/N]", "imag [m/N]"]
    assert (linear[0, 0], linear[-1, 0], len(linear)) == (20.0, 120.0, 200)
    # driven point: it dissipates
    assert np.all(linear[:, 2] < 0.0)
    header, tested = columns_of(out / "rest-test.csv")
    assert header[:3] == ["frequency [Hz]", "real [m/N]", "imag [m/N]"]
    by_line = np.interp(tested[:, 0], linear[:, 0], np.hypot(linear[:, 1], linear[:, 2]))
    inside = (tested[:, 0] > 21.0) & (tested[:, 0] < 119.0)
    ratio = np.hypot(tested[:, 1], tested[:, 2])[inside] / by_line[inside]
    assert ratio == pytest.approx(np.ones(inside.sum()), rel=0.02)


def test_frf_by_options(machine_file, tmp_path):
    options = ["--excite", "table/tool:y", "--by", "linearised", "--band", "10 Hz, 30 Hz"]
    result = chatter("frf", machine_file, *options, "--brake", "Y", "--no-friction")
    assert result.exit_code == 0, result.output
    _, values = columns_of(tmp_path / "out/table-tool-y.csv")
    assert (values[0, 0], values[-1, 0]) == (10.0, 30.0)
    # quasi-static: nut and brake in a row; the brake's 1e5 N m/rad over (10 mm / 2 pi)^2
    stiffness = 1.0 / (1.0 / 1.2e8 + (10e-3 / (2.0 * np.pi)) ** 2 / 1e5)
    assert values[0, 1] == pytest.approx(1.0 / stiffness, rel=0.05)


def test_frf_of_the_tool_point_where_none_is_asked_for(machine_text, machine_file, tmp_path):
    head = machine_text.split("[frf.rest]")[0]
    machine_file.write_text(head)
    result = chatter("frf", machine_file, "--by", "linearised", "--json")
    assert result.exit_code == 0, result.output
    assert [curve["name"] for curve in strict(result.stdout)["curves"]] == [
        "tool x", "tool y", "tool z",
    ]  # fmt: skip
    refused(chatter("move", machine_file, sets=["title=b"]), tmp_path / "none", "no [move.NAME]")


def test_where_there_is_no_peak_the_largest_value_is_told(machine_file):
    options = ["--excite", "table:y", "--by", "linearised", "--band", "200 Hz, 300 Hz"]
    result = chatter("frf", machine_file, *options, "--no-friction")
    assert result.exit_code == 0, result.output
    assert "none from 200 to 300 Hz; the largest value is" in result.stdout
    assert "m/N at 200 Hz" in result.stdout


@pytest.mark.parametrize(
    ("excite", "read", "unit"),
    [
        ("motor:Y", "table:y", "m/(N*m)"),
        ("motor:Y", "motor:Y", "rad/(N*m)"),
        ("table:y", "table:rx", "rad/N"),
        ("table:rz", "table:rz", "rad/(N*m)"),
    ],
)
def test_units_say_what_is_excited_and_read(machine_file, tmp_path, excite, read, unit):
    options = ["--excite", excite, "--read", read, "--by", "linearised", "--json"]
    result = chatter("frf", machine_file, *options)
    assert result.exit_code == 0, result.output
    (curve,) = strict(result.stdout)["curves"]
    assert curve["unit"] == unit
    (path,) = (tmp_path / "out").glob("*.csv")
    header, _ = columns_of(path)
    assert header == ["frequency [Hz]", f"real [{unit}]", f"imag [{unit}]"]


def test_move_of_all_moves(machine_file, tmp_path):
    result = chatter("move", machine_file, "--json")
    assert result.exit_code == 0, result.output
    summaries = strict(result.stdout)
    assert set(summaries) == {"fast", "slow"}
    for name in ("fast", "slow"):
        folder = tmp_path / "out" / name
        assert {path.name for path in folder.iterdir()} == {"move.csv", "move.png", "summary.json"}
        assert (folder / "move.png").read_bytes()[:8] == PNG
    header, values = columns_of(tmp_path / "out/fast/move.csv")
    assert header[:4] == ["time [s]", "Y set [m]", "Y motor [m]", "Y scale [m]"]
    end = dict(zip(header, values[-1], strict=True))
    assert end["Y set [m]"] == pytest.approx(0.02)
    assert end["Y scale [m]"] == pytest.approx(0.02, abs=2e-5)
    assert end["Y tool [m]"] == pytest.approx(0.02, abs=2e-5)
    error = np.max(np.abs(values[:, 1] - values[:, 3]))
    assert summaries["fast"]["axes"]["Y"]["tracking_error_um"] == pytest.approx(
        1e6 * error, rel=1e-5
    )


def test_move_of_one_move(machine_file, tmp_path):
    result = chatter("move", machine_file, "--only", "slow")
    assert result.exit_code == 0, result.output
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "move.csv", "move.png", "summary.json",
    }  # fmt: skip
    assert "slow: largest set less actual" in result.stdout


@pytest.mark.parametrize("command", ["frf", "move"])
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("connector.guide.stiffness.x=-1 N/um", ["connector.guide.stiffness.x", "at least 0"]),
        ("body.table.mass=0 kg", ["body.table.mass", "greater than 0"]),
        ('connector.guide.between=["table", "beed"]', ["connector.guide.between[1]", '"beed"']),
        ("connector.guide.stiffness.rx=0 N*m/rad", ['"table" rotation about x']),
        (
            "axis.Y.control.velocity.sample_time=250 us",
            ["axis.Y.control", "velocity", "0.00025 s", "multiple"],
        ),
        ("axis.Y.control.current.sample_time=50 us", ["current", "not a whole multiple", "step"]),
        (
            "axis.Y.control.velocity.proportional_gain=500 N*m*s/rad",
            ['axis "Y"', "unstable", "about 2.5e+03 Hz", "velocity gain 500"],
        ),
        ("axis.Y.control.position.gain=3000 1/s", ['axis "Y"', "unstable", "Hz"]),
        ("body.table.mas=3 kg", ["body.table.mas", "unknown key"]),
        ("step=0 s", ["step"]),
    ],
)
def test_bad_machines(machine_file, tmp_path, command, text, words):
    refused(chatter(command, machine_file, sets=[text]), tmp_path, "small.toml", *words)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--excite", "tabel:y"], ["small.toml", 'no point "tabel"', '"table"']),
        (["--excite", "table:q"], ["excite", "'table:q'"]),
        (["--excite", "table"], ["excite", "a point and a direction"]),
        (["--excite", "motor:Y"], ["excite", "torque"]),
        (["--excite", "motor:Q", "--by", "torque impulse", "--read", "table:y"],
         ["small.toml", 'axis "Q" is not under control']),
        (["--excite", "motor:Y", "--by", "torque multisine"], ["read", "missing"]),
        (["--excite", "table:y", "--moving", "Y=1 mm/s", "--brake", "Y"],
         ["small.toml", 'axis "Y" is not under control']),
        (["--excite", "table:y", "--moving", "Y"], ["--moving", "AXIS=VALUE"]),
        (["--excite", "table:y", "--moving", "Y=1 mm"], ["moving", "velocity"]),
        (["--excite", "table:y", "--band", "200 Hz, 10 Hz"], ["band", "not below"]),
        (["--excite", "table:y", "--band", "200 Hz"], ["band", "2"]),
        (["--excite", "table:y", "--band", "10 Hz, 9 kHz"], ["band", "9000 Hz", "5000 Hz"]),
        (["--excite", "table:y", "--by", "kick"], ["by", '"hammer"']),
        (["--excite", "table:y", "--level", "3 m"], ["level"]),
        (["--excite", "table:y", "--free", "Q"], ["small.toml", 'no axis "Q"']),
        (["--excite", "table:y", "--position", "Q=1 mm"], ["small.toml", "Q"]),
        (["--only", "rust"], ["--only rust", "[frf.rust]", "rest, linear"]),
    ],
)  # fmt: skip
def test_bad_options_of_frf(machine_file, tmp_path, options, words):
    refused(chatter("frf", machine_file, *options), tmp_path, *words)


@pytest.mark.parametrize(
    ("sets", "options", "words"),
    [
        (['move.fast.axes=["Q"]'], [], ["small.toml: move.fast", '"Q"']),
        (["move.fast.travel=[1, 2]"], [], ["move.fast.travel", "2 lengths for 1 axes"]),
        (["move.fast.radius=1 mm"], [], ["move.fast.radius", "does not belong"]),
        (["move.fast.cycle=1.05 ms"], [], ["cycle", "multiple"]),
        (['move.fast.condition={Y="brake"}'], [], ["not under control"]),
        ([], ["--only", "fats"], ["--only fats", "[move.fats]", "fast, slow"]),
    ],
)
def test_bad_moves(machine_file, tmp_path, sets, options, words):
    refused(chatter("move", machine_file, *options, sets=sets), tmp_path, *words)


def test_no_such_file(tmp_path):
    for command in ("frf", "move"):
        refused(chatter(command, tmp_path / "none.toml"), tmp_path, "none.toml")
