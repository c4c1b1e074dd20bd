"""Sweeps in threads: results in order, progress as parts finish, the first error by index."""

import threading

import numpy as np
import pytest

from chatter.engine import parallel
from chatter.engine.parallel import each, scattered


@pytest.fixture(autouse=True)
def two_threads(monkeypatch):
    monkeypatch.setattr(parallel, "worker_count", lambda: 2)


def test_progress_counts_what_finished_though_the_first_part_takes_long():
    others = threading.Event()
    reported = []

    def part(index):
        if index == 0:
            assert others.wait(10.0)
        return index**2

    def progress(done, total):
        reported.append((done, total))
        if done == 5:
            others.set()

    assert each(part, 6, progress) == [0, 1, 4, 9, 16, 25]
    assert reported == [(done, 6) for done in range(1, 7)]


def test_chunks_count_by_their_points():
    reported = []
    assert each(abs, 7, lambda *shares: reported.append(shares), points_a_chunk=3) == list(range(7))
    assert sorted(reported)[-1] == (7, 7)
    assert len(reported) == 3


def test_the_error_is_that_of_the_lowest_index():
    second = threading.Event()

    def part(index):
        if index == 1:
            second.set()
            raise ValueError("one")
        if index == 0:
            assert second.wait(10.0)
            raise ValueError("zero")
        return index

    with pytest.raises(ValueError, match="zero"):
        each(part, 2)


def test_progress_may_give_up():
    def progress(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        each(abs, 50, progress)


def test_points_are_begun_all_over_the_sweep():
    """Low speeds came first and took longest: a sheet was announced with twice its time."""
    begun = []
    assert each(lambda index: begun.append(index) or index, 40) == list(range(40))
    # any tenth of them is spread: none further from one of the first 4 than a half of the whole
    assert np.ptp(begun[:4]) >= 20


@pytest.mark.parametrize("count", [1, 2, 5, 100, 1000])
def test_every_part_of_the_order_is_spread_evenly(count):
    order = scattered(count)
    assert sorted(order) == list(range(count))
    cost = 1.0 / (1.0 + np.arange(count))  # as of low speeds
    if count >= 100:
        half = cost[order[: count // 2]].sum() / cost.sum()
        assert 0.3 < half < 0.7
        # in their own order a tenth of the points has half of the cost
        assert cost[: count // 10].sum() > 0.5 * cost.sum()
