"""Tables in text as people have them: exponents of Fortran, thousands, columns of one name."""

import re
from pathlib import Path

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.explain.measurement_file import read_measurement
from chatter.io.formats.csv import read_table, read_with_headings
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.number_marks import with_plain_numbers
from chatter.io.formats.uff58 import UFF58
from chatter.io.hammer_records import read_hammer_record
from chatter.io.signals import read_signals
from dynamics.frf.container import MeasurementError

RATE, COUNT = 25600.0, 60
TIME = np.arange(COUNT) / RATE
FORCE = np.where((TIME > 4e-4) & (TIME < 8e-4), 1234.5, 0.25)
MOTION = 1500.0 * np.exp(-200.0 * TIME) * np.sin(2.0 * np.pi * 900.0 * TIME)
HEADING = "time [s],force [N],acceleration [m/s^2]"
FRF_HEADING = "frequency [Hz],real [um/N],imag [um/N]"


def rows(separator=",", form="{:.9g}", end="", columns=(TIME, FORCE, MOTION)):
    lines = (separator.join(form.format(one) for one in row) for row in zip(*columns, strict=True))
    return "".join(f"{line}{end}\n" for line in lines)


def with_(separator):
    return HEADING.replace(",", separator) + "\n"


def written(folder, text, name="tap.txt"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def quoted(text):
    """Rows with quotes around cells, and commas between them."""
    return "".join(f'"{line}"\n' for line in text.replace(";", '","').splitlines())


GERMAN = str.maketrans(",.", ".,")
TAPS = {
    "Fortran": "# time [s] force [N] acceleration [m/s^2]\n"
    + rows("  ", "{:.9E}").replace("E+", "D+").replace("E-", "D-"),
    "small d": HEADING + "\n" + rows(",", "{:.9e}").replace("e+", "d+").replace("e-", "d-"),
    "thousands": with_(";") + rows(";", "{:,.9f}"),
    "thousands, tabs": with_("\t") + rows("\t", "{:,.9f}"),
    "thousands, blanks": "time [s] force [N] acceleration [m/s^2]\n" + rows("  ", "{:,.9f}"),
    "thousands, quotes": HEADING + "\n" + quoted(rows(";", "{:,.9f}")),
    "German thousands": with_(";") + rows(";", "{:,.9f}").translate(GERMAN),
    "Swiss thousands": with_(";") + rows(";", "{:,.9f}").replace(",", "'"),
    "French thousands": with_(";") + rows(";", "{:,.9f}").replace(",", "\u202f").replace(".", ","),
    "blanks in cells": with_(";") + rows(";", "{:,.9f}").replace(",", " "),
    "minus sign": with_(";") + rows(";").replace("-", "\u2212"),
    "two separators at the end": HEADING + "\n" + rows(end=",,"),
    "numbers above": f"Test 12\n{COUNT}\n25600\n{HEADING}\n{rows()}",
    "brackets below": "time;force;acceleration\n[s];[N];[m/s^2]\n" + rows(";").replace(".", ","),
    "slashes": "time/s;force/N;acceleration/(m/s^2)\n" + rows(";"),
    "words": "Time in s,Force in N,Acceleration in m/s^2\n" + rows(),
    "strokes": "time_s,force_N,acc_ms2\n" + rows(),
    "zeros at the end": HEADING + "\n" + rows() + "\0" * 9,
    "a copy": "time [s],force [N],force [N],acceleration [m/s^2]\n"
    + rows(columns=(TIME, FORCE, FORCE, MOTION)),
}


@pytest.mark.parametrize("text", TAPS.values(), ids=TAPS)
def test_a_tap_is_read(tmp_path, text):
    found = read_hammer_record(written(tmp_path, text))
    assert found.sampling_rate == pytest.approx(RATE)
    assert found.force == pytest.approx(FORCE, abs=1e-6)
    assert found.response == pytest.approx(MOTION, abs=1e-5)


def test_numbers_above_are_passed_over_where_columns_are_stated(tmp_path):
    table = read_with_headings(written(tmp_path, f"3\n{COUNT}\n{rows()}"), HEADING.split(","))
    assert table.numbers(1) == pytest.approx(FORCE)


@pytest.mark.parametrize(
    ("lines", "plain"),
    [
        (["1,234;5,678"], ["1,234;5,678"]),  # decimal commas, as nothing says otherwise
        (["1,234;0.5"], ["1234;0.5"]),
        (["0,5;1,234"], ["0,5;1,234"]),
        (["1,234,567\t2"], ["1234567\t2"]),
        (["100,200,300"], ["100,200,300"]),  # three columns
        (["100,200 300,400"], ["100,200 300,400"]),
        (["Firmware;1.234.567", "0.5;1.25"], ["Firmware;1.234.567", "0.5;1.25"]),
        (["3D view;2d5"], ["3D view;2E5"]),
    ],
)
def test_what_a_comma_is(lines, plain):
    assert list(with_plain_numbers(Path("a.csv"), lines)) == plain


def test_commas_of_both_kinds_are_refused():
    with pytest.raises(MeasurementError, match=r"1,234\.5 in line 1 .* 0,5 in line 2 has it"):
        with_plain_numbers(Path("a.csv"), ["1,234.5;2.0", "0,5;1.0"])


def test_several_forces_name_the_key_that_answers(tmp_path):
    columns = TIME, FORCE, 2.0 * FORCE, MOTION
    text = "time [s],force [N],force [N],acceleration [m/s^2]\n" + rows(columns=columns)
    path = written(tmp_path, text)
    with pytest.raises(MeasurementError, match="several columns are a force") as raised:
        read_hammer_record(path)
    stated = re.search(r'--columns "(.*)"', str(raised.value))[1]
    assert read_hammer_record(path, columns=stated).force == pytest.approx(FORCE)


@pytest.mark.parametrize(
    ("text", "force"),
    [
        ("time [s],Fx [N],Fx [N]\n0,1,1\n1,2,2\n", [1.0, 2.0]),
        ("time [s],Fx [N],Fx [lbf]\n0,4.4482,1\n1,8.8964,2\n", [4.4482, 8.8964]),
        ("time [s],Fx [V],Fx [N]\n0,0.1,1\n1,0.2,2\n", [1.0, 2.0]),
        ("time in s,Fx in N\n0,1\n1,2\n", [1.0, 2.0]),
    ],
    ids=["copy", "in pounds", "raw volts", "words"],
)
def test_columns_of_one_name_that_say_which_is_meant(tmp_path, text, force):
    assert read_signals(written(tmp_path, text), "milling")["Fx"] == pytest.approx(force)


def test_columns_of_one_name_ask_by_a_key_that_answers(tmp_path):
    path = written(tmp_path, "time [s],Fx [N],Fx [N]\n0,1,3\n1,2,5\n", "run.csv")
    with pytest.raises(InputError, match='columns 2 and 3 are both "Fx"') as raised:
        read_signals(path, "milling")
    stated = re.search(r'measurement.toml, "(.*)"', str(raised.value))[1]
    assert read_signals(path, "milling", columns=stated)["Fx"] == pytest.approx([1.0, 2.0])


def test_a_run_states_its_columns(tmp_path):
    case = '[tool]\nteeth = 2\ndiameter = "10 mm"\n[cut]\nmode = "slot"\n'
    cut = 'spindle_speed = "6000 rpm"\nfeed_per_tooth = "0.1 mm"\naxial_depth = "1 mm"\n'
    written(tmp_path, case + cut, "case.toml")
    written(tmp_path, rows(), "run.csv")
    run = '[[run]]\nfile = "run.csv"\ncolumns = "time [s], Fx [N], Fy [N]"\n'
    written(tmp_path, f'kind = "milling"\ncase = "case.toml"\n{run}', "measurement.toml")
    (found,) = read_measurement(tmp_path).runs
    assert found.signals["Fx"] == pytest.approx(FORCE)
    run = run.replace('"time [s], Fx [N], Fy [N]"', "3")
    written(tmp_path, f'kind = "milling"\ncase = "case.toml"\n{run}', "measurement.toml")
    with pytest.raises(InputError, match="columns: 3 is given; names and units of all columns"):
        read_measurement(tmp_path)


LINES = 5.0 * np.arange(1, 41)
RECEPTANCE = 1.0 / (2e7 * (1.0 - (LINES / 120.0) ** 2 + 0.06j * LINES / 120.0))
IN_UM = LINES, 1e6 * RECEPTANCE.real, 1e6 * RECEPTANCE.imag


@pytest.mark.parametrize(
    "text",
    [
        FRF_HEADING + "\n" + rows(",", "{:.9E}", columns=IN_UM).replace("E", "D"),
        "Frequency in Hz;Real in um/N;Imag in um/N\n" + rows(";", columns=IN_UM).replace(".", ","),
        "Frequency/Hz;Real/(um/N);Imag/(um/N)\n" + rows(";", columns=IN_UM),
        "frequency\treal\timag\n(Hz)\t((um)/N)\t((um)/N)\n" + rows("\t", columns=IN_UM),
        f"Points: 40\n40\n{FRF_HEADING}\n" + rows(columns=IN_UM, end=",,"),
    ],
    ids=["Fortran", "words", "slashes", "units below", "numbers above"],
)
def test_frfs_are_read(tmp_path, text):
    (found,) = frfs_of_table(read_table(written(tmp_path, text)))
    assert found.receptance().values == pytest.approx(RECEPTANCE, rel=1e-6)


def universal(values):
    """Dataset 58 of a receptance, as the standard lays it out."""
    head = ["    -1", "    58", *["NONE".ljust(80)] * 5]
    head.append("    4         1    1         0 NONE               1   1 NONE               1   1")
    head.append(f"{5:10d}{values.size:10d}{1:10d}{5.0:13.5e}{5.0:13.5e}{0.0:13.5e}")
    for kind, name, unit in ((18, "Frequency", "Hz"), (8, "Displacement", "m"), (13, "Force", "N")):
        head.append(f"{kind:10d}    0    0    0 {name:<20s} {unit:<20s}")
    head.append(f"{0:10d}    0    0    0 {'NONE':<20s} {'NONE':<20s}")
    numbers = np.column_stack([values.real, values.imag]).ravel()
    body = ["".join(f"{one:13.5e}" for one in numbers[k : k + 6]) for k in range(0, 80, 6)]
    return "\n".join([*head, *body, "    -1", ""])


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace("e-", "d-").replace("e+", "d+"),
        lambda text: text.replace(".", ","),
        lambda text: text.replace("\n", "\r\n") + "\x1a",
    ],
    ids=["mark", "carriage returns", "small d", "decimal commas", "DOS"],
)
def test_universal_files_are_read(tmp_path, change):
    path = written(tmp_path, change(universal(RECEPTANCE)), "tap.uff")
    (found,) = UFF58.read_frfs(path)
    assert found.receptance().values == pytest.approx(RECEPTANCE, rel=1e-5)
