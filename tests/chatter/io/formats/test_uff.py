"""FRFs from universal files: text and binary, units, senses, and every way to be wrong."""

import gc
import struct

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.io.formats.format_list import read_frfs
from chatter.monitoring.recording_file import read_recording
from dynamics.frf.container import MeasurementError, Point
from tests.places import DATA, EXAMPLES

BEAM = DATA / "frf-beam"

VALUES = np.array([1.5 - 2.5j, -3.25 + 0.5j, 4.0 + 8.0j, 0.125 - 1e-3j, 2e-5 + 0j])
START, STEP = 10.0, 2.5
TIME_STEP = 2.5e-3
FREQUENCY = START + STEP * np.arange(VALUES.size)


def axis(code, unit="NONE"):
    return f"{code:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {unit:<20s}"


def heading(
    kind=6,
    count=VALUES.size,
    even=True,
    function=4,
    response=(7, 1),
    reference=(7, 1),
    abscissa=(18,),
    numerator=(12,),
    denominator=(13,),
    step=STEP,
):
    return [
        *["test", "NONE", "NONE", "NONE", "NONE"],
        f"{function:5d}{0:10d}{0:5d}{0:10d} {'NONE':<10s}{response[0]:10d}{response[1]:4d}"
        f" {'NONE':<10s}{reference[0]:10d}{reference[1]:4d}",
        f"{kind:10d}{count:10d}{int(even):10d}{START if even else 0:13.5E}"
        f"{step if even else 0:13.5E}{0:13.5E}",
        axis(*abscissa),
        axis(*numerator),
        axis(*denominator),
        axis(0),
    ]


def numbers(values, even, frequency=FREQUENCY):
    columns = [] if even else [frequency]
    columns += [values.real, values.imag] if np.iscomplexobj(values) else [values]
    return np.stack(columns, axis=1)


def text_dataset(values=VALUES, even=True, kind=6, **fields):
    table = numbers(values, even)
    width = (0 if even else 1, 20 if kind in (4, 6) else 13)
    cells = []
    for row in table:
        for place, number in enumerate(row):
            is_abscissa = place < width[0]
            cells.append(f"{number:13.5E}" if is_abscissa or width[1] == 13 else f"{number:20.11E}")
    per_line = {(4, True): 4, (6, True): 4, (4, False): 4, (6, False): 3}.get((kind, even), 6)
    body = ["".join(cells[i : i + per_line]) for i in range(0, len(cells), per_line)]
    fields = {"kind": kind, "even": even, "count": len(values), **fields}
    return "\n".join(["    -1", "    58", *heading(**fields), *body, "    -1", ""]).encode()


def binary_dataset(order=1, kind=6, even=True, *, abscissa_size=4, declared=None, **fields):
    size = 8 if kind in (4, 6) else 4
    mark = "<" if order == 1 else ">"
    table = numbers(VALUES, even)
    letters = {4: "f", 8: "d"}
    layout = mark + ("" if even else letters[abscissa_size]) + 2 * letters[size]
    payload = b"".join(struct.pack(layout, *row) for row in table)
    declared = len(payload) if declared is None else declared
    first = f"    58b{order:6d}{2:6d}{11:12d}{declared:12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    text = "\n".join(["    -1", first, *heading(kind=kind, even=even, **fields), ""]).encode()
    return text + payload + b"    -1\n"


def write(folder, *datasets, name="frf.uff"):
    path = folder / name
    path.write_bytes(b"".join(datasets))
    return path


def units_dataset(length, force):
    return (
        (
            f"    -1\n   164\n{9:10d}{'user':>20s}{1:10d}\n"
            f"{length:25.16E}{force:25.16E}{1.0:25.16E}\n{0.0:25.16E}\n    -1\n"
        )
        .replace("E+", "D+")
        .encode()
    )


OTHER = b"    -1\n   151\nmodel\nNONE\nNONE\nNONE\n    -1\n    -1\n    15\n         1\n    -1\n"


def only(path):
    (frf,) = read_frfs(path)
    return frf


