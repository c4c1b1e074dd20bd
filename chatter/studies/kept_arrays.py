"""Arrays of finished predictions, kept on disk, so that a search that was killed goes on.

A search that learns from thousands of predictions takes the same way again where it finds them, and
ends with the same bytes. Every run of the program appends to a file of its own, so that several may
run in one folder; a record that was cut off by a kill, or does not match its checksum, counts as
not made.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import struct
import time
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import RunError

Arrays = Mapping[str, NDArray]

#: below the result cache
FOLDER = "predictions"
#: bytes kept at the most, and share of what the disk has left
_MOST_BYTES, _SHARE_OF_DISK = 1 << 30, 0.25
#: files of a search that nobody went on with are kept this long, s
_KEEP_OTHERS = 30 * 86400.0
#: marks a record; it is followed by key, checksum and size of the content
_MARK = b"ka2\n"
_HEADER = struct.Struct("<4s16sIQ")


class _Place(NamedTuple):
    """Where a record lies."""

    path: Path
    offset: int
    size: int
    checksum: int


class KeptArrays:
    """Named arrays by key, on disk where a folder is given, else nowhere.

    Parameters
    ----------
    folder : path, optional
        Of the results; the arrays lie below its result cache.
    inputs : str
        What all records depend on: those of other inputs are not seen.
    """

    def __init__(self, folder: str | Path | None, *inputs: str) -> None:
        self.path = None if folder is None else Path(folder) / "result-cache" / FOLDER
        self._base = _digest("\0".join(inputs).encode())
        self._own: Path | None = None
        self._lock = Lock()
        self._places: dict[bytes, _Place] = {}
        self._left = _MOST_BYTES
        if self.path is not None:
            self._look_around()

    @property
    def count(self) -> int:
        """Records that an earlier run, or this one, has kept."""
        return len(self._places)

    def made(self, inputs: str, compute: Callable[[], Arrays]) -> Arrays:
        """Arrays of a key, computed where they are not kept yet; for threads too.

        OSError if they cannot be written.
        """
        key = _digest(self._base + inputs.encode())
        found = self._read(key)
        if found is None:
            # in the order that they are read again in, which the last bit of a sum may depend on
            found = {name: np.array(one, order="C") for name, one in compute().items()}
            self._write(key, found)
        return found

    @contextmanager
    def going_on(self) -> Iterator[None]:
        """Tell a search that is interrupted what is kept of it."""
        try:
            yield
        except KeyboardInterrupt:
            if self.path is None:
                raise
            raise RunError(
                f"interrupted: {self.count} predictions are in {self.path}, and the same command "
                "goes on from there"
            ) from None

    def discard(self) -> None:
        """Delete what was kept of these inputs: the results are written."""
        self._places, self._own = {}, None
        if self.path is None:
            return
        for path in self._files():
            with suppress(OSError):
                path.unlink()
        for folder in (self.path, self.path.parent):
            with suppress(OSError):
                folder.rmdir()  # where nothing else is in it

    def _files(self) -> list[Path]:
        return sorted(self.path.glob(f"{self._base.hex()}-*"))

    def _look_around(self) -> None:
        """Find the records of earlier runs; delete old ones of other inputs."""
        if not self.path.is_dir():
            return
        own = self._files()
        for path in set(self.path.iterdir()) - set(own):
            with suppress(OSError):
                if time.time() - path.stat().st_mtime > _KEEP_OTHERS:
                    path.unlink()
        for path in own:
            self._look_into(path)

    def _look_into(self, path: Path) -> None:
        try:
            size = path.stat().st_size
            self._left -= size
            with path.open("rb") as stream:
                while len(header := stream.read(_HEADER.size)) == _HEADER.size:
                    mark, key, checksum, length = _HEADER.unpack(header)
                    at = stream.tell()
                    if mark != _MARK or at + length > size:
                        return
                    self._places[key] = _Place(path, at, length, checksum)
                    stream.seek(length, os.SEEK_CUR)
        except OSError:
            return

    def _read(self, key: bytes) -> dict[str, NDArray] | None:
        """Arrays of a record that is whole; None where there is none."""
        with self._lock:
            place = self._places.get(key)
        if place is None:
            return None
        try:
            with place.path.open("rb") as stream:
                stream.seek(place.offset)
                content = stream.read(place.size)
        except OSError:
            return None  # another run has written its results and deleted the file
        return _arrays_of(content) if zlib.crc32(content) == place.checksum else None

    def _write(self, key: bytes, arrays: Arrays) -> None:
        if self.path is None:
            return
        if sum(one.nbytes for one in arrays.values()) > self._left:
            return
        content = _bytes_of(arrays)
        checksum = zlib.crc32(content)
        record = _HEADER.pack(_MARK, key, checksum, len(content)) + content
        with self._lock:
            if len(record) > self._left:
                return
            try:
                if self._own is None:
                    self._own = self._begun()
                at = _appended(self._own, record) + _HEADER.size
            except OSError as error:
                # no RunError: a search takes that for a case that cannot be predicted
                words = f"predictions cannot be kept: {error.strerror}; those that are there stay"
                raise OSError(error.errno, words, str(self.path)) from None
            self._left -= len(record)
            self._places[key] = _Place(self._own, at, len(content), checksum)

    def _begun(self) -> Path:
        """File of this run, which nobody else writes to."""
        self.path.mkdir(parents=True, exist_ok=True)
        free = shutil.disk_usage(self.path).free
        self._left = min(self._left, int(_SHARE_OF_DISK * free))
        # in the order of time, as a later record stands for one that was damaged
        name = f"{self._base.hex()}-{time.time_ns():020d}-{os.urandom(4).hex()}"
        return self.path / name


def digest_of(arrays: Arrays) -> str:
    """Digest of named arrays."""
    digest = hashlib.blake2b(digest_size=16)
    for name, values in arrays.items():
        content = np.ascontiguousarray(values)
        digest.update(f"{name} {content.dtype} {content.shape}".encode())
        digest.update(content.tobytes())
    return digest.hexdigest()


def _appended(path: Path, record: bytes) -> int:
    """Write a record to the end of a file, all of it or nothing, and return where it begins."""
    with path.open("ab", buffering=0) as stream:
        begin = stream.seek(0, os.SEEK_END)
        rest = memoryview(record)
        try:
            while rest:
                rest = rest[stream.write(rest) :]
        except OSError:
            with suppress(OSError):
                stream.truncate(begin)
            raise
    return begin


def _digest(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=16).digest()


def _bytes_of(arrays: Arrays) -> bytes:
    stream = io.BytesIO()
    stream.write(json.dumps(list(arrays)).encode() + b"\n")
    for values in arrays.values():
        np.lib.format.write_array(stream, values, allow_pickle=False)
    return stream.getvalue()


def _arrays_of(content: bytes) -> dict[str, NDArray] | None:
    """Arrays of a content that has its checksum; None where it is of another making."""
    stream = io.BytesIO(content)
    try:
        names = json.loads(stream.readline())
        return {name: np.lib.format.read_array(stream, allow_pickle=False) for name in names}
    except (ValueError, TypeError):
        return None
