"""Result cache: records of the finished parts of a study, so that an interrupted one goes on.

A record is what JSON knows, with nan and inf, and its key is a hash of all that it depends on.
diskcache keeps the records in SQLite, as text: nothing that lies on disk is ever unpickled.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar

import diskcache

from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor
from chatter.studies.executor import open_executor

if TYPE_CHECKING:
    from typing_extensions import Unpack

Item = TypeVar("Item")

#: beside the results of a study
FOLDER = "result-cache"


class Execution(TypedDict, total=False):
    """How a study is carried out: keyword arguments that studies share.

    Attributes
    ----------
    folder : path
        Keeps finished parts in the result cache there, and reuses those of the same input.
    progress : callable
        Called with (done, total) parts.
    resumed : callable
        Called once with (finished before, total) parts.
    cluster : str or Executor
        Where parts are computed, as for `chatter.studies.executor.open_executor`; None: here.
    """

    folder: str | Path | None
    progress: Progress
    resumed: Callable[[int, int], None] | None
    cluster: str | Executor | None


class _TextDisk(diskcache.Disk):
    """Text as it is; what asks to be unpickled is refused."""

    def fetch(self, mode: int, filename: str | None, value: Any, read: bool) -> Any:
        """Return a value that was stored."""
        if mode == diskcache.core.MODE_PICKLE:
            raise RunError(f"{self._directory}: holds data that is no text; delete it")
        return super().fetch(mode, filename, value, read)

    def get(self, key: Any, raw: bool) -> Any:
        """Return a key that was stored."""
        if not raw:
            raise RunError(f"{self._directory}: holds keys that are no text; delete it")
        return super().get(key, raw)


class ResultCache:
    """Records by key, on disk where a folder is given, else in memory.

    The cache is the folder "result-cache" in that of the results; inputs are what all records
    depend on.
    """

    def __init__(self, folder: str | Path | None, *inputs: str) -> None:
        self.path = None if folder is None else Path(folder) / FOLDER
        self._base = _hash(*inputs)
        self._requested: set[str] = set()

    def __enter__(self) -> ResultCache:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the files that this thread has open."""
        if self.path is not None and "_records" in vars(self):
            self._records.close()

    @cached_property
    def _records(self) -> Any:
        """Text by key; the folder is made with the first record."""
        if self.path is None:
            return {}
        try:
            return diskcache.Cache(str(self.path), disk=_TextDisk, eviction_policy="none")
        except (sqlite3.Error, diskcache.Timeout) as error:
            raise RunError(f"{self.path}: the cache cannot be opened: {error}") from None

    def key(self, *inputs: str) -> str:
        """Key of a record that depends on some inputs besides those of all records."""
        return _hash(self._base, *inputs)

    def __iter__(self) -> Iterator[str]:
        """Keys in the order in which their records were added."""
        return iter(()) if self._is_new else iter(self._records)

    def __contains__(self, key: str) -> bool:
        """Whether there is a record of a key."""
        with self._faults_told("read"):
            return not self._is_new and key in self._records

    def __getitem__(self, key: str) -> Any:
        """Record of a key."""
        with self._faults_told("read"):
            return json.loads(self._records[key])

    def __setitem__(self, key: str, record: Any) -> None:
        """Keep a record; it is on disk when this returns."""
        with self._faults_told("written"):
            self._records[key] = json.dumps(record)

    @contextmanager
    def _faults_told(self, done: str) -> Iterator[None]:
        """Say in words what is wrong with the disk; records that are there stay."""
        try:
            yield
        except (sqlite3.Error, diskcache.Timeout, json.JSONDecodeError, OSError) as error:
            reason = "another run holds it" if isinstance(error, diskcache.Timeout) else error
            advice = "" if done == "written" else "; if it is damaged, delete it"
            raise RunError(f"{self.path}: the cache cannot be {done}: {reason}{advice}") from None

    @property
    def _is_new(self) -> bool:
        return self.path is not None and not self.path.is_dir()

    def finished(self, keys: Sequence[str]) -> int:
        """Count those of some keys that have a record."""
        return sum(key in self for key in keys)

    def record(self, name: str, inputs: object, compute: Callable[[], Any]) -> Any:
        """Record of a part of a search, computed where it is not known yet; for threads too.

        `name` and the `repr` of `inputs` tell it from other parts.
        """
        key = self.key(name, repr(inputs))
        self._requested.add(key)
        if key not in self:
            self[key] = compute()
        return self[key]

    def evaluate(
        self,
        function: Callable[[Item], Any],
        items: Sequence[Item],
        keys: Sequence[str],
        noun: str,
        **execution: Unpack[Execution],
    ) -> list[Any]:
        """Records that a function makes of items, in their order; known ones are not computed.

        Function and items can be pickled; a record with a "failure" is not kept, so that it is
        tried again. Keys are those of the record of each item; the noun is what messages call the
        items. Execution as `Execution`; the folder is that of the cache. TypeError if a keyword is
        not known, InputError as the function does, RunError if it is interrupted; finished records
        are in the cache.
        """
        unknown = execution.keys() - Execution.__annotations__.keys()
        if unknown:
            raise TypeError(f"a study takes no argument {min(unknown)!r}")
        progress = execution.get("progress") or no_progress
        resumed, before = execution.get("resumed"), self.finished(keys)
        if before and resumed is not None:
            resumed(before, len(keys))
        # two items of the same key are computed once
        pairs = zip(keys, items, strict=True)
        missing = list({key: item for key, item in pairs if key not in self}.items())
        failed: dict[str, Any] = {}
        done = len(keys) - len(missing)
        progress(done, len(keys))
        try:
            with open_executor(execution.get("cluster") if missing else None) as executor:
                results = executor.results(function, [item for _, item in missing])
                for index, record in results:
                    key = missing[index][0]
                    if isinstance(record, dict) and record.get("failure"):
                        failed[key] = record
                    else:
                        self[key] = record
                    done += 1
                    progress(done, len(keys))
        except KeyboardInterrupt:
            raise self._interrupted(f"{done} of {len(keys)} {noun}", done) from None
        return [failed[key] if key in failed else self[key] for key in keys]

    def search_interrupted(self) -> RunError:
        """What to raise where a search is interrupted."""
        finished = self.finished(tuple(self._requested))
        return self._interrupted(f"{finished} parts of the search", finished)

    def _interrupted(self, what: str, finished: int) -> RunError:
        kept = f"; they are in {self.path}, and the same command goes on from there"
        return RunError(f"interrupted: {what} are finished{kept if self.path and finished else ''}")


def _hash(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
