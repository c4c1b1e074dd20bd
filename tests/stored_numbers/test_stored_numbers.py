"""Every stored case gives what is stored, each number within its tolerance."""

import pytest

from tests.stored_numbers import store
from tests.stored_numbers.cases import stored_cases
from tests.stored_numbers.results import readings

CASES = stored_cases()
STORED = store.read()


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.nightly] if case.nightly else [])
        for name, case in CASES.items()
    ],
)
def test_the_numbers_are_those_stored(name):
    found = store.differences(STORED.get(name, {}), readings(CASES[name]))
    assert not found, "\n".join([name, *found])


def test_nothing_is_stored_of_cases_that_are_gone():
    assert set(STORED) == set(CASES)
