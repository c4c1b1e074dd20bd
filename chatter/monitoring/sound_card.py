"""A sound card recorded into a WAV file, which can be followed while it grows."""

from __future__ import annotations

import threading
import wave
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from chatter.description.errors import InputError

#: s of sound that are written at once: a small part of a revolution
_BLOCK = 0.005
_BYTES_OF_A_SAMPLE = 2
#: most channels that are recorded
_CHANNELS = 2
#: name of the input that the computer has as its own
DEFAULT = "default"


@contextmanager
def recorded(
    path: str | Path, device: str = DEFAULT, sampling_rate: float | None = None
) -> Iterator[None]:
    """Record a sound card into a new WAV file, 16 bits a sample, as long as the context lasts.

    Parameters
    ----------
    path : path
        WAV file that is not there yet.
    device : str
        Name of the input or a part of it, or its number; "default".
    sampling_rate : float, optional
        Hz; by default that of the input.

    Raises
    ------
    InputError
        If sounddevice or its library PortAudio is not installed, there is no such input, the file
        exists, or the recording breaks off.
    """
    path = Path(path)
    if path.suffix.lower() != ".wav":
        raise InputError(
            f"{path}: a sound card is recorded into a WAV file; name one, such as cut.wav"
        )
    stream = _stream(device, sampling_rate)
    ended = threading.Event()
    failures: list[Exception] = []
    try:
        with _new_file(path) as file, wave.open(file, "wb") as sound, stream:
            sound.setnchannels(stream.channels)
            sound.setsampwidth(_BYTES_OF_A_SAMPLE)
            sound.setframerate(round(stream.samplerate))
            sound.writeframesraw(b"")  # its head, before the first sample
            file.flush()

            def write() -> None:
                try:
                    while not ended.is_set():
                        block, _ = stream.read(round(_BLOCK * stream.samplerate))
                        sound.writeframesraw(bytes(block))
                        file.flush()
                except Exception as error:  # whatever the sound card raises in a thread
                    failures.append(error)

            writer = threading.Thread(target=write, daemon=True)
            writer.start()
            try:
                yield
            finally:
                ended.set()
                writer.join()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error
    if failures:
        raise InputError(f"{path}: the sound card broke off: {failures[0]}") from failures[0]


def _new_file(path: Path) -> Any:
    try:
        return path.open("xb")
    except FileExistsError:
        raise InputError(
            f"{path}: exists already; a sound card is recorded into a new file"
        ) from None


def _stream(device: str, sampling_rate: float | None) -> Any:
    """Input of the sound card, opened."""
    try:
        import sounddevice
    except ImportError as error:
        raise InputError(
            'a sound card is read with sounddevice: install "chatter[sound]"'
        ) from error
    except OSError as error:  # the package is there, its library is not
        raise InputError(
            f"a sound card is read with PortAudio, a library of the system: {error}"
        ) from error
    wanted = None if device == DEFAULT else int(device) if device.isdigit() else device
    try:
        found = sounddevice.query_devices(wanted, "input")
        return sounddevice.RawInputStream(
            samplerate=sampling_rate or found["default_samplerate"],
            channels=min(_CHANNELS, found["max_input_channels"]),
            device=wanted,
            dtype="int16",
            latency="low",
        )
    except (ValueError, sounddevice.PortAudioError) as error:
        raise InputError(f'--sound-card "{device}": {error}') from error
