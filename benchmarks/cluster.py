"""A map of a million points on 1, 2, 4 and 8 worker processes of this machine.

Each number of workers computes 1000 spindle speeds at 1000 cutting coefficients anew; workers have
loaded their compiled code before. Then a worker is killed in the middle of a study, and after that
the scheduler is lost, and the study goes on from what was finished: the numbers must be the same.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from distributed import Client, LocalCluster

import chatter
from chatter.engine.parallel import Executor
from chatter.stability.diagram import StabilityMap
from chatter.studies.diagram_over_axes import lobes_over
from chatter.studies.executor import DaskExecutor, open_executor

CASE = Path(__file__).parents[1] / "examples" / "two-degrees-of-freedom" / "case.toml"
WORKERS = (1, 2, 4, 8)
SIDE = 1000
#: of the columns, after which a worker or the scheduler is lost
_LOST_AFTER = 0.3


def study(executor: Executor, folder: Path, side: int = SIDE, progress=None) -> StabilityMap:
    """Spectral radius over spindle speed and cutting coefficient."""
    return lobes_over(
        chatter.load(CASE),
        f"cut.spindle_speed=5000 rpm..20000 rpm:{side}",
        f"material.Ktc=400 MPa..1200 MPa:{side}",
        cluster=executor,
        folder=folder,
        **({} if progress is None else {"progress": progress}),
    )


def cluster_of(workers: int) -> LocalCluster:
    """Start workers of one thread each."""
    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        silence_logs=50,
    )


def timed(workers: int, folder: Path) -> tuple[StabilityMap, float]:
    """Map of a million points and the wall time that it took, s."""
    with cluster_of(workers) as cluster, Client(cluster) as client:
        executor = DaskExecutor(client)
        study(executor, folder / "first", 4 * workers)
        begun = time.perf_counter()
        return study(executor, folder / "map"), time.perf_counter() - begun


def with_a_worker_lost(folder: Path) -> StabilityMap:
    """Map for which one of two workers is killed in the middle."""
    with cluster_of(2) as cluster, Client(cluster) as client:
        first = next(iter(client.run(os.getpid).values()))
        killed = []

        def progress(done: int, total: int) -> None:
            if done > _LOST_AFTER * total and not killed:
                killed.append(os.kill(first, signal.SIGKILL))

        return study(DaskExecutor(client), folder, progress=progress)


@contextmanager
def scheduler_and_workers(folder: Path) -> Iterator[tuple[subprocess.Popen, str]]:
    """Start a scheduler and two workers as processes of their own; yields it and its address."""
    told, silent = folder / "scheduler.json", {"stderr": subprocess.DEVNULL}
    begin = [sys.executable, "-m"]
    where = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(told)]
    scheduler = subprocess.Popen([*begin, "distributed.cli.dask_scheduler", *where], **silent)
    try:
        while not told.is_file():
            time.sleep(0.1)
        address = json.loads(told.read_text())["address"]
        plain = [address, "--nworkers", "2", "--nthreads", "1", "--no-dashboard"]
        workers = subprocess.Popen([*begin, "distributed.cli.dask_worker", *plain], **silent)
        try:
            yield scheduler, address
        finally:
            workers.kill()
            workers.wait()
    finally:
        scheduler.kill()
        scheduler.wait()


def with_the_scheduler_lost(folder: Path) -> tuple[StabilityMap, int]:
    """Map of which the scheduler is killed in the middle, taken up by another; columns kept."""
    kept = 0
    folder.mkdir()
    with scheduler_and_workers(folder) as (scheduler, address), open_executor(address) as executor:

        def progress(done: int, total: int) -> None:
            nonlocal kept
            kept = done
            if done > _LOST_AFTER * total:
                scheduler.kill()

        try:
            study(executor, folder, progress=progress)
        except chatter.RunError as error:
            print(f"  {error}")
    with cluster_of(2) as cluster, Client(cluster) as client:
        return study(DaskExecutor(client), folder), kept


def same(one: StabilityMap, other: StabilityMap) -> str:
    """Whether two maps are the same to the last bit, in words."""
    return "the same" if np.array_equal(one.spectral_radius, other.spectral_radius) else "OTHERS"


def main() -> None:
    """Measure and print."""
    print(f"{SIDE} x {SIDE} points, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
    with tempfile.TemporaryDirectory() as place:
        reference, alone = timed(WORKERS[0], Path(place) / "1")
        print(f"{WORKERS[0]} worker: {alone:.1f} s")
        for workers in WORKERS[1:]:
            found, wall = timed(workers, Path(place) / str(workers))
            print(
                f"{workers} workers: {wall:.1f} s, {alone / wall:.2f} times one worker; "
                f"radii {same(found, reference)}",
                flush=True,
            )
        lost = with_a_worker_lost(Path(place) / "worker")
        print(f"a worker killed: radii {same(lost, reference)}", flush=True)
        resumed, kept = with_the_scheduler_lost(Path(place) / "scheduler")
        print(f"the scheduler lost after {kept} columns: radii {same(resumed, reference)}")
        for kind in ("csv", "parquet"):
            begun = time.perf_counter()
            resumed.save(Path(place) / kind, kind)
            print(f"written with its table as {kind}: {time.perf_counter() - begun:.1f} s")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"memory of the process that hands out: {peak:.0f} MB at the most")


if __name__ == "__main__":
    main()
