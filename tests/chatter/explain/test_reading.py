"""Files of every format are read into the same signals; what is wrong is said by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.explain.measurement_file import read_measurement
from chatter.io.headings import named
from chatter.io.signals import read_signals

TIME = np.arange(20) * 1e-3
FORCE = 100.0 + 5.0 * np.arange(20)
MOVE = 1e-6 * np.arange(20)
CASE = """
[tool]
teeth = 2
diameter = "20 mm"
[material]
Ktc = "800 MPa"
[cut]
mode = "down"
spindle_speed = "9000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "5 mm"
[[structure.mode]]
frequency = "700 Hz"
damping = 0.03
mass = "0.6 kg"
direction = [1, 0, 0]
[axis]
moving_mass = "10 kg"
"""


def dataset58(values, code, direction, title="NONE", unit="NONE", kind=1, is_complex=False):
    """Text dataset 58: a function over an even abscissa."""

    def axis(code, unit):
        return f"{code:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {unit:<20}\n"

    abscissa = 18 if is_complex else 17
    step = 10.0 if is_complex else TIME[1]
    numbers = np.column_stack([values.real, values.imag]).ravel() if is_complex else values
    text = f"    -1\n    58\n{title}\n" + "NONE\n" * 4
    text += f"{kind:5d}{1:10d}{1:5d}{0:10d} {'NONE':<10}{1:10d}{direction:4d} "
    text += f"{'NONE':<10}{1:10d}{abs(direction) if is_complex else 0:4d}\n"
    text += (
        f"{6 if is_complex else 4:10d}{values.size:10d}{1:10d}{0.0:13.5e}{step:13.5e}{0.0:13.5e}\n"
    )
    text += axis(abscissa, "NONE") + axis(code, unit)
    text += axis(13 if is_complex else 0, "NONE") + axis(0, "NONE")
    return text + "".join(f"{v:20.11e}\n" for v in numbers) + "    -1\n"


HEADERS = "    -1\n   151\nmodel\nNONE\n    -1\n    -1\n   164\n         1  SI                  2\n"
HEADERS += "  1.00000000000000000D+00  1.00000000000000000D+00  1.00000000000000000D+00\n"
HEADERS += "  2.73150000000000000D+02\n    -1\n"


def test_universal_time_records_of_a_milling_run(tmp_path):
    path = tmp_path / "run.unv"
    path.write_text(
        HEADERS
        + dataset58(FORCE, 13, 1, unit="N")
        + dataset58(FORCE, 13, -2, unit="kN")
        + dataset58(MOVE * 1e6, 8, 1, unit="um")
        + dataset58(FORCE, 0, 0, title="spindle_angle [deg]")
    )
    signals = read_signals(path, "milling")
    np.testing.assert_allclose(signals["time"], TIME, rtol=1e-5)
    np.testing.assert_allclose(signals["Fx"], FORCE)
    np.testing.assert_allclose(signals["Fy"], -1e3 * FORCE)
    np.testing.assert_allclose(signals["x"], MOVE, atol=1e-15)
    np.testing.assert_allclose(signals["spindle_angle"], np.radians(FORCE))


def test_universal_time_records_of_an_axis(tmp_path):
    path = tmp_path / "move.uff"
    path.write_text(dataset58(MOVE, 8, 1) + dataset58(FORCE, 13, 1))
    signals = read_signals(path, "axis")
    assert set(signals) == {"time", "position", "force"}


def test_a_universal_file_without_time_records_is_told(tmp_path):
    path = tmp_path / "run.uff"
    path.write_text(HEADERS)
    with pytest.raises(InputError, match="holds no time record; it holds 1 x dataset 151"):
        read_signals(path, "milling")


def test_the_frf_of_the_direction_is_taken_of_a_universal_file(tmp_path):
    path = tmp_path / "taps.unv"
    values = (1.0 + np.arange(20) + 2.0j) * 1e-8
    frfs = [dataset58(k * values, 8, k, kind=4, is_complex=True) for k in (1, 2)]
    path.write_text(HEADERS + "".join(frfs))
    signals = read_signals(path, "frf", "y")
    np.testing.assert_allclose(signals["real"] + 1j * signals["imag"], 2.0 * values)
    with pytest.raises(InputError, match=r'0 FRFs of direction "z".*xx, yy'):
        read_signals(path, "frf", "z")


def test_npz_with_units_and_complex_frfs(tmp_path):
    np.savez(tmp_path / "run.npz", **{"time [ms]": TIME * 1e3, "Fx": FORCE, "x [um]": MOVE * 1e6})
    signals = read_signals(tmp_path / "run.npz", "milling")
    np.testing.assert_allclose(signals["time"], TIME)
    np.testing.assert_allclose(signals["x"], MOVE)
    values = 1.0 + 2.0j * np.arange(20)
    np.savez(tmp_path / "tap.npz", **{"frequency [Hz]": 10.0 * TIME, "receptance [um/N]": values})
    signals = read_signals(tmp_path / "tap.npz", "frf", "x")
    np.testing.assert_allclose(signals["real"] + 1j * signals["imag"], 1e-6 * values)


def test_npz_that_is_none(tmp_path):
    (tmp_path / "run.npz").write_bytes(b"nothing")
    with pytest.raises(InputError, match=r"run\.npz"):
        read_signals(tmp_path / "run.npz")
    np.savez(tmp_path / "objects.npz", time=np.array([{}, None], dtype=object))
    with pytest.raises(InputError, match=r"objects\.npz"):
        read_signals(tmp_path / "objects.npz")


def test_tdms_with_units_and_waveform_clock(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    clock = {"wf_increment": 1e-3, "wf_start_offset": 0.0, "wf_samples": 20}
    with nptdms.TdmsWriter(tmp_path / "run.tdms") as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("run", "Fx", FORCE, {"unit_string": "kN", **clock}),
                nptdms.ChannelObject("run", "x", MOVE * 1e6, {"unit_string": "um"}),
            ]
        )
    signals = read_signals(tmp_path / "run.tdms", "milling")
    np.testing.assert_allclose(signals["time"], TIME)
    np.testing.assert_allclose(signals["Fx"], 1e3 * FORCE)
    np.testing.assert_allclose(signals["x"], MOVE)


def test_frfs_as_magnitude_and_phase_and_as_accelerance(tmp_path):
    path = tmp_path / "tap.csv"
    path.write_text("frequency [Hz],magnitude [um/N],phase [deg]\n10,2,90\n20,2,180\n30,1,0\n")
    signals = read_signals(path, "frf", "x")
    np.testing.assert_allclose(signals["real"], [0.0, -2e-6, 1e-6], atol=1e-18)
    np.testing.assert_allclose(signals["imag"], [2e-6, 0.0, 0.0], atol=1e-18)
    path.write_text("frequency [Hz],real [m/s^2/N],imag [m/s^2/N]\n10,1,0\n20,1,0\n30,1,0\n")
    signals = read_signals(path, "frf", "x")
    omega = 2.0 * np.pi * np.array([10.0, 20.0, 30.0])
    np.testing.assert_allclose(signals["real"], -1.0 / omega**2)


@pytest.mark.parametrize(
    ("heading", "name", "factor"),
    [
        ("Fx [N]", "Fx", 1.0),
        ("Fx (kN)", "Fx", 1e3),
        ("Fx_N", "Fx", 1.0),
        ("fx/N", "Fx", 1.0),
        ("x_um", "x", 1e-6),
        ("Time", "time", 1.0),
        ("Spindle angle [deg]", "spindle_angle", np.pi / 180.0),
        ("spindle_angle", "spindle_angle", 1.0),
        ("spindle_speed [rpm]", "spindle_speed", np.pi / 30.0),
        ("spindle speed [1/s]", "spindle_speed", 2.0 * np.pi),
        ("temperature [degC]", "temperature", None),
        ("remark [furlong per week]", "remark", None),
    ],
)
def test_headings(heading, name, factor):
    found, by = named(Path("a.csv"), heading)
    assert found == name
    if factor is not None:
        assert by == pytest.approx(factor)


@pytest.mark.parametrize("heading", ["Fx [um]", "x [V]", "time [N]", "real [N/m]", "[N]"])
def test_headings_that_are_refused(heading):
    with pytest.raises(InputError, match=r"a\.csv"):
        named(Path("a.csv"), heading)


def test_verdicts_in_words(tmp_path):
    path = tmp_path / "points.csv"
    words = ["1", "0", "true", "False", "stable", "Chatter", "marginal", "unstable", ""]
    rows = "\n".join(f"9000,1,{word}" for word in words)
    path.write_text(f"spindle_speed [rpm],axial_depth [mm],stable\n{rows}\n")
    found = read_signals(path, "stability")["stable"]
    np.testing.assert_array_equal(found, [1, 0, 1, 0, 1, 0, np.nan, 0, np.nan])
    path.write_text("spindle_speed [rpm],axial_depth [mm],stable\n9000,1,perhaps\n")
    with pytest.raises(InputError, match='line 2: stable: "perhaps" is no verdict'):
        read_signals(path, "stability")


def test_two_columns_of_one_name_are_refused(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [s],Fx [N],fx (N)\n0,1,1\n1,2,3\n")
    with pytest.raises(InputError, match='columns 2 and 3 are both "Fx"'):
        read_signals(path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('colour = "red"', "colour is not a key; there are"),
        ('[[run]]\nfile = "a.csv"\n[tolerance]\nKtc = "few"', 'tolerance.Ktc: "few"'),
        ('[[run]]\nfile = "a.csv"\n[tolerance]\ntool.helx = 0.2', r"tolerance.tool.helx: .*helix"),
        ('[[run]]\nfile = "a.csv"\n[tolerance]\n"tool.runout" = 0.2', "no number there"),
        ('[[run]]\nfile = "a.csv"\nspeed = 3', r"run 1 \(a.csv\): speed is not a key"),
        ('[[run]]\nfile = "a.csv"\nspindle_speed = "3 mm"', r"run 1 \(a.csv\): .*spindle_speed"),
        ('[[run]]\nfile = "a.csv"\n[[run]]\nfile = "a.csv"', "a.csv is the file of 2 runs"),
        ("[[run]]\nfile = 7", "run 1: file: 7"),
        ("run = 3", "run: runs are tables"),
    ],
)
def test_what_is_wrong_in_the_description_is_named(tmp_path, text, words):
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "a.csv").write_text("time [s],Fx [N]\n0,1\n1,2\n")
    (tmp_path / "measurement.toml").write_text(f'kind = "milling"\ncase = "case.toml"\n{text}\n')
    with pytest.raises(InputError, match=words):
        read_measurement(tmp_path)


def test_missing_columns_are_named_with_those_there_are(tmp_path):
    from chatter.explain.checking import checked

    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "a.csv").write_text("time [s],torque [N*m]\n0,1\n1,2\n")
    (tmp_path / "measurement.toml").write_text(
        'kind = "milling"\ncase = "case.toml"\n[[run]]\nfile = "a.csv"\n'
    )
    with pytest.raises(InputError, match=r"a\.csv: column Fx or Fy.*there are time, torque"):
        checked(read_measurement(tmp_path))


def written_tests(folder: Path, heading: str, more: str = "") -> Path:
    """Folder of cutting tests with a column more."""
    (folder / "case.toml").write_text(CASE)
    rows = f"spindle_speed [rpm],axial_depth [mm],stable,{heading}\n9000,1.0,1,1.5\n9500,2.0,0,\n"
    (folder / "points.csv").write_text(rows)
    head = 'kind = "stability"\ncase = "case.toml"\npoints = "points.csv"\n'
    (folder / "measurement.toml").write_text(head + more)
    return folder


@pytest.mark.parametrize(
    ("heading", "name", "value"),
    [
        ("spindle_power [kW]", "spindle_power", 1500.0),
        ("power [W]", "spindle_power", 1.5),
        ("cut_time [min]", "cut_time", 90.0),
        ("feed_per_tooth [mm]", "feed_per_tooth", 1.5e-3),
        ("chatter_frequency [kHz]", "chatter_frequency", 1500.0),
    ],
)
def test_columns_of_cutting_tests_come_in_si(tmp_path, heading, name, value):
    measurement = read_measurement(written_tests(tmp_path, heading, 'idle_power = "0.18 kW"\n'))
    column = measurement.runs[0].signals[name]
    assert column[0] == pytest.approx(value)
    assert np.isnan(column[1])
    assert measurement.idle_power == pytest.approx(180.0)


@pytest.mark.parametrize("given", ['"-20 W"', '"20 N"'])
def test_an_idle_power_that_is_none_is_refused(tmp_path, given):
    with pytest.raises(InputError, match="idle_power"):
        read_measurement(written_tests(tmp_path, "power [W]", f"idle_power = {given}\n"))


@pytest.mark.parametrize(
    ("run", "said"),
    [
        ('feed_per_tooth = "0.1 mm"', "run 1: file is missing; a run names its signals"),
        ("file = 3", "run 1: file: 3 is not a file name"),
        ('file = "a.csv"\nname = "first"', "name: a run has the name of its file"),
    ],
)
def test_wrong_runs_are_told(tmp_path, run, said):
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "measurement.toml").write_text(
        f'kind = "milling"\ncase = "case.toml"\n[[run]]\n{run}\n'
    )
    with pytest.raises(InputError, match=said):
        read_measurement(tmp_path)


@pytest.mark.parametrize("rows", ["", "0,1\n"])
def test_a_record_without_two_samples_is_told(tmp_path, rows):
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "a.csv").write_text("time [s],Fx [N]\n" + rows)
    (tmp_path / "measurement.toml").write_text(
        'kind = "milling"\ncase = "case.toml"\n[[run]]\nfile = "a.csv"\n'
    )
    with pytest.raises(InputError, match=r"a\.csv.*(2 are needed|no line of numbers)"):
        read_measurement(tmp_path)


def test_runs_of_a_measurement_are_sheets_of_one_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for name, scale in {"slow": 1.0, "fast": 2.0}.items():
        sheet = book.active if name == "slow" else book.create_sheet()
        sheet.title = name
        sheet.append(["time [s]", "Fx [kN]"])
        for k in range(64):
            sheet.append([1e-3 * k, scale * k])
    book.save(tmp_path / "cuts.xlsx")
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "measurement.toml").write_text(
        'kind = "milling"\ncase = "case.toml"\n[[run]]\nfile = "cuts.xlsx#slow"\n'
        '[[run]]\nfile = "cuts.xlsx#2"\nspindle_speed = "4000 rpm"\n'
    )
    measured = read_measurement(tmp_path)
    assert [run.name for run in measured.runs] == ["cuts.xlsx#slow", "cuts.xlsx#2"]
    for run, scale in zip(measured.runs, (1.0, 2.0), strict=True):
        np.testing.assert_allclose(run.signals["Fx"], 1e3 * scale * np.arange(64))
    only = read_measurement(f"{tmp_path / 'cuts.xlsx'}#slow")
    assert [run.name for run in only.runs] == ["cuts.xlsx#slow"]


def test_keys_without_number_are_told_in_a_few_lines(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    tables = "".join(f"[t{k}]\n" for k in range(5000))
    text = f'kind = "milling"\ncase = "case.toml"\n{tables}'
    (tmp_path / "measurement.toml").write_text(text)
    with pytest.raises(InputError) as told:
        read_measurement(tmp_path)
    assert len(told.value.messages) == 21
    assert told.value.messages[0].startswith(f"{tmp_path / 'measurement.toml'}: t0 is not a key")
    assert told.value.messages[-1].endswith("measurement.toml: and 4980 more of this kind")
