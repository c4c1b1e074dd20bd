"""Sound as telephones record it: what PyAV encodes comes back, and what is none is refused."""

import sys

import av
import numpy as np
import pytest

import chatter
from chatter.io.formats.format_list import format_of
from dynamics.frf.container import MeasurementError
from tests.chatter.detection import made_recordings

RATE, TONE = 48000, 898.8
CODECS = {".m4a": "aac", ".mp3": "libmp3lame", ".opus": "libopus", ".flac": "flac"}


def read(path):
    return format_of(path, "signals").read_signals(path)


def encode(path, rows, codec, with_picture=False, rate=RATE):
    """Write channels (c, n) as sound, with a moving picture beside it if wanted."""
    rows = np.ascontiguousarray(rows, dtype=np.float32)
    with av.open(str(path), "w") as out:
        layout = "mono" if len(rows) == 1 else "stereo"
        if with_picture:
            picture = out.add_stream("mpeg4", rate=25)
            picture.width = picture.height = 64
            picture.pix_fmt = "yuv420p"
        track = out.add_stream(codec, rate=rate, layout=layout)
        if with_picture:
            frame = av.VideoFrame.from_ndarray(np.zeros((64, 64, 3), np.uint8), format="rgb24")
            out.mux([*picture.encode(frame), *picture.encode(None)])
        frame = av.AudioFrame.from_ndarray(rows, format="fltp", layout=layout)
        frame.sample_rate = rate
        context = track.codec_context
        pieces = av.AudioResampler(
            format=context.format, layout=layout, rate=rate, frame_size=context.frame_size or 1024
        )
        for piece in (*pieces.resample(frame), *pieces.resample(None)):
            out.mux(track.encode(piece))
        out.mux(track.encode(None))


def tones(seconds=2.0):
    """Two channels: a tone of half the full scale, and one of a fifth an octave higher."""
    time = np.arange(int(seconds * RATE)) / RATE
    return np.array([0.5 * np.sin(2 * np.pi * k * TONE * time) for k in (1, 2)]) * [[1.0], [0.4]]


