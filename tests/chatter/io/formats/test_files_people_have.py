"""LVM, MAT, XLSX, Parquet, NPZ, headerless text: what is written by others comes back in SI."""

import contextlib
import zipfile

import numpy as np
import pytest
import scipy.io

from chatter.io.formats import named_arrays, npz
from chatter.io.formats.format_list import format_of, read_frfs
from chatter.io.hammer_records import is_hammer_record, read_hammer_record
from chatter.io.stated_columns import read_signal_table
from dynamics.frf.container import MeasurementError

RATE = 2048.0
TIME = np.arange(64) / RATE
FORCE = 1e3 * np.exp(-((TIME - 0.004) ** 2) / 2e-7)
ACCELERATION = -20.0 * np.sin(900.0 * TIME)
STATED = "time [ms], force [kN], acceleration [g]"
GRAVITY = 9.80665


def read(path):
    return format_of(path, "signals").read_signals(path)


def assert_is_the_record(record):
    """The record above, in SI, whatever it was written in."""
    assert record.sampling_rate == pytest.approx(RATE, rel=1e-6)
    assert record.quantity == "accelerance"
    np.testing.assert_allclose(record.force, FORCE, atol=1e-6)
    np.testing.assert_allclose(record.response, ACCELERATION, atol=1e-6)


def as_lvm(path, decimal=".", abscissas="One", separator="Tab", segments=1):
    mark = {"Tab": "\t", "Comma": ","}[separator]

    def row(*cells):
        return mark.join(str(cell).replace(".", decimal) for cell in cells)

    lines = ["LabVIEW Measurement", row("Writer_Version", 2), row("Reader_Version", 2)]
    lines += [row("Separator", separator), f"Decimal_Separator{mark}{decimal}"]
    lines += [row("X_Columns", abscissas), "***End_of_Header***", ""]
    for block in np.array_split(np.arange(TIME.size), segments):
        lines += [row("Channels", 2), row("Samples", block.size, block.size)]
        lines += [row("X_Dimension", "Time", "Time"), row("Y_Unit_Label", "kN", "g")]
        lines += [row("X0", TIME[block[0]], TIME[block[0]]), row("Delta_X", 1 / RATE, 1 / RATE)]
        lines += ["***End_of_Header***"]
        one = ["X_Value", "Force", "Acc", "Comment"]
        lines += [row(*([*one[:2], "X_Value", *one[2:]] if abscissas == "Multi" else one))]
        for k in block:
            force, motion = FORCE[k] / 1e3, ACCELERATION[k] / GRAVITY
            cells = {
                "One": (TIME[k], force, motion),
                "Multi": (TIME[k], force, TIME[k], motion),
                "No": ("", force, motion),
            }
            lines.append(row(*cells[abscissas]))
        lines.append("")
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "layout",
    [
        {},
        {"decimal": ","},
        {"abscissas": "No"},
        {"abscissas": "No", "decimal": ","},
        {"abscissas": "Multi"},
        {"separator": "Comma"},
        {"segments": 3},
    ],
)
def test_lvm_of_every_layout(tmp_path, layout):
    assert_is_the_record(read_hammer_record(as_lvm(tmp_path / "tap.lvm", **layout)))


def test_lvm_without_abscissas_has_an_empty_cell_for_comments_behind_each_property(tmp_path):
    path = as_lvm(tmp_path / "tap.lvm", abscissas="No")
    lines = path.read_text(encoding="utf-8").split("\n")
    ended = [f"{line}\t" if "\t" in line else line for line in lines]
    path.write_text("\r\n".join(ended), encoding="utf-8")
    assert_is_the_record(read_hammer_record(path))


def test_lvm_is_recognised_by_content(tmp_path):
    assert format_of(as_lvm(tmp_path / "tap.txt"), "signals").name == "lvm"


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("***End_of_Header***", "", "cut short"),
        ("Separator\tTab", "Separator\tDot", "Tab or Comma"),
        ("X_Columns\tOne", "X_Columns\tTwo", "One, Multi or No"),
        ("Channels\t2", "Channels\ttwo", "line 9: 'two' is not a number"),
    ],
)
def test_wrong_lvm_is_refused(tmp_path, old, new, reason):
    path = as_lvm(tmp_path / "tap.lvm")
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(MeasurementError, match=reason):
        read(path)


def test_mat_of_version_5_with_vectors_and_rate(tmp_path):
    path = tmp_path / "tap.mat"
    content = {"force_N": FORCE, "acc_g": ACCELERATION / GRAVITY, "fs": RATE, "note": "a tap"}
    scipy.io.savemat(path, content, do_compression=True)
    assert_is_the_record(read_hammer_record(path))


def test_mat_with_a_structure(tmp_path):
    path = tmp_path / "tap.mat"
    fields = {"t_s": TIME, "force_kN": FORCE / 1e3, "acc_ms2": ACCELERATION}
    scipy.io.savemat(path, {"tap": fields})
    assert_is_the_record(read_hammer_record(path))


