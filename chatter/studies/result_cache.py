"""Results of many items, here or on a cluster, kept on disk as they come and taken up again."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from chatter.description.errors import RunError
from chatter.description.progress import Progress
from chatter.engine.parallel import Executor
from chatter.studies.executor import open_executor
from chatter.studies.finished_points import FinishedPoints, key_of

Item = TypeVar("Item")


def kept_results(
    function: Callable[[Item], Any],
    items: Sequence[Item],
    keys: Sequence[str],
    noun: str,
    cluster: str | Executor | None,
    folder: str | Path | None,
    progress: Progress,
) -> list[Any]:
    """Records that a function makes of items, in their order.

    Parameters
    ----------
    function : callable
        Of an item; can be pickled, as items can. What it returns is what JSON knows.
    items : sequence
    keys : sequence of str
        Hash of all that the record of an item depends on.
    noun : str
        What the items are, for messages.
    cluster : str or Executor, optional
        As for `chatter.studies.executor.open_executor`.
    folder : path, optional
        Keeps finished records in points.jsonl there, and reuses those of the same keys.
    progress : callable
        Called with (done, total) items.

    Raises
    ------
    InputError
        As the function does.
    RunError
        If it is interrupted; finished records are in the folder.
    """
    store = FinishedPoints(folder)
    missing = [place for place, key in enumerate(keys) if key not in store]
    done = len(keys) - len(missing)
    try:
        with open_executor(cluster if missing else None) as executor:
            for place, found in executor.results(function, [items[place] for place in missing]):
                store.add(keys[missing[place]], found)
                done += 1
                progress(done, len(keys))
    except KeyboardInterrupt:
        raise store.interrupted(keys, noun) from None
    return [store[key] for key in keys]


class KeptPieces:
    """Pieces of a search that depend on one another, kept on disk as they end; for threads too.

    Parameters
    ----------
    folder : path, optional
        Keeps finished pieces in points.jsonl there, and reuses those of the same input.
    base : str
        Hash of what all pieces depend on.
    """

    def __init__(self, folder: str | Path | None, base: str) -> None:
        self._store = FinishedPoints(folder)
        self._base = base
        self._asked: set[str] = set()
        self._lock = threading.Lock()

    def piece(self, name: str, inputs: Any, compute: Callable[[], Any]) -> Any:
        """Record of a piece, computed if it is not known yet.

        Parameters
        ----------
        name : str
            Kind of the piece.
        inputs : object
            What it depends on besides; `repr` tells it from others.
        compute : callable
            What it returns is what JSON knows.
        """
        key = key_of(self._base, name, repr(inputs))
        self._asked.add(key)
        if key not in self._store:
            record = compute()
            with self._lock:
                # another thread may have come to the same piece
                if key not in self._store:
                    self._store.add(key, record)
        return self._store[key]

    def interrupted(self) -> RunError:
        """What to raise where the search is interrupted."""
        finished = sum(key in self._store for key in self._asked)
        kept = f"; they are in {self._store.path}, and the same command goes on from there"
        return RunError(
            f"interrupted: {finished} pieces of the search are finished"
            f"{kept if self._store.path and finished else ''}"
        )
