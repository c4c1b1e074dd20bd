"""Chooses the slow tests that `make test` leaves to `make nightly`, by what they cost.

    CHATTER_TEST_COSTS=COSTS pytest -n auto --dist loadfile -p tests.cost_record
    python -m tests.nightly_tests COSTS

rewrites tests/nightly.txt, which tests/conftest.py reads; what the file names already and the run
left out stays in it. Of a test with several cases the quickest stays in `make test`, of every
module one test at the least. A test of the physics that has no cases is left out only if it takes
long, since it may be the only one that fails for a wrong sign, factor or unit. Tests that are very
slow, and the few for which a kind of the time loop would be compiled, are left out in any case.
"""

import argparse
import json
import math
import os
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
#: names the list in place of tests/nightly.txt
OTHER_LIST = "CHATTER_NIGHTLY_LIST"
LIST = Path(os.environ.get(OTHER_LIST) or ROOT / "tests" / "nightly.txt")
#: seconds from which on a case of a test is slow, a test that has but one, of physics or not, and
#: any test
SLOW_CASE, SLOW_TEST, SLOW_PHYSICS, VERY_SLOW = 0.2, 0.3, 1.0, 2.5
#: a kind of the time loop that no more tests than these need is compiled for few
FEW = 12
#: published numbers, the rules of the tree and the only run of a command stay in every run
_ALWAYS = (
    "tests/chatter/assembly/test_assemble.py::test_command_writes_what_it_says",
    "tests/validation/test_published.py",
    "tests/validation/test_hajdu_2020.py",
    "tests/test_architecture.py",
)
#: trees of the physics, and of published machines
_PHYSICS = (
    "tests/cutting/",
    "tests/dynamics/",
    "tests/examples/",
    "tests/validation/",
    "tests/chatter/compile/",
    "tests/chatter/detection/",
    "tests/chatter/engine/",
    "tests/chatter/simulation/",
    "tests/chatter/stability/",
)


class Cost(NamedTuple):
    """What a test takes."""

    seconds: float  # of the processor, without compilation
    loops: tuple[str, ...] = ()  # kinds of the time loop


#: of a test that the run left out
_LEFT_OUT = Cost(math.inf)


def nightly_tests() -> frozenset[str]:
    """Node ids of the list."""
    lines = LIST.read_text(encoding="utf-8").splitlines()
    return frozenset(line for line in lines if line and not line.startswith("#"))


def read_costs(text: str) -> dict[str, Cost]:
    """Costs by node id, as `tests.cost_record` writes them."""
    rows = [json.loads(line) for line in text.splitlines()]
    return {test: Cost(seconds, tuple(loops)) for test, seconds, loops in rows}


def chosen(
    every: Iterable[str], costs: Mapping[str, Cost], listed: frozenset[str] = frozenset()
) -> list[str]:
    """Slow ones among all node ids, those of the list that have no cost among them."""
    known = {test: costs.get(test, _LEFT_OUT if test in listed else Cost(0.0)) for test in every}
    costs = {test: cost for test, cost in known.items() if not test.startswith(_ALWAYS)}
    left = _slow(costs)
    left |= _needing_rare_loops({test: known[test] for test in known.keys() - left}) & costs.keys()
    modules: dict[str, list[str]] = defaultdict(list)
    for test in costs:
        modules[test.partition("::")[0]].append(test)
    for own in modules.values():
        if left.issuperset(own):
            left.remove(min(own, key=lambda test: (costs[test].seconds, test)))
    return sorted(left)


def _slow(costs: Mapping[str, Cost]) -> set[str]:
    """Slow cases beside a quicker one, slow tests, and very slow ones."""
    cases: dict[str, list[str]] = defaultdict(list)
    for test in costs:
        cases[test.partition("[")[0]].append(test)
    left = {test for test, cost in costs.items() if cost.seconds > VERY_SLOW}
    for own in cases.values():
        first, *others = sorted(own, key=lambda test: costs[test].seconds)
        left |= {one for one in others if costs[one].seconds > SLOW_CASE}
        most = SLOW_PHYSICS if first.startswith(_PHYSICS) else SLOW_TEST
        if not others and costs[first].seconds > most:
            left.add(first)
    return left


def _needing_rare_loops(costs: Mapping[str, Cost]) -> set[str]:
    """Tests that need a kind of the time loop which few others need."""
    users = Counter(kind for cost in costs.values() for kind in cost.loops)
    return {test for test, cost in costs.items() if any(users[kind] <= FEW for kind in cost.loops)}


def collected(*words: str) -> list[str]:
    """Node ids of what `make nightly` runs, but for the tests that are marked where they stand.

    Words are for pytest, such as another folder.
    """
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:xdist", *words]
    marks = ["-m", "not browser and not ansys and not nightly"]
    marks += ["-o", "addopts=--import-mode=importlib"]
    # without the list, whose tests are marked when they are collected
    without = {**os.environ, OTHER_LIST: os.devnull}
    found = subprocess.run(
        [*command, *marks], capture_output=True, text=True, check=True, cwd=ROOT, env=without
    )
    return [line for line in found.stdout.splitlines() if "::" in line]


def main() -> None:
    """Read the command line and write the list."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("costs", type=Path)
    given = parser.parse_args()
    costs = read_costs(given.costs.read_text(encoding="utf-8"))
    tests = chosen(collected(), costs, nightly_tests())
    head = "# Tests that `make test` leaves to `make nightly`; made by tests/nightly_tests.py.\n"
    LIST.write_text(head + "".join(f"{one}\n" for one in tests), encoding="utf-8")
    print(f"{len(tests)} tests in {LIST.name}")


if __name__ == "__main__":
    main()
