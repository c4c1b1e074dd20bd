"""Which tests are left to the nightly run, and that those of the list exist."""

from tests.nightly_tests import (
    FEW,
    ROOT,
    SLOW_CASE,
    SLOW_PHYSICS,
    SLOW_TEST,
    VERY_SLOW,
    Cost,
    chosen,
    collected,
    nightly_tests,
    read_costs,
)


def test_costs_are_read_as_they_are_recorded():
    text = """["tests/a.py::test_one", 0.75, []]
["tests/b.py::test_two[a case, of \\"two\\" words]", 3.0, ["1f", "2e"]]
"""
    assert read_costs(text) == {
        "tests/a.py::test_one": Cost(0.75),
        'tests/b.py::test_two[a case, of "two" words]': Cost(3.0, ("1f", "2e")),
    }


def test_the_quickest_case_stays_one_test_of_a_module_and_longer_ones_of_the_physics():
    slow = 2.0 * SLOW_TEST
    assert slow < SLOW_PHYSICS < VERY_SLOW
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
        "tests/cutting/test_d.py::test_very_slow[1]": 1.1 * VERY_SLOW,
        "tests/cutting/test_d.py::test_very_slow[2]": 1.2 * VERY_SLOW,
    }
    costs = {test: Cost(taken) for test, taken in seconds.items()}
    assert chosen([*seconds, "tests/c.py::test_not_timed"], costs) == [
        "tests/a.py::test_alone",
        "tests/a.py::test_cases[1]",
        "tests/a.py::test_cases[2]",
        "tests/b.py::test_slower",
        "tests/cutting/test_d.py::test_cases[1]",
        "tests/cutting/test_d.py::test_long",
        "tests/cutting/test_d.py::test_very_slow[1]",
        "tests/cutting/test_d.py::test_very_slow[2]",
    ]


def test_what_a_run_left_out_stays_left_out():
    costs = {"tests/a.py::test_cases[2]": Cost(2.0 * SLOW_CASE)}
    listed = frozenset({"tests/a.py::test_cases[1]", "tests/a.py::test_removed"})
    every = ["tests/a.py::test_cases[1]", *costs]
    assert chosen(every, costs, listed) == ["tests/a.py::test_cases[1]"]


def test_a_kind_of_the_time_loop_is_not_compiled_for_few_tests():
    few = {f"tests/a.py::test_{i}": Cost(0.1, ("rare", "usual")) for i in range(FEW)}
    more = {f"tests/b.py::test_{i}": Cost(0.1, ("usual",)) for i in range(FEW)}
    alone = {"tests/c.py::test_alone": Cost(0.1, ("own",))}
    costs = {**few, **more, **alone, "tests/a.py::test_without": Cost(0.1)}
    assert chosen(costs, costs) == sorted(few)


def test_every_test_of_the_list_exists():
    listed = nightly_tests()
    assert listed
    for test in listed:
        file, _, rest = test.partition("::")
        name = rest.partition("[")[0].rpartition("::")[2]
        assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8"), test


def test_a_test_that_is_marked_where_it_stands_is_not_of_the_list(tmp_path):
    (tmp_path / "test_three.py").write_text(
        "import pytest\n\n\ndef test_quick():\n    pass\n\n\n"
        "@pytest.mark.nightly\ndef test_marked():\n    pass\n\n\n"
        "@pytest.mark.parametrize('n', [1, pytest.param(2, marks=pytest.mark.nightly)])\n"
        "def test_cases(n):\n    pass\n"
    )
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text("utf-8"))
    found = collected("-c", str(ROOT / "pyproject.toml"), "--rootdir", str(tmp_path), str(tmp_path))
    assert [one.partition("::")[2] for one in found] == ["test_quick", "test_cases[1]"]


def test_tests_of_the_list_are_collected_although_it_marks_them():
    listed = min(nightly_tests())
    assert listed in collected(listed.partition("::")[0])
