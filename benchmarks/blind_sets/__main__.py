"""Write blind sets: ``python -m benchmarks.blind_sets OUT --kind milling --count 20 --seed 1``."""

from __future__ import annotations

import argparse
import importlib
from pathlib import Path

import numpy as np

KINDS = ("milling", "axis", "stability", "frf", "recorded")
#: first number of the sets of a kind, so that kinds can share a folder
FIRST = {"milling": 1, "axis": 1001, "stability": 2001, "frf": 3001, "recorded": 4001}


def write_sets(out: Path, kind: str, count: int, seed: int, effect: str | None = None) -> None:
    """Write ``count`` sets of a kind; each hangs on the seed and its own number alone."""
    module = importlib.import_module(f"benchmarks.blind_sets.{kind}")
    for number in range(1, count + 1):
        rng = np.random.default_rng([seed, KINDS.index(kind), number])
        module.write_set(out, FIRST[kind] + number - 1, rng, effect)
        print(f"set-{FIRST[kind] + number - 1:04d}", flush=True)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blind_sets", description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--kind", choices=KINDS, default="milling")
    parser.add_argument("--count", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--effect", help="one name, two joined by +, or none")
    given = parser.parse_args()
    write_sets(given.out, given.kind, given.count, given.seed, given.effect)


if __name__ == "__main__":
    main()