def test_the_beam_equals_its_tables():
    frfs = read_frfs(EXAMPLES / "flexible-workpiece" / "beam.uff")
    assert len(frfs) == 3
    for number, frf in enumerate(frfs, start=1):
        (table,) = read_frfs(BEAM / f"point_{number}.csv")
        assert frf.quantity == table.quantity == "accelerance"
        assert frf.response == Point("1", "x")
        assert frf.reference == Point(str(number), "x")
        np.testing.assert_array_equal(frf.frequency, table.frequency)
        # the table is printed with ten digits
        np.testing.assert_allclose(frf.values, table.values, rtol=1e-8)


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize(("kind", "digits"), [(5, 1e-5), (6, 1e-11)])
def test_text_precisions_and_spacings(tmp_path, kind, digits, even):
    frf = only(write(tmp_path, text_dataset(kind=kind, even=even)))
    np.testing.assert_allclose(frf.frequency, FREQUENCY, rtol=1e-6)
    np.testing.assert_allclose(frf.values, VALUES, rtol=digits)
    assert frf.quantity == "accelerance"


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize(("kind", "digits"), [(5, 1e-6), (6, 1e-15)])
def test_binary_precisions_spacings_and_byte_orders(tmp_path, order, kind, digits, even):
    frf = only(write(tmp_path, binary_dataset(order, kind, even)))
    np.testing.assert_allclose(frf.frequency, FREQUENCY, rtol=1e-6)
    np.testing.assert_allclose(frf.values, VALUES, rtol=digits, atol=1e-12)


def test_binary_with_all_numbers_double_and_a_wrong_byte_count(tmp_path):
    # some writers do so; the numbers end where the closing line stands
    path = write(tmp_path, binary_dataset(even=False, abscissa_size=8, declared=40), text_dataset())
    first, second = read_frfs(path)
    np.testing.assert_array_equal(first.values, VALUES)
    np.testing.assert_allclose(second.values, VALUES, rtol=1e-11)


def test_other_datasets_and_functions_are_passed_over(tmp_path):
    time = text_dataset(np.arange(3.0), kind=4, function=1, abscissa=(17,), denominator=(0,))
    path = write(tmp_path, OTHER, time, text_dataset(), name="frf.unv")
    assert only(path).values.size == VALUES.size


def test_the_content_tells_the_format_whatever_the_suffix(tmp_path):
    assert only(write(tmp_path, text_dataset(), name="frf.csv")).quantity == "accelerance"


def test_a_stray_line_of_minus_one(tmp_path):
    assert only(write(tmp_path, b"    -1\n", text_dataset())).values.size == VALUES.size


def test_carriage_returns(tmp_path):
    path = write(tmp_path, text_dataset().replace(b"\n", b"\r\n"))
    np.testing.assert_allclose(only(path).values, VALUES, rtol=1e-11)


@pytest.mark.parametrize(
    ("code", "quantity"), [(8, "receptance"), (11, "mobility"), (12, "accelerance")]
)
def test_data_types_tell_the_quantity(tmp_path, code, quantity):
    assert only(write(tmp_path, text_dataset(numerator=(code,)))).quantity == quantity


def test_units_dataset_scales_by_division(tmp_path):
    # a file in mm and mN: factors 1000 and 1000; 1 mm/s^2 per mN is 1 m/s^2 per N
    path = write(tmp_path, units_dataset(1000.0, 1000.0), text_dataset())
    np.testing.assert_allclose(only(path).values, VALUES, rtol=1e-11)
    path = write(tmp_path, units_dataset(1000.0, 1.0), text_dataset())
    np.testing.assert_allclose(only(path).values, VALUES / 1000.0, rtol=1e-11)


@pytest.mark.parametrize(
    ("numerator", "denominator", "quantity", "factor"),
    [
        ((12, "g"), (13, "N"), "accelerance", 9.80665),
        ((1, "mm"), (1, "kN"), "receptance", 1e-6),
        ((0, "um/N"), (0,), "receptance", 1e-6),
        ((12, "g/N"), (13,), "accelerance", 9.80665),
        ((11, "in/s"), (13, "lbf"), "mobility", 0.0254 / 4.4482216152605),
    ],
)
def test_axis_labels_hold_over_the_units_dataset(
    tmp_path, numerator, denominator, quantity, factor
):
    dataset = text_dataset(numerator=numerator, denominator=denominator)
    frf = only(write(tmp_path, units_dataset(1.0, 1.0), dataset))
    assert frf.quantity == quantity
    np.testing.assert_allclose(frf.values, factor * VALUES, rtol=1e-10)


