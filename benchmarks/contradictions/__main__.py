"""Hunt for contradictions: ``python -m benchmarks.contradictions OUT --count 5000 --seed 1``.

A run that was ended goes on where it was: what the folder holds is not computed again.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from benchmarks.contradictions.confrontation_list import CONFRONTATIONS, by_name
from benchmarks.contradictions.hunt import hunt, table, tasks_of
from benchmarks.contradictions.one_case import Judged

#: seconds between two lines of progress
_BETWEEN = 30.0


class _Progress:
    """Findings as they come, and every half minute how far it is."""

    def __init__(self, count: int) -> None:
        self.count, self.done, self.findings = count, 0, 0
        self.last = time.monotonic()

    def __call__(self, found: Judged) -> None:
        self.done += 1
        if found.is_finding:
            self.findings += 1
            worst = max((one["excess"] for one in found.compared), default=0.0)
            print(
                f"{found.outcome}: {found.confrontation} {found.seed} {found.number}: "
                f"{found.reason or f'{worst:.3g} times what is allowed'}",
                flush=True,
            )
        if time.monotonic() - self.last > _BETWEEN:
            self.last = time.monotonic()
            print(f"{self.done} of at most {self.count}, {self.findings} findings", flush=True)


def main() -> int:
    """Command line; 1 where anything disagrees, failed or took too long."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.contradictions", description=__doc__
    )
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=5000, help="cases over all confrontations")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--time-limit", type=float, default=120.0, help="of a case, s")
    names = [one.name for one in CONFRONTATIONS]
    parser.add_argument("--only", action="append", choices=names, help="confrontation; repeatable")
    given = parser.parse_args()
    chosen = [by_name(name) for name in given.only] if given.only else list(CONFRONTATIONS)
    results = hunt(
        given.out,
        tasks_of(chosen, given.seed, given.count),
        given.workers,
        given.time_limit,
        _Progress(given.count),
    )
    text = table(results)
    (given.out / "table.md").write_text(text, encoding="utf-8")
    print(text)
    return int(any(one.is_finding for one in results))


if __name__ == "__main__":
    sys.exit(main())
