"""Long commands killed (SIGKILL) at random moments and started again: the same bytes in the end.

    python -m benchmarks.killed_commands OUT [--kills 30] [--seed 0] [--commands whatif optimum ...]

Every command runs undisturbed first. Then it is killed at a random moment of that time and begun
again in the same folder, so many times; each time it then runs to its end, and what it has written
has to be that of the undisturbed run, byte by byte. The folder begins empty at every second kill,
at the others it holds what the last run left. The same is asked of two runs at once in one folder,
of a run whose disk is full at a random size of a file (it has to say so, without a traceback, and
goes on when there is room), and of one that goes on after a kill with the clock set back ten years.
"""

import argparse
import os
import random
import resource
import shutil
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import tomlkit

EXAMPLES = Path(__file__).parents[1] / "examples"
_END_MILL = {
    "tool": {"teeth": 2, "diameter": "16 mm"},
    "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
    "cut": {
        "mode": "down",
        "spindle_speed": "9000 rpm",
        "feed_per_tooth": "0.1 mm",
        "axial_depth": "1 mm",
        "radial_depth": "8 mm",
    },
    "structure": {
        "mode": [
            {
                "frequency": "922 +- 10 Hz",
                "damping": 0.011,
                "mass": "0.04 kg",
                "direction": [1, 0, 0],
            }
        ]
    },
    "lobes": {
        "speeds": {"from": "5000 rpm", "to": "11000 rpm", "count": 30},
        "depths": {"to": "5 mm", "count": 20},
    },
    "optimum": {
        "speeds": {"from": "8800 rpm", "to": "9600 rpm"},
        "depths": {"to": "3 mm", "count": 10},
        "max_power": "2 kW",
    },
    "pitch_design": {
        "speeds": {"from": "8800 rpm", "to": "9600 rpm"},
        "depths": {"to": "3 mm", "count": 10},
        "count": 4,
    },
}
#: command -> its words; CASE and EXAMPLES are replaced
COMMANDS = {
    "whatif": ("whatif", "CASE", "--vary", "cut.radial_depth=2 mm..8 mm:9"),
    "uncertainty": ("uncertainty", "CASE", "--samples", "40"),
    "optimum": ("optimum", "CASE"),
    "pitch": ("pitch", "CASE"),
    "bifurcation": ("bifurcation", "CASE", "--vary", "cut.axial_depth=0.5 mm..3 mm:12"),
    "lobes-axes": (
        "lobes",
        "CASE",
        "--x",
        "cut.radial_depth=2 mm..8 mm:8",
        "--y",
        "cut.axial_depth=0.5 mm..3 mm:8",
    ),
    "lobes-grid": ("lobes", "CASE", "--grid"),
    "simulate": ("simulate", "CASE"),
    "explain": ("explain", "EXAMPLES/explain-stability/measurement"),
    "explain-frf": ("explain", "EXAMPLES/explain-frf/measurement"),
    "explain-axis": ("explain", "EXAMPLES/explain-axis/measurement"),
    "explain-cuts": ("explain", "EXAMPLES/explain-milling/measurement"),
    "learn": ("learn", "EXAMPLES/explain-stability/measurement/case.toml", "POINTS"),
}


#: loaded by Python before anything else where it lies on its path
_CLOCK_SET_BACK = """
import time
now, now_ns = time.time, time.time_ns
time.time = lambda: now() - 10 * 365 * 86400.0
time.time_ns = lambda: now_ns() - 10 * 365 * 86400 * 10**9
"""
#: bytes that a file has at the most, of a disk that is full
_FULL = (1_000, 60_000)


