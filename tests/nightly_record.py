"""Writes what the last nightly run of the tests found into docs/validation.md.

    python -m tests.nightly_record build/nightly/tests.xml

`make nightly` runs every test and calls this, whether they pass or not. The record stands between
two comments of the page, and replaces the one before.
"""

import argparse
import os
import platform
import subprocess
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "validation.md"
BEGIN, END = "<!-- last nightly run -->", "<!-- end of the last nightly run -->"
LIBRARIES = ("numpy", "scipy", "numba")
SLOWEST = 10
#: name of the property by which tests/conftest.py marks a nightly test in a report
PROPERTY = "nightly"


@dataclass(frozen=True)
class TestRun:
    """What a run of the tests found.

    Parameters
    ----------
    begun : datetime
    seconds : float
        From begin to end.
    outcomes : mapping
        Of "passed", "failed", "skipped": how many tests.
    nightly : int
        Tests that only a nightly run takes.
    in_tests, in_nightly : float
        Time in all tests, and in the nightly ones, s: the sum over the processes.
    slowest : sequence of (str, float)
        Tests and their times, s.
    """

    __test__ = False  # for pytest a name that begins with Test is a class of tests

    begun: datetime
    seconds: float
    outcomes: dict[str, int]
    nightly: int
    in_tests: float
    in_nightly: float
    slowest: Sequence[tuple[str, float]]


def read_report(path: Path) -> TestRun:
    """Read a JUnit report of pytest; ValueError for one without a test."""
    suites = ElementTree.parse(path).getroot().iter("testsuite")
    suite = next(suites, None)
    cases = [] if suite is None else list(suite.iter("testcase"))
    if not cases:
        raise ValueError(f"{path}: no test in the report")
    outcomes = {"passed": 0, "failed": 0, "skipped": 0}
    for case in cases:
        outcomes[_outcome(case)] += 1
    nightly = [case for case in cases if case.find(f".//property[@name='{PROPERTY}']") is not None]
    ordered = sorted(cases, key=_seconds, reverse=True)[:SLOWEST]
    return TestRun(
        datetime.fromisoformat(suite.attrib["timestamp"]),
        float(suite.attrib["time"]),
        outcomes,
        len(nightly),
        sum(map(_seconds, cases)),
        sum(map(_seconds, nightly)),
        [(_name(case), _seconds(case)) for case in ordered],
    )


def _outcome(case: ElementTree.Element) -> str:
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    return "passed" if case.find("skipped") is None else "skipped"


def _seconds(case: ElementTree.Element) -> float:
    return float(case.attrib["time"])


def _name(case: ElementTree.Element) -> str:
    return f"{case.attrib['classname'].removeprefix('tests.')}: {case.attrib['name']}"


def lines_of(run: TestRun, tree: str, versions: str) -> list[str]:
    """Lines of the record."""
    counts = ", ".join(f"{count} {outcome}" for outcome, count in run.outcomes.items() if count)
    rows = [
        ("begun", f"{run.begun:%Y-%m-%d %H:%M}"),
        ("commit", tree),
        ("with", versions),
        ("tests", f"{counts}; {run.nightly} of them nightly"),
        ("time", f"{run.seconds / 60.0:.1f} min on {os.cpu_count()} cores"),
        (
            "time in tests, all processes",
            f"{run.in_tests / 60.0:.1f} min, of which nightly {run.in_nightly / 60.0:.1f} min",
        ),
    ]
    slow = [(f"`{name}`".replace("|", "\\|"), f"{seconds:.0f} s") for name, seconds in run.slowest]
    return [*_table(("last run", ""), rows), "", *_table(("slowest", "time"), slow)]


def _table(head: tuple[str, str], rows: Sequence[tuple[str, str]]) -> list[str]:
    return [f"| {left} | {right} |" for left, right in (head, ("---", "---"), *rows)]


def with_record(page: str, lines: Sequence[str]) -> str:
    """Page with a new record; ValueError where it has no place for one."""
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"{PAGE.name} does not hold {BEGIN} and {END}")
    return "".join([before, BEGIN, "\n", "\n".join(lines), "\n", END, after])


def _tree() -> str:
    """Commit of the working tree, and whether it was changed."""

    def asked(*words: str) -> str:
        done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    changed = " with changes" if asked("status", "--porcelain", "--untracked-files=no") else ""
    return asked("rev-parse", "--short", "HEAD") + changed


def main() -> None:
    """Write the record of a report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("report", type=Path, help="JUnit report of pytest")
    run = read_report(parser.parse_args().report)
    names = [f"{name} {version(name)}" for name in LIBRARIES]
    versions = ", ".join([f"Python {platform.python_version()}", *names])
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(with_record(page, lines_of(run, _tree(), versions)), encoding="utf-8")


if __name__ == "__main__":
    main()
