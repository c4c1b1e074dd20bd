"""Which tests are left to the nightly run, and that those of the list exist."""

import pytest

from tests.nightly_tests import (
    ROOT,
    SLOW_CASE,
    SLOW_PHYSICS,
    SLOW_TEST,
    chosen,
    durations,
    nightly_tests,
)


def test_durations_are_read_as_pytest_prints_them():
    text = """
============================= slowest durations ==============================
12.50s setup    tests/a.py::test_one
0.75s call     tests/a.py::test_one
3.00s call     tests/b.py::test_two[a case, of "two" words]
(9 durations < 0.005s hidden.  Use -vv to show these durations.)
"""
    assert durations(text) == {
        "tests/a.py::test_one": pytest.approx(13.25),
        'tests/b.py::test_two[a case, of "two" words]': pytest.approx(3.0),
    }


def test_the_quickest_case_stays_one_test_of_a_module_and_longer_ones_of_the_physics():
    slow = 2.0 * SLOW_TEST
    assert slow < SLOW_PHYSICS
    seconds = {
        "tests/a.py::test_cases[1]": slow,
        "tests/a.py::test_cases[2]": 2.0 * slow,
        "tests/a.py::test_cases[3]": 1.1 * SLOW_CASE,
        "tests/a.py::test_alone": slow,
        "tests/b.py::test_alone": slow,
        "tests/b.py::test_slower": 2.0 * slow,
        "tests/c.py::test_quick": 0.9 * SLOW_TEST,
        "tests/cutting/test_d.py::test_alone": 0.9 * SLOW_PHYSICS,
        "tests/cutting/test_d.py::test_long": 1.1 * SLOW_PHYSICS,
        "tests/cutting/test_d.py::test_cases[1]": slow,
        "tests/cutting/test_d.py::test_cases[2]": 0.5 * slow,
    }
    assert chosen([*seconds, "tests/c.py::test_not_timed"], seconds) == [
        "tests/a.py::test_alone",
        "tests/a.py::test_cases[1]",
        "tests/a.py::test_cases[2]",
        "tests/b.py::test_slower",
        "tests/cutting/test_d.py::test_cases[1]",
        "tests/cutting/test_d.py::test_long",
    ]


def test_every_test_of_the_list_exists():
    listed = nightly_tests()
    assert listed
    for test in listed:
        file, _, rest = test.partition("::")
        name = rest.partition("[")[0].rpartition("::")[2]
        assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8"), test
