"""Pockets of a diagram: where they lie, their margins, their removal rate."""

import numpy as np
import pytest

from chatter.stability.pockets import DEPTH_MARGIN, SPEED_MARGIN, find_pockets

SPEEDS = np.linspace(900.0, 1100.0, 401)


def hill(centre, height, width):
    return height * np.exp(-(((SPEEDS - centre) / width) ** 2))


def test_one_hill():
    limits = 1e-3 + hill(1000.0, 2e-3, 40.0)
    (pocket,) = find_pockets(SPEEDS, limits, 10e-3, 2e-6)
    assert pocket.spindle_speed == pytest.approx(1000.0, abs=0.5)
    assert pocket.critical_depth == pytest.approx(3e-3, rel=1e-3)
    # the lowest limit within the speed margin, less the depth margin
    edge = 1e-3 + 2e-3 * np.exp(-((SPEED_MARGIN * 1000.0 / 40.0) ** 2))
    assert pocket.axial_depth == pytest.approx((1.0 - DEPTH_MARGIN) * edge, rel=1e-3)
    assert pocket.removal_rate == pytest.approx(
        pocket.axial_depth * pocket.spindle_speed * 2e-6, rel=1e-12
    )


def test_highest_removal_rate_first_and_no_more_than_asked_for():
    limits = 1e-3 + hill(940.0, 3e-3, 15.0) + hill(1000.0, 1e-3, 15.0) + hill(1060.0, 2e-3, 15.0)
    pockets = find_pockets(SPEEDS, limits, 10e-3, 1e-6)
    assert [round(pocket.spindle_speed) for pocket in pockets] == [940, 1060, 1000]
    assert len(find_pockets(SPEEDS, limits, 10e-3, 1e-6, most=2)) == 2


def test_a_spike_narrower_than_the_speed_margin_is_no_pocket():
    limits = np.full(SPEEDS.size, 1e-3)
    limits[200] = 50e-3
    for pocket in find_pockets(SPEEDS, limits, 60e-3, 1e-6):
        assert pocket.axial_depth == pytest.approx((1.0 - DEPTH_MARGIN) * 1e-3)


def test_no_pocket_is_deeper_than_was_searched():
    limits = np.where(np.abs(SPEEDS - 1000.0) < 40.0, np.inf, 1e-3)
    (pocket,) = find_pockets(SPEEDS, limits, 5e-3, 1e-6)
    assert pocket.spindle_speed == pytest.approx(1000.0, abs=1.0)
    assert pocket.axial_depth == pytest.approx((1.0 - DEPTH_MARGIN) * 5e-3)
    assert np.isinf(pocket.critical_depth)


def test_every_pocket_is_stable_with_the_speed_off_by_the_margin():
    rng = np.random.default_rng(5)
    for _ in range(50):
        limits = 1e-3 * np.exp(np.cumsum(rng.normal(0.0, 0.1, SPEEDS.size)))
        for pocket in find_pockets(SPEEDS, limits, 1.0, 1e-6):
            near = np.abs(SPEEDS / pocket.spindle_speed - 1.0) <= SPEED_MARGIN
            assert np.all(limits[near] > pocket.axial_depth)


def test_stable_everywhere_and_few_speeds():
    (pocket,) = find_pockets(SPEEDS, np.full(SPEEDS.size, np.inf), 4e-3, 1e-6)
    assert pocket.axial_depth == pytest.approx((1.0 - DEPTH_MARGIN) * 4e-3)
    assert len(find_pockets(SPEEDS[:2], np.array([1e-3, 1e-3]), 4e-3, 1e-6)) == 1


def test_no_pocket_is_shallower_than_what_any_speed_allows():
    """Shallow lobes: 15 % below a peak is less than the lowest limit."""
    limits = 1e-3 * (1.05 + 0.05 * np.cos(np.linspace(0.0, 12.0 * np.pi, SPEEDS.size)))
    assert find_pockets(SPEEDS, limits, 4e-3, 1e-6) == ()
    deep = 1e-3 * (1.5 + 0.5 * np.cos(np.linspace(0.0, 4.0 * np.pi, SPEEDS.size)))
    found = find_pockets(SPEEDS, deep, 4e-3, 1e-6)
    assert found
    assert all(pocket.axial_depth > deep.min() for pocket in found)


def test_no_limit_beyond_what_was_searched_is_given_to_a_pocket():
    """A machine's pocket had "771.4 mm" for its limit, the search 40 mm."""
    limits = 1e-3 + hill(1000.0, 700e-3, 40.0)
    (pocket,) = find_pockets(SPEEDS, limits, 40e-3, 2e-6)
    assert np.isinf(pocket.critical_depth)
    assert pocket.axial_depth == pytest.approx((1.0 - DEPTH_MARGIN) * 40e-3)
