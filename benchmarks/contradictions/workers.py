"""Processes that judge cases, each within a time limit."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterable, Iterator
from multiprocessing.connection import Connection, wait

from benchmarks.contradictions.confrontation_list import by_name
from benchmarks.contradictions.one_case import Judged, judged

#: confrontation, seed and number
Task = tuple[str, int, int]
#: until a confrontation has answered once its kernels may have to be compiled, s
_COMPILING = 1200.0


def serve(connection: Connection) -> None:
    """Judge what comes in until None does."""
    for name, seed, number in iter(connection.recv, None):
        connection.send(judged(by_name(name), seed, number))


class Worker:
    """A process with the task that it works on; one that is too slow is ended."""

    def __init__(self) -> None:
        self.task: Task | None = None
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, far = context.Pipe()
        self.process = context.Process(target=serve, args=(far,), daemon=True)
        self.process.start()
        far.close()

    def take(self, task: Task, time_limit: float) -> None:
        """Begin a task, which may take so long, s."""
        self.task, self.since, self.time_limit = task, time.monotonic(), time_limit
        self.connection.send(task)

    def answer(self) -> Judged:
        """Result of the task, which has arrived."""
        task, self.task = self.task, None
        try:
            return self.connection.recv()
        except EOFError:
            self.process.join()
            code = self.process.exitcode
            self._start()
            return Judged(*task, "failed", f"the process ended with {code}")

    @property
    def left(self) -> float:
        """Seconds of the time limit that are left."""
        return self.time_limit - (time.monotonic() - self.since)

    def given_up(self) -> Judged:
        """End the process and begin a new one."""
        task, self.task = self.task, None
        self.process.kill()
        self.process.join()
        self._start()
        reason = f"no answer within {self.time_limit:g} s"
        return Judged(*task, "too long", reason, seconds=self.time_limit)

    def end(self) -> None:
        """Let the process end."""
        self.process.kill()
        self.process.join()


def all_judged(tasks: Iterable[Task], workers: int, time_limit: float) -> Iterator[Judged]:
    """Judge tasks in some processes, each task within a limit, s; results as they come."""
    coming = iter(tasks)
    idle = [Worker() for _ in range(workers)]
    busy: list[Worker] = []
    compiled: set[str] = set()
    try:
        while True:
            while idle and (task := next(coming, None)) is not None:
                worker = idle.pop()
                limit = time_limit if task[0] in compiled else max(time_limit, _COMPILING)
                worker.take(task, limit)
                busy.append(worker)
            if not busy:
                return
            soonest = max(0.0, min(worker.left for worker in busy))
            ready = wait([worker.connection for worker in busy], soonest)
            for worker in tuple(busy):
                if worker.connection not in ready and worker.left > 0.0:
                    continue
                busy.remove(worker)
                idle.append(worker)
                found = worker.answer() if worker.connection in ready else worker.given_up()
                compiled.add(found.confrontation)
                yield found
    finally:
        for worker in (*idle, *busy):
            worker.end()