def started(
    words: tuple[str, ...], case: Path, out: Path, *, path: str = "", largest: int | None = None
) -> subprocess.Popen:
    """Process of a command, with a folder before Python's path and a largest size of files."""
    points = EXAMPLES / "explain-stability/measurement/points.csv"
    named = {"CASE": str(case), "POINTS": str(points)}
    line = [named.get(word, word.replace("EXAMPLES", str(EXAMPLES))) for word in words]
    return subprocess.Popen(
        [sys.executable, "-m", "chatter", *line, "--out", str(out)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env={**os.environ, "COLUMNS": "200", "PYTHONPATH": path},
        text=True,
        preexec_fn=None
        if largest is None
        else partial(resource.setrlimit, resource.RLIMIT_FSIZE, (largest, largest)),
    )


def finished(process: subprocess.Popen) -> str:
    """Wait for the end; empty, or what went wrong."""
    _, said = process.communicate()
    return "" if process.returncode == 0 else f"exit {process.returncode}: {said.strip()[-500:]}"


def content(folder: Path) -> dict[str, bytes]:
    """Every file that is left but those of the result cache."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and "result-cache" not in path.parts
    }


def differing(found: dict[str, bytes], wanted: dict[str, bytes]) -> str:
    """Names of files that differ, are missing or left over; empty where there are none."""
    names = [name for name in sorted({*found, *wanted}) if found.get(name) != wanted.get(name)]
    return ", ".join(names)


def campaign(name: str, out: Path, kills: int, chance: random.Random) -> int:
    """Kill a command so many times; the number of runs that did not end as they should."""
    words, folder = COMMANDS[name], out / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    case = folder / "case.toml"
    case.write_text(tomlkit.dumps(_END_MILL), encoding="utf-8")
    finished(started(words, case, folder / "first"))  # compiles
    begun = time.monotonic()
    wrong = finished(started(words, case, folder / "whole"))
    lasted = time.monotonic() - begun
    wanted = content(folder / "whole")
    if wrong or not wanted:
        print(f"{name}: {wrong or 'writes nothing'}", flush=True)
        return 1
    defects = 0
    for number in range(kills):
        target = folder / "killed"
        if number % 2 == 0:
            shutil.rmtree(target, ignore_errors=True)
        process = started(words, case, target)
        time.sleep(chance.uniform(0.0, lasted))
        process.kill()
        process.communicate()
        said = finished(started(words, case, target)) or differing(content(target), wanted)
        if said:
            defects += 1
            print(f"{name}: kill {number}: {said}", flush=True)
    beside = {
        "two runs in one folder": two_at_once(words, case, folder / "twice"),
        "disk full": on_a_full_disk(words, case, folder / "full", chance.randint(*_FULL)),
        "clock set back": with_the_clock_set_back(
            words, case, folder / "clock", chance.uniform(0.0, lasted)
        ),
    }
    for what, (said, target) in beside.items():
        said = said or differing(content(target), wanted)
        if said:
            defects += 1
            print(f"{name}: {what}: {said}", flush=True)
    also = ", ".join(beside)
    print(f"{name}: {lasted:.1f} s, {kills} kills, {also}: {defects} defects", flush=True)
    return defects


def two_at_once(words: tuple[str, ...], case: Path, target: Path) -> tuple[str, Path]:
    """Two runs in one folder: what went wrong, and where they wrote."""
    both = [started(words, case, target) for _ in range(2)]
    return " ".join(finished(one) for one in both).strip(), target


def on_a_full_disk(
    words: tuple[str, ...], case: Path, target: Path, largest: int
) -> tuple[str, Path]:
    """A run that finds no room, which has to say so, and one that does."""
    first = started(words, case, target, largest=largest)
    _, said = first.communicate()
    told = [line for line in said.splitlines() if line.startswith("chatter: ")]
    is_told = bool(told) and not any("a fault in chatter" in line for line in told)
    if first.returncode and (not is_told or "Traceback" in said):
        return f"exit {first.returncode} without a clear message: {said.strip()[-300:]}", target
    return finished(started(words, case, target)), target


def with_the_clock_set_back(
    words: tuple[str, ...], case: Path, target: Path, seconds: float
) -> tuple[str, Path]:
    """A run that goes on after a kill ten years before it began."""
    (target.parent / "sitecustomize.py").write_text(_CLOCK_SET_BACK, encoding="utf-8")
    process = started(words, case, target)
    time.sleep(seconds)
    process.kill()
    process.communicate()
    return finished(started(words, case, target, path=str(target.parent))), target


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS))
    asked = parser.parse_args()
    chance = random.Random(asked.seed)
    defects = sum(campaign(name, asked.out, asked.kills, chance) for name in asked.commands)
    print(f"{len(asked.commands)} commands, {asked.kills} kills each: {defects} defects")
    sys.exit(defects > 0)


if __name__ == "__main__":
    main()
