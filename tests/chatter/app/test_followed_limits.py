"""Limits under a slider, corrected from those before."""

from __future__ import annotations

import numpy as np
import pytest

import chatter
from chatter.app import followed_limits
from chatter.app.followed_limits import FollowedLimits
from chatter.stability.model import milling_model
from tests.places import EXAMPLES

CASE = chatter.load(EXAMPLES / "two-degrees-of-freedom" / "case.toml").patch(
    {"cut.axial_depth": "1 mm"}
)
SPEEDS = np.linspace(5000.0, 25000.0, 96) * np.pi / 30.0
DEPTHS = np.linspace(0.0, 8e-3, 25)[1:]


def no_progress(*_):
    pass


def harder(factor):
    """The case with every cutting coefficient times a factor: each limit over that factor."""
    return CASE.patch(
        {"material.Ktc": f"{600.0 * factor} MPa", "material.Krc": f"{200.0 * factor} MPa"}
    )


def corrected(followed, case):
    return followed.limits(milling_model(case), SPEEDS, DEPTHS, None, no_progress)


def limits(followed, case):
    """Corrected and checked."""
    curve = corrected(followed, case)
    checked = followed.check(no_progress)
    return curve if checked is None else checked


def differing(curve, expected):
    """Share of the speeds whose first limit is off by more than 1 %."""
    low, wanted = np.minimum(curve.critical_depth, DEPTHS[-1]), np.minimum(expected, DEPTHS[-1])
    return np.mean(np.abs(low / wanted - 1.0) > 0.01)


@pytest.fixture
def searched_once(monkeypatch):
    """Refuse a second search of all speeds."""
    searching, calls = followed_limits.collocation.limit_curve, []

    def once(*given):
        calls.append(given)
        assert len(calls) == 1
        return searching(*given)

    monkeypatch.setattr(followed_limits.collocation, "limit_curve", once)


@pytest.mark.usefixtures("searched_once")
@pytest.mark.parametrize("step", [1.002, 1.02, 0.98])
def test_limits_stay_inverse_to_the_coefficients(step):
    followed = FollowedLimits()
    first = limits(followed, CASE)
    factor = 1.0
    for _ in range(12):
        factor *= step
        curve = limits(followed, harder(factor))
        known = first.critical_depth / factor
        # what comes into the diagram from below has no limit in the first one
        inside = np.isfinite(known) & (known < DEPTHS[-1])
        found = curve.critical_depth[inside] / known[inside]
        assert np.mean(np.abs(found - 1.0) > 0.01) < 0.03
        beside = np.abs(curve.chatter_frequency / first.chatter_frequency - 1.0)[inside]
        assert np.nanmedian(beside) < 1e-3


def test_a_large_step_comes_to_what_a_search_finds():
    followed = FollowedLimits()
    limits(followed, CASE)
    searched = limits(FollowedLimits(), harder(1.6))
    for _ in range(2 * followed_limits._TURNS):
        curve = limits(followed, harder(1.6))
    assert differing(curve, searched.critical_depth) == 0.0
    assert curve.bifurcation.count("flip") == searched.bifurcation.count("flip")


def test_a_mode_that_moves_brings_its_lobes_along():
    followed, searched = FollowedLimits(), FollowedLimits()
    for frequency in np.linspace(922.0, 960.0, 12):
        moved = CASE.patch({"structure.mode[1].frequency": f"{frequency} Hz"})
        curve = limits(followed, moved)
    wanted = limits(searched, moved).critical_depth
    assert differing(curve, wanted) <= 4 / len(SPEEDS)
    for _ in range(2 * followed_limits._TURNS):
        curve = limits(followed, moved)
    assert differing(curve, wanted) == 0.0


def test_what_a_correction_does_not_see_is_found_by_the_checks():
    followed, moved = FollowedLimits(), CASE.patch({"structure.mode[1].frequency": "960 Hz"})
    limits(followed, CASE)
    wanted = limits(FollowedLimits(), moved).critical_depth
    for _ in range(2 * followed_limits._TURNS):
        unchecked = corrected(followed, moved)
    assert differing(unchecked, wanted) > 0.0
    for _ in range(2 * followed_limits._TURNS):
        checked = limits(followed, moved)
    assert differing(checked, wanted) == 0.0
    corrected(followed, moved)
    # nothing is left to find, which is not drawn again
    assert followed.check(no_progress) is None


def test_other_depths_are_searched_anew():
    followed = FollowedLimits()
    limits(followed, CASE)
    shallow = followed.limits(milling_model(CASE), SPEEDS, 0.5 * DEPTHS, None, no_progress)
    wanted = FollowedLimits().limits(milling_model(CASE), SPEEDS, 0.5 * DEPTHS, None, no_progress)
    assert np.array_equal(shallow.critical_depth, wanted.critical_depth)
