"""Chooses the slow tests that `make test` leaves to `make nightly`, by what they took.

    pytest -m 'not browser and not ansys' --durations=0 -vv > DURATIONS
    python -m tests.nightly_tests DURATIONS

rewrites tests/nightly.txt, which tests/conftest.py reads. Take the second run of an environment:
in the first the tests that come first compile for all. Of a test with several cases the quickest
stays in `make test`, of every module one test at the least. A test of the physics that has no cases
is left out only if it takes long, since it may be the only one that fails for a wrong sign, factor
or unit.
"""

import argparse
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]
LIST = ROOT / "tests" / "nightly.txt"
#: seconds from which on a case of a test is slow, and a test that has but one, of physics or not
SLOW_CASE, SLOW_TEST, SLOW_PHYSICS = 0.3, 0.5, 3.0
#: published numbers and the rules of the tree stay in every run
_ALWAYS = (
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

_LINE = re.compile(r"^\s*([0-9.]+)s (?:setup|call|teardown)\s+(tests/.*)$")


def nightly_tests() -> frozenset[str]:
    """Node ids of the list."""
    lines = LIST.read_text(encoding="utf-8").splitlines()
    return frozenset(line for line in lines if line and not line.startswith("#"))


def durations(text: str) -> dict[str, float]:
    """Seconds by node id, as pytest prints them."""
    found: dict[str, float] = defaultdict(float)
    for line in text.splitlines():
        match = _LINE.match(line)
        if match:
            found[match[2]] += float(match[1])
    return dict(found)


def chosen(every: Iterable[str], seconds: Mapping[str, float]) -> list[str]:
    """Slow ones among all node ids."""
    cases: dict[str, list[str]] = defaultdict(list)
    modules: dict[str, list[str]] = defaultdict(list)
    for test in every:
        if test.startswith(_ALWAYS):
            continue
        cases[test.partition("[")[0]].append(test)
        modules[test.partition("::")[0]].append(test)

    def took(test: str) -> float:
        return seconds.get(test, 0.0)

    left = set()
    for own in cases.values():
        first, *others = sorted(own, key=took)
        left |= {one for one in others if took(one) > SLOW_CASE}
        most = SLOW_PHYSICS if first.startswith(_PHYSICS) else SLOW_TEST
        if not others and took(first) > most:
            left.add(first)
    for own in modules.values():
        if left.issuperset(own):
            left.remove(min(own, key=took))
    return sorted(left)


def _collected() -> list[str]:
    """Node ids of what `make nightly` runs, but for the tests that are marked where they stand."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:xdist"]
    marks = ["-m", "not browser and not ansys", "-o", "addopts=--import-mode=importlib"]
    out = subprocess.run([*command, *marks], capture_output=True, text=True, check=True, cwd=ROOT)
    return [line for line in out.stdout.splitlines() if line.startswith("tests/")]


def main() -> None:
    """Read the command line and write the list."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("durations", type=Path)
    given = parser.parse_args()
    tests = chosen(_collected(), durations(given.durations.read_text(encoding="utf-8")))
    head = "# Tests that `make test` leaves to `make nightly`; made by tests/nightly_tests.py.\n"
    LIST.write_text(head + "".join(f"{one}\n" for one in tests), encoding="utf-8")
    print(f"{len(tests)} tests in {LIST.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
