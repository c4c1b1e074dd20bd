"""Figures that were asked for, in one table: ``python -m benchmarks [NAME ...] [--out FILE]``.

Each row: the work, what is wanted, what was reached in this run, the bound and a peer. Other work
on the machine lengthens the times; its load stands above the table. Every other benchmark is a
module of its own (`make benchmarks` runs those of this folder).
"""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path

from benchmarks.figures import closing_the_loop, stability, starting, tap_tests, time_domain

FIGURES = (
    *starting.FIGURES,
    *stability.FIGURES,
    *time_domain.FIGURES,
    *closing_the_loop.FIGURES,
    *tap_tests.FIGURES,
)


def main() -> None:
    """Measure and print."""
    names = [one.name for one in FIGURES]
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(names)}")
    parser.add_argument("--out", type=Path, help="JSON file of the rows")
    given = parser.parse_args()
    if unknown := sorted(set(given.names) - set(names)):
        parser.error(f"{', '.join(unknown)}: there is {', '.join(names)}")
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}\n")
    print(f"{'work':52s} {'wanted':>8s} {'reached':>8s} unit")
    rows = []
    for one in FIGURES:
        if given.names and one.name not in given.names:
            continue
        reached = one.measured()
        verdict = "" if one.is_met(reached) else "  not met"
        print(f"{one.work:52s} {one.wanted:8.3g} {reached.value:8.3g} {one.unit}{verdict}")
        for label, text in (("bound", reached.bound), ("peer", reached.peer)):
            if text:
                print(f"    {label}: {text}", flush=True)
        rows.append({"name": one.name, "work": one.work, "wanted": one.wanted, "unit": one.unit,
                     **reached._asdict(), "met": one.is_met(reached)})  # fmt: skip
    if given.out:
        given.out.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
