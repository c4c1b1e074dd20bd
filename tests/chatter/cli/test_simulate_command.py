"""`chatter simulate`: its files, its options, and how it refuses what it cannot simulate."""

import csv
import json
import math

import numpy as np
import pytest

from tests.cases import TOOL_OF_922_HERTZ
from tests.command_line import chatter_command

CASE = f"""{TOOL_OF_922_HERTZ}
[simulation]
revolutions = 40
"""

HEADER = "time [s],spindle_angle [rad],Fx [N],Fy [N],Fz [N],x [um],y [um],z [um]"
BOX = '[{x=["-5 mm","20 mm"],y=["-10 mm","10 mm"],z=["0 mm","5 mm"]}]'


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


def simulate(case_file, *assignments, options=()):
    sets = [part for text in assignments for part in ("--set", text)]
    out = case_file.parent / "out"
    words = ["simulate", case_file, "--out", out, *sets, *options]
    return chatter_command(*words)


def refused(result, folder, *words, code=2):
    """One line on stderr that holds the words; no file is left."""
    assert result.exit_code == code, result.output
    assert "fault in chatter" not in result.output
    assert "Traceback" not in result.output
    assert len(result.stderr.strip().splitlines()) == 1, result.stderr
    for word in ("case.toml", *words):
        assert word in result.stderr
    assert result.stdout == ""
    assert not (folder / "out").exists()


def strict(text):
    def no_constant(name):
        raise AssertionError(f"{name} in the output")

    return json.loads(text, parse_constant=no_constant)


def table_of(path):
    with path.open() as file:
        assert file.readline() == HEADER + "\n"
        return np.array([[float(cell) for cell in row] for row in csv.reader(file)])


