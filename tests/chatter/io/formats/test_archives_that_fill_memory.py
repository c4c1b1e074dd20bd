"""Small files that unpack to more than memory holds are refused before they are unpacked."""

from __future__ import annotations

import struct
import zipfile
import zlib

import numpy as np
import pytest

from chatter.io.formats.format_list import read_frfs
from chatter.io.stated_columns import read_signal_table
from dynamics.frf.container import MeasurementError

SHEET = (
    '<?xml version="1.0"?><worksheet '
    'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">{}<sheetData>{}</sheetData>'
    "</worksheet>"
)


def workbook(path, sheet):
    """A workbook of openpyxl whose only sheet is replaced."""
    openpyxl = pytest.importorskip("openpyxl")
    openpyxl.Workbook().save(path)
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    parts["xl/worksheets/sheet1.xml"] = sheet.encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return path


def cell(place, text):
    return f'<c r="{place}" t="inlineStr"><is><t>{text}</t></is></c>'


ROWS = f'<row r="1">{cell("A1", "time [s]")}{cell("B1", "force [N]")}</row>' + "".join(
    f'<row r="{k}"><c r="A{k}"><v>{k}</v></c><c r="B{k}"><v>{-k}</v></c></row>' for k in range(2, 9)
)


def test_cell_in_a_far_corner_of_a_sheet_is_refused(tmp_path):
    corner = '<row r="99999999999"><c r="A99999999999"><v>1</v></c></row>'
    path = workbook(tmp_path / "far.xlsx", SHEET.format("", ROWS + corner))
    with pytest.raises(MeasurementError, match=r"far\.xlsx: its content unpacks to .* times"):
        read_signal_table(path)


def test_width_that_a_sheet_claims_is_not_filled(tmp_path):
    path = workbook(tmp_path / "wide.xlsx", SHEET.format('<dimension ref="A1:XFD1048576"/>', ROWS))
    table = read_signal_table(path)
    np.testing.assert_array_equal(table.numbers(1), -np.arange(2.0, 9.0))


def test_texts_and_lists_of_parquet_are_not_read(tmp_path):
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    times = 60_000_000
    long = pa.ListArray.from_arrays([0, times, times], pa.array(np.zeros(times, np.int8)))
    path = tmp_path / "lists.parquet"
    content = {"time [s]": [0.0, 1.0], "force [N]": [3.0, 4.0], "notes": long}
    parquet.write_table(pa.table(content), path)
    before = pa.total_allocated_bytes()
    peak = pa.default_memory_pool().max_memory()
    table = read_signal_table(path)
    assert [one.heading for one in table.columns] == ["time [s]", "force [N]"]
    np.testing.assert_array_equal(table.numbers(1), [3.0, 4.0])
    assert pa.default_memory_pool().max_memory() == max(peak, before)


def test_parquet_without_numbers_says_what_is_there(tmp_path):
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "a.parquet"
    parquet.write_table(pa.table({"notes": ["a", "b"]}), path)
    with pytest.raises(MeasurementError, match=r"a\.parquet: holds no column of numbers.* notes"):
        read_signal_table(path)


def mat_of_cells(path, count, *, compressed):
    """A MAT file of version 5 with one cell array in a structure of empty arrays of 8 bytes."""
    name = struct.pack("<IIii", 5, 8, count, 1) + struct.pack("<II", 1, 1) + b"c".ljust(8, b"\0")
    cells = struct.pack("<IIII", 6, 8, 1, 0) + name + struct.pack("<II", 14, 0) * count
    element = struct.pack("<II", 14, len(cells)) + cells
    if compressed:
        packed = zlib.compress(element)
        element = struct.pack("<II", 15, len(packed)) + packed
    path.write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + element)
    return path


@pytest.mark.parametrize("compressed", [True, False])
def test_cells_without_number_are_refused_before_they_are_read(tmp_path, compressed):
    path = mat_of_cells(tmp_path / "cells.mat", 200_000, compressed=compressed)
    with pytest.raises(
        MeasurementError, match=r"cells\.mat: .* hold 100001 arrays; at most 100000"
    ):
        read_signal_table(path)


def hdf5(path, fill):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


def test_dataset_of_a_fill_value_is_refused(tmp_path):
    """130 million numbers of which none is in the file."""
    path = hdf5(
        tmp_path / "fill.mat",
        lambda file: file.create_dataset(
            "force_N", shape=(130_000_000, 1), dtype="f8", chunks=(1000, 1)
        ),
    )
    with pytest.raises(MeasurementError, match=r"fill\.mat: its content unpacks to 992 MB"):
        read_signal_table(path)


@pytest.mark.parametrize(
    "element", ["S1000000", np.dtype([("real", "f8"), ("imag", "f8"), ("rest", "f8", (100_000,))])]
)
def test_elements_that_are_no_single_numbers_are_passed_over(tmp_path, element):
    """20 000 elements of a megabyte, none of them in the file."""

    def fill(file):
        file.create_dataset("force_N", shape=(20_000,), dtype=element, chunks=(1,))
        file.create_dataset("time_s", data=[[0.0], [1.0], [2.0]])

    table = read_signal_table(hdf5(tmp_path / "fat.mat", fill))
    assert [one.heading for one in table.columns] == ["time [s]"]


def test_zeros_that_pack_a_thousand_times_are_refused(tmp_path):
    path = tmp_path / "zeros.npz"
    np.savez_compressed(path, **{"force [N]": np.zeros(10_000_000)})
    with pytest.raises(
        MeasurementError, match=r"zeros\.npz: its content unpacks to 76 MB, \d+ tim"
    ):
        read_signal_table(path)


def test_noise_beside_channels_of_nothing_is_read(tmp_path):
    """Five million samples of a sensor of 12 bits beside a dead channel and an even clock."""
    count = 5_000_000
    noise = np.random.default_rng(1).integers(0, 16, count) / 64.0
    path = tmp_path / "cut.npz"
    columns = {"force [N]": noise, "dead [N]": np.zeros(count)}
    np.savez_compressed(path, **columns)
    assert read_signal_table(path).size == count


def test_entities_are_refused_in_utf_16_too(tmp_path):
    path = tmp_path / "trace.xml"
    text = (
        '<?xml version="1.0" encoding="utf-16"?><!DOCTYPE t [<!ENTITY a "ha">]><traceSession>'
        '<traceData><dataFrame><dataSignal id="f1" name="&a;"/><rec time="0" f1="1"/></dataFrame>'
        "</traceData></traceSession>"
    )
    path.write_bytes(text.encode("utf-16"))
    with pytest.raises(MeasurementError, match=r"trace\.xml: declares entities"):
        read_signal_table(path)


def test_wav_whose_numbers_take_more_than_it_does_is_refused(tmp_path, monkeypatch):
    import wave

    from chatter.io.formats import named_arrays

    path = tmp_path / "cut.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 1, 8000, 0, "NONE", ""))
        file.writeframes(bytes(2**18))
    monkeypatch.setattr(named_arrays, "LARGEST_FILE", 2**20)
    with pytest.raises(MeasurementError, match=r"cut\.wav: its content unpacks to 2 MB; at most 1"):
        read_signal_table(path)


def test_frfs_are_bounded_as_signals_are(tmp_path):
    path = tmp_path / "zeros.npz"
    np.savez_compressed(path, **{"frequency [Hz]": np.zeros(10_000_000)})
    with pytest.raises(MeasurementError, match=r"zeros\.npz: its content unpacks"):
        read_frfs(path)
