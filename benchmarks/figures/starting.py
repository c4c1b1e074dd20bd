"""From the start of a process to its end, warm, and the first use with nothing compiled."""

import os
import subprocess
import sys
import tempfile
import time
from functools import partial

from benchmarks.figures.figure import Figure, Reached
from benchmarks.start_up import CASE, HERE, TARGETS, command_of, taken

#: what a command cannot do without: the bound is a bare Python that loads it
_LOADS = {
    "--help": "pass",
    "import": "pass",
    "check": "import numpy",
    "lobes": "import numpy, matplotlib.figure, matplotlib.backends.backend_agg",
    "simulate": "import numpy, matplotlib.figure, matplotlib.backends.backend_agg",
}
_TIMES, _FIRST_USE = 4, 10.0


def _warm(name: str) -> Reached:
    with tempfile.TemporaryDirectory() as folder:
        bytecode = f"{folder}/bytecode"
        command = command_of(name, CASE, f"{folder}/out")
        walls = [taken(command, HERE, bytecode)[0] for _ in range(_TIMES + 1)]
        bare = [taken(["-c", _LOADS[name]], HERE, bytecode)[0] for _ in range(_TIMES)]
    return Reached(min(walls[1:]), f"python -c '{_LOADS[name]}': {min(bare):.2f} s")


def _first_use() -> Reached:
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PYTHONPATH": str(HERE), "XDG_CACHE_HOME": folder}
        environment.pop("NUMBA_CACHE_DIR", None)
        begun = time.perf_counter()
        command = [sys.executable, *command_of("check", CASE, folder)]
        subprocess.run(command, env=environment, cwd=HERE, check=True, capture_output=True)
        return Reached(time.perf_counter() - begun)


FIGURES = (
    *(
        Figure(f"start {name}", f"chatter {name}, warm", target, "s", partial(_warm, name))
        for name, target in TARGETS.items()
    ),
    Figure("first use", "chatter check, nothing compiled", _FIRST_USE, "s", _first_use),
)
