"""Points on disk: one JSON line each, written as they are finished.

A line counts only for the same input: its key is a hash of all that the point depends on.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from chatter.description.errors import RunError

FILE = "points.jsonl"


def key_of(*parts: str) -> str:
    """Hash of texts."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


class FinishedPoints:
    """Points finished so far, by key.

    Parameters
    ----------
    folder : Path or None
        Where points.jsonl is; None keeps them in memory alone.
    """

    def __init__(self, folder: str | Path | None) -> None:
        self.path = None if folder is None else Path(folder) / FILE
        self._known: dict[str, Any] = {}
        if self.path is not None and self.path.is_file():
            self._read()

    def _read(self) -> None:
        for line in self.path.read_text(encoding="utf-8", errors="replace").splitlines():
            try:
                entry = json.loads(line)
                self._known[entry["key"]] = entry["point"]
            except (ValueError, KeyError, TypeError):
                # the last line of a run that was killed
                continue

    def __contains__(self, key: str) -> bool:
        """Whether a point is finished."""
        return key in self._known

    def __getitem__(self, key: str) -> Any:
        """Record of a point."""
        return self._known[key]

    def remember(self, key: str, point: Any) -> None:
        """Keep a point in memory alone."""
        self._known[key] = point

    def add(self, key: str, point: Any) -> None:
        """Keep a point; it is on disk when this returns."""
        line = json.dumps({"key": key, "point": point}, allow_nan=False)
        self.remember(key, json.loads(line)["point"])
        if self.path is None:
            return
        self.path.parent.mkdir(parents=True, exist_ok=True)
        started = self.path.is_file() and not self._ends_in_newline()
        with self.path.open("a", encoding="utf-8") as file:
            file.write(("\n" if started else "") + line + "\n")
            file.flush()
            os.fsync(file.fileno())

    def interrupted(self, keys: Sequence[str], noun: str) -> RunError:
        """What to raise where a run over these keys is interrupted."""
        finished = sum(key in self for key in keys)
        kept = f"; they are in {self.path}, and the same command goes on from there"
        return RunError(
            f"interrupted: {finished} of {len(keys)} {noun} are finished"
            f"{kept if self.path and finished else ''}"
        )

    def _ends_in_newline(self) -> bool:
        with self.path.open("rb") as file:
            file.seek(0, os.SEEK_END)
            if file.tell() == 0:
                return True
            file.seek(-1, os.SEEK_END)
            return file.read(1) == b"\n"
