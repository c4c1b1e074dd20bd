"""Files that hold several records: sheets, groups, structures, channels that come again."""

from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.signal

from chatter import detect, modes
from chatter.io.formats.format_list import read_frfs
from chatter.io.formats.records import stem_of
from chatter.io.hammer_records import read_hammer_folder, read_hammer_record, read_hammer_records
from chatter.io.signals import read_signals
from chatter.io.stated_columns import read_signal_table
from dynamics.frf.container import MeasurementError

RATE = 8192.0
TIME = np.arange(4096) / RATE
#: a mode of 400 Hz, 2 % and 5 kg, struck by half-sines of unlike height
FREQUENCY, DAMPING, MASS = 400.0, 0.02, 5.0
HEIGHTS = (300.0, 450.0, 600.0)


def blow(height):
    """Force of a half-sine of 2 ms, and the acceleration of the mode by its exact step response."""
    begin, width = 0.02, 2e-3
    force = np.where(
        (begin < TIME) & (begin + width > TIME),
        height * np.sin(np.pi * (TIME - begin) / width),
        0.0,
    )
    stiffness = MASS * (2.0 * np.pi * FREQUENCY) ** 2
    damper = 2.0 * DAMPING * np.sqrt(stiffness * MASS)
    matrix = np.array([[0.0, 1.0], [-stiffness / MASS, -damper / MASS]])
    system = (matrix, np.array([[0.0], [1.0 / MASS]]), matrix[1:], np.array([[1.0 / MASS]]))
    _, acceleration, _ = scipy.signal.lsim(system, force, TIME)
    return force, acceleration


BLOWS = [blow(height) for height in HEIGHTS]


