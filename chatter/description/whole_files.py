"""Files that are there as a whole or not at all: a full disk or a kill leaves the old one."""

import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO


def write_whole(path: str | Path, content: str | bytes | Callable[[IO[bytes]], object]) -> Path:
    """Write a file beside its place and move it there when it is whole.

    Text is UTF-8 without changes of its line ends; a callable writes into the open file. OSError
    names the file; what stood there before is left then.
    """
    path = Path(path)
    try:
        return _written(path, content)
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def _written(path: Path, content: str | bytes | Callable[[IO[bytes]], object]) -> Path:
    if path.exists() and not path.is_file():
        # a device or a pipe, such as /dev/stdout, is written to
        with path.open("wb") as stream:
            _write(stream, content)
        return path
    # through a link to the file it stands for
    target = path.resolve()
    handle, name = tempfile.mkstemp(prefix=f".{target.name[:40]}.", dir=target.parent)
    beside = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            _write(stream, content)
            stream.flush()
            os.fsync(stream.fileno())
        beside.chmod(target.stat().st_mode & 0o777 if target.exists() else 0o666 & ~_umask())
        beside.replace(target)
    except BaseException:
        with suppress(OSError):
            beside.unlink()
        raise
    return path


def _write(stream: IO[bytes], content: str | bytes | Callable[[IO[bytes]], object]) -> None:
    if callable(content):
        content(stream)
    else:
        stream.write(content.encode("utf-8") if isinstance(content, str) else content)


def _umask() -> int:
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
