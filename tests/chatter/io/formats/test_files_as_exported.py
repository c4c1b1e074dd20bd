"""Exports of programs as they come: time stamps, quoted decimal commas, merged cells, clocks."""

import datetime
import struct

import numpy as np
import pytest
import scipy.io

from chatter.description.errors import InputError
from chatter.io.formats.format_list import format_of
from chatter.io.hammer_records import is_hammer_record, read_hammer_record
from chatter.io.signals import read_signals
from chatter.io.time_stamps import seconds_of
from chatter.monitoring.recording_file import read_recording
from chatter.studies.modal_test import modes
from dynamics.frf.container import MeasurementError
from tests.chatter.io.formats.test_files_people_have import (
    ACCELERATION,
    FORCE,
    GRAVITY,
    RATE,
    TIME,
    as_lvm,
    assert_is_the_record,
)

HEADING = "Time [s],Force [N],Acc [m/s^2]"
ROWS = np.column_stack([TIME, FORCE, ACCELERATION])


def written(path, heading, row, encoding="utf-8"):
    lines = [heading, *(row(*one) for one in ROWS)]
    path.write_text("\n".join(lines) + "\n", encoding=encoding)
    return path


def with_comma(value):
    return f"{value:.9f}".replace(".", ",")


def test_decimal_commas_in_quotes_between_commas(tmp_path):
    path = written(
        tmp_path / "a.csv",
        '"Zeit [s]","Kraft [N]","Acc [m/s²]"',
        lambda *row: ",".join(f'"{with_comma(one)}"' for one in row),
        "cp1252",
    )
    assert_is_the_record(read_hammer_record(path))