def as_workbook(path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    notes = book.create_sheet("Notes")
    notes.append(["speed", 12])
    for k, (force, motion) in enumerate(BLOWS):
        sheet = book.create_sheet(f"Tap {k + 1}")
        sheet.append(["time [ms]", "force [kN]", "acc [m/s^2]"])
        for row in zip(1e3 * TIME, 1e-3 * force, motion, strict=True):
            sheet.append([float(cell) for cell in row])
    book.save(path)
    return path


def as_tdms(path, names="Tap {}"):
    nptdms = pytest.importorskip("nptdms")
    clock = {"wf_increment": 1.0 / RATE}
    with nptdms.TdmsWriter(path) as file:
        for k, (force, motion) in enumerate(BLOWS):
            group = names.format(k + 1)
            file.write_segment(
                [
                    nptdms.ChannelObject(group, "Hammer", force, {**clock, "unit_string": "N"}),
                    nptdms.ChannelObject(group, "Acc", motion, {**clock, "unit_string": "m/s^2"}),
                ]
            )
    return path


def as_lvm(path):
    """Blows as LabVIEW appends them: a segment each, whose time begins anew."""
    lines = [
        "LabVIEW Measurement\t",
        "Separator\tTab",
        "X_Columns\tOne",
        "***End_of_Header***\t",
        "",
    ]
    for force, motion in BLOWS:
        lines += ["Channels\t2\t\t\t", "Y_Unit_Label\tN\tm/s^2\t", "***End_of_Header***\t\t\t"]
        lines += ["X_Value\tHammer\tAcc\tComment"]
        lines += [f"{t:.9f}\t{f:.6f}\t{a:.6f}" for t, f, a in zip(TIME, force, motion, strict=True)]
        lines += [""]
    path.write_text("\r\n".join(lines), encoding="utf-8")
    return path


def as_structure_array(path):
    elements = np.empty((1, len(BLOWS)), dtype=[("force_N", object), ("acc_ms2", object)])
    for k, (force, motion) in enumerate(BLOWS):
        elements[0, k] = (force, motion)
    scipy.io.savemat(path, {"taps": elements, "fs": RATE})
    return path


def as_structures(path):
    fields = [{"t_s": TIME, "force_N": force, "acc_ms2": motion} for force, motion in BLOWS]
    scipy.io.savemat(path, {f"tap{k + 1}": one for k, one in enumerate(fields)})
    return path


def as_structures_in_one(path):
    fields = [{"t_s": TIME, "force_N": force, "acc_ms2": motion} for force, motion in BLOWS]
    scipy.io.savemat(path, {"data": {f"tap{k + 1}": one for k, one in enumerate(fields)}})
    return path


def as_version_7_3(path):
    """A structure array as MATLAB lays it out: a dataset of references for each field."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        held, group = file.create_group("#refs#"), file.create_group("taps")
        group.attrs["MATLAB_class"] = np.bytes_("struct")
        for k, field in enumerate(("force_N", "acc_ms2")):
            group.create_dataset(field, (len(BLOWS), 1), dtype=h5py.ref_dtype)
            for number, one in enumerate(BLOWS):
                data = held.create_dataset(f"{field}{number}", data=one[k].reshape(1, -1))
                data.attrs["MATLAB_class"] = np.bytes_("double")
                group[field][number, 0] = data.ref
        file["fs"] = [[RATE]]
        file["fs"].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


def as_universal(path, order=("force", "acceleration")):
    """Time records of type 58 with node 1 in +z, force by code 13, acceleration by 12."""
    lines = []
    for number, one in enumerate(BLOWS):
        channels = {"force": (13, "N", one[0]), "acceleration": (12, "m/s^2", one[1])}
        for name in order:
            code, unit, values = channels[name]
            lines += ["    -1", "    58", f"{name} of blow {number + 1}", *["NONE"] * 4]
            lines.append(
                f"{1:5d}{number:10d}{0:5d}{0:10d} "
                f"{'NONE':<10}{1:10d}{3:4d} {'NONE':<10}{0:10d}{0:4d}"
            )
            lines.append(f"{4:10d}{TIME.size:10d}{1:10d}{0.0:13.5e}{1.0 / RATE:13.7E}{0.0:13.5e}")
            lines.append(f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':<20} {'s':<20}")
            lines.append(f"{code:10d}{0:5d}{0:5d}{0:5d} {name:<20} {unit:<20}")
            lines += [f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {'NONE':<20}"] * 2
            for row in values.reshape(-1, 4):
                lines.append("".join(f"{cell:20.11E}" for cell in row))
            lines.append("    -1")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


WRITTEN = {
    "taps.xlsx": (as_workbook, ("Tap 1", "Tap 2", "Tap 3")),
    "taps.tdms": (as_tdms, ("Tap 1", "Tap 2", "Tap 3")),
    "taps.lvm": (as_lvm, ("segment 1", "segment 2", "segment 3")),
    "array.mat": (as_structure_array, ("taps(1)", "taps(2)", "taps(3)")),
    "structures.mat": (as_structures, ("tap1", "tap2", "tap3")),
    "nested.mat": (as_structures_in_one, ("data.tap1", "data.tap2", "data.tap3")),
    "new.mat": (as_version_7_3, ("taps(1)", "taps(2)", "taps(3)")),
    "taps.uff": (as_universal, ("1", "2", "3")),
}


@pytest.fixture(params=WRITTEN, scope="module")
def file_and_names(request, tmp_path_factory):
    write, names = WRITTEN[request.param]
    return write(tmp_path_factory.mktemp("records") / request.param), names


def test_every_record_of_a_file_comes_back_in_si(file_and_names):
    path, names = file_and_names
    found = read_hammer_records(path)
    assert [one.name for one in found.records] == [f"{path.name}#{name}" for name in names]
    for record, (force, motion) in zip(found.records, BLOWS, strict=True):
        assert record.sampling_rate == pytest.approx(RATE, rel=1e-6)
        np.testing.assert_allclose(record.force, force, atol=1e-6)
        np.testing.assert_allclose(record.response, motion, atol=1e-6)


def test_one_record_is_named_or_numbered(file_and_names):
    path, names = file_and_names
    for record in (names[1], "2"):
        found = read_hammer_record(f"{path}#{record}")
        np.testing.assert_allclose(found.force, BLOWS[1][0], atol=1e-6)


def test_a_command_on_one_record_asks_which_and_says_how_it_is_named(file_and_names):
    path, names = file_and_names
    with pytest.raises(MeasurementError) as told:
        read_signal_table(path)
    assert str(told.value).startswith(f"{path}: holds 3 records: {', '.join(names)}; name one, ")
    assert f'"{path.name}#{names[0]}"' in str(told.value)


def test_what_is_not_there_is_told_beside_what_is(file_and_names):
    path, _ = file_and_names
    with pytest.raises(MeasurementError, match=r"there is no record 'tap 9'; it holds 3 records"):
        read_signal_table(path.with_name(f"{path.name}#tap 9"))
    with pytest.raises(MeasurementError, match=r"there is no record '4'"):
        read_signal_table(path.with_name(f"{path.name}#4"))


def test_modes_of_all_blows_in_a_file(file_and_names):
    path, names = file_and_names
    found = modes(path)
    (mode,) = found.summary()["modes"]
    assert mode["frequency_Hz"] == pytest.approx(FREQUENCY, rel=2e-3)
    assert mode["mass_kg"] == pytest.approx(MASS, rel=0.03)
    assert found.hammer.used == tuple(f"{path.name}#{name}" for name in names)


def test_files_of_several_records_stand_in_a_folder_with_others(tmp_path):
    as_structures(tmp_path / "tap.mat")
    force, motion = BLOWS[0]
    rows = "\n".join(
        f"{t:.9f},{f:.9f},{a:.9f}" for t, f, a in zip(TIME, force, motion, strict=True)
    )
    (tmp_path / "one.csv").write_text(f"time [s],force [N],acc [m/s^2]\n{rows}\n", encoding="utf-8")
    found = read_hammer_folder(tmp_path)
    names = ["one.csv", "tap.mat#tap1", "tap.mat#tap2", "tap.mat#tap3"]
    assert [one.name for one in found.records] == names


def test_a_format_of_one_record_has_no_other(tmp_path):
    path = tmp_path / "one.csv"
    path.write_text("time [s],force [N]\n0,1\n1,2\n", encoding="utf-8")
    with pytest.raises(MeasurementError, match=r"is one record; nothing in it is called 'two'"):
        read_signal_table(path.with_name("one.csv#two"))


def test_a_file_may_have_the_mark_in_its_name(tmp_path):
    path = tmp_path / "tap #2.csv"
    path.write_text("time [s],force [N]\n0,1\n1,2\n", encoding="utf-8")
    assert read_signals(path)["force"].tolist() == [1.0, 2.0]


def test_detection_in_one_record_of_a_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    time = np.arange(8192) / 8192.0
    # 4 teeth at 3000 rpm, in the cut for 40 % of the time; in the second sheet they cut the waves
    # of 731 Hz that chatter left
    in_cut = (200.0 * time) % 1.0 < 0.4
    noise = 0.02 * np.random.default_rng(4).standard_normal((2, time.size))
    stable = in_cut + noise[0]
    loud = in_cut * (1.0 + 3.0 * np.sin(2.0 * np.pi * 731.0 * time)) + noise[1]
    for name, values in {"quiet": stable, "loud": loud}.items():
        sheet = book.active if name == "quiet" else book.create_sheet()
        sheet.title = name
        sheet.append(["time [s]", "acceleration [m/s^2]"])
        for row in zip(time, values, strict=True):
            sheet.append([float(cell) for cell in row])
    book.save(tmp_path / "cuts.xlsx")
    found = {
        name: detect(tmp_path / f"cuts.xlsx#{name}", spindle_speed="3000 rpm", teeth=4)
        for name in ("quiet", "loud")
    }
    assert found["quiet"].verdict == "stable"
    assert found["loud"].verdict == "chatter"
    assert found["loud"].chatter_frequency == pytest.approx(731.0, rel=2e-3)


def test_signals_with_their_own_time_are_channels_of_one_record(tmp_path):
    force, motion = BLOWS[0]
    scipy.io.savemat(
        tmp_path / "a.mat",
        {
            "hammer": {"t": TIME, "y": force / 1e3, "unit": "kN"},
            "acc": {"t": TIME, "y": motion, "unit": "m/s^2"},
        },
    )
    record = read_hammer_record(tmp_path / "a.mat")
    np.testing.assert_allclose(record.force, force, atol=1e-6)
    np.testing.assert_allclose(record.response, motion, atol=1e-6)
    assert record.sampling_rate == pytest.approx(RATE, rel=1e-6)


def test_frfs_of_two_sheets_are_two(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for k, name in enumerate(("xx", "yy")):
        sheet = book.active if k == 0 else book.create_sheet()
        sheet.title = name
        sheet.append(["frequency [Hz]", f"real {name} [um/N]", f"imag {name} [um/N]"])
        for line in range(64):
            sheet.append([10.0 + line, 1.0 + k, -0.5 * line])
    book.save(tmp_path / "frf.xlsx")
    found = read_frfs(tmp_path / "frf.xlsx")
    assert [one.response.direction for one in found] == ["x", "y"]
    np.testing.assert_allclose(found[1].values, 1e-6 * (2.0 - 0.5j * np.arange(64)))
    (only,) = read_frfs(tmp_path / "frf.xlsx#yy")
    assert only.response.direction == "y"


def test_references_that_repeat_a_dataset_are_counted_each_time(tmp_path, monkeypatch):
    h5py = pytest.importorskip("h5py")
    from chatter.io.formats import named_arrays

    monkeypatch.setattr(named_arrays, "LARGEST_FILE", 2**20)
    path = tmp_path / "bomb.mat"
    with h5py.File(path, "w") as file:
        large = file.create_group("#refs#").create_dataset("a", data=np.zeros((1, 2**14)))
        cells = file.create_dataset("cells", (100, 1), dtype=h5py.ref_dtype)
        cells[:, 0] = [large.ref] * 100
    with pytest.raises(MeasurementError, match=r"unpacks to .* at most 1 MB"):
        read_signal_table(path)


def test_each_record_has_its_folder_of_results(tmp_path):
    path = as_structures(tmp_path / "tap.mat")
    assert stem_of(Path(f"{path}#tap1")) == "tap-tap1"
    assert stem_of(tmp_path / "tap.mat") == "tap"
    book = tmp_path / "cuts 1.xlsx"
    book.touch()
    assert stem_of(Path(f"{book}#Cut 2 / fast")) == "cuts 1-Cut-2-fast"


def test_the_name_of_a_record_may_have_a_stroke(tmp_path):
    path = as_tdms(tmp_path / "a.tdms", names="run/{}")
    np.testing.assert_allclose(read_hammer_record(f"{path}#run/2").force, BLOWS[1][0])


def test_vectors_of_a_cell_array_are_columns_without_a_unit(tmp_path):
    cells = np.empty((1, 3), dtype=object)
    cells[0, 0], cells[0, 1], cells[0, 2] = TIME, *BLOWS[0]
    scipy.io.savemat(tmp_path / "a.mat", {"data": cells})
    stated = "time [s], force [N], acceleration [m/s^2]"
    record = read_hammer_record(tmp_path / "a.mat", columns=stated)
    np.testing.assert_allclose(record.force, BLOWS[0][0], atol=1e-6)


def test_signals_of_other_times_are_no_record(tmp_path):
    force, motion = BLOWS[0]
    acceleration = {"t": TIME[::2], "y": motion[::2], "unit": "m/s^2"}
    signals = {"force": {"t": TIME, "y": force, "unit": "N"}, "acc": acceleration}
    scipy.io.savemat(tmp_path / "a.mat", signals)
    with pytest.raises(MeasurementError, match=r"acc has other times than the signals before it"):
        read_hammer_record(tmp_path / "a.mat")


def test_a_sheet_as_long_as_a_record_that_lacks_its_heading_is_named(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    path = as_workbook(tmp_path / "taps.xlsx")
    book = openpyxl.load_workbook(path)
    book["Tap 2"].delete_rows(1)
    book.save(path)
    with pytest.raises(MeasurementError, match=r"taps\.xlsx: sheet Tap 2: no heading with names"):
        read_hammer_records(path)


def test_an_array_of_too_many_structures_is_refused_and_not_left_out(tmp_path):
    elements = np.empty((1, 5000), dtype=[("force_N", object)])
    elements["force_N"] = 1.0
    scipy.io.savemat(tmp_path / "a.mat", {"taps": elements, "t_s": TIME, "force_N": BLOWS[0][0]})
    with pytest.raises(MeasurementError, match=r"taps has 5000 elements; at most 4096 are read"):
        read_signal_table(tmp_path / "a.mat")