def test_files_of_a_run(case_file, tmp_path):
    result = simulate(case_file)
    assert result.exit_code == 0, result.output
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "signals.csv",
        "simulate.png",
        "summary.json",
    }
    assert (tmp_path / "out/simulate.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    table = table_of(tmp_path / "out/signals.csv")
    assert np.isfinite(table).all()
    assert table[0, 0] == 0.0
    assert table[-1, 0] == pytest.approx(40 * 60.0 / 10000.0)
    assert table[-1, 1] == pytest.approx(40 * 2.0 * math.pi)
    assert np.ptp(np.diff(table[:, 0])) < 1e-8


def test_numbers_of_a_run(case_file, tmp_path):
    assert simulate(case_file).exit_code == 0
    summary = strict((tmp_path / "out/summary.json").read_text())
    table = table_of(tmp_path / "out/signals.csv")
    # validation 2.3: stable below 2.104690 mm
    assert summary["verdict"] == "stable"
    assert summary["chatter_frequency_Hz"] is None
    settled = table[table[:, 1] >= 20 * 2.0 * math.pi - 1e-6]
    for column, name in enumerate(("Fx", "Fy", "Fz"), start=2):
        # the largest force may lie between two rows
        largest = np.abs(settled[:, column]).max()
        assert (1.0 - 1e-5) * largest <= summary["peak_force_N"][name] <= 1.005 * largest
    # a periodic motion of the tool leaves the mean of Ktc h (a tooth after the other) as it is:
    # N b f / (2 pi) times the integrals of K over the immersion from 90 to 180 degrees
    width, feed, tangential, radial = 1e-3, 1e-4, 600e6, 200e6
    share = 2 * width * feed / (2.0 * math.pi)
    mean_x = share * (0.5 * tangential - 0.25 * math.pi * radial)
    mean_y = share * (0.25 * math.pi * tangential + 0.5 * radial)
    assert summary["mean_force_N"]["Fx"] == pytest.approx(mean_x, rel=0.02)
    assert summary["mean_force_N"]["Fy"] == pytest.approx(mean_y, rel=0.02)
    assert summary["mean_force_N"]["Fz"] == 0.0
    # power: specific force times the rate at which material goes, K b a_e v_f
    feed_rate = 2 * feed * 10000.0 / 60.0
    power = summary["power"]
    assert power["mean_W"] == pytest.approx(tangential * width * 8e-3 * feed_rate, rel=0.02)
    speed = 10000.0 * math.pi / 30.0
    assert power["mean_torque_Nm"] * speed == pytest.approx(power["mean_W"], rel=1e-9)
    assert math.isfinite(summary["surface_location_error_um"])
    assert {"wall", "floor"} <= set(summary["roughness"])
    assert summary["revolutions"] == pytest.approx(40.0)


def test_chatter_is_told_with_its_frequency(case_file, tmp_path):
    # validation 2.3: limit of 3.774048 mm at 20000 rpm, a flip
    result = simulate(
        case_file,
        "cut.mode=up",
        "cut.radial_depth=0.8 mm",
        "cut.spindle_speed=20000 rpm",
        "cut.axial_depth=4.2 mm",
        "simulation.revolutions=100",
    )
    assert result.exit_code == 0, result.output
    assert "chatter at 1000.0 Hz" in result.stdout
    summary = strict((tmp_path / "out/summary.json").read_text())
    assert (summary["verdict"], summary["bifurcation"]) == ("chatter", "flip")
    # an odd multiple of half the tooth-passing frequency, the one near the mode
    assert summary["chatter_frequency_Hz"] == pytest.approx(1.5 * 2 * 20000 / 60, rel=1e-3)


@pytest.mark.parametrize("chip", ["delay", "dexel", "voxel"])
def test_json_on_stdout_is_the_file(case_file, tmp_path, chip):
    result = simulate(case_file, "simulation.revolutions=9", options=["--json", "--chip", chip])
    assert result.exit_code == 0, result.output
    summary = strict(result.stdout)
    assert summary == strict((tmp_path / "out/summary.json").read_text())
    assert summary["resolution"]["chip"] == chip
    assert summary["revolutions"] == pytest.approx(9.0)
    assert summary["verdict"] == "stable"
    # mean of the linear law over the immersion, N b f / (2 pi) (pi / 4 Ktc + 1 / 2 Krc)
    mean = 1e-7 / math.pi * (0.25 * math.pi * 600e6 + 0.5 * 200e6)
    assert summary["mean_force_N"]["Fy"] == pytest.approx(mean, rel=0.02)


def test_chip_of_the_option_wins_over_the_case(case_file):
    options = ["--json", "--chip", "delay"]
    result = simulate(
        case_file, "simulation.chip=dexel", "simulation.revolutions=2", options=options
    )
    assert strict(result.stdout)["resolution"]["chip"] == "delay"


@pytest.mark.parametrize(
    "assignments",
    [["simulation.revolutions=0.01"], ["simulation.revolutions=null", "simulation.duration=1 us"]],
)
def test_a_run_too_short_to_judge(case_file, assignments):
    result = simulate(case_file, *assignments, options=["--json"])
    assert result.exit_code == 0, result.output
    summary = strict(result.stdout)
    assert summary["verdict"] == "not judged"
    assert summary["chatter_frequency_Hz"] is None


def test_a_rigid_tool_does_not_chatter(case_file):
    case_file.write_text(CASE[: CASE.index("[[structure")] + "[simulation]\nrevolutions = 3\n")
    result = simulate(case_file, options=["--json"])
    assert result.exit_code == 0, result.output
    summary = strict(result.stdout)
    assert summary["verdict"] == "not judged"
    assert summary["peak_displacement_um"] == 0.0


@pytest.mark.parametrize(
    ("assignments", "words"),
    [
        (["simulation.chip=hexel"], ["simulation.chip", "hexel", '"voxel"']),
        (["simulation.revolutions=-3"], ["simulation.revolutions", "-3"]),
        (["simulation.revolutions=0"], ["simulation.revolutions", "0"]),
        (["simulation.revolutions=nan"], ["simulation.revolutions", "finite"]),
        (["simulation.revolutions=1e9"], ["simulation", "steps"]),
        (["simulation.duration=1 mm"], ["simulation.duration", "1 mm"]),
        (["simulation.steps=7"], ["simulation.steps", "7"]),
        (["simulation.slices=0"], ["simulation.slices", "0"]),
        ([f"stock.box={BOX}"], ["stock", '"dexel"']),
        (['simulation.path=[["0 mm","0 mm"],["5 mm","0 mm"]]'], ["simulation.path", '"dexel"']),
        (
            ["tool.edge_radius=20 um", "process_damping.indentation_force=1e14 N/m^3"],
            ["tool.clearance_angle", "missing"],
        ),
        (
            ["tool.clearance_angle=6 deg", "process_damping.indentation_force=1e14 N/m^3"],
            ["tool.edge_radius", "flank_wear"],
        ),
        (
            ["tool.kind=ball", "cut.axial_depth=0.1 mm", "cut.radial_depth=0.5 mm"],
            ["cut.radial_depth", "0.1 mm", "stepover"],
        ),
        (
            ["tool.teeth=3", 'tool.helix=["0 deg", "0 deg", "80 deg"]', "cut.axial_depth=5 mm"],
            ["tool.helix"],
        ),
        (
            ["simulation.chip=voxel", "simulation.resolution=1 nm"],
            ["simulation.resolution", "0.001 um", "GB"],
        ),
        (["tool.runout.offset=-1 mm"], ["tool.runout.offset", "-1 mm"]),
        (['tool.pitch=["100 deg", "100 deg", "160 deg"]'], ["tool.pitch", "2 teeth"]),
        (['tool.radial_error=["5 um"]'], ["tool.radial_error", "2 teeth"]),
        (['tool.axial_error=["5 um"]'], ["tool.axial_error", "2 teeth"]),
        (
            ["cut.speed_variation.amplitude=0.9", "cut.speed_variation.frequency=5 Hz"],
            ["cut.speed_variation.amplitude", "0.9"],
        ),
        (["cut.feed_per_tooth=50 mm"], ["cut.feed_per_tooth", "50 mm"]),
        (["cut.spindle_speed=0.1 rpm"], ["cut.spindle_speed"]),
        (["tool.helix=89.9999 deg"], ["tool.helix"]),
        (["structure.mode[0].damping=1.2"], ["structure.mode[0].damping", "1.2"]),
    ],
)
def test_wrong_input(case_file, tmp_path, assignments, words):
    refused(simulate(case_file, *assignments), tmp_path, *words)


def test_duration_and_revolutions_in_one_file(case_file, tmp_path):
    case_file.write_text(CASE + 'duration = "1 s"\n')
    refused(simulate(case_file), tmp_path, "simulation", "duration", "revolutions")


def test_two_flutes_that_cross(case_file, tmp_path):
    # tan(60 deg) - tan(30 deg) over the radius of 8 mm makes half a turn at 21.8 mm
    result = simulate(case_file, 'tool.helix=["30 deg", "60 deg"]', "cut.axial_depth=30 mm")
    refused(result, tmp_path, "tool.helix", "flutes")


def test_wrong_chip_of_the_option(case_file, tmp_path):
    refused(simulate(case_file, options=["--chip", "hexel"]), tmp_path, "hexel", '"dexel"')


@pytest.mark.parametrize("depth", ["20 mm", "200 mm"])
def test_a_run_that_leaves_the_range_writes_what_there_is(case_file, tmp_path, depth):
    # validation 2.3: stable below 2.104690 mm
    result = simulate(case_file, f"cut.axial_depth={depth}")
    assert result.exit_code == 1
    assert "displaced by more than 1.6 mm" in result.stderr
    assert "chatter at" in result.stdout
    assert "has a spectral radius of" in result.stdout
    summary = strict((tmp_path / "out/summary.json").read_text())
    assert summary["verdict"] == "chatter"
    table = table_of(tmp_path / "out/signals.csv")
    assert np.isfinite(table).all()
    # the last row is the first beyond the range, in um
    assert np.linalg.norm(table[:-1, 5:8], axis=1).max() < 1.7e3
    assert (tmp_path / "out/simulate.png").exists()


def test_a_soft_structure_that_leaves_the_range_is_no_chatter(case_file, tmp_path):
    # edges that rub with 100 N each move a tool of 20 N/mm by more than 1.6 mm
    result = simulate(
        case_file,
        "structure.mode[0].mass=none",
        "structure.mode[0].stiffness=20 N/mm",
        "structure.mode[0].damping=0.9",
        "structure.mode[0].frequency=20 Hz",
        "cut.axial_depth=0.5 mm",
        "cut.spindle_speed=300 rpm",
        "material.Kte=200 N/mm",
        "material.Kre=200 N/mm",
    )
    assert result.exit_code == 1
    summary = strict((tmp_path / "out/summary.json").read_text())
    assert summary["verdict"] == "not judged"
    assert "the linear analysis finds the cut stable" in summary["reason"]


@pytest.mark.parametrize(
    "assignments",
    [
        ["tool.teeth=40", "cut.feed_per_tooth=0.01 mm"],
        ["tool.helix=89 deg"],
        ["cut.spindle_speed=200000 rpm", "structure.mode[0].damping=0.9"],
        ["tool.runout.offset=0.1 mm", 'tool.radial_error=["5 um", "0 um"]'],
        ['tool.pitch=["100 deg", "260 deg"]'],
        ["cut.speed_variation.amplitude=0.2", "cut.speed_variation.frequency=5 Hz"],
        ["tool.kind=ball", "cut.radial_depth=7 mm"],
        ["cut.mode=slot", "cut.radial_depth=16 mm", "cut.axial_depth=0.05 mm"],
    ],
)
def test_unusual_but_right_input_gives_numbers(case_file, tmp_path, assignments):
    result = simulate(case_file, "simulation.revolutions=10", *assignments)
    assert result.exit_code == 0, result.output
    summary = strict((tmp_path / "out/summary.json").read_text())
    assert summary["peak_resultant_N"] > 0.0
    assert np.isfinite(table_of(tmp_path / "out/signals.csv")).all()


def test_signals_are_written_as_asked_for(case_file):
    assert simulate(case_file).exit_code == 0
    out = case_file.parent / "out"
    table = table_of(out / "signals.csv")
    (out / "signals.csv").unlink()
    assert simulate(case_file, options=("--signals", "none")).exit_code == 0
    assert {path.name for path in out.iterdir()} == {"summary.json", "simulate.png"}
    parquet = pytest.importorskip("pyarrow.parquet")
    assert simulate(case_file, options=("--signals", "parquet")).exit_code == 0
    written = parquet.read_table(out / "signals.parquet")
    assert ",".join(written.column_names) + "\n" == HEADER + "\n"
    columns = np.column_stack([column.to_numpy() for column in written.columns])
    np.testing.assert_allclose(columns, table, rtol=1e-5, atol=1e-9)


def test_an_unknown_file_of_signals_is_refused(case_file):
    result = simulate(case_file, options=("--signals", "xlsx"))
    assert result.exit_code == 2
    assert '"xlsx" is not known; there are csv, parquet, none' in result.stderr
    assert not (case_file.parent / "out").exists()


def test_the_picture_is_as_large_as_it_says(case_file):
    from PIL import Image

    assert simulate(case_file, options=("--signals", "none")).exit_code == 0
    with Image.open(case_file.parent / "out" / "simulate.png") as picture:
        # 11 by 12 inches at 120 dots
        assert picture.size == (1320, 1440)
        assert picture.mode == "RGB"
