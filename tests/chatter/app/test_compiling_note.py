"""A page that waits for the compiler says so, and no other one does."""

import time

import numba
import pytest

from chatter.app.workbench.compiling_note import NOTE, reported_while_compiling


def compiled_anew():
    """Compile something that takes a second or so."""

    @numba.njit
    def sums(values):
        total = 0.0
        for one in values:
            total += one * one
        return total

    sums((1.0, 2.0, 3.0))


def test_it_is_told_once_while_code_is_compiled():
    told = []
    with reported_while_compiling(told.append, patience=0.01):
        compiled_anew()
        time.sleep(0.05)
    assert told == [NOTE]


def test_nothing_is_told_of_what_is_compiled_already():
    told = []
    with reported_while_compiling(told.append, patience=0.01):
        time.sleep(0.1)
    assert told == []


def test_a_failure_inside_goes_on_outside():
    told = []
    with pytest.raises(ZeroDivisionError), reported_while_compiling(told.append):
        1 / 0  # noqa: B018
    assert told == []
