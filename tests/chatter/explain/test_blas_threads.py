"""BLAS works on one thread while `explain` does, and as before afterwards."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import chatter
from chatter.explain.blas_threads import one_blas_thread


def _threads() -> set[int]:
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


@pytest.fixture
def three_threads():
    with threadpool_limits(limits=3, user_api="blas"):
        if _threads() != {3}:
            pytest.skip("BLAS has no threads here")
        yield


@pytest.mark.usefixtures("three_threads")
def test_one_thread_within_and_as_before_afterwards():
    with one_blas_thread():
        assert _threads() == {1}
    assert _threads() == {3}


@pytest.mark.usefixtures("three_threads")
def test_explain_works_with_one_and_gives_back_also_where_it_fails(monkeypatch):
    seen = []

    def read(*_):
        seen.append(_threads())
        raise chatter.InputError("no such folder")

    monkeypatch.setattr("chatter.explain.explanation.read_measurement", read)
    with pytest.raises(chatter.InputError):
        chatter.explain("no such folder")
    assert seen == [{1}]
    assert _threads() == {3}
