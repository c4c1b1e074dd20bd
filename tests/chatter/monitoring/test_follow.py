"""Files that are still being written: what is followed is what was written."""

import itertools
import struct
import threading
import time as clock_time

import numpy as np
import pytest
import scipy.io.wavfile

from chatter.description.errors import InputError
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.running_detection import RunningDetection
from chatter.monitoring.detect import detect
from chatter.monitoring.follow import follow
from chatter.monitoring.growing_file import growing_file
from tests.chatter.detection.made_recordings import (
    RATE,
    chatter_line,
    clock,
    during,
    forced_cut,
    noise,
    ringing,
)
from tests.command_line import chatter_command

REVOLUTION, TEETH, FREQUENCY = 50.0, 4, 1230.0


def made(begin, seconds=4.0):
    random = np.random.default_rng(1)
    time = clock(seconds)
    values = forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time)
    chatter_part = chatter_line(random, time, FREQUENCY, TEETH * REVOLUTION)
    return 0.05 * (values + 4.0 * during(time, begin, seconds) * chatter_part)


def recorded(values):
    return Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])


def running(values, revolution=REVOLUTION):
    return RunningDetection(recorded(values[:256]), revolution, TEETH)


def test_a_verdict_every_revolution_and_chatter_within_the_window():
    values = made(2.0)
    found = running(values).take(values[:, None])
    times = [one.time for one in found]
    # the window of 24 revolutions is full at 0.48 s
    assert times[0] == pytest.approx(0.5, abs=1e-3)
    np.testing.assert_allclose(np.diff(times), 1.0 / REVOLUTION, rtol=1e-9)
    before = {one.verdict for one in found if one.time < 2.0}
    assert "chatter" not in before
    first = next(one for one in found if one.verdict == "chatter")
    assert 2.0 < first.time < 2.0 + 16.0 / REVOLUTION
    assert {one.verdict for one in found if one.time > first.time} == {"chatter"}
    assert found[-1].chatter_frequency == pytest.approx(FREQUENCY, rel=1e-3)


def observed_at(factor, begin):
    """Verdicts on a record that begins at a time, with the speed stated wrong by a factor."""
    values = made(begin)[:, None]
    found = running(values[:, 0], factor * REVOLUTION)
    return taken_in_time(found, values)


def taken_in_time(found, values):
    """Observations of samples that come no faster than windows are judged together."""
    observed = []
    for part in np.array_split(values, 40):
        observed += found.take(part)
        # the check goes on beside the verdicts: as long as it may take where samples come in time
        deadline = clock_time.monotonic() + 20.0
        while found.judges_together and clock_time.monotonic() < deadline:
            clock_time.sleep(0.005)
    return observed


@pytest.mark.parametrize("factor", [0.8, 1.2])
@pytest.mark.parametrize("begin", [0.0, 9.0])
def test_a_wrong_speed_is_told_beside_the_verdicts_and_nothing_is_stable_then(factor, begin):
    observed = observed_at(factor, begin)
    last = observed[-1]
    assert last.speed_is_refuted
    assert last.verdict != "stable"
    assert not observed[0].speed_is_refuted


@pytest.mark.parametrize("factor", [0.9, 0.94, 1.06, 1.1])
@pytest.mark.parametrize(("begin", "verdict"), [(0.0, "chatter"), (9.0, "stable")])
def test_a_speed_some_percent_off_is_read_off_the_lines(factor, begin, verdict):
    observed = observed_at(factor, begin)
    assert not observed[0].speed_is_corrected
    last = observed[-1]
    assert last.speed_is_corrected
    assert not last.speed_is_refuted
    assert last.spindle_frequency == pytest.approx(REVOLUTION, rel=2e-3)
    assert last.verdict == verdict
    if verdict == "chatter":
        assert last.chatter_frequency == pytest.approx(FREQUENCY, rel=1e-3)


