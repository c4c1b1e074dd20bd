"""WAV files: what is written by the standard library and by scipy comes back."""

import struct
import wave

import numpy as np
import pytest
import scipy.io.wavfile

from chatter.io.formats.format_list import format_of
from dynamics.frf.container import MeasurementError

RATE = 8000


def read(path):
    return format_of(path, "signals").read_signals(path)


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_pcm_of_every_width_is_a_share_of_full_scale(tmp_path, width):
    path = tmp_path / "a.wav"
    left, right = np.array([0.0, 0.5, -0.5, 0.25]), np.array([-0.25, 0.0, 0.75, -1.0])
    scale = 2 ** (8 * width - 1)
    raw = b""
    for pair in zip(left, right, strict=True):
        for value in pair:
            number = int(value * scale) + (128 if width == 1 else 0)
            raw += number.to_bytes(width, "little", signed=width > 1)
    with wave.open(str(path), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(width)
        file.setframerate(RATE)
        file.writeframes(raw)
    table = read(path)
    assert [one.name for one in table.columns] == ["time", "sound 1", "sound 2"]
    np.testing.assert_allclose(table.numbers(0), np.arange(4) / RATE)
    np.testing.assert_allclose(table.numbers(1), left)
    np.testing.assert_allclose(table.numbers(2), right)


def test_floating_point_is_as_it_is_whatever_the_extension(tmp_path):
    path = tmp_path / "recording.dat"
    values = np.array([0.1, -2.5, 3.0], dtype=np.float32)
    scipy.io.wavfile.write(path.with_suffix(".wav"), RATE, values)
    path.with_suffix(".wav").rename(path)
    np.testing.assert_allclose(read(path).numbers(1), values)


def test_a_broken_file_is_refused_by_name(tmp_path):
    path = tmp_path / "broken.wav"
    path.write_bytes(b"RIFF" + struct.pack("<I", 36) + b"WAVEfmt ")
    with pytest.raises(MeasurementError, match=r"broken\.wav: is no WAV file that can be read"):
        read(path)
