"""Stress study of the modal identification: made-up structures by the hundred.

    python -m benchmarks.modal_identification [cases per kind] [first seed] [kind ...]

For each kind of structure it prints how many of the modes that the data bear (Cramer-Rao bound
of the damping below 10 %) were found, how many of those accurately (0.2 % in frequency and 5 % in
damping, or four times the bound), how many modes were reported that do not exist, and the time.
With VERBOSE set in the environment every failure is listed.
"""

from __future__ import annotations

import os
import sys
import time

from dynamics.identification.fit import identify_modes
from tests.dynamics.identification import made_up_frfs as made_up


def main(arguments: list[str]) -> None:
    count = int(arguments[0]) if arguments else 40
    first = int(arguments[1]) if len(arguments) > 1 else 0
    kinds = arguments[2:] or list(made_up.KINDS)
    print(
        f"{'kind':14s}{'cases':>6s}{'modes':>7s}{'found':>8s}{'accurate':>9s}"
        f"{'false':>7s}{'perfect':>9s}{'s/case':>8s}"
    )
    for kind in kinds:
        modes = found = accurate = false = perfect = 0
        start = time.perf_counter()
        for seed in range(first, first + count):
            case = made_up.made_up_case(kind, seed)
            try:
                score = made_up.score(case, identify_modes(case.frfs))
            except Exception as error:  # a crash counts as everything missed
                print(f"{kind} {seed}: {type(error).__name__}: {error}")
                modes += len(case.modes)
                continue
            modes += score.attainable
            found += score.found
            accurate += score.accurate
            false += score.false
            perfect += score.accurate == score.attainable and not score.false
            if score.missed and os.environ.get("VERBOSE"):
                print(f"  {kind} {seed}: " + "; ".join(score.missed))
        seconds = (time.perf_counter() - start) / count
        print(
            f"{kind:14s}{count:6d}{modes:7d}{found / max(modes, 1):8.1%}"
            f"{accurate / max(modes, 1):9.1%}{false:7d}{perfect / count:9.1%}{seconds:8.2f}"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
