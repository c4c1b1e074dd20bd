"""`explain` from the start of a new process to its answer."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.blind_sets.__main__ import write_sets
from benchmarks.figures.figure import Figure, Reached
from benchmarks.start_up import HERE


def _explained(effect: str) -> Reached:
    """Of a set with an effect that is drawn for this purpose, with kernels in the cache."""
    with tempfile.TemporaryDirectory() as folder:
        write_sets(Path(folder), "milling", 1, 1, effect)
        (place,) = Path(folder).glob("set-*")
        runs = len(list(place.glob("run*.csv")))
        command = [sys.executable, "-m", "chatter", "explain", str(place), "--out", folder + "/o"]
        begun = time.perf_counter()
        environment = {**os.environ, "PYTHONPATH": str(HERE)}
        subprocess.run(command, env=environment, cwd=HERE, check=True, capture_output=True)
        return Reached(time.perf_counter() - begun, f"{runs} runs")


FIGURES = (
    Figure("explain", "runout found in seven runs", 12.0, "s", lambda: _explained("runout")),
    Figure("unexplained", "an effect in no list", 30.0, "s", lambda: _explained("cubic_stiffness")),
)