def test_groups_of_thousands_in_quotes_are_not_taken_for_decimals(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text('time [s],force [N]\n0.0,"1,234"\n0.1,"2,345"\n', encoding="utf-8")
    with pytest.raises(MeasurementError, match=r"'1,234' is not a number"):
        format_of(path, "signals").read_signals(path).numbers(1)


@pytest.mark.parametrize(
    ("stamp", "separator", "point"),
    [
        ("2024-03-12 23:59:{:012.9f}", ",", "."),
        ("2024-03-12T09:12:{:012.9f}Z", ",", "."),
        ("12.03.2024 09:12:{:012.9f}", ";", ","),
        ("09:12:{:012.9f}", "\t", "."),
    ],
)
def test_time_stamps_are_a_time(tmp_path, stamp, separator, point):
    def row(time, force, motion):
        cells = stamp.format(time), f"{force:.9f}", f"{motion:.9f}"
        return separator.join(cells).replace(".", point) if point == "," else separator.join(cells)

    heading = separator.join(("Timestamp", "Force [N]", "Acc [m/s^2]"))
    assert_is_the_record(read_hammer_record(written(tmp_path / "a.csv", heading, row)))


def test_midnight_does_not_turn_time_back():
    dated = ["2024-02-28 23:59:59.75", "2024-02-29 00:00:00.25", "2024-02-29 00:00:01"]
    assert seconds_of(dated) == pytest.approx([0.0, 0.5, 1.25])
    assert seconds_of(["23:59:59.75", "00:00:00.25"]) == pytest.approx([0.0, 0.5])
    assert seconds_of(["09:00:00", "noon"]) is None


@pytest.mark.parametrize("unit", ["Newtons", "Newton"])
def test_units_that_labview_writes_out(tmp_path, unit):
    path = as_lvm(tmp_path / "a.lvm")
    text = path.read_text(encoding="utf-8").replace("kN\tg", f"{unit}\tg")
    path.write_text(text, encoding="utf-8")
    record = read_hammer_record(path)
    np.testing.assert_allclose(record.force, FORCE / 1e3, atol=1e-9)


@pytest.mark.parametrize("end", ["", "\t"])
def test_units_of_lvm_with_a_time_for_each_channel_stand_above_their_channels(tmp_path, end):
    """Properties as LabVIEW 8 wrote them: a cell for each abscissa, left empty."""
    lines = ["LabVIEW Measurement", "Separator\tTab", "X_Columns\tMulti", "***End_of_Header***", ""]
    lines += ["Channels\t3\t\t\t\t\t", f"Y_Unit_Label\tkN\t\tkN\t\tkN{end}", "***End_of_Header***"]
    lines += ["X_Value\tFx\tX_Value\tFy\tX_Value\tFz\tComment"]
    lines += ["0.0\t0.1\t0.0\t0.2\t0.0\t0.3", "0.5\t1.1\t0.5\t1.2\t0.5\t1.3"]
    path = tmp_path / "cut.lvm"
    path.write_text("\n".join(lines), encoding="utf-8")
    signals = read_signals(path)
    assert signals["Fx"].tolist() == [100.0, 1100.0]
    assert signals["Fy"].tolist() == [200.0, 1200.0]
    assert signals["Fz"].tolist() == [300.0, 1300.0]


def test_tdms_with_texts_and_empty_channels_beside_the_signals(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    path = tmp_path / "log.tdms"
    clock = {"wf_increment": 1.0 / RATE}
    with nptdms.TdmsWriter(path) as file:
        file.write_segment(
            [
                nptdms.ChannelObject("Log", "Hammer", FORCE, {**clock, "unit_string": "N"}),
                nptdms.ChannelObject("Log", "Acc", ACCELERATION, {**clock, "unit_string": "m/s^2"}),
                nptdms.ChannelObject("Events", "Remark", np.array(["begin", "end"])),
                nptdms.ChannelObject("Events", "Level", np.array([])),
            ]
        )
    assert_is_the_record(read_hammer_record(path))


def test_dates_of_tdms_are_a_time(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    path = tmp_path / "log.tdms"
    begin = np.datetime64("2024-03-12T09:12:33", "us")
    with nptdms.TdmsWriter(path) as file:
        dates = begin + np.arange(4) * np.timedelta64(500, "us")
        file.write_segment(
            [
                nptdms.ChannelObject("Log", "Time", dates),
                nptdms.ChannelObject("Log", "Fx", np.arange(4.0), {"unit_string": "kN"}),
            ]
        )
    signals = read_signals(path)
    np.testing.assert_allclose(signals["time"], [0.0, 5e-4, 1e-3, 1.5e-3], atol=1e-9)
    assert signals["Fx"].tolist() == [0.0, 1e3, 2e3, 3e3]


def as_tdms(path, *groups, clock=None, unit="unit_string", time=False):
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(path) as file:
        for group in groups or ("G",):
            given = {"wf_increment": 1.0 / RATE} if clock is None else clock
            channels = [
                nptdms.ChannelObject(group, "Hammer", FORCE, {**given, unit: "N"}),
                nptdms.ChannelObject(group, "Acc", ACCELERATION / GRAVITY, {**given, unit: "g"}),
            ]
            if time:
                channels.insert(0, nptdms.ChannelObject(group, "Time", TIME))
            file.write_segment(channels)
    return path


def test_tdms_without_a_start_or_with_unit_descriptions(tmp_path):
    assert_is_the_record(read_hammer_record(as_tdms(tmp_path / "a.tdms")))
    described = as_tdms(tmp_path / "b.tdms", clock={}, unit="NI_UnitDescription", time=True)
    assert_is_the_record(read_hammer_record(described))


def test_one_record_of_tdms_with_two_groups_is_asked_for_by_their_names(tmp_path):
    with pytest.raises(MeasurementError, match=r"2 records: Blow 1, Blow 2; name one, "):
        read_hammer_record(as_tdms(tmp_path / "a.tdms", "Blow 1", "Blow 2"))


def workbook(path, *sheets, merged=()):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for number, (corner, rows) in enumerate(sheets):
        sheet = book.create_sheet(f"Sheet {number}")
        for k, row in enumerate(rows):
            for j, cell in enumerate(row):
                if cell is not None:
                    sheet.cell(corner[0] + k, corner[1] + j, cell)
        for cells in merged if number == 0 else ():
            sheet.merge_cells(cells)
    book.save(path)
    return path


NAMES = HEADING.split(",")


def test_workbook_with_headings_over_merged_cells(tmp_path):
    rows = [[NAMES[0], "Channels", None], [None, *NAMES[1:]], *ROWS.tolist()]
    path = workbook(tmp_path / "a.xlsx", ((1, 1), rows), merged=("B1:C1", "A1:A2"))
    assert_is_the_record(read_hammer_record(path))


def test_workbook_whose_table_does_not_begin_at_its_corner(tmp_path):
    path = workbook(tmp_path / "a.xlsx", ((5, 3), [NAMES, *ROWS.tolist()]))
    assert_is_the_record(read_hammer_record(path))


def test_workbook_of_numbers_as_text_with_decimal_commas(tmp_path):
    rows = [[with_comma(cell) for cell in row] for row in ROWS]
    path = workbook(tmp_path / "a.xlsx", ((1, 1), [NAMES, *rows]))
    assert_is_the_record(read_hammer_record(path))


def test_workbook_of_a_record_and_its_statistics(tmp_path):
    statistics = [["", "max", "min"], ["Force [N]", 1e3, 0.0], ["Acc [g]", 2.0, -2.0]]
    path = workbook(tmp_path / "a.xlsx", ((1, 1), statistics), ((1, 1), [NAMES, *ROWS.tolist()]))
    assert_is_the_record(read_hammer_record(path))


def test_workbook_without_numbers_is_said_to_have_none(tmp_path):
    path = workbook(tmp_path / "a.xlsx", ((1, 1), [["Tap", "of tool 7"]]))
    with pytest.raises(MeasurementError, match="no sheet holds rows of numbers"):
        read_hammer_record(path)


def test_parquet_with_dates(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    begin = datetime.datetime(2024, 3, 12, 23, 59, 59, 990_000)
    # whole microseconds, as dates have them
    dates = [begin + datetime.timedelta(seconds=float(one)) for one in TIME]
    table = {"stamp": dates, "force [N]": FORCE, "acc [m/s^2]": ACCELERATION}
    parquet.write_table(pyarrow.table(table), tmp_path / "a.parquet")
    record = read_hammer_record(tmp_path / "a.parquet")
    assert record.sampling_rate == pytest.approx(RATE, rel=1e-4)
    np.testing.assert_allclose(record.force, FORCE)


def test_a_time_without_unit_is_in_seconds_where_it_may_be(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", {"t": TIME, "force_N": FORCE, "acc_ms2": ACCELERATION})
    assert_is_the_record(read_hammer_record(tmp_path / "a.mat"))
    slow = {"t": 1e3 * TIME, "force_N": FORCE, "acc_ms2": ACCELERATION}
    scipy.io.savemat(tmp_path / "b.mat", slow)
    with pytest.raises(MeasurementError, match=r"t has no unit, and in s .* 2\.048 Hz; write"):
        read_hammer_record(tmp_path / "b.mat")


def test_a_sampling_rate_stands_for_the_time(tmp_path):
    path = written(tmp_path / "a.csv", "Force [N],Acc [m/s^2]", lambda _, f, a: f"{f:.9f},{a:.9f}")
    assert is_hammer_record(path)
    assert_is_the_record(read_hammer_record(path, sampling_rate=RATE))
    # the message names the key that answers it, and no frequency that is not there
    with pytest.raises(InputError, match=r"no column is a time; .*--sampling-rate"):
        modes(path)


def test_columns_without_units_are_asked_for_by_their_key(tmp_path):
    np.savez(tmp_path / "a.npz", fs=RATE, data=ROWS[:, 1:])
    with pytest.raises(InputError, match='here 3: --columns "time'):
        modes(tmp_path / "a.npz")


@pytest.mark.parametrize("size", [0, 0xFFFFFFFF])
def test_sound_of_a_recorder_that_was_cut_off(tmp_path, size):
    samples = np.round(2e4 * np.sin(900.0 * np.arange(500) / 8000.0)).astype("<i2")
    kind = struct.pack("<HHIIHH", 1, 1, 8000, 16000, 2, 16)
    head = b"WAVE" + struct.pack("<4sI", b"fmt ", 16) + kind
    note = struct.pack("<4sI", b"LIST", 5) + b"abcde\0"
    body = head + note + struct.pack("<4sI", b"data", size) + samples.tobytes()
    path = tmp_path / "a.wav"
    path.write_bytes(struct.pack("<4sI", b"RIFF", size) + body)
    table = format_of(path, "signals").read_signals(path)
    np.testing.assert_array_equal(table.numbers(1), samples / 32768.0)
    assert table.numbers(0)[-1] == pytest.approx(499 / 8000.0)


@pytest.mark.parametrize("value", [0.0, 4.0])
def test_a_recording_that_never_changes_is_said_to_be_one(tmp_path, value):
    path = written(tmp_path / "a.csv", "time [s],ax [m/s^2]", lambda t, *_: f"{t:.9f},{value}")
    with pytest.raises(InputError, match="ax never changes: nothing was recorded"):
        read_recording(path)


def test_one_sample_is_no_recording(tmp_path):
    (tmp_path / "a.csv").write_text("time [s],ax [m/s^2]\n0.0,1.0\n", encoding="utf-8")
    with pytest.raises(InputError, match="1 sample is no recording"):
        read_recording(tmp_path / "a.csv")