def test_nodes_directions_and_senses(tmp_path):
    frf = only(write(tmp_path, text_dataset(response=(12, -2), reference=(3, 3))))
    assert frf.response == Point("12", "y", -1)
    assert frf.reference == Point("3", "z", 1)
    scalar = only(write(tmp_path, text_dataset(response=(0, 0), reference=(0, 0))))
    assert scalar.response == Point()


def test_coherence_joins_its_function(tmp_path):
    coherence = np.linspace(0.5, 1.0, VALUES.size)
    path = write(
        tmp_path,
        text_dataset(response=(2, 1)),
        text_dataset(),
        text_dataset(coherence, kind=4, function=6, numerator=(0,), denominator=(0,)),
    )
    elsewhere, here = read_frfs(path)
    assert elsewhere.coherence is None
    np.testing.assert_allclose(here.coherence, coherence)


def cut(dataset, start, stop):
    return dataset[:start] + dataset[stop:]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"    -1\n    58\n", "cut short"),
        (text_dataset()[:-40], "cut short"),
        (text_dataset(count=99), "10 numbers where its heading promises 198"),
        (text_dataset(count=2), "10 numbers where its heading promises 4"),
        (text_dataset(count=9999999999), "promises 19999999998"),
        (text_dataset(count=-5), "promises -10"),
        (text_dataset().replace(b"1.5", b"x.5", 1), "x.5"),
        (text_dataset().replace(b"1.50000000000E+00", b"              NaN", 1), "value 1 is not"),
        (text_dataset(kind=3), "data type 3"),
        (text_dataset(VALUES.real, kind=4), "phase is missing"),
        (text_dataset(numerator=(0,)), "neither unit labels nor data types"),
        (text_dataset(denominator=(0,)), "neither unit labels nor data types"),
        (text_dataset(numerator=(13,), denominator=(12,)), "neither unit labels nor data types"),
        (text_dataset(numerator=(12, "volts")), "'volts'"),
        (text_dataset(numerator=(12, "mm")), "marked as acceleration but its unit is 'mm'"),
        (text_dataset(abscissa=(17,)), "abscissa is a time"),
        (text_dataset(response=(1, 4)), "no frequency response.*rotation"),
        (text_dataset(np.arange(3.0), kind=4, function=1), "1 x time response"),
        (OTHER, "1 x dataset 151, 1 x dataset 15"),
        (text_dataset().replace(b"    4         0", b"   xx         0"), "records 6 to 11"),
        (b"    -1\n    58\na\nb\n    -1\n", "fewer than 11"),
        (units_dataset(0.0, 1.0) + text_dataset(), "164.*positive"),
        (binary_dataset().replace(b"58b     1     2", b"58b     1     1"), "binary layout"),
        (binary_dataset(count=77), "80 bytes of numbers"),
        (b"    -1\nnot a number\n    -1\n", "dataset number"),
    ],
)
def test_wrong_files_are_refused(tmp_path, content, said):
    with pytest.raises(MeasurementError, match=f"(?s)frf.uff.*{said}"):
        read_frfs(write(tmp_path, content))


def test_a_text_that_is_no_universal_file(tmp_path):
    with pytest.raises(MeasurementError, match="no dataset"):
        read_frfs(write(tmp_path, b"frequency [Hz],real [m/N]\n"))


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.filterwarnings("ignore::ResourceWarning")  # it leaves its files open
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("even", [0, 1])
def test_files_of_another_writer(tmp_path, binary, even):
    pyuff = pytest.importorskip("pyuff")
    path = tmp_path / "other.uff"
    dataset = {
        "type": 58,
        "binary": binary,
        "func_type": 4,
        "rsp_node": 4,
        "rsp_dir": -3,
        "ref_node": 2,
        "ref_dir": 1,
        "data": VALUES,
        "x": FREQUENCY,
        "id1": "one",
        "abscissa_spacing": even,
        "abscissa_spec_data_type": 18,
        "ordinate_spec_data_type": 8,
        "orddenom_spec_data_type": 13,
        "ordinate_axis_units_lab": "mm",
        "orddenom_axis_units_lab": "N",
    }
    pyuff.UFF(str(path)).write_sets([dataset, dataset], mode="add")
    gc.collect()
    frfs = read_frfs(path)
    assert len(frfs) == 2
    for frf in frfs:
        assert frf.quantity == "receptance"
        assert (frf.response, frf.reference) == (Point("4", "z", -1), Point("2", "x"))
        np.testing.assert_allclose(frf.frequency, FREQUENCY, rtol=1e-5)
        np.testing.assert_allclose(frf.values, 1e-3 * VALUES, rtol=1e-10)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.filterwarnings("ignore::ResourceWarning")  # it leaves its files open