def test_mat_with_a_matrix_and_stated_columns(tmp_path):
    path = tmp_path / "tap.mat"
    matrix = np.column_stack([1e3 * TIME, FORCE / 1e3, ACCELERATION / GRAVITY])
    scipy.io.savemat(path, {"data": matrix})
    assert_is_the_record(read_hammer_record(path, columns=STATED))
    with pytest.raises(MeasurementError, match=r"--columns states 2 columns where .* has 3: data"):
        read_signal_table(path, "time [s], force [N]")


def test_mat_with_a_complex_frf(tmp_path):
    values = 1.0 - 2.0j * np.arange(64)
    path = tmp_path / "frf.mat"
    scipy.io.savemat(path, {"frequency_Hz": 10.0 + np.arange(64), "receptance [um/N]": values})
    (frf,) = read_frfs(path)
    np.testing.assert_allclose(frf.values, 1e-6 * values)


def test_mat_of_version_7_3(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "tap.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in {"force_N": FORCE, "acc_ms2": ACCELERATION}.items():
            file[name] = values.reshape(1, -1)  # a column in MATLAB
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
        file["fs"] = [[RATE]]
        file["note"] = np.frombuffer(b"tap of the day" * 8, dtype=np.uint8)
        file["note"].attrs["MATLAB_class"] = np.bytes_("char")
        file["elsewhere"] = h5py.ExternalLink("/etc/passwd", "/")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    assert_is_the_record(read_hammer_record(path))


def test_mat_of_version_7_3_keeps_columns_of_a_matrix(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "tap.mat"
    with h5py.File(path, "w") as file:
        file["data"] = np.stack([1e3 * TIME, FORCE / 1e3, ACCELERATION / GRAVITY])
    assert_is_the_record(read_hammer_record(path, columns=STATED))


def workbook(path, rows, *more):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    for name, others in more:
        sheet = book.create_sheet(name)
        for row in others:
            sheet.append(row)
    book.save(path)
    return path


RECORD_ROWS = list(zip(*(one.tolist() for one in (TIME, FORCE, ACCELERATION)), strict=True))


def test_workbook_with_a_preamble_and_a_sheet_of_notes(tmp_path):
    heading = [["Tap of spindle 2"], [], ["Time [s]", "Force [N]", "Acceleration [m/s²]"]]
    notes = ("Notes", [["Hammer", "086C03"], ["Operator", "A. B."]])
    path = workbook(tmp_path / "tap.xlsx", [*heading, *RECORD_ROWS], notes)
    assert_is_the_record(read_hammer_record(path))


def test_workbook_with_units_on_their_own_line(tmp_path):
    heading = [["Time", "Force", "Acc"], ["s", "N", "m/s^2"]]
    assert_is_the_record(read_hammer_record(workbook(tmp_path / "a.xlsx", heading + RECORD_ROWS)))


def test_of_a_workbook_with_two_tables_one_is_asked_for(tmp_path):
    heading = [["Time [s]", "Force [N]", "Acc [m/s^2]"]]
    path = workbook(tmp_path / "a.xlsx", heading + RECORD_ROWS, ("tap 2", heading + RECORD_ROWS))
    with pytest.raises(MeasurementError, match=r"2 records: Sheet, tap 2; name one, "):
        read(path)


def test_parquet_with_units_in_names_and_properties(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    fields = [
        pyarrow.field("time [s]", pyarrow.float64()),
        pyarrow.field("force", pyarrow.float64(), metadata={"unit": "kN"}),
        pyarrow.field("acc_ms2", pyarrow.float32()),
        pyarrow.field("note", pyarrow.string()),
    ]
    arrays = [TIME, FORCE / 1e3, ACCELERATION.astype(np.float32), ["x"] * TIME.size]
    path = tmp_path / "tap.parquet"
    parquet.write_table(pyarrow.Table.from_arrays(list(map(pyarrow.array, arrays)),
                                                  schema=pyarrow.schema(fields)), path)  # fmt: skip
    record = read_hammer_record(path)
    np.testing.assert_allclose(record.force, FORCE, atol=1e-9)
    np.testing.assert_allclose(record.response, ACCELERATION, atol=1e-5)


@pytest.mark.parametrize("name", ["a.mat", "a.xlsx", "a.parquet", "a.npz"])
def test_broken_files_are_refused_by_name(tmp_path, name):
    module = {"a.xlsx": "openpyxl", "a.parquet": "pyarrow"}.get(name)
    if module:
        pytest.importorskip(module)
    path = tmp_path / name
    path.write_bytes(b"not at all what the name says")
    with pytest.raises(MeasurementError, match=name):
        read(path)


def test_npz_with_objects_is_refused(tmp_path):
    path = tmp_path / "a.npz"
    np.savez(path, run=np.array([{"a": 1}, None], dtype=object))
    with pytest.raises(MeasurementError, match="allow_pickle"):
        read(path)


@pytest.mark.parametrize("name", ["a.npz", "a.xlsx", "a.mat"])
def test_what_unpacks_to_too_much_is_refused(tmp_path, name, monkeypatch):
    if name == "a.xlsx":
        pytest.importorskip("openpyxl")
    monkeypatch.setattr(named_arrays, "LARGEST_FILE", 2**20)
    path = tmp_path / name
    if name == "a.mat":
        scipy.io.savemat(path, {"a": np.zeros(2**18)}, do_compression=True)
    else:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("a.npy", bytes(2**21))
    assert path.stat().st_size < 2**14
    with pytest.raises(MeasurementError, match="unpacks to 2 MB; at most 1 MB"):
        read(path)


def test_fields_of_a_structure_that_unpack_to_too_much_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(named_arrays, "LARGEST_FILE", 2**20)
    path = tmp_path / "tap.mat"
    scipy.io.savemat(path, {"tap": {"force_N": np.zeros(2**19)}}, do_compression=True)
    assert path.stat().st_size < 2**14
    with pytest.raises(MeasurementError, match=r"tap\.mat: its content unpacks to .* at most 1 MB"):
        read(path)


def test_matrix_that_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(named_arrays, "LARGEST_FILE", 2**20)
    path = tmp_path / "mass.npz"
    np.savez_compressed(path, mass=np.zeros((512, 512)))
    with pytest.raises(MeasurementError, match=r"mass\.npz: its content unpacks to 2 MB"):
        npz.read_matrices(path)


@pytest.mark.parametrize("separator", ["\t", " ", ",", ";"])
def test_headerless_text_with_stated_columns(tmp_path, separator):
    path = tmp_path / "tap.txt"
    np.savetxt(
        path,
        np.column_stack([1e3 * TIME, FORCE / 1e3, ACCELERATION / GRAVITY]),
        delimiter=separator,
        fmt="%.18e",
    )
    assert_is_the_record(read_hammer_record(path, columns=STATED))
    assert is_hammer_record(path, STATED)
    with pytest.raises(MeasurementError, match=r"no heading .* --columns"):
        read_hammer_record(path)
    with pytest.raises(MeasurementError, match="line 1 has 3 columns where --columns states 2"):
        read_hammer_record(path, columns="time [s], force [N]")
    with pytest.raises(MeasurementError, match="name every column once"):
        read_hammer_record(path, columns="time [s],, force [N]")


def test_export_of_dynoware(tmp_path):
    """Preamble, names, units on their own line, as the dynamometer's program writes them."""
    path = tmp_path / "cut.txt"
    preamble = "Test title:\tslot\nDate:\t01.02.2020\nSampling rate [Hz]:\t2048.000000\n"
    preamble += "Measuring time [s]:\t0.03\n\nTime\tFx\tFy\ns\tN\tkN\n"
    rows = "".join(f"{t:.9f}\t{f:.9f}\t{-f / 1e3:.12f}\n" for t, f in zip(TIME, FORCE, strict=True))
    path.write_text(preamble + rows)
    table = read(path)
    assert [column.heading for column in table.columns] == ["Time [s]", "Fx [N]", "Fy [kN]"]
    np.testing.assert_allclose(table.numbers(1), FORCE, atol=1e-8)
    np.testing.assert_allclose(table.numbers(2), -FORCE / 1e3, atol=1e-11)


def test_an_archive_damaged_within_its_data_is_refused(tmp_path):
    path = tmp_path / "tap.npz"
    np.savez_compressed(path, **{"time [s]": TIME, "force [N]": FORCE})
    whole = path.read_bytes()
    for at in range(40, len(whole), 97):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :])
        with contextlib.suppress(MeasurementError):
            read(path)


@pytest.mark.parametrize(
    "damaged",
    [
        lambda whole: whole[:60],
        lambda whole: whole[:-30],
        lambda _: b"PK\x03\x04" * 9,
        lambda _: bytes(range(200)),
        lambda _: b"",
    ],
)
def test_a_damaged_archive_is_refused_and_closed(tmp_path, damaged):
    path = tmp_path / "a.npz"
    np.savez(path, **{"time [s]": np.arange(9.0), "force [N]": np.arange(9.0)})
    path.write_bytes(damaged(path.read_bytes()))
    # an unclosed file would be a warning, and so an error
    with pytest.raises(MeasurementError, match="cannot be read: it is no NumPy archive"):
        npz.read_columns(path)


def test_a_single_array_is_told_how_it_is_saved(tmp_path):
    path = tmp_path / "a.npz"
    with path.open("wb") as file:
        np.save(file, np.arange(9.0))
    with pytest.raises(MeasurementError, match="holds one array; save them by name"):
        npz.read_columns(path)