def line_of(table, number):
    """Frequency and amplitude of a tone, by its share of a window of Hann in the middle."""
    values = table.numbers(number)[RATE // 2 : RATE + RATE // 2]
    assert table.numbers(0)[1] == pytest.approx(1.0 / RATE)
    spectrum = np.abs(np.fft.rfft(values * np.hanning(values.size)))
    peak = int(np.argmax(spectrum))
    around = slice(peak - 3, peak + 4)
    frequency = np.average(np.arange(spectrum.size)[around], weights=spectrum[around] ** 2)
    power = np.sum(spectrum[around] ** 2) / np.sum(np.hanning(values.size) ** 2)
    return frequency * RATE / values.size, np.sqrt(4.0 * power / values.size)


@pytest.mark.parametrize("extension", CODECS)
def test_tones_come_back_by_channel(tmp_path, extension):
    path = tmp_path / f"cut{extension}"
    encode(path, tones(), CODECS[extension])
    table = read(path)
    assert [one.name for one in table.columns] == ["time", "sound 1", "sound 2"]
    for number, (order, amplitude) in enumerate(((1, 0.5), (2, 0.2)), start=1):
        frequency, found = line_of(table, number)
        assert frequency == pytest.approx(order * TONE, abs=0.2)
        # what an encoder of few bits leaves of it
        assert found == pytest.approx(amplitude, rel=0.1)


@pytest.mark.parametrize("extension", [".m4a", ".opus"])
def test_chatter_is_heard_in_what_a_telephone_records(tmp_path, extension):
    """A line of 1230 Hz, twice as strong as the cut of four teeth at 3000 rpm, from 1 s on."""
    random, time = np.random.default_rng(1), made_recordings.clock(4.0)
    cut = made_recordings.forced_cut(random, time, 50.0, 4)
    line = made_recordings.chatter_line(random, time, 1230.0, 200.0)
    values = cut + 2.0 * made_recordings.during(time, 1.0, 4.0) * line
    values += made_recordings.noise(random, time)
    wanted = np.arange(int(4.0 * RATE)) / RATE
    sound = np.interp(wanted, time, values)
    path = tmp_path / f"cut{extension}"
    encode(path, 0.5 * sound[None, :] / np.abs(sound).max(), CODECS[extension])
    found = chatter.detect(path, "3000 rpm", 4)
    assert found.verdict == "chatter"
    assert found.chatter_frequency == pytest.approx(1230.0, rel=2e-3)
    begin = next(one.begin for one in found.segments if one.verdict == "chatter")
    assert begin == pytest.approx(1.0, abs=0.3)


def test_lossless_sound_is_exact(tmp_path):
    encode(tmp_path / "cut.flac", tones(0.5), "flac")
    values = read(tmp_path / "cut.flac").numbers(1)
    np.testing.assert_allclose(values[:20000], tones(0.5)[0, :20000], atol=2.0**-15)


def test_a_film_is_read_by_its_sound(tmp_path):
    encode(tmp_path / "cut.mp4", tones(), "aac", with_picture=True)
    assert line_of(read(tmp_path / "cut.mp4"), 1)[0] == pytest.approx(TONE, abs=0.2)


def test_the_content_tells_the_format_under_any_name(tmp_path):
    encode(tmp_path / "cut.mp3", tones(), "libmp3lame")
    (tmp_path / "cut.mp3").rename(tmp_path / "cut.m4a")
    assert line_of(read(tmp_path / "cut.m4a"), 1)[0] == pytest.approx(TONE, abs=0.2)


def test_what_was_cut_off_is_read_to_its_end(tmp_path):
    encode(tmp_path / "cut.mp3", tones(4.0), "libmp3lame")
    content = (tmp_path / "cut.mp3").read_bytes()
    (tmp_path / "cut.mp3").write_bytes(content[: len(content) // 2])
    assert 1.5 < read(tmp_path / "cut.mp3").numbers(0)[-1] < 2.5


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("extension", CODECS)
def test_damaged_sound_is_read_or_refused(tmp_path, extension, seed):
    path = tmp_path / f"cut{extension}"
    encode(path, tones(0.3), CODECS[extension])
    content, rng = bytearray(path.read_bytes()), np.random.default_rng(seed)
    for place in rng.integers(0, len(content), 40):
        content[place] = rng.integers(256)
    path.write_bytes(bytes(content[: rng.integers(20, len(content))]))
    try:
        assert np.all(np.isfinite(read(path).numbers(1)))
    except MeasurementError as error:
        refused = str(error)
    else:
        refused = str(path)
    assert str(path) in refused


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("cut.m4a", b"no sound at all"),
        ("cut.mp3", b"#EXTM3U\nfile:///etc/hostname\n"),
        ("cut.m4a", b"ffconcat version 1.0\nfile 'other.wav'\n"),
    ],
)
def test_what_is_no_sound_is_refused(tmp_path, name, content):
    """A list of other files is none: nothing but the file itself is read."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(MeasurementError, match=r"is no sound that can be read"):
        read(tmp_path / name)


def test_a_film_without_sound_is_refused(tmp_path):
    with av.open(str(tmp_path / "mute.mp4"), "w") as out:
        picture = out.add_stream("mpeg4", rate=25)
        picture.width = picture.height = 64
        frame = av.VideoFrame.from_ndarray(np.zeros((64, 64, 3), np.uint8), format="rgb24")
        out.mux([*picture.encode(frame), *picture.encode(None)])
    with pytest.raises(MeasurementError, match="holds no sound"):
        read(tmp_path / "mute.mp4")


def test_without_the_library_the_extra_is_named(tmp_path, monkeypatch):
    encode(tmp_path / "cut.mp3", tones(0.3), "libmp3lame")
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(MeasurementError, match=r"chatter\[sound\]"):
        read(tmp_path / "cut.mp3")
