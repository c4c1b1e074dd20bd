"""Ctrl-C while compiled code runs is an exception of Python, never the end of the process."""

import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from chatter.engine import interruption

#: the first call unpickles the types of its results, later ones look them up
PROGRAM = """
import signal, threading, time
from typing import NamedTuple
import numpy as np
from numba import njit, types

import chatter.engine.presets

class Pair(NamedTuple):
    first: np.ndarray
    second: np.ndarray

@njit(nogil=True)
def work(count):
    total = 0.0
    for i in range(count):
        total += np.sin(total + i)
    return Pair(np.full(2, total), np.ones(3)), Pair(np.ones(1), np.ones(2))

work.compile((types.int64,))
caught, longest = 0, 0.0
for _ in range(10):
    begun = time.monotonic()
    threading.Timer(0.02, signal.raise_signal, [signal.SIGINT]).start()
    try:
        work(5_000_000)
        time.sleep(10.0)
    except KeyboardInterrupt:
        caught += 1
        longest = max(longest, time.monotonic() - begun)
print(caught, longest < 8.0)
"""


def test_ctrl_c_in_compiled_code_is_a_keyboard_interrupt():
    line = [sys.executable, "-c", PROGRAM]
    ended = subprocess.run(line, capture_output=True, text=True, timeout=120.0, check=False)
    assert (ended.returncode, ended.stdout.strip()) == (0, "10 True"), ended.stderr


#: with a WAIT longer than the delay, Ctrl-C comes again while the first is still being told
SWALLOWED = """
import ctypes, signal, sys, time
from chatter.engine import interruption

told = []
sys.unraisablehook = lambda lost: told.append(lost.exc_type.__name__)
interruption.repeat_swallowed_interruptions()
sent = interruption._send_later
waits = []


def late(number):
    sent(number)
    end = time.monotonic() + (waits.pop() if waits else 0.0)
    while time.monotonic() < end:
        pass


interruption._send_later = late
called = ctypes.CFUNCTYPE(None)


def fails():
    raise ValueError


called(fails)()
for _ in range(10):
    waits.append(WAIT)
    try:
        called(lambda: signal.raise_signal(signal.SIGINT))()
        time.sleep(60.0)
    except KeyboardInterrupt:
        told.append("interrupted")
print(told)
"""


@pytest.mark.parametrize("wait", [0.0, 0.02])
def test_what_was_swallowed_comes_again_and_other_errors_are_told_as_before(wait):
    line = [sys.executable, "-c", SWALLOWED.replace("WAIT", repr(wait))]
    ended = subprocess.run(line, capture_output=True, text=True, timeout=50.0, check=False)
    told = ["ValueError", *["interrupted"] * 10]
    assert (ended.returncode, ended.stdout.strip()) == (0, repr(told)), ended.stderr


@pytest.fixture
def handler(monkeypatch):
    before = signal.getsignal(signal.SIGINT)
    yield lambda: signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, before)


def test_the_handler_that_was_there_is_called(handler):
    called = []
    signal.signal(signal.SIGINT, lambda *_: called.append("mine"))
    interruption.defer_interruptions()
    signal.raise_signal(signal.SIGINT)
    assert called == ["mine"]


def test_a_process_that_ignores_ctrl_c_goes_on_ignoring_it(handler):
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    interruption.defer_interruptions()
    with interruption.interruptions_deferred():
        assert handler() is signal.SIG_IGN


def test_a_handler_set_since_is_back_after_the_call(handler):
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with interruption.interruptions_deferred():
        assert handler() is not signal.default_int_handler
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert handler() is signal.default_int_handler


def test_a_notebook_defers_in_every_cell(handler, monkeypatch):
    hooks = []
    shell = SimpleNamespace(
        events=SimpleNamespace(register=lambda event, hook: hooks.append((event, hook)))
    )
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    signal.signal(signal.SIGINT, signal.default_int_handler)
    interruption.defer_interruptions()
    (event, hook), deferring = hooks[0], handler()
    assert event == "pre_run_cell"
    # as the kernel of a notebook does before each cell
    signal.signal(signal.SIGINT, signal.default_int_handler)
    hook(None)
    assert type(handler()) is type(deferring)
