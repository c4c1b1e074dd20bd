"""Long commands killed (SIGKILL) at random moments and started again: the same bytes in the end.

    python -m benchmarks.killed_commands OUT [--kills 30] [--seed 0] [--commands whatif optimum ...]

Every command runs undisturbed first. Then it is killed at a random moment of that time and begun
again in the same folder, so many times; each time it then runs to its end, and what it has written
has to be that of the undisturbed run, byte by byte. The folder begins empty at every second kill,
at the others it holds what the last run left. The same is asked of two runs at once in one folder.
"""

import argparse
import os
import random
import shutil
import subprocess
import sys
import time
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
    "learn": ("learn", "EXAMPLES/explain-stability/measurement/case.toml", "POINTS"),
}


def started(words: tuple[str, ...], case: Path, out: Path) -> subprocess.Popen:
    """Process of a command."""
    points = EXAMPLES / "explain-stability/measurement/points.csv"
    named = {"CASE": str(case), "POINTS": str(points)}
    line = [named.get(word, word.replace("EXAMPLES", str(EXAMPLES))) for word in words]
    return subprocess.Popen(
        [sys.executable, "-m", "chatter", *line, "--out", str(out)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env={**os.environ, "COLUMNS": "200"},
        text=True,
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
    target = folder / "twice"
    both = [started(words, case, target) for _ in range(2)]
    said = " ".join(finished(one) for one in both).strip() or differing(content(target), wanted)
    if said:
        defects += 1
        print(f"{name}: two runs in one folder: {said}", flush=True)
    print(f"{name}: {lasted:.1f} s, {kills} kills, 2 runs at once, {defects} defects", flush=True)
    return defects


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
