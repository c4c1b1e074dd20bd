"""Results of many items, here or on a cluster, kept on disk as they come and taken up again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from chatter.cluster import Computing, computing_on
from chatter.stability.sweep import Progress
from chatter.what_if.finished import FinishedPoints

Item = TypeVar("Item")


def kept_results(
    function: Callable[[Item], Any],
    items: Sequence[Item],
    keys: Sequence[str],
    noun: str,
    cluster: str | Computing | None,
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
    cluster : str or Computing, optional
        As for `chatter.cluster.computing_on`.
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
        with computing_on(cluster if missing else None) as computing:
            for place, found in computing.results(function, [items[place] for place in missing]):
                store.add(keys[missing[place]], found)
                done += 1
                progress(done, len(keys))
    except KeyboardInterrupt:
        raise store.interrupted(keys, noun) from None
    return [store[key] for key in keys]