@pytest.mark.parametrize("encoding", ["utf-8", "cp1252"])
@pytest.mark.parametrize(
    ("numerator", "denominator", "factor"),
    [("m/s²", "N", 1.0), ("mm/s²", "N", 1e-3), ("(1/N)*(m/s²)", "", 1.0), ("g", "N", 9.80665)],
)
def test_headings_that_are_no_ascii(tmp_path, encoding, numerator, denominator, factor):
    pyuff = pytest.importorskip("pyuff")
    path = tmp_path / "other.uff"
    dataset = {
        "type": 58,
        "binary": 0,
        "func_type": 4,
        "rsp_node": 4,
        "rsp_dir": 1,
        "ref_node": 4,
        "ref_dir": 1,
        "data": VALUES,
        "x": FREQUENCY,
        "id1": "Fräser, Länge 40 µm",
        "rsp_ent_name": "Fräser",
        "abscissa_spacing": 1,
        "abscissa_spec_data_type": 18,
        "ordinate_spec_data_type": 12,
        "orddenom_spec_data_type": 13,
        "ordinate_axis_units_lab": numerator,
        "orddenom_axis_units_lab": denominator,
    }
    pyuff.UFF(str(path)).write_sets(dataset, mode="overwrite")
    gc.collect()
    path.write_bytes(path.read_bytes().decode("utf-8").encode(encoding))
    (frf,) = read_frfs(path)
    assert frf.quantity == "accelerance"
    np.testing.assert_allclose(frf.values, factor * VALUES, rtol=1e-10)


@pytest.mark.parametrize(("unit", "quantity"), [("Pa", "sound"), ("V", "unknown"), ("m/s2", None)])
def test_sounds_and_voltages_are_time_records(tmp_path, unit, quantity):
    pressure = np.sin(np.arange(400.0))
    fields = {"kind": 4, "function": 1, "abscissa": (17, "(Sec)"), "denominator": (0,)}
    fields["step"] = TIME_STEP
    dataset = text_dataset(pressure, numerator=(15 if unit == "Pa" else 0, unit), **fields)
    path = write(tmp_path, dataset)
    recording = read_recording(path)
    assert recording.time_step == pytest.approx(TIME_STEP)
    assert recording.quantities == (quantity or "acceleration",)
    np.testing.assert_allclose(recording.values[:, 0], pressure, atol=1e-10)


def test_a_time_record_of_an_unknown_unit_or_another_than_its_type_is_refused(tmp_path):
    fields = {"kind": 4, "function": 1, "abscissa": (17,), "denominator": (0,)}
    for numerator, said in (((0, "furlong/x"), "not understood"), ((12, "Pa"), "'Pa' is none of")):
        path = write(tmp_path, text_dataset(np.arange(400.0), numerator=numerator, **fields))
        with pytest.raises(InputError, match=said):
            read_recording(path)


def test_numbers_without_blanks_between_them_and_records_of_rotations(tmp_path):
    """Fields of 13 columns, as the standard has them: a sign may stand right behind a number."""
    values = -np.linspace(1.0, 2.0, 300)
    fields = {"abscissa": (17,), "denominator": (0,), "step": TIME_STEP}
    lines = heading(2, values.size, True, 1, **fields)
    rows = ["".join(f"{one:13.6E}" for one in values[k : k + 6]) for k in range(0, 300, 6)]
    assert "E+00-" in rows[0]
    text = "\n".join(["    -1", "    58", *lines, *rows, "    -1", ""])
    path = write(tmp_path, text.encode())
    np.testing.assert_allclose(read_recording(path).values[:, 0], values, atol=1e-6)
    lines = heading(2, values.size, True, 1, (7, 6), **fields)
    text = "\n".join(["    -1", "    58", *lines, *rows, "    -1", ""])
    with pytest.raises(InputError, match="time response of a rotation"):
        read_recording(write(tmp_path, text.encode()))
