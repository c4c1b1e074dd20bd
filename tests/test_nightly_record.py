"""The record of the last nightly run, and what makes a test nightly."""

import subprocess
import sys

import pytest

from tests import nightly_record
from tests.places import ROOT

REPORT = """<?xml version="1.0" encoding="utf-8"?>
<testsuites><testsuite name="pytest" errors="1" failures="1" skipped="0" tests="4" time="120.0"
timestamp="2026-11-26T03:10:00+00:00">
<testcase classname="tests.cutting.test_a" name="test_quick" time="1.5" />
<testcase classname="tests.cutting.test_a" name="test_slow[x|y]" time="90.0">
<properties><property name="nightly" value="True" /></properties></testcase>
<testcase classname="tests.cutting.test_a" name="test_wrong" time="20.0">
<failure message="no">no</failure></testcase>
<testcase classname="tests.cutting.test_a" name="test_of_a_broken_fixture" time="8.5">
<error message="no">no</error></testcase>
</testsuite></testsuites>
"""


@pytest.fixture
def run(tmp_path):
    (tmp_path / "tests.xml").write_text(REPORT, encoding="utf-8")
    return nightly_record.read_report(tmp_path / "tests.xml")


def test_counts_and_times_of_a_report(run):
    assert run.outcomes == {"passed": 2, "failed": 2, "skipped": 0}
    assert run.nightly == 1
    assert (run.seconds, run.in_tests, run.in_nightly) == (120.0, 120.0, 90.0)
    assert [seconds for _, seconds in run.slowest] == [90.0, 20.0, 8.5, 1.5]


def test_a_record_replaces_the_one_before(run):
    lines = nightly_record.lines_of(run, "abc1234", "Python 3.11")
    text = "\n".join(lines)
    assert "| begun | 2026-11-26 03:10 |" in text
    assert "| tests | 2 passed, 2 failed; 1 of them nightly |" in text
    assert "| `cutting.test_a: test_slow[x\\|y]` | 90 s |" in text
    page = f"above\n{nightly_record.BEGIN}\nold\n{nightly_record.END}\nbelow\n"
    once = nightly_record.with_record(page, lines)
    assert once.startswith("above\n")
    assert once.endswith("\nbelow\n")
    assert "old" not in once
    assert nightly_record.with_record(once, lines) == once


def test_a_report_without_tests_and_a_page_without_a_place_are_told(tmp_path, run):
    (tmp_path / "empty.xml").write_text('<testsuites><testsuite name="pytest" /></testsuites>')
    with pytest.raises(ValueError, match="no test"):
        nightly_record.read_report(tmp_path / "empty.xml")
    with pytest.raises(ValueError, match="does not hold"):
        nightly_record.with_record("a page", ["a line"])


def test_the_page_has_a_place_for_the_record():
    page = nightly_record.PAGE.read_text(encoding="utf-8")
    assert nightly_record.with_record(page, ["a line"]) != page


def test_nightly_tests_are_deselected_and_marked_in_a_report(tmp_path):
    """The settings of the project on two tests, one of them nightly, by pytest itself."""
    (tmp_path / "test_two.py").write_text(
        "import pytest\n\n\ndef test_quick():\n    pass\n\n\n"
        "@pytest.mark.nightly\ndef test_slow():\n    pass\n"
    )
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text("utf-8"))

    def found(*words):
        report = tmp_path / "tests.xml"
        command = ["-c", ROOT / "pyproject.toml", "--rootdir", tmp_path, "-p", "no:cacheprovider"]
        command += ["-n", "0", "--junitxml", report, tmp_path, *words]
        words = [sys.executable, "-m", "pytest", *map(str, command)]
        done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout
        return done.stdout, nightly_record.read_report(report)

    shown, run = found()
    assert "1 deselected" in shown
    assert (run.outcomes["passed"], run.outcomes["skipped"], run.nightly) == (1, 0, 0)
    _, run = found("-m", "not browser and not ansys")
    assert (run.outcomes["passed"], run.nightly) == (2, 1)
