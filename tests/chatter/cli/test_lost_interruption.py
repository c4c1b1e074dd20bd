"""Ctrl-C that is swallowed by what calls Python from C ends the work all the same."""

import subprocess
import sys

PROGRAM = """
import ctypes, signal, sys, time
from chatter.cli.lost_interruption import repeat_lost_interruptions

told = []
sys.unraisablehook = lambda lost: told.append(lost.exc_type.__name__)
repeat_lost_interruptions()
called = ctypes.CFUNCTYPE(None)


def fails():
    raise ValueError


called(fails)()
for _ in range(20):
    try:
        called(lambda: signal.raise_signal(signal.SIGINT))()
        time.sleep(60.0)
    except KeyboardInterrupt:
        told.append("interrupted")
print(told[0], told.count("interrupted"), len(told))
"""


def test_what_was_swallowed_comes_again_and_other_errors_are_told_as_before():
    line = [sys.executable, "-c", PROGRAM]
    ended = subprocess.run(line, capture_output=True, text=True, timeout=50.0, check=False)
    assert (ended.returncode, ended.stdout.strip()) == (0, "ValueError 20 21"), ended.stderr
