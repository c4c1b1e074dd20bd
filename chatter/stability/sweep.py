"""One sweep for every method: points in chunks, chunks in threads, progress and interruption."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Result = TypeVar("Result")

#: called with (done, total) points
Progress = Callable[[int, int], None]

#: points a chunk: small enough for a smooth progress bar, large enough to cost nothing
_POINTS_A_CHUNK = 32


def no_progress(done: int, total: int) -> None:
    """Report nothing."""


#: of a thread that other tasks run beside
_alone = threading.local()


@contextmanager
def one_thread() -> Iterator[None]:
    """Let sweeps of this thread use one thread: what surrounds it keeps the others busy."""
    before = getattr(_alone, "wanted", False)
    _alone.wanted = True
    try:
        yield
    finally:
        _alone.wanted = before


def worker_count() -> int:
    """Threads to use: the processors this process may run on."""
    if getattr(_alone, "wanted", False):
        return 1
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return max(1, os.cpu_count() or 1)


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
    if len(chunks) == 1 or worker_count() == 1:
        for chunk in chunks:
            results.append(function(chunk))
            progress(int(chunk[-1]) + 1, count)
        return results
    futures = [_threads(worker_count()).submit(_worked, function, chunk) for chunk in chunks]
    try:
        for chunk, future in zip(chunks, futures, strict=True):
            results.append(future.result())
            progress(int(chunk[-1]) + 1, count)
    except BaseException:
        for future in futures:
            future.cancel()
        raise
    return results


@lru_cache(maxsize=1)
def _threads(count: int) -> ThreadPoolExecutor:
    """Threads of all sweeps: a fast diagram is over before new ones would have started."""
    return ThreadPoolExecutor(max_workers=count, thread_name_prefix="sweep")


# threads do not live on in a process that is forked off
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_threads.cache_clear)


def _worked(function: Callable[[NDArray[np.int64]], Result], chunk: NDArray[np.int64]) -> Result:
    """Work on a chunk in a thread of the sweeps; a sweep within it must not wait for those."""
    with one_thread():
        return function(chunk)
