"""Shares in a variance: known sums, correlated values, and percentages that add up."""

import numpy as np
import pytest

from chatter.cli.uncertainty import _lines_on_variance
from chatter.studies.uncertainty.shares_of_variance import shares_of_variance, whole_percentages


def drawn(count=20000, seed=1):
    return np.random.default_rng(seed).normal(size=(count, 3))


def test_shares_of_a_sum_of_independent_values():
    values = drawn()
    # variance 1 + 4 + 0
    result = values[:, 0] + 2.0 * values[:, 1]
    assert shares_of_variance(values, result) == pytest.approx([0.2, 0.8, 0.0], abs=0.02)


def test_two_values_that_go_together_share_alike():
    values = drawn()
    values[:, 1] = 0.8 * values[:, 0] + 0.6 * values[:, 1]
    shares = shares_of_variance(values, values[:, 0] + values[:, 1])
    assert shares[0] == pytest.approx(shares[1], rel=0.03)
    # squares of the correlation would be 0.9 each
    assert shares.sum() == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_they_never_exceed_the_whole_in_few_samples(seed):
    values = drawn(12, seed)
    result = values @ [1.0, 1.0, 1.0] + 0.3 * values[:, 0] ** 2
    shares = shares_of_variance(values, result)
    assert np.all(shares >= 0.0)
    # R^2 of the least-squares plane
    plane = np.column_stack([np.ones(12), values])
    fitted = plane @ np.linalg.lstsq(plane, result, rcond=None)[0]
    assert shares.sum() == pytest.approx(np.var(fitted) / np.var(result), rel=1e-9)
    assert shares.sum() <= 1.0 + 1e-12


def test_values_that_do_not_vary_or_are_the_same():
    values = drawn(200)
    values[:, 1] = 3.0
    values[:, 2] = values[:, 0]
    assert shares_of_variance(values, values[:, 0]) == pytest.approx([0.5, 0.0, 0.5])
    assert shares_of_variance(values, np.ones(200)).tolist() == [0.0, 0.0, 0.0]


def test_percentages_add_up():
    assert whole_percentages([0.335, 0.335, 0.33]) == [34, 33, 33]
    assert sum(whole_percentages([1 / 7] * 7)) == 100
    assert whole_percentages([0.0, 1.0]) == [0, 100]


def test_lines_add_up_to_a_hundred():
    lines = _lines_on_variance({"a": 0.214, "b": 0.664, "c": 0.0})
    assert lines == [
        "b: 67 % of its variance",
        "a: 21 % of its variance",
        "c: 0 % of its variance",
        "curvature and joint influence: 12 %",
    ]
    assert _lines_on_variance({"a": None}) == []
