"""Survey and report: ``python -m benchmarks.calibration OUT --count 300 --seed 1``."""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.blind_sets.__main__ import KINDS
from benchmarks.calibration.answers import read_answers, surveyed
from benchmarks.calibration.picture import draw
from benchmarks.calibration.reliability import in_words, summary_of


def main() -> None:
    """Command line."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.calibration", description=__doc__)
    options.add_argument("out", type=Path)
    options.add_argument("--count", type=int, default=300)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--kinds", nargs="+", choices=KINDS, default=["frf", "axis", "stability"])
    options.add_argument("--processes", type=int, default=1, help="sets explained at once")
    options.add_argument("--report", action="store_true", help="of what was answered already")
    given = options.parse_args()
    if not given.report:
        for one in surveyed(given.out, given.kinds, given.count, given.seed, given.processes):
            names = [effect["name"] for effect in one["effects"]]
            print(
                f"{one['kind']} {one['number']}: {one['truth'] or 'none'} -> {one['verdict']} "
                f"{names}, {one['seconds']} s",
                flush=True,
            )
    answers = read_answers(given.out / "answers.jsonl")
    if not answers:
        print("no set was answered yet")
        return
    draw(summary_of(answers), given.out / "reliability.png")
    print(in_words(answers))


if __name__ == "__main__":
    main()
