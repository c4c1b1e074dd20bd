"""Compressed sound, as telephones and cameras record it, decoded by PyAV (FFmpeg)."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from chatter.description.arrays import Array
from chatter.io.files import LARGEST_FILE, read_content
from chatter.io.formats.format import Format
from chatter.io.sensitivities import FULL_SCALE
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError

#: extension -> demultiplexer of FFmpeg: one that reads nothing but the file it is given
_CONTAINERS = {
    **dict.fromkeys((".m4a", ".mp4", ".mov", ".3gp"), "mov"),
    **dict.fromkeys((".ogg", ".oga", ".opus"), "ogg"),
    **dict.fromkeys((".webm", ".mkv", ".mka"), "matroska"),
    ".mp3": "mp3",
    ".flac": "flac",
    ".aac": "aac",
    ".amr": "amr",
    ".wma": "asf",
    ".caf": "caf",
}
#: what these begin with, and where
_BEGINNINGS = (
    (4, b"ftyp", "mov"),
    (0, b"OggS", "ogg"),
    (0, b"\x1a\x45\xdf\xa3", "matroska"),
    (0, b"ID3", "mp3"),
    (0, b"fLaC", "flac"),
    (0, b"#!AMR", "amr"),
    (0, b"\x30\x26\xb2\x75\x8e\x66\xcf\x11", "asf"),
    (0, b"caff", "caf"),
)


def read_sound(path: Path) -> Table:
    """Time and channels of the first sound track of a file, as a share of full scale.

    MeasurementError if PyAV is not installed, the file is none that it reads, holds no sound, or
    holds more than a file of its channels may.
    """
    try:
        import av
    except ImportError as error:
        raise MeasurementError(
            f'{path}: compressed sound is read with PyAV: install "chatter[sound]", or save it as '
            "WAV"
        ) from error
    content = read_content(path)
    container = _container(content[:64]) or _CONTAINERS.get(path.suffix.lower())
    try:
        with av.open(io.BytesIO(content), format=container) as opened:
            rate, values = _decoded(path, opened, av.AudioResampler)
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(
            f"{path}: is no sound that can be read: {getattr(error, 'strerror', None) or error}"
        ) from error
    if values.size == 0 or rate <= 0:
        raise MeasurementError(f"{path}: the file holds no samples of sound")
    columns = [Column("time [s]", np.arange(values.shape[1]) / rate)]
    columns += [Column(f"sound {k + 1}", row) for k, row in enumerate(values)]
    return table_of(path, columns, "channels")


def _decoded(path: Path, opened: Any, resampler: Callable[..., Any]) -> tuple[float, Array]:
    """Samples a second, and channels (c, n) of the first sound track."""
    if not opened.streams.audio:
        raise MeasurementError(f"{path}: the file holds no sound")
    # one row a channel, floating point, at the rate of the track
    as_rows = resampler(format="fltp")
    parts, size, rate = [], 0, 0.0
    for frame in _frames(opened):
        for one in as_rows.resample(frame):
            rate = float(one.sample_rate)
            parts.append(one.to_ndarray())
            size += parts[-1].nbytes
        if size > LARGEST_FILE // 2:
            raise MeasurementError(
                f"{path}: holds more than {LARGEST_FILE / 2 / 1024**2:.0f} MB of samples when "
                "decoded; cut it to the part that is wanted"
            )
    if not parts:
        return rate, np.empty((1, 0))
    return rate, np.concatenate(parts, axis=1, dtype=np.float64)


def _frames(opened: Any) -> Any:
    """Frames of the first sound track, up to where a file that was cut off ends."""
    import av

    frames = opened.decode(audio=0)
    found = False
    while True:
        try:
            frame = next(frames)
        except StopIteration:
            return
        except av.FFmpegError:
            if not found:
                raise
            return
        found = True
        yield frame


def _container(head: bytes) -> str | None:
    return next(
        (name for at, begins, name in _BEGINNINGS if head[at : at + len(begins)] == begins), None
    )


COMPRESSED_SOUND = Format(
    name="compressed sound",
    label="sound and video of telephones and recorders",
    help="the first sound track, its channels as a share of full scale; AAC, MP3, Opus, Vorbis, "
    'FLAC and others; needs "chatter[sound]"',
    extensions=tuple(_CONTAINERS),
    read_signals=read_sound,
    own_unit=FULL_SCALE,
    recognises=lambda head: _container(head) is not None,
)
