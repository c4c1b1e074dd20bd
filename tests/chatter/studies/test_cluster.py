"""Studies on a cluster of real worker processes: same bytes, lost workers, interruption."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import chatter
from chatter.description.errors import InputError, RunError
from chatter.engine.parallel import SerialExecutor, one_thread, worker_count
from chatter.studies.executor import DaskExecutor, _TaskSize, open_executor
from chatter.studies.result_cache import ResultCache
from tests.chatter.simulation.on_machine.coupled_machines import (
    body,
    cut_case,
    linear_axis,
    spindle,
    spring,
)
from tests.chatter.simulation.on_machine.coupled_machines import written as saved
from tests.places import EXAMPLES

distributed = pytest.importorskip("distributed")
cloudpickle = pytest.importorskip("cloudpickle")

CASE = EXAMPLES / "two-degrees-of-freedom" / "case.toml"
cloudpickle.register_pickle_by_value(sys.modules[__name__])


@pytest.fixture(scope="module")
def client():
    with (
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
            silence_logs=50,
        ) as cluster,
        distributed.Client(cluster) as opened,
    ):
        yield opened


def small_case():
    return chatter.load(CASE).patch(
        {
            "lobes.speeds": {"from": "15000 rpm", "to": "21000 rpm", "count": 14},
            "lobes.depths": {"to": "5 mm", "count": 8},
            "material.Ktc": "600 +- 40 MPa",
        }
    )


def written(result, folder):
    return {path.name: path.read_bytes() for path in result.save(folder)}


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """Files of the three studies without a cluster."""
    return {name: run(tmp_path_factory.mktemp(name)) for name, run in STUDIES.items()}


def run_grid(folder, cluster=None):
    found = chatter.lobes(small_case(), grid=True, cluster=cluster, folder=folder)
    return {**written(found, folder), "radius": found.grid.spectral_radius.tobytes()}


def run_whatif(folder, cluster=None):
    vary = {"cut.radial_depth": ["0.4 mm", "0.8 mm", "1.2 mm"], "tool.teeth": [2, 3]}
    return written(
        chatter.whatif(small_case(), vary, "critical depth", folder=folder, cluster=cluster), folder
    )


def run_uncertainty(folder, cluster=None):
    found = chatter.uncertainty(small_case(), 12, speeds=5, folder=folder, cluster=cluster)
    return written(found, folder)


def column_machine(folder):
    """Head that climbs a column on a soft foot: the higher it stands, the softer the tool."""
    machine = {
        "tool_point": "tip",
        "workpiece": "work",
        "damping_ratio": 0.03,
        "body": {
            "bed": body(1e5),
            "column": body(300.0, (0.0, 0.0, 0.5), (30.0, 30.0, 30.0)),
            "head": body(80.0, (0.0, 0.0, 0.4), (2.0, 2.0, 2.0)),
        },
        "connector": {
            "anchors": spring("bed", "ground"),
            "foot": spring("column", "bed", rx=6e6, ry=5e6),
            "guide": spring("head", "column", at=(0.0, 0.0, 0.4), z=0.0),
        },
        "point": {
            "tip": {"on": "head", "at": [0.0, 0.0, 0.4]},
            "work": {"on": "bed", "at": [0.0, 0.0, 0.4]},
        },
        "axis": {
            "Z": linear_axis((0, 0, 1), "head", "column", ["head"]),
            "S": spindle("head", inertia=0.02),
        },
    }
    path = saved(folder, machine)
    cut = {"spindle_speed": "400 rpm", "axial_depth": "1 mm"}
    lobes = {"speeds": {"from": "300 rpm", "to": "500 rpm", "count": 8}, "depths": {"to": "60 mm"}}
    case = cut_case({"machine": str(path)}, cut=cut)
    return case.patch({"lobes": {"method": "zero-order", **lobes}})


@pytest.fixture(scope="module", autouse=True)
def column(tmp_path_factory):
    """The case on the column machine, its file where workers find it, too."""
    COLUMN["case"] = column_machine(tmp_path_factory.mktemp("column"))


COLUMN = {}
POSITION = "machine.axis.Z.position"


def run_workspace(folder, cluster=None):
    vary = {POSITION: ["0 mm", "120 mm", "250 mm"], "cut.radial_depth": ["5 mm", "6 mm"]}
    case = COLUMN["case"]
    found = chatter.whatif(
        case, vary, "lobes", quantity="critical_depth_mm", folder=folder, cluster=cluster
    )
    return written(found, folder)


def run_path(folder, cluster=None):
    found = chatter.lobes_over(
        COLUMN["case"], f"{POSITION}=50 mm..250 mm:6", cluster=cluster, folder=folder
    )
    return written(found, folder)


def run_map(folder, cluster=None):
    found = chatter.lobes_over(
        small_case(),
        "cut.spindle_speed=15000 rpm..20000 rpm:5",
        "cut.radial_depth=0.5 mm..2 mm:4",
        cluster=cluster,
        folder=folder,
    )
    return {**written(found, folder), "radius": found.spectral_radius.tobytes()}


STUDIES = {
    "grid": run_grid,
    "whatif": run_whatif,
    "uncertainty": run_uncertainty,
    "workspace": run_workspace,
    "path": run_path,
    "map": run_map,
}


def without_grid_archive(files):
    # an archive holds the time of writing; its content is compared as "radius"
    return {name: content for name, content in files.items() if name != "grid.npz"}


@pytest.mark.parametrize("name", STUDIES)
def test_same_bytes_as_without_a_cluster(name, client, here, tmp_path):
    # tasks of one item and of several
    for seconds in (1e-9, 30.0):
        folder = tmp_path / str(seconds)
        found = STUDIES[name](folder, DaskExecutor(client, seconds))
        assert without_grid_archive(found) == without_grid_archive(here[name])


@pytest.mark.parametrize("name", STUDIES)
def test_finished_points_are_not_computed_again(name, client, here, tmp_path):
    STUDIES[name](tmp_path, DaskExecutor(client))
    before = records_in(tmp_path)
    again = STUDIES[name](tmp_path, DaskExecutor(None))
    assert without_grid_archive(again) == without_grid_archive(here[name])
    assert records_in(tmp_path) == before


def records_in(folder):
    """Finished records of a folder by key, in the order in which they were added."""
    with ResultCache(folder) as cache:
        return {key: cache[key] for key in cache}


def slow_square(folder, seconds, number):
    """Square of a number; each time that it is computed leaves a file."""
    (Path(folder) / f"{number}-{os.getpid()}-{time.monotonic_ns()}").touch()
    time.sleep(seconds)
    return number * number


def pids_of(client):
    return list(client.run(os.getpid).values())


def test_a_lost_worker_costs_its_own_tasks_alone(client, tmp_path):
    square = partial(slow_square, str(tmp_path), 0.05)
    killed, found = None, {}
    for place, result in DaskExecutor(client, 0.15).results(square, range(40)):
        found[place] = result
        if killed is None and len(found) >= 8:
            killed = pids_of(client)[0]
            os.kill(killed, signal.SIGKILL)
    assert found == {number: number * number for number in range(40)}
    computed = [path.name.split("-") for path in tmp_path.iterdir()]
    repeated = len(computed) - 40
    # at most what the lost worker had begun or finished but not handed over: a few tasks of
    # three items, not the half of the study that it would have done
    assert 0 <= repeated <= 9
    assert str(killed) in {pid for _, pid, _ in computed}
    client.wait_for_workers(2, timeout=60)


class LosingAWorker(DaskExecutor):
    """Kills a worker process when some results have come."""

    killed = None

    def results(self, function, items):
        for count, found in enumerate(super().results(function, items)):
            if count == 2:
                self.killed = pids_of(self._client)[0]
                os.kill(self.killed, signal.SIGKILL)
            yield found


@pytest.mark.parametrize("name", ["workspace", "path"])
def test_a_study_of_the_workspace_bears_the_loss_of_a_worker(name, client, here, tmp_path):
    executor = LosingAWorker(client, 1e-9)
    assert STUDIES[name](tmp_path, executor) == here[name]
    assert executor.killed is not None
    assert len(records_in(tmp_path)) == 6
    client.wait_for_workers(2, timeout=60)
    assert executor.killed not in pids_of(client)


def test_a_study_of_the_workspace_goes_on_where_it_was(client, here, tmp_path):
    class Interrupted(DaskExecutor):
        def results(self, function, items):
            for count, found in enumerate(super().results(function, items)):
                if count == 3:
                    raise KeyboardInterrupt
                yield found

    with pytest.raises(RunError, match="interrupted: 3 of 6 values"):
        run_path(tmp_path, Interrupted(client, 1e-9))
    assert len(records_in(tmp_path)) == 3
    assert run_path(tmp_path, DaskExecutor(client)) == here["path"]
    assert len(records_in(tmp_path)) == 6


def test_the_workspace_makes_a_difference(here):
    rows = here["path"]["lobes.csv"].decode().splitlines()[1:]
    depths = [float(row.split(",")[1]) for row in rows]
    assert depths == sorted(depths, reverse=True)
    assert depths[-1] < 0.7 * depths[0]


def test_interruption_keeps_what_is_finished(client, here, tmp_path):
    class Interrupted(DaskExecutor):
        def results(self, function, items):
            for count, found in enumerate(super().results(function, items)):
                if count == 5:
                    raise KeyboardInterrupt
                yield found

    with pytest.raises(RunError, match="interrupted: 5 of 12 samples"):
        run_uncertainty(tmp_path, Interrupted(client, 1e-9))
    assert len(records_in(tmp_path)) == 5
    assert run_uncertainty(tmp_path, DaskExecutor(client)) == here["uncertainty"]
    assert len(records_in(tmp_path)) == 12


def fails(number):
    raise InputError([f"number {number} is wrong", "and so is all else"])


def test_errors_of_the_input_come_back_as_such(client):
    with pytest.raises(InputError) as raised:
        list(DaskExecutor(client).results(fails, [3]))
    assert raised.value.messages == ("number 3 is wrong", "and so is all else")


def test_tasks_take_some_seconds():
    cost = _TaskSize(3.0)
    assert cost.items_per_task(1000, 4) == 1
    cost.add(2, 0.5)
    assert cost.items_per_task(1000, 4) == 12
    # towards the end every worker gets a share
    assert cost.items_per_task(8, 4) == 2
    cost.add(1, 100.0)
    assert cost.items_per_task(1000, 4) == 1


def test_here_keeps_the_order():
    assert list(SerialExecutor().results(np.sqrt, [4.0, 9.0])) == [(0, 2.0), (1, 3.0)]


def test_a_task_uses_one_thread():
    before = worker_count()
    with one_thread():
        assert worker_count() == 1
        other = []
        thread = threading.Thread(target=lambda: other.append(worker_count()))
        thread.start()
        thread.join()
        assert other == [before]
    assert worker_count() == before


@pytest.mark.parametrize(
    "address", ["localhost", "tcp://", "tcp://host", "file:///etc/passwd:1", "http://a:1", ""]
)
def test_what_is_no_address_is_told(address):
    with pytest.raises(InputError, match="is no cluster"), open_executor(address):
        pass


def test_an_address_without_scheduler_is_told(monkeypatch):
    monkeypatch.setattr("chatter.studies.executor._SCHEDULER_TIMEOUT", 0.5)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{taken.getsockname()[1]}"
        with pytest.raises(InputError, match="no scheduler answers"), open_executor(address):
            pass


def test_a_missing_distributed_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"chatter\[cluster\]"), open_executor("local"):
        pass


def test_cluster_by_address(client, here, tmp_path):
    assert run_whatif(tmp_path, client.scheduler.address) == here["whatif"]


def compute_until_killed(address, scheduler):
    with open_executor(address) as executor:
        for place, _ in executor.results(time.sleep, [0.1] * 100):
            if place == 2:
                scheduler.kill()


def test_a_lost_scheduler_is_told(tmp_path):
    told = tmp_path / "scheduler.json"
    started = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1"]
    started += ["--port", "0", "--no-dashboard", "--scheduler-file", str(told)]
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    scheduler, workers = subprocess.Popen(started, **silent), None
    try:
        until = time.monotonic() + 60.0
        while not (told.is_file() and told.read_text().strip().endswith("}")):
            assert time.monotonic() < until
            time.sleep(0.05)
        address = json.loads(told.read_text())["address"]
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address]
        workers = subprocess.Popen([*worker, "--nthreads", "1", "--no-dashboard"], **silent)
        with pytest.raises(RunError, match="cluster is lost"):
            compute_until_killed(address, scheduler)
    finally:
        for process in (workers, scheduler):
            if process is not None:
                process.terminate()
                process.wait(20.0)


COMMAND = [sys.executable, "-c", "from chatter.cli import main; main()"]


class ResumedError(Exception):
    """What a study has before it goes on."""


def stop_at_once(before, total):
    raise ResumedError(before, total)


@pytest.mark.skipif(os.name != "posix", reason="Ctrl-C is sent as a signal")
def test_ctrl_c_on_the_command_line_and_resumption(tmp_path):
    case = tmp_path / "case.toml"
    small_case().save(case)
    out = tmp_path / "out"
    asked = [*COMMAND, "uncertainty", str(case), "--samples", "3000", "--speeds", "9"]
    process = subprocess.Popen(
        [*asked, "--cluster", "local", "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        until = time.monotonic() + 90.0
        while not records_in(out) and time.monotonic() < until:
            assert process.poll() is None, process.communicate()
            time.sleep(0.05)
        # as a terminal does: to the whole group, workers included
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    assert process.returncode == 1
    assert "interrupted: " in errors
    assert "the same command goes on from there" in errors
    assert "Traceback" not in errors
    kept = len(records_in(out))
    assert kept > 0
    # workers finish in any order: only the whole study is sure to ask for what was kept
    with pytest.raises(ResumedError) as resumed:
        chatter.uncertainty(chatter.load(case), 3000, speeds=9, folder=out, resumed=stop_at_once)
    assert resumed.value.args == (kept, 3000)