def test_chatter_on_a_harmonic_of_the_stated_speed_is_called_once_its_windows_show_the_speed():
    # 24.6 revolutions of the true speed to a harmonic of that which is 9.8 % slower
    stated = FREQUENCY / round(FREQUENCY / (0.9 * REVOLUTION))
    values = made(1.0, 4.0)[:, None]
    found = running(values[:, 0], stated).take(values)  # beside no judgement of many windows
    first = next(one for one in found if one.verdict == "chatter")
    assert 1.0 < first.time < 1.0 + 60.0 / REVOLUTION
    assert first.spindle_frequency == pytest.approx(REVOLUTION, rel=5e-3)
    assert first.chatter_frequency == pytest.approx(FREQUENCY, rel=2e-3)


@pytest.mark.parametrize("factor", [1.016, 0.984])
def test_no_stable_cut_chatters_before_its_speed_is_read_off_the_lines(factor):
    for seconds in (1.0, 3.0):
        values = made(9.0, seconds)[:, None]
        found = running(values[:, 0], factor * REVOLUTION).take(values)
        assert "chatter" not in {one.verdict for one in found}


def test_a_stable_cut_after_chatter_is_not_idle():
    values = np.concatenate([made(9.0, 2.0), made(0.0, 2.0), made(9.0, 4.0)])
    observed = taken_in_time(running(values), values[:, None])
    assert {one.verdict for one in observed if 3.2 < one.time < 3.9} == {"chatter"}
    assert {one.verdict for one in observed if one.time > 5.5} == {"stable"}


def test_what_cannot_be_judged_together_is_not_called_stable():
    """A mode that noise shakes, as large as the cut: the whole of it is not judged."""
    random, time = np.random.default_rng(1), clock(4.0)
    values = forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time)
    values += 1.2 * ringing(random, time, FREQUENCY, 0.004)
    observed = taken_in_time(running(values), values[:, None])
    assert detect(recorded(values), 2.0 * np.pi * REVOLUTION, TEETH).segments[-1].verdict == (
        "not judged"
    )
    assert {one.verdict for one in observed if one.time > 3.0} == {"not judged"}


def test_the_right_speed_is_not_refuted():
    for begin in (0.0, 9.0):
        values = made(begin)[:, None]
        found = running(values[:, 0])
        observed = []
        for part in np.array_split(values, 40):
            observed += found.take(part)
            while found.judges_together:
                clock_time.sleep(0.005)
        assert not any(one.speed_is_refuted or one.speed_is_corrected for one in observed)
        assert observed[-1].verdict == ("chatter" if begin == 0.0 else "stable")


def test_the_parts_in_which_samples_come_do_not_matter():
    values = made(1.0, 2.0)[:, None]
    at_once = running(values[:, 0]).take(values)
    one_by_one = running(values[:, 0])
    edges = [0, 1, 700, 701, 9000, len(values)]
    in_parts = [
        found
        for low, high in itertools.pairwise(edges)
        for found in one_by_one.take(values[low:high])
    ]
    assert [one[:2] for one in in_parts] == [one[:2] for one in at_once]


def test_a_stable_cut_never_chatters():
    values = made(9.0)
    assert "chatter" not in {one.verdict for one in running(values).take(values[:, None])}


def test_a_sound_grows_whatever_its_header_has_as_its_length(tmp_path):
    values = (made(1.0) * 20000).astype("<i2")
    path = tmp_path / "cut.wav"
    scipy.io.wavfile.write(path, int(RATE), values)
    whole = bytearray(path.read_bytes())
    struct.pack_into("<I", whole, whole.find(b"data") + 4, 0)
    half = len(whole) // 2 | 1  # in the middle of a sample
    path.write_bytes(whole[:half])
    file = growing_file(path)
    parts = [file.new_samples()]
    path.write_bytes(whole)
    parts.append(file.new_samples())
    assert file.start.time_step == pytest.approx(1.0 / RATE)
    assert len(file.new_samples()) == 0
    np.testing.assert_allclose(np.concatenate(parts)[:, 0], values / 32768.0)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_grows_by_lines(tmp_path, separator):
    path = tmp_path / "cut.csv"
    lines = [separator.join(("time [s]", "temperature [degC]", "ax [m/s^2]"))]
    values = made(1.0)
    lines += [
        separator.join((f"{k / RATE:.5f}", "20", f"{one:.6f}")) for k, one in enumerate(values)
    ]
    text = "\n".join(lines) + "\n"
    head = text.index("\n", 20_000) - 3  # in the middle of a number
    path.write_text(text[: text.rindex("\n", 0, head) + 1], encoding="utf-8")
    file = growing_file(path)
    assert file.start.channels == ("ax",)
    path.write_text(text[:head], encoding="utf-8")
    parts = [file.new_samples()]
    path.write_text(text, encoding="utf-8")
    parts.append(file.new_samples())
    np.testing.assert_allclose(np.concatenate(parts)[:, 0], values, atol=1e-6)


