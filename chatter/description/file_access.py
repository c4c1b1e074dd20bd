"""Which files a case or machine file may name: those below its folder, and what the user allows.

A file from a stranger must not read what lies elsewhere. Allowed are the folder of the file, the
folder in which the program was started or that the workbench was given, the folders of an
environment variable, and whatever a file names that this user's chatter wrote itself, such as the
case of an optimum in a folder of results.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

#: folders, separated as in PATH, whose files every case may name
VARIABLE = "CHATTER_FILES"
_WRITTEN = "written-files"
#: what was written first is forgotten beyond this, bytes
_MOST_WRITTEN = 1 << 20

#: folders that the user opened in this process
_OPENED: set[Path] = set()


def open_folder(folder: Path) -> None:
    """Allow what lies in a folder that the user gave to work in."""
    _OPENED.add(_resolved(folder))


def is_allowed(file: Path, folder: Path) -> bool:
    """Whether a description in a folder may name a file."""
    target = _resolved(file)
    return any(target.is_relative_to(root) for root in _roots(folder))


def _resolved(path: Path) -> Path:
    try:
        return path.resolve()
    except (OSError, RuntimeError):  # links in a circle
        return path.absolute()


def _roots(folder: Path) -> Iterator[Path]:
    yield _resolved(folder)
    yield from _OPENED
    with suppress(OSError):  # the folder is gone
        yield _resolved(Path.cwd())
    for name in os.environ.get(VARIABLE, "").split(os.pathsep):
        if name:
            yield _resolved(Path(name).expanduser())


def remember_written(text: str) -> None:
    """Remember the text of a description that this program wrote; in vain where it cannot."""
    file = _state_folder() / _WRITTEN
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        if file.exists() and file.stat().st_size > _MOST_WRITTEN:
            file.unlink()
        with file.open("a", encoding="ascii") as stream:
            stream.write(_hash(text) + "\n")


def was_written(text: str) -> bool:
    """Whether this program wrote the text of a description."""
    with suppress(OSError, UnicodeDecodeError):
        known = (_state_folder() / _WRITTEN).read_text(encoding="ascii")
        return _hash(text) in known.split()
    return False


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()


def _state_folder() -> Path:
    home = os.environ.get("XDG_STATE_HOME")
    return (Path(home) if home else Path.home() / ".local" / "state") / "chatter"
