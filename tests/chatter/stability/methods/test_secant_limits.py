"""Limits of a cut that hardly differs from another, by secants."""

import numpy as np
import pytest

from chatter.stability.methods.collocation.secant_limits import (
    RecordedGrowthRate,
    limits_by_secants,
)

#: where growth begins, ends and begins again at three speeds, m
LIMITS = np.array([[1.0e-3, 2.0e-3, 2.5e-3], [1.1e-3, 2.1e-3, 2.7e-3], [0.8e-3, 1.7e-3, 2.2e-3]])
POINTS, EVERY = np.repeat(np.arange(3), 3), LIMITS.ravel()


def growth_rate(points, depth, moved=1.0):
    """A cubic in depth, with all limits moved by a factor."""
    return 1e9 * np.prod(depth[:, None] - moved * LIMITS[points], axis=1)


def recorded():
    growth = RecordedGrowthRate(growth_rate)
    grid = np.linspace(0.0, 3e-3, 61)[1:]
    for point in (2, 0, 1):
        growth(np.full(grid.size, point), grid)
    return growth


def test_slopes_are_those_of_the_growth_rate():
    a, b, c = LIMITS.T
    exact = 1e9 * np.stack([(a - b) * (a - c), (b - a) * (b - c), (c - a) * (c - b)]).T.ravel()
    assert recorded().slopes(POINTS, EVERY) == pytest.approx(exact, rel=0.1)


def test_a_side_without_a_point_gives_no_slope():
    assert np.isnan(recorded().slopes(np.array([0, 1]), np.array([1e-5, 4e-3]))).all()
    assert np.isnan(RecordedGrowthRate(growth_rate).slopes(np.array([0]), np.array([1e-3]))).all()


@pytest.mark.parametrize("moved", [0.97, 1.0, 1.02])
def test_limits_are_found_where_they_have_moved_to(moved):
    evaluated = []

    def growth(points, depth):
        evaluated.append(depth.size)
        return growth_rate(points, depth, moved)

    slopes = recorded().slopes(POINTS, EVERY)
    found = limits_by_secants(POINTS, EVERY, slopes, growth, 1e-4)
    assert found == pytest.approx(moved * EVERY, rel=1e-4)
    assert sum(evaluated) <= 3.5 * EVERY.size


def test_what_moves_too_far_or_has_another_slope_is_left():
    slopes = recorded().slopes(POINTS, EVERY)
    far = limits_by_secants(
        POINTS, EVERY, slopes, lambda point, depth: growth_rate(point, depth, 1.2), 1e-4
    )
    assert np.isnan(far).all()

    def steeper(points, depth):
        # beyond a depth beside each limit another motion grows, at ten times the rate
        value = growth_rate(points, depth, 1.01)
        return np.where(np.abs(value) < 0.2 * growth_rate(points, EVERY, 1.01), value, 10.0 * value)

    kinked = limits_by_secants(POINTS, EVERY, slopes, steeper, 1e-4)
    there = np.isfinite(kinked)
    assert kinked[there] == pytest.approx(1.01 * EVERY[there], rel=1e-3)


def test_a_slope_of_the_wrong_sign_settles_nowhere():
    slopes = recorded().slopes(POINTS, EVERY)
    found = limits_by_secants(
        POINTS, EVERY, -slopes, lambda point, depth: growth_rate(point, depth, 1.01), 1e-4
    )
    assert np.isnan(found).all()
