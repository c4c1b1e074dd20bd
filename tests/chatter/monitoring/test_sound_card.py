"""A sound card recorded and followed: the sound is made, the card is a stand-in for its driver."""

import sys
import threading
import types

import numpy as np
import pytest
import scipy.io.wavfile

from chatter.description.errors import InputError
from chatter.monitoring.follow import follow
from chatter.monitoring.sound_card import recorded
from tests.chatter.detection.made_recordings import RATE, chatter_line, clock, forced_cut, noise
from tests.command_line import chatter_command

REVOLUTION, TEETH, FREQUENCY = 50.0, 4, 1230.0


def sound():
    random, time = np.random.default_rng(2), clock(2.0)
    values = forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time)
    values += 4.0 * chatter_line(random, time, FREQUENCY, TEETH * REVOLUTION)
    return (1000.0 * values).astype("<i2")


def driver(values):
    """What is used of sounddevice, with an input that plays `values` and then is silent."""
    module = types.ModuleType("sounddevice")
    module.PortAudioError = type("PortAudioError", (Exception,), {})

    class RawInputStream:
        def __init__(self, samplerate, channels, device, dtype, latency):
            self.samplerate, self.channels = samplerate, channels
            self._at = 0

        def __enter__(self):
            return self

        def __exit__(self, *of_an_error):
            pass

        def read(self, count):
            if self._at >= len(values):
                threading.Event().wait(0.01)
                return b"", False
            self._at += count
            return values[self._at - count : self._at].tobytes(), False

    def query_devices(device, kind):
        if device not in (None, 1, "microphone"):
            raise ValueError(f"No input device matching {device!r}")
        assert kind == "input"
        return {"default_samplerate": RATE, "max_input_channels": 1}

    module.RawInputStream, module.query_devices = RawInputStream, query_devices
    return module


def test_what_is_heard_is_recorded_and_followed(tmp_path, monkeypatch):
    values = sound()
    monkeypatch.setitem(sys.modules, "sounddevice", driver(values))
    path = tmp_path / "cut.wav"
    with recorded(path, "microphone"):
        found = list(follow(path, "3000 rpm", TEETH, patience=0.5))
    assert found[-1].verdict == "chatter"
    assert found[-1].chatter_frequency == pytest.approx(FREQUENCY, rel=1e-3)
    rate, written = scipy.io.wavfile.read(path)  # its head has the length once it is closed
    assert rate == RATE
    np.testing.assert_array_equal(written, values)


def test_a_recording_is_not_written_over_and_inputs_are_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "sounddevice", driver(sound()))
    path = tmp_path / "cut.wav"
    path.write_bytes(b"a sound")
    with pytest.raises(InputError, match=r"cut\.wav: exists already"), recorded(path):
        pass
    assert path.read_bytes() == b"a sound"
    radio = recorded(tmp_path / "new.wav", "radio")
    with pytest.raises(InputError, match="No input device matching 'radio'"), radio:
        pass
    with pytest.raises(InputError, match="into a WAV file"), recorded(tmp_path / "new.csv"):
        pass


def test_without_the_package_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    options = ("--spindle-speed", "3000 rpm", "--follow", "--sound-card", "default")
    done = chatter_command("detect", tmp_path / "cut.wav", *options)
    assert done.exit_code == 2
    assert 'install "chatter[sound]"' in done.output
    assert not (tmp_path / "cut.wav").exists()
    done = chatter_command("detect", tmp_path / "cut.wav", "--sound-card", "default")
    assert done.exit_code == 2
    assert "--sound-card goes with --follow" in done.output
