"""Hammer records from files: columns by unit, sampling rate of rounded times, folders."""

import numpy as np
import pytest

from chatter.io.hammer_records import read_hammer_folder, read_hammer_record
from dynamics.frf.container import MeasurementError
from dynamics.frf.hammer.record import HammerRecord

RATE, COUNT = 25600.0, 400


def table(
    head="time [s],force [N],acceleration [m/s^2]",
    rate=RATE,
    digits=7,
    count=COUNT,
    separator=",",
    columns=None,
):
    time = 0.25 + np.arange(count) / rate
    force = np.sin(np.arange(count))
    rows = columns or [
        [f"{t:.{digits}f}", f"{f:.3f}", f"{2 * f:.4f}"] for t, f in zip(time, force, strict=True)
    ]
    return "\n".join([head, *(separator.join(row) for row in rows)]) + "\n"


def write(folder, text, name="tap01.csv"):
    path = folder / name
    path.write_text(text)
    return path


def test_a_record_in_its_units(tmp_path):
    record = read_hammer_record(write(tmp_path, table()))
    assert record.name == "tap01.csv"
    assert record.sampling_rate == RATE
    assert record.quantity == "accelerance"
    np.testing.assert_allclose(record.response, 2 * np.sin(np.arange(COUNT)), atol=1e-4)
    assert record.time[1] == pytest.approx(0.25 + 1 / RATE)


@pytest.mark.parametrize(
    ("head", "quantity", "force", "response"),
    [
        ("t [ms],F [kN],a [g]", "accelerance", 1000.0, 9.80665),
        ("Time (s);Hammer (lbf);Velocity (mm/s)", "mobility", 4.4482216152605, 1e-3),
        ("time [s]\tforce x [N]\tdisplacement x [um]", "receptance", 1.0, 1e-6),
    ],
)
def test_units_tell_the_columns(tmp_path, head, quantity, force, response):
    separator = ";" if ";" in head else "\t" if "\t" in head else ","
    record = read_hammer_record(write(tmp_path, table(head, separator=separator)))
    raw = np.round(np.sin(np.arange(COUNT)), 3)
    assert record.quantity == quantity
    np.testing.assert_allclose(record.force, force * raw)
    assert np.max(record.response) == pytest.approx(2 * response, rel=1e-3)


@pytest.mark.parametrize(
    ("rate", "digits"), [(25600.0, 7), (51200.0, 5), (10000.0, 4), (44100.0, 6), (12800.5, 9)]
)
def test_the_rate_of_rounded_times_is_exact(tmp_path, rate, digits):
    # five digits at 51.2 kHz: neighbours repeat
    path = write(tmp_path, table(rate=rate, digits=digits, count=2000))
    assert read_hammer_record(path).sampling_rate == pytest.approx(rate, rel=1e-9)


def test_several_responses_must_be_told_apart(tmp_path):
    rows = [[f"{i / RATE:.7f}", "1.0", f"{i}.0", f"{2 * i}.0"] for i in range(50)]
    head = "time [s],force [N],acceleration x [m/s^2],acceleration y [m/s^2]"
    path = write(tmp_path, table(head, columns=rows))
    with pytest.raises(MeasurementError, match="'acceleration x', 'acceleration y'; leave the"):
        read_hammer_record(path)
    record = read_hammer_record(path, response="acceleration y")
    assert record.response[10] == 20.0
    assert record.response_point.direction == "y"
    with pytest.raises(MeasurementError, match="no response column 'z'"):
        read_hammer_record(path, response="z")


def lines_without(text, *dropped):
    return "\n".join(line for i, line in enumerate(text.split("\n")) if i not in dropped)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (lines_without(table(), 100, 101), "line 101: time steps by .* without gaps"),
        (lines_without(table(), 100), "line 101: time steps by"),
        (table().replace("0.2539062", "0.2501062"), "times must rise"),
        (table("t,F,a"), "no heading with names and units"),
        (table("time [s],force [N],temperature [kg]"), "'temperature'.*kg"),
        (table("time [s],acceleration [g],velocity [m/s]"), "no column is a force"),
        (table("time [s],force [N],other [N]"), "several columns are a force"),
        (table("frequency [Hz],real [m/N],imag [m/N]"), "m/N"),
        (table(count=20), "20 samples"),
        (table().replace("0.841", "nan"), "not a finite number"),
        ("words\n", "text only"),
    ],
)
def test_wrong_records_are_refused(tmp_path, text, said):
    with pytest.raises(MeasurementError, match=f"(?s)tap01.csv.*{said}"):
        read_hammer_record(write(tmp_path, text))


def test_a_folder_in_natural_order_with_what_is_no_record(tmp_path):
    for name in ("tap10.csv", "tap2.csv", "Tap1.CSV"):
        write(tmp_path, table(), name)
    write(tmp_path, "words\n", "notes.txt")
    write(tmp_path, "a = 1\n", "truth.toml")
    write(tmp_path, "", ".hidden.csv")
    (tmp_path / "raw").mkdir()
    folder = read_hammer_folder(tmp_path)
    assert [record.name for record in folder.records] == ["Tap1.CSV", "tap2.csv", "tap10.csv"]
    assert folder.unreadable[0][0] == "notes.txt"
    assert "text only" in folder.unreadable[0][1]
    assert folder.passed_over == ("truth.toml",)


def test_folders_that_hold_no_record(tmp_path):
    with pytest.raises(MeasurementError, match=r"holds no hammer record.*\.csv"):
        read_hammer_folder(tmp_path)
    write(tmp_path, "words\n")
    with pytest.raises(MeasurementError, match=r"holds no hammer record \(tap01.csv: .*text only"):
        read_hammer_folder(tmp_path)
    with pytest.raises(MeasurementError, match="is a file"):
        read_hammer_folder(tmp_path / "tap01.csv")
    with pytest.raises(MeasurementError, match="no such folder"):
        read_hammer_folder(tmp_path / "none")


def test_a_record_checks_its_arrays():
    with pytest.raises(MeasurementError, match="same length"):
        HammerRecord("r", RATE, np.zeros(100), np.zeros(99))
    with pytest.raises(MeasurementError, match="not a finite"):
        HammerRecord("r", RATE, np.zeros(100), np.full(100, np.inf))
    with pytest.raises(MeasurementError, match="sampling rate"):
        HammerRecord("r", 0.0, np.zeros(100), np.zeros(100))
