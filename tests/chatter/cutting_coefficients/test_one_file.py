"""One file of forces: its case given, parts of a varied cut, air before and after it."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.errors import InputError
from tests.chatter.cutting_coefficients.test_coefficients import CASE, SPEED, TRUE, waveform
from tests.command_line import chatter_command

UP = (0.0, math.acos(0.5))  # half the radius wide
RATE = 10_000


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    text = CASE.format(mode="up", width='radial_depth = "3 mm"')
    path.write_text(text, encoding="utf-8")
    return path


def forces_of(feeds):
    """Forces (n, 3) at the feed of each sample, mm: linear in it between two feeds."""
    turn = np.arange(round(RATE / SPEED)) / RATE
    low, high = (np.resize(waveform(turn, feed, UP), (len(feeds), 3)) for feed in (0.0, 1e-4))
    return low + (high - low) * (np.asarray(feeds) / 0.1)[:, None]


def write(path, forces, **columns):
    time = np.arange(len(forces)) / RATE
    heading = "time [s],Fx [N],Fy [N],Fz [N]" + "".join(f",{name}" for name in columns)
    table = np.column_stack([time, forces, *columns.values()])
    np.savetxt(path, table, delimiter=",", comments="", header=heading)
    return path


def values_of(found):
    factors = {"MPa": 1e6, "N/mm": 1e3}
    summary = found.summary()
    return {one["name"]: one["value"] * factors[one["unit"]] for one in summary["coefficients"]}


def assert_true(found, share=0.04):
    for key, value in values_of(found).items():
        assert value == pytest.approx(TRUE[key], rel=share), key


@pytest.mark.parametrize(
    "column", [pytest.param("feed_per_tooth [mm]", marks=pytest.mark.nightly), "feed_rate [mm/min]"]
)
def test_steps_of_the_feed_in_one_file_are_a_series(tmp_path, case, column):
    feeds = np.repeat([0.03, 0.06, 0.09, 0.12], RATE // 2)
    told = feeds if "tooth" in column else feeds * 3 * 60.0 * SPEED
    file = write(tmp_path / "steps.csv", forces_of(feeds), **{column: told})
    found = chatter.coefficients(file, case)
    assert len(found.measurement.runs) == 4
    assert found.kept.law.name == "linear"
    assert_true(found)
    name = found.measurement.runs[1].name
    assert name.startswith("steps.csv, feed_")
    assert {one.run for one in chatter.coefficients(file, case, hold_out=[name]).means} == {
        run.name for run in found.measurement.runs if run.name != name
    }


@pytest.mark.nightly
def test_a_ramp_of_the_feed_is_divided(tmp_path, case):
    feeds = np.linspace(0.02, 0.14, 2 * RATE)
    file = write(tmp_path / "ramp.csv", forces_of(feeds), **{"feed_per_tooth [mm]": feeds})
    found = chatter.coefficients(file, case)
    assert len(found.measurement.runs) == 8
    assert_true(found)


def test_parts_of_one_file_that_measurement_toml_tells(tmp_path, case):
    write(tmp_path / "cut.csv", forces_of(np.repeat([0.03, 0.08, 0.12], RATE // 2)))
    runs = [
        f'[[run]]\nfile = "cut.csv"\n{window}\nfeed_per_tooth = "{feed} mm"\n'
        for window, feed in (
            ('to = "0.499 s"', 0.03),
            ('from = "500 ms"\nto = "0.999 s"', 0.08),
            ('from = "1 s"', 0.12),
        )
    ]
    text = 'kind = "milling"\ncase = "case.toml"\n' + "".join(runs)
    (tmp_path / "measurement.toml").write_text(text, encoding="utf-8")
    found = chatter.coefficients(tmp_path)
    assert [run.name for run in found.measurement.runs] == [
        "cut.csv, 0 s to 0.499 s", "cut.csv, 0.5 s to 0.999 s", "cut.csv, 1 s to 1.4999 s",
    ]  # fmt: skip
    assert_true(found)
    for change, told in (("500 ms", "2 s"), "holds 0 samples"), (("500 ms", "2 mm"), "from, to"):
        (tmp_path / "measurement.toml").write_text(text.replace(*change), encoding="utf-8")
        with pytest.raises(InputError, match=told):
            chatter.coefficients(tmp_path)


def test_air_around_the_cut_shows_offset_and_drift(tmp_path, case):
    runs = []
    for feed in (0.03, 0.06, 0.09, 0.12):
        forces = forces_of(np.full(int(2.0 * RATE), feed))
        time = np.arange(len(forces)) / RATE
        forces[(time < 0.5) | (time > 1.6)] = 0.0
        # 30 N that drift by 20 N: more than the edge forces
        forces += np.outer(1.0 + 0.33 * time, [30.0, -20.0, 15.0])
        forces += np.random.default_rng(3).standard_normal(forces.shape)
        write(tmp_path / f"f{feed}.csv", forces)
        runs.append(f'[[run]]\nfile = "f{feed}.csv"\nfeed_per_tooth = "{feed} mm"\n')
    text = 'kind = "milling"\ncase = "case.toml"\n' + "".join(runs)
    (tmp_path / "measurement.toml").write_text(text, encoding="utf-8")
    found = chatter.coefficients(tmp_path)
    assert found.zeroed
    assert found.kept.law.name == "linear"
    assert_true(found)
    assert any("taken off" in note for note in found.notes)


def test_a_file_without_headings_and_its_case(tmp_path, case):
    file = write(tmp_path / "cut.csv", forces_of(np.full(RATE // 2, 0.08)))
    bare = tmp_path / "bare.txt"
    bare.write_text("\n".join(file.read_text().splitlines()[1:]), encoding="utf-8")
    shown = chatter_command(
        "coefficients", bare, "--case", case, "--columns", "time [s], Fx [N], Fy [N], Fz [N]",
        "--mean-forces", "--out", tmp_path / "out",
    )  # fmt: skip
    assert shown.exit_code == 0, shown.stderr
    assert (tmp_path / "out" / "material.toml").is_file()
    # one feed: what is not told is said
    assert "do not tell the edge forces" in " ".join(shown.stderr.split())


@pytest.mark.parametrize(
    ("records", "told"),
    [
        ("cut.csv", "nothing tells which tool and cut it is of; give them by --case FILE"),
        (".", r"there is no measurement\.toml, which tells of case\.toml, cut\.csv: kind"),
    ],
)
def test_what_is_missing_is_asked_for(tmp_path, case, records, told):
    write(tmp_path / "cut.csv", forces_of(np.full(2000, 0.08)))
    with pytest.raises(InputError, match=told):
        chatter.coefficients(tmp_path / records)


def test_a_law_that_does_not_cut_is_not_kept(tmp_path, case):
    file = write(tmp_path / "cut.csv", -forces_of(np.full(RATE // 2, 0.08)))
    found = chatter.coefficients(file, case)
    assert not found.has_material
    assert {path.name for path in found.save(tmp_path / "out")} == {
        "coefficients.json", "coefficients.png",
    }  # fmt: skip
    with pytest.raises(InputError, match="no row is kept"):
        found.keep_in(tmp_path / "ours.toml", "steel")


def test_forces_along_x_and_y_alone_tell_what_they_can(tmp_path, case):
    feeds = np.repeat([0.03, 0.06, 0.09, 0.12], RATE // 2)
    file = write(tmp_path / "steps.csv", forces_of(feeds), **{"feed_per_tooth [mm]": feeds})
    table = np.loadtxt(file, delimiter=",", skiprows=1)[:, [0, 1, 2, 4]]
    heading = "time [s],Fx [N],Fy [N],feed_per_tooth [mm]"
    np.savetxt(file, table, delimiter=",", comments="", header=heading)
    found = chatter.coefficients(file, case)
    assert set(values_of(found)) == {"Ktc", "Krc", "Kte", "Kre"}
    assert_true(found)
    with pytest.raises(InputError, match="forces along x, y and z"):
        found.with_rake(0.1)
    whole = found.with_waveforms().summary()
    assert {one["name"] for one in whole["coefficients"]} == {"Ktc", "Krc", "Kte", "Kre"}
    (tmp_path / "whole.toml").write_text(case.read_text() + found.material_toml())
    assert chatter.load(tmp_path / "whole.toml").get("material.Ktc") > 0.0


@pytest.mark.parametrize(
    ("value", "told"), [(np.nan, "Fy: 20 samples are blank"), (1.0, "no force varies")]
)
def test_records_that_hold_no_cut_are_refused(tmp_path, case, value, told):
    forces = forces_of(np.full(2000, 0.08))
    if np.isnan(value):
        forces[100:120, 1] = value
    else:
        forces[:] = value
    with pytest.raises(InputError, match=told):
        chatter.coefficients(write(tmp_path / "cut.csv", forces), case)


@pytest.mark.parametrize("samples", [3, 20, 300])
def test_a_record_of_less_than_four_revolutions_is_refused_in_words(tmp_path, case, samples):
    forces = forces_of(np.full(2000, 0.08))[:samples]
    with pytest.raises(InputError, match=r"whole revolutions at .* rpm; at least 4 are required"):
        chatter.coefficients(write(tmp_path / "cut.csv", forces), case)


@pytest.mark.parametrize(
    ("times", "words"),
    [
        (lambda time: 0.0 * time, "0 s in row 1 is followed by 0 s; times must rise"),
        (lambda time: time[::-1], "times must rise"),
        (lambda time: 1e6 * time, "s apart, and a revolution takes .* another unit"),
        (lambda time: np.where(time > 0.1, np.nan, time), "is followed by nan s; times must rise"),
    ],
)
def test_a_clock_that_does_not_rise_is_refused(tmp_path, case, times, words):
    forces = forces_of(np.repeat([0.03, 0.06], RATE // 2))
    file = write(tmp_path / "cut.csv", forces)
    rows = np.loadtxt(file, delimiter=",", skiprows=1)
    rows[:, 0] = times(rows[:, 0])
    heading = file.read_text().splitlines()[0]
    np.savetxt(file, rows, delimiter=",", comments="", header=heading)
    with pytest.raises(InputError, match=f"cut.csv: time: .*{words}"):
        chatter.coefficients(file, case)


def test_a_record_of_one_sample_is_refused(tmp_path, case):
    file = write(tmp_path / "cut.csv", forces_of([0.03])[:1])
    with pytest.raises(InputError, match=r"cut\.csv: 1 sample is no record of a cut"):
        chatter.coefficients(file, case)


@pytest.mark.parametrize(("unit", "is_told"), [("N", False), ("kN", True)])
def test_forces_in_another_unit_than_the_heading_says_are_told(tmp_path, case, unit, is_told):
    feeds = np.repeat([0.04, 0.1], RATE // 2)
    file = write(tmp_path / "a.csv", forces_of(feeds), **{"feed_per_tooth [mm]": feeds})
    file.write_text(file.read_text().replace("[N]", f"[{unit}]"))
    notes = chatter.coefficients(file, case).notes
    assert any("check the unit of the forces in the heading" in one for one in notes) == is_told
