"""Tables in text as measuring programs export them: units on a line, rates above, words below."""

import numpy as np
import pytest

from chatter.io.formats.csv import read_table, read_with_headings
from chatter.io.formats.stated_rate import stated_step
from chatter.io.signals import read_signals
from chatter.monitoring.recording_file import read_recording
from dynamics.frf.container import MeasurementError

STEP, COUNT = 1e-4, 400
TIME = STEP * np.arange(COUNT)
FX, FY = np.sin(700.0 * TIME), 2.0 * np.cos(500.0 * TIME)


def rows(separator=",", *columns, decimal="."):
    columns = columns or (TIME, FX, FY)
    lines = [separator.join(f"{one:.9g}" for one in row) for row in zip(*columns, strict=True)]
    return "".join(f"{line.replace('.', decimal)}\n" for line in lines)


def written(folder, text, encoding="utf-8"):
    path = folder / "record.txt"
    path.write_bytes(text.encode(encoding))
    return path


def assert_read(table):
    assert [one.heading for one in table.columns] == ["time [s]", "Fx [N]", "Fy [N]"]
    for number, true in enumerate((TIME, FX, FY)):
        assert table.numbers(number) == pytest.approx(true, abs=1e-8)


@pytest.mark.parametrize(
    "units", ["[s]\t[N]\t[N]", "(s)\t(N)\t(N)", "s\tN\tN"], ids=["square", "round", "bare"]
)
def test_units_on_a_line_of_their_own(tmp_path, units):
    """As DynoWare has them, below its preamble."""
    preamble = "File name:\tC:\\cut7.dwd\nMeasuring time [s]:\t0.04\nSampling rate [Hz]:\t10000\n\n"
    text = f"{preamble}time\tFx\tFy\n{units}\n{rows(chr(9))}"
    assert_read(read_table(written(tmp_path, text)))


def test_names_below_a_line_that_is_no_heading_have_no_units_of_it(tmp_path):
    """As oscilloscopes have them: the line above the names says what the axis is of."""
    text = f"Vertical Units,V,V\nTIME,CH1,CH2\n{rows()}"
    table = read_table(written(tmp_path, text))
    assert [one.heading for one in table.columns] == ["TIME", "CH1", "CH2"]


@pytest.mark.parametrize(
    "line",
    [
        "Sampling rate: 10000 Hz",
        "Sampling rate [Hz]:\t10000",
        "Sample Rate [kHz],10",
        "Abtastrate;10000;Hz",
        "Abtastfrequenz: 10,0 kHz",
        "Sampling frequency (Hz)=10000",
        "# SampleRate: 10000",
        "fs\t10 kS/s",
        '"Sample rate","10000"',
        "Delta T,0.0001,s",
        "Sample interval: 100 us",
    ],
)
def test_a_rate_above_the_table_is_that_of_its_rows(tmp_path, line):
    text = f"Machine;DMU 50\n{line}\n\nFx [N];Fy [N]\n{rows(';', FX, FY)}"
    assert_read(read_table(written(tmp_path, text)))


@pytest.mark.parametrize(
    "lines",
    [
        ["Sampling rate: 10,000 Hz"],  # ten or ten thousand
        ["Measuring time [s]: 2.0"],
        ["Delta T: 0.0001"],
        ["Sampling rate: 10000 rpm"],
        ["Sampling rate: 0 Hz"],
        ["Sampling rate: 10000 Hz", "Sampling rate: 20000 Hz"],
    ],
)
def test_what_states_no_rate_beyond_doubt_states_none(lines):
    assert stated_step(lines) is None


def test_a_table_over_frequency_gets_no_time(tmp_path):
    text = f"Sampling rate: 10000 Hz\nfrequency [Hz];a [m/s^2]\n{rows(';', TIME, FX)}"
    table = read_table(written(tmp_path, text))
    assert [one.heading for one in table.columns] == ["frequency [Hz]", "a [m/s^2]"]


def test_a_rate_above_rows_whose_headings_are_stated(tmp_path):
    path = written(tmp_path, f"Sampling rate: 10000 Hz\n{rows(' ', FX, FY)}")
    assert_read(read_with_headings(path, ["Fx [N]", "Fy [N]"]))


def test_words_below_the_last_row_end_it(tmp_path):
    path = written(tmp_path, f"time [s],Fx [N],Fy [N]\n{rows()}\nEnd of data\n")
    assert_read(read_table(path))
    path = written(tmp_path, f"time [s],Fx [N],Fy [N]\n{rows()}0.04,1.0\nEnd of data\n")
    with pytest.raises(MeasurementError, match="has 2 columns"):
        read_table(path)


def test_a_date_beside_the_time_of_day(tmp_path):
    stamps = [f"2024/03/05,10:23:{59.9999 if k < 1 else 0.0001 * (k - 1):07.4f}" for k in range(3)]
    stamps[1:] = [one.replace("10:23", "10:24") for one in stamps[1:]]
    text = "Date,Time,Fx [N]\n" + "".join(f"{one},{k}\n" for k, one in enumerate(stamps))
    table = read_table(written(tmp_path, text))
    assert [one.heading for one in table.columns] == ["time [s]", "Fx [N]"]
    assert table.numbers(0) == pytest.approx([0.0, 1e-4, 2e-4], abs=1e-9)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_two_bytes_a_letter_with_and_without_a_mark(tmp_path, encoding):
    assert_read(read_table(written(tmp_path, f"time [s],Fx [N],Fy [N]\n{rows()}", encoding)))


def test_channels_of_one_name_are_not_one_channel(tmp_path):
    path = written(tmp_path, f"time [s],F [N],F [N]\n{rows()}")
    recording = read_recording(path)
    assert recording.channels == ("F", "F 3")
    assert recording.values[:, 0] == pytest.approx(FX, abs=1e-8)
    assert recording.values[:, 1] == pytest.approx(FY, abs=1e-8)


def test_the_time_of_catman_is_one(tmp_path):
    path = written(tmp_path, f"Time  1 - default sample rate\tFx\ns\tN\n{rows(chr(9), TIME, FX)}")
    assert read_recording(path).time_step == pytest.approx(STEP)


@pytest.mark.parametrize("heading", ["Zeit [s],Fx [N],Fy [N]", "Zeit / s,Fx / N,Fy / N"])
def test_the_time_of_a_measurement_in_german(tmp_path, heading):
    found = read_signals(written(tmp_path, f"{heading}\n{rows()}"), "milling")
    assert list(found) == ["time", "Fx", "Fy"]
    assert found["time"] == pytest.approx(TIME, abs=1e-8)


def test_numbers_of_rows_without_a_name_are_passed_over(tmp_path):
    path = written(tmp_path, f",time [s],Fx [N]\n{rows(',', np.arange(COUNT), TIME, FX)}")
    found = read_signals(path, "milling")
    assert list(found) == ["time", "Fx"]
    assert found["Fx"] == pytest.approx(FX, abs=1e-8)
