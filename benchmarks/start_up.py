"""Time of short commands from the start of the process to its end, warm.

    python -m benchmarks.start_up [--times 4] [--case CASE] [--beside FOLDER]

Wall time, and processor time of user and system, of the best of several runs; compiled code is on
disk after a run that is not counted. Modules are compiled to bytecode once, as an installation
does, whatever the environment says. With `--beside`, another checkout takes turns with this one,
and the ratio of processor times is printed: on a machine with other work it alone says something.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
CASE = "examples/two-degrees-of-freedom/case.toml"
#: command -> wall time that it should take on a quiet machine with two cores, s
TARGETS = {"--help": 0.15, "import": 0.05, "check": 0.6, "lobes": 1.2, "simulate": 1.5}


def command_of(name: str, case: str, out: str) -> list[str]:
    """Arguments of Python for a row of the table."""
    if name == "import":
        return ["-c", "import chatter"]
    if name == "--help":
        return ["-m", "chatter", name]
    return ["-m", "chatter", name, case, *([] if name == "check" else ["--out", out])]


def taken(arguments: list[str], root: Path, bytecode: str) -> tuple[float, float]:
    """Wall and processor time of a Python process on a checkout, s."""
    environment = {**os.environ, "PYTHONPATH": str(root), "PYTHONPYCACHEPREFIX": bytecode}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [sys.executable, *arguments], env=environment, cwd=root, check=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    wall = time.perf_counter() - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--times", type=int, default=4)
    parser.add_argument("--case", default=CASE)
    parser.add_argument("--beside", type=Path)
    given = parser.parse_args()
    roots = [HERE, *([given.beside.resolve()] if given.beside else [])]
    print(
        f"{'warm, s':12s} {'target':>7s} {'wall':>7s} {'processor':>10s}  beside: processor, ratio"
    )
    with tempfile.TemporaryDirectory() as folder:
        for name, target in TARGETS.items():
            arguments = command_of(name, given.case, f"{folder}/out")
            runs: dict[Path, list[tuple[float, float]]] = {root: [] for root in roots}
            for number in range(given.times + 1):
                for root in roots:
                    one = taken(arguments, root, f"{folder}/bytecode")
                    if number > 0:
                        runs[root].append(one)
            wall, processor = (min(values) for values in zip(*runs[HERE], strict=True))
            line = f"{name:12s} {target:7.2f} {wall:7.2f} {processor:10.2f}"
            for root in roots[1:]:
                other = min(one for _, one in runs[root])
                line += f"  {other:.2f}, {processor / other:.2f}"
            print(line, flush=True)


if __name__ == "__main__":
    main()
