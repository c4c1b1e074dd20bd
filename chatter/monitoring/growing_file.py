"""Samples of a file that is still being written: WAV or a table in text."""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.detection.spectral.recording import Recording
from chatter.io.formats.wav import full_scale
from chatter.monitoring.recording_file import is_tacho_name, read_recording

_WAV = (b"RIFF", b"RF64")
#: format tag and bits of a sample -> type of a number; 3 is floating point, 24 bits are the upper
#: three bytes of four
_NUMBERS = {
    **{(1, 8): "u1", (1, 16): "<i2", (1, 24): "<i4", (1, 32): "<i4"},
    **{(3, 32): "<f4", (3, 64): "<f8"},
}
#: tag of a format that names its own in an extension, and where
_EXTENSIBLE, _OWN_TAG = 0xFFFE, 24


class GrowingSound:
    """A WAV file that grows: whatever its header has as its length, samples go on to its end.

    InputError if it is of a kind that cannot be followed.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        with path.open("rb") as file:
            head = file.read(65536)
        chunks = _chunks(head)
        if not {b"fmt ", b"data"} <= chunks.keys():
            raise InputError(f"{path}: the head of the WAV file is not written yet")
        kind, data = chunks[b"fmt "], chunks[b"data"]
        tag, self._channels, rate = struct.unpack_from("<HHI", head, kind + 8)
        (bits,) = struct.unpack_from("<H", head, kind + 22)
        if tag == _EXTENSIBLE:
            (tag,) = struct.unpack_from("<H", head, kind + 8 + _OWN_TAG)
        if (tag, bits) not in _NUMBERS:
            raise InputError(f"{path}: WAV of {bits} bits a sample cannot be followed; 8 to 32")
        self._number = np.dtype(_NUMBERS[tag, bits])
        self._bytes = bits // 8
        self._at = data + 8
        names = tuple(f"sound {k + 1}" for k in range(self._channels))
        self.start = Recording(
            str(path), 1.0 / rate, names, ("sound",) * self._channels, np.zeros((256, len(names)))
        )

    def new_samples(self) -> Array:
        """Samples (n, k) that were written since the last call."""
        size = self._bytes * self._channels
        with self._path.open("rb") as file:
            file.seek(self._at)
            raw = file.read()
        whole = len(raw) // size * size
        self._at += whole
        numbers = np.frombuffer(raw[:whole], np.uint8).reshape(-1, self._bytes)
        missing = self._number.itemsize - self._bytes
        numbers = np.pad(numbers, ((0, 0), (missing, 0))).view(self._number)
        return full_scale(numbers).reshape(-1, self._channels)


def _chunks(head: bytes) -> dict[bytes, int]:
    """Where the chunks of a WAV file begin, by their names, up to that of the samples."""
    found, at = {}, 12
    while at + 8 <= len(head) and b"data" not in found:
        name, size = struct.unpack_from("<4sI", head, at)
        found[name] = at
        at += 8 + size + size % 2
    return found


class GrowingTable:
    """A table in text that grows by lines.

    InputError if what is there is no recording yet.
    """

    def __init__(
        self, path: Path, channels: Sequence[str] = (), sampling_rate: float | None = None
    ) -> None:
        self._path = path
        self.start = read_recording(path, channels, sampling_rate)
        text = path.read_text(encoding="utf-8", errors="replace")
        wanted = set(self.start.channels)
        headings = (_names(line) for line in text.splitlines())
        heading = next((names for names in headings if wanted <= set(names)), None)
        if heading is None:
            raise InputError(
                f"{path}: cannot be followed: it is no WAV file, and no line of text in it names "
                f"the columns {', '.join(self.start.channels)}"
            )
        self._columns = [heading.index(name) for name in self.start.channels]
        if self.start.tacho is not None:
            self._columns.append(next(k for k, name in enumerate(heading) if is_tacho_name(name)))
        self._at = 0
        self._rest = b""

    def new_samples(self) -> Array:
        """Samples (n, k) of the lines that were completed since the last call, the tacho last."""
        with self._path.open("rb") as file:
            file.seek(self._at)
            raw = file.read()
        self._at += len(raw)
        lines = (self._rest + raw).split(b"\n")
        self._rest = lines.pop()
        rows = [row for line in lines if (row := self._row(line.decode("utf-8", "replace")))]
        return np.array(rows, dtype=np.float64).reshape(-1, len(self._columns))

    def _row(self, line: str) -> list[float] | None:
        """Numbers of a line; None where it has none, as headings."""
        cells = _split(line)
        try:
            return [float(cells[k].replace(",", ".")) for k in self._columns]
        except (ValueError, IndexError):
            return None


def _names(line: str) -> list[str]:
    """Names of columns on a line, without their units."""
    cells = (one.strip().strip('"').lstrip("#% ") for one in _split(line))
    return [re.split(r"[\[(]", cell)[0].strip() for cell in cells]


def _split(line: str) -> list[str]:
    """Cells of a line."""
    for separator in (";", "\t", ","):
        if separator in line:
            return line.split(separator)
    return line.split()


def growing_file(
    path: Path, channels: Sequence[str] = (), sampling_rate: float | None = None
) -> GrowingSound | GrowingTable:
    """File that is still being written, by its content."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    with path.open("rb") as file:
        is_sound = file.read(4) in _WAV
    return GrowingSound(path) if is_sound else GrowingTable(path, channels, sampling_rate)
