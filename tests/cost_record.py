"""What each test costs: processor time without compilation, and the kinds of time loop it needs.

    CHATTER_TEST_COSTS=FILE pytest -n auto --dist loadfile -p tests.cost_record

appends a line of JSON for each test to FILE, from which `tests.nightly_tests` chooses. A kind of
the time loop is one choice of laws, which takes about ten seconds to compile.
"""

import hashlib
import importlib
import json
import os
import resource
import time
from pathlib import Path

import numba
import pytest
from numba.core import event

#: modules that run the time loop
_RUNS = ("simulation.cut_run", "simulation.virtual_tests.run", "engine.loop_stability")


class _Compilation(event.Listener):
    """Processor time of this process within the compiler, s."""

    def __init__(self):
        self.seconds, self._begun, self._within = 0.0, 0.0, 0

    def on_start(self, event):
        if not self._within:
            self._begun = time.process_time()
        self._within += 1

    def on_end(self, event):
        self._within -= 1
        if not self._within:
            self.seconds += time.process_time() - self._begun


class _CountedLoop:
    """The time loop, which notes by which types it is called."""

    def __init__(self, loop, kinds):
        self._loop, self._kinds = loop, kinds

    def __call__(self, *given):
        types = str(tuple(numba.typeof(one) for one in given))
        self._kinds.add(hashlib.sha256(types.encode()).hexdigest()[:12])
        return self._loop(*given)

    def __getattr__(self, name):
        return getattr(self._loop, name)


class CostRecord:
    """Plugin of one process of tests."""

    def __init__(self, file: Path) -> None:
        self._file, self._kinds, self._compilation = file, set(), _Compilation()
        event.register("numba:compile", self._compilation)
        for name in _RUNS:
            module = importlib.import_module(f"chatter.{name}")
            module.run = _CountedLoop(module.run, self._kinds)

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item):
        self._kinds.clear()
        self._compilation.seconds, before = 0.0, _processor_time()
        yield
        seconds = _processor_time() - before - self._compilation.seconds
        line = [item.nodeid, round(max(seconds, 0.0), 3), sorted(self._kinds)]
        with self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")


def _processor_time() -> float:
    """Of this process and of those that it has waited for, s."""
    used = (resource.getrusage(whose) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def pytest_configure(config):
    """Processes that run tests record them."""
    if hasattr(config, "workerinput"):
        config.pluginmanager.register(CostRecord(Path(os.environ["CHATTER_TEST_COSTS"])))