def test_following_while_another_writes(tmp_path):
    values = made(1.5, 3.0)
    path = tmp_path / "cut.wav"
    scipy.io.wavfile.write(path, int(RATE), (values * 20000).astype("<i2"))
    whole = path.read_bytes()
    path.write_bytes(whole[:2000])

    def write():
        with path.open("ab") as file:
            for low in range(2000, len(whole), 4000):
                file.write(whole[low : low + 4000])
                file.flush()
                clock_time.sleep(0.005)

    writer = threading.Thread(target=write)
    writer.start()
    found = list(follow(path, "3000 rpm", TEETH, patience=1.0))
    writer.join()
    assert found[-1].time == pytest.approx(3.0, abs=1.0 / REVOLUTION + 1e-3)
    assert found[-1].verdict == "chatter"
    assert found[0].verdict == "stable"


def test_following_needs_a_speed(tmp_path):
    path = tmp_path / "cut.wav"
    scipy.io.wavfile.write(path, int(RATE), np.zeros(1000, dtype=np.int16))
    with pytest.raises(InputError, match="--follow needs --spindle-speed"):
        list(follow(path, None))
    done = chatter_command("detect", path, "--follow")
    assert done.exit_code == 2
    with pytest.raises(InputError, match=r"none\.wav: no such file"):
        list(follow(tmp_path / "none.wav", "3000 rpm"))


def test_a_sound_of_24_bits_grows_with_a_chunk_before_its_samples(tmp_path):
    whole_numbers = np.array([0, 1, -1, 8388607, -8388608, 4194304], dtype="<i4")
    samples = b"".join(int(one).to_bytes(3, "little", signed=True) for one in whole_numbers)
    note = b"data!!"  # no chunk of samples, though it is called so
    head = b"RIFF\0\0\0\0WAVE" + struct.pack("<4sIHHIIHH", b"fmt ", 16, 1, 2, 48000, 288000, 6, 24)
    head += struct.pack("<4sI", b"LIST", len(note)) + note + struct.pack("<4sI", b"data", 0)
    path = tmp_path / "cut.wav"
    path.write_bytes(head + samples[:8])
    file = growing_file(path)
    parts = [file.new_samples()]
    path.write_bytes(head + samples)
    parts.append(file.new_samples())
    expected = (whole_numbers / 2.0**23).reshape(-1, 2)
    np.testing.assert_array_equal(np.concatenate(parts), expected)
    assert file.start.channels == ("sound 1", "sound 2")


def test_what_does_not_grow_by_lines_is_refused(tmp_path):
    path = tmp_path / "cut.npz"
    np.savez(path, **{"time [s]": clock(1.0), "ax [m/s^2]": made(9.0, 1.0)})
    with pytest.raises(InputError, match=r"cut\.npz: cannot be followed"):
        growing_file(path)


def test_speed_and_teeth_of_the_case_are_followed(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(
        '[tool]\nkind = "end mill"\nteeth = 4\ndiameter = "20 mm"\n'
        '[material]\nlaw = "linear"\nKtc = "800 MPa"\nKrc = "300 MPa"\n'
        '[cut]\nmode = "down"\nspindle_speed = "3000 rpm"\nfeed_per_tooth = "0.1 mm"\n'
        'axial_depth = "1 mm"\nradial_depth = "10 mm"\n',
        encoding="utf-8",
    )
    path = tmp_path / "cut.wav"
    scipy.io.wavfile.write(path, int(RATE), (made(1.0, 2.0) * 20000).astype("<i2"))
    by_case = list(follow(path, patience=0.1, case=case))
    stated = list(follow(path, "3000 rpm", TEETH, patience=0.1))
    assert by_case[-1].verdict == "chatter"
    assert [one[:2] for one in by_case] == [one[:2] for one in stated]
