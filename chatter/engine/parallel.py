"""Parallel evaluation: chunks of points in threads, and the interface of an executor.

`sweep` serves compiled code that releases the interpreter lock. Whole items of a study, which may
be sent to other processes, go through an `Executor`; that of a Dask cluster is in
`chatter.studies.executor`.
"""

import math
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed, wait
from contextlib import contextmanager
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress, no_progress
from chatter.engine.interruption import interruptions_deferred

Item = TypeVar("Item")
Result = TypeVar("Result")

#: points a chunk: small enough for a smooth progress bar, large enough to cost nothing
_POINTS_A_CHUNK = 32


class Executor(Protocol):
    """Evaluates the items of a study."""

    def results(
        self, function: Callable[[Item], Result], items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """Yield the index of an item and its result as they are finished.

        Parameters
        ----------
        function : callable
            Of one item. Its result depends on the item alone, so that it is the same anywhere;
            it can be pickled, as items and results can.
        items : sequence

        Raises
        ------
        InputError, RunError
            As the function does, or if the workers are lost.
        """
        ...


class SerialExecutor:
    """One item after the other in this process; each may use all its threads."""

    def results(
        self, function: Callable[[Item], Result], items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """Yield results in the order of the items."""
        for index, item in enumerate(items):
            yield index, function(item)


#: of a thread: whether other tasks run beside it, and the pool that its sweeps share
_alone = threading.local()


@contextmanager
def one_thread() -> Iterator[None]:
    """Let sweeps of this thread use one thread: what surrounds it keeps the others busy."""
    _alone.wanted = True
    try:
        yield
    finally:
        _alone.wanted = False


@contextmanager
def kept_threads() -> Iterator[None]:
    """Let sweeps of this thread share their threads: starting some for each costs a millisecond."""
    if getattr(_alone, "pool", None) is not None:
        yield
        return
    with ThreadPoolExecutor(max_workers=worker_count()) as pool:
        _alone.pool = pool
        try:
            yield
        finally:
            _alone.pool = None


@contextmanager
def _threads() -> Iterator[ThreadPoolExecutor]:
    """Threads for one sweep."""
    kept = getattr(_alone, "pool", None)
    if kept is not None:
        yield kept
        return
    with ThreadPoolExecutor(max_workers=worker_count()) as pool:
        yield pool


def worker_count() -> int:
    """Threads to use: the processors this process may run on."""
    if getattr(_alone, "wanted", False):
        return 1
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return max(1, os.cpu_count() or 1)


def each(
    function: Callable[[int], Result],
    count: int,
    progress: Progress = no_progress,
    points_a_chunk: int = 1,
) -> list[Result]:
    """Results of a function of every index 0 .. count-1, in order; see `sweep`."""

    def some(points: NDArray[np.int64]) -> list[Result]:
        return [function(int(point)) for point in points]

    parts = sweep(some, count, progress, points_a_chunk)
    return [found for part in parts for found in part]


def scattered(count: int) -> NDArray[np.int64]:
    """Order of the indices 0 .. count-1 in which any of the first are spread over all.

    Points of a sweep take longer at one end, low speeds say: begun in this order they keep one
    pace, by which the rest is estimated. By the golden ratio (Weyl's sequence).
    """
    return np.argsort(np.arange(count) * (0.5 * (math.sqrt(5.0) - 1.0)) % 1.0, kind="stable")


def sweep(
    function: Callable[[NDArray[np.int64]], Result],
    count: int,
    progress: Progress = no_progress,
    points_a_chunk: int = _POINTS_A_CHUNK,
) -> list[Result]:
    """Evaluate a function on chunks of the indices 0 .. count-1, in parallel threads.

    Parameters
    ----------
    function : callable
        Takes an array of indices; compiled code inside it releases the interpreter lock. The
        result must not depend on how the points are split, so that it is the same bytes for
        any number of threads.
    count : int
        Number of points.
    progress : callable, optional
        Called with (done, total) as chunks finish.
    points_a_chunk : int
        Points handed to a thread at once.

    Returns
    -------
    list
        Results of the chunks in order.
    """
    chunks = [
        np.arange(first, min(first + points_a_chunk, count))
        for first in range(0, count, points_a_chunk)
    ]
    results: list[Result] = []
    if len(chunks) == 1:
        # a thread would take longer to start
        with interruptions_deferred():
            results.append(function(chunks[0]))
        progress(count, count)
        return results
    with _threads() as pool:
        begun = {int(k): pool.submit(function, chunks[k]) for k in scattered(len(chunks))}
        futures = [begun[k] for k in range(len(chunks))]
        try:
            # counted as they finish, whichever they are; results and errors in order
            sizes = dict(zip(futures, map(len, chunks), strict=True))
            done = 0
            for future in as_completed(futures):
                if future.exception() is not None:
                    break
                done += sizes[future]
                progress(done, count)
            results += [future.result() for future in futures]
        except BaseException:
            for future in futures:
                future.cancel()
            # those that run use arrays of the caller
            wait(futures)
            raise
    return results
