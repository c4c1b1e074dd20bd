"""Executor of a study: this process, or the workers of a Dask cluster.

Both offer the interface `chatter.engine.parallel.Executor`. A cluster is trusted: its scheduler and
workers exchange pickled functions and data, and run what they get.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor
from concurrent.futures import as_completed as futures_as_completed
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, TypeVar

from chatter.description.errors import InputError, RunError
from chatter.engine.parallel import Executor, SerialExecutor, one_thread, worker_count

if TYPE_CHECKING:
    from distributed import Client

Item = TypeVar("Item")
Result = TypeVar("Result")

LOCAL = "local"
#: s: a task is to take about this, so that scheduling costs nothing and little is lost with it
_TASK_SECONDS = 3.0
#: s
_SCHEDULER_TIMEOUT, _WORKERS_TIMEOUT = 10.0, 60.0
_TASKS_PER_WORKER = 2
#: run by workers at their start: Ctrl-C goes to every process of a terminal, and the one that
#: started them ends them
_IGNORE_CTRL_C = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
_ADDRESS = re.compile(r"(tcp|tls|ws|wss)://[^\s/:]+(:\d+)")
_ADDRESS_IPV6 = re.compile(r"(tcp|tls|ws|wss)://\[[0-9a-fA-F:.]+\](:\d+)")


class ThreadExecutor:
    """Items side by side in threads of this process: for compiled code that is one thread each."""

    def results(
        self, function: Callable[[Item], Result], items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """Yield results as they are finished."""
        with ThreadPoolExecutor(max_workers=worker_count()) as pool:
            futures = {pool.submit(_alone, function, item): n for n, item in enumerate(items)}
            try:
                for future in futures_as_completed(futures):
                    yield futures[future], future.result()
            finally:
                for future in futures:
                    future.cancel()


def _alone(function: Callable[[Item], Result], item: Item) -> Result:
    with one_thread():
        return function(item)


class DaskExecutor:
    """Tasks of several items on the workers of a Dask cluster, one thread each.

    A task is to take `task_seconds`; the number of its items follows from the time that items took.
    """

    def __init__(self, client: Client, task_seconds: float = _TASK_SECONDS) -> None:
        self._client = client
        self._task_seconds = task_seconds

    def results(
        self, function: Callable[[Item], Result], items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """Yield results as tasks end; a lost worker's tasks are computed by others."""
        if not items:
            return
        from distributed import as_completed

        waiting = list(range(len(items)))[::-1]
        task_size = _TaskSize(self._task_seconds)
        indices: dict[Any, list[int]] = {}
        ended = as_completed()
        try:
            while waiting or indices:
                workers = sum(self._client.nthreads().values())
                wanted = _TASKS_PER_WORKER * max(1, workers)
                while waiting and len(indices) < wanted:
                    size = task_size.items_per_task(len(waiting), wanted)
                    mine = [waiting.pop() for _ in range(size)]
                    future = self._submit(function, [items[index] for index in mine])
                    indices[future] = mine
                    ended.add(future)
                future = next(ended)
                mine = indices.pop(future)
                found, seconds = _result_of(future)
                task_size.add(len(mine), seconds)
                yield from zip(mine, found, strict=True)
        except (CancelledError, OSError) as error:
            lost = f"the cluster is lost ({type(error).__name__}); what was finished is kept"
            raise RunError(lost) from None
        finally:
            # a client that is closed has taken its tasks along
            if indices and self._client.status == "running":
                with suppress(OSError):
                    self._client.cancel(list(indices))

    def _submit(self, function: Callable, items: list) -> Any:
        # each task is new: a result of the same name may be that of another version
        return self._client.submit(_task, function, items, _version(), pure=False)


class _TaskSize:
    """Time that items took, and how many make a task."""

    def __init__(self, task_seconds: float) -> None:
        self._task_seconds = task_seconds
        self._items, self._seconds = 0, 0.0

    def add(self, items: int, seconds: float) -> None:
        self._items += items
        self._seconds += seconds

    def items_per_task(self, waiting: int, tasks: int) -> int:
        """Items of the next task: one until a cost is known, fewer towards the end."""
        if self._items == 0:
            return 1
        mean = max(self._seconds / self._items, 1e-6)
        fair = math.ceil(waiting / tasks)
        return max(1, min(int(self._task_seconds / mean), fair, waiting))


def _task(function: Callable, items: list, version: str) -> tuple[list, float, list[str]]:
    """On a worker: results of some items, the time they took, and what was wrong with the input."""
    if version != _version():
        return [], 0.0, ["a worker of the cluster has another version of chatter than this one"]
    started = time.perf_counter()
    with one_thread():
        try:
            found = [function(item) for item in items]
        except InputError as error:
            return [], 0.0, list(error.messages)
        except OSError as error:
            return [], 0.0, [f"on a worker: {error.filename or 'a file'}: {error.strerror}"]
    return found, time.perf_counter() - started, []


def _version() -> str:
    """Hash of the sources, as in the name of the folder of compiled code."""
    from chatter.engine.presets import CACHE_FOLDER

    return CACHE_FOLDER.name


def _result_of(future: Any) -> tuple[list, float]:
    from distributed import KilledWorker

    try:
        found, seconds, problems = future.result()
    except KilledWorker:
        raise RunError(
            "a task has lost its worker again and again, most likely for want of memory; "
            "what was finished is kept"
        ) from None
    if problems:
        raise InputError(problems)
    return found, seconds


@contextmanager
def open_executor(cluster: str | Executor | None) -> Iterator[Executor]:
    """Open an executor, and close what was opened.

    "local" starts worker processes on this machine; "tcp://host:port" is the scheduler of a Dask
    cluster; None is this process. InputError if distributed is not installed, or no scheduler or
    worker answers.
    """
    if cluster is None:
        yield SerialExecutor()
        return
    if not isinstance(cluster, str):
        yield cluster
        return
    known = cluster == LOCAL or _ADDRESS.fullmatch(cluster) or _ADDRESS_IPV6.fullmatch(cluster)
    if not known:
        raise InputError(
            f'--cluster "{cluster}" is no cluster; "{LOCAL}" is one, or the address of a '
            "scheduler, such as tcp://host:8786"
        )
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise InputError(
            '--cluster needs distributed, which is not installed: pip install "chatter[cluster]"'
        ) from None
    opened = _local_client() if cluster == LOCAL else _client_of(cluster)
    with opened as client:
        yield DaskExecutor(client)


@contextmanager
def _local_client() -> Iterator[Client]:
    import logging

    from distributed import Client, LocalCluster

    # no dashboard: it would be served to the network
    with (
        LocalCluster(
            n_workers=worker_count(),
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
            silence_logs=logging.CRITICAL,
            preload=_IGNORE_CTRL_C,
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@contextmanager
def _client_of(address: str) -> Iterator[Client]:
    import logging

    from distributed import Client

    # a lost connection is told in a sentence; each of its loggers has a level of its own
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distrib")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=_SCHEDULER_TIMEOUT)
    except (OSError, TimeoutError, ValueError):
        raise InputError(
            f"--cluster {address}: no scheduler answers there within "
            f"{_SCHEDULER_TIMEOUT:g} s; dask scheduler starts one"
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_WORKERS_TIMEOUT)
        except TimeoutError:
            raise InputError(
                f"--cluster {address}: its scheduler has had no worker for "
                f"{_WORKERS_TIMEOUT:g} s; dask worker {address} starts one"
            ) from None
        yield client
