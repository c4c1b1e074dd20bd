"""How many faulty hammer records are found and how many good ones lost, over hundreds of sets.

Run:  python -m benchmarks.hammer_examination [sets] [seed]

Sets of six to nine records of a three-mode structure (two modes 2 to 8 % apart), none to three
records with a fault of random kind and severity, in three conditions: white noise of half to four
times an ordinary sensor's; sensors with offset, mains hum and converter steps and a hand that
scatters by 1 %; and a hand that scatters by 3 %. Prints rates by fault and the faults missed.
"""

from __future__ import annotations

import sys
import time
from collections import Counter, defaultdict
from typing import NamedTuple

import numpy as np

from dynamics.frf.hammer.examine import examine_records
from tests.dynamics.frf.hammer.hammer_records import random_set

CONDITIONS = {
    "white noise": {},
    "real sensors, hand 1 %": {"sensors": "real", "scatter": 0.01},
    "real sensors, hand 3 %": {"sensors": "real", "scatter": 0.03},
}


class Rates(NamedTuple):
    """How many records with a fault were found, and how many good ones lost."""

    found: int
    faulty: int
    lost: int
    good: int


def study(sets: int, seed: int, condition: dict) -> Rates:
    """Examine random sets and print the rates."""
    injected, named, missed, lost = Counter(), defaultdict(Counter), [], []
    good = wrong_sets = 0
    start = time.perf_counter()
    for number in range(sets):
        _, taps = random_set(np.random.default_rng([seed, number]), **condition)
        found = {
            finding.record: finding
            for finding in reversed(examine_records([tap.record for tap in taps]))
            if finding.is_decisive
        }
        before = len(missed) + len(lost)
        for tap in taps:
            finding = found.get(tap.record.name)
            if not tap.fault:
                good += 1
                lost += [(number, finding)] if finding else []
                continue
            injected[tap.fault] += 1
            if finding is None:
                missed.append((number, tap.fault, tap.severity))
            else:
                named[tap.fault][finding.fault] += 1
        wrong_sets += len(missed) + len(lost) > before
    seconds = (time.perf_counter() - start) / sets
    faulty = sum(injected.values())
    print(f"  sets {sets}, not entirely right {wrong_sets}, {seconds:.2f} s a set")
    print(f"  faulty records found {faulty - len(missed)} of {faulty}")
    print(f"  good records lost    {len(lost)} of {good}")
    for fault, count in sorted(injected.items()):
        found_count = sum(named[fault].values())
        names = ", ".join(f"{name} {n}" for name, n in named[fault].most_common())
        print(f"    {fault:13s} {found_count:4d} of {count:4d}   named {names}")
    for number, fault, severity in missed:
        print(f"    missed in set {number}: {fault}, {severity}")
    for number, finding in lost:
        print(f"    lost in set {number}: {finding.record}, {finding.fault}: {finding.reason}")
    return Rates(faulty - len(missed), faulty, len(lost), good)


def main() -> None:
    """Run the study in every condition."""
    sets = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    for name, condition in CONDITIONS.items():
        print(name)
        study(sets, seed, condition)


if __name__ == "__main__":
    main()
