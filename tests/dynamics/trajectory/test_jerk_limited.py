"""Jerk-limited moves against closed forms, limits and symmetry."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from dynamics.trajectory.jerk_limited import JerkLimitedMove, reachable_speed, speed_change_length
from dynamics.trajectory.motion import TrajectoryError

positive = st.floats(1e-3, 1e3)


def extremes(move, count=4001):
    t = np.linspace(0.0, move.duration, count)
    ends = np.cumsum([0.0, *move.durations])
    return move.at(np.sort(np.concatenate([t, ends])))


@settings(max_examples=300, deadline=None)
@given(st.floats(1e-6, 1e3), positive, positive, positive)
def test_limits_hold_and_the_end_is_met(length, v, a, j):
    move = JerkLimitedMove([0.0], [length], v, a, j)
    motion = extremes(move, 201)
    assert np.abs(motion.velocity).max() <= v * (1 + 1e-9)
    assert np.abs(motion.acceleration).max() <= a * (1 + 1e-9)
    assert motion.position[-1, 0] == length
    assert motion.position[0, 0] == 0.0
    assert motion.velocity[-1, 0] == 0.0 == motion.velocity[0, 0]
    assert (np.diff(motion.position[:, 0]) >= -1e-12 * length).all()
    middle = [move.at(move.duration * (0.5 + side)).position[0] for side in (-1e-13, 1e-13)]
    assert middle[1] == pytest.approx(middle[0], abs=1e-9 * length)
    assert middle[0] == pytest.approx(0.5 * length, rel=1e-9)
    # one limit at least is used up: else the move could be faster
    ramp, constant, _, cruise = move.durations[:4]
    assert cruise > 0.0 or constant > 0.0 or ramp == pytest.approx((length / 2 / j) ** (1 / 3))


@settings(max_examples=100, deadline=None)
@given(st.floats(1e-4, 1e2), positive, positive, positive)
def test_jerk_never_exceeds_its_limit_and_acceleration_is_continuous(length, v, a, j):
    move = JerkLimitedMove([0.0], [length], v, a, j)
    t = np.linspace(0.0, move.duration, 3001)
    gain = move.at(t).acceleration[:, 0]
    steps = np.abs(np.diff(gain)) / np.diff(t)
    assert steps.max() <= j * (1 + 1e-6) + 1e-9 * a / (t[1] - t[0])


@pytest.mark.parametrize(
    ("length", "duration"),
    [
        # v = 1, a = 5, j = 50: full move, and as short as it may be
        (3.0, 3.0 / 1.0 + 1.0 / 5.0 + 5.0 / 50.0),
        (1.0 * (0.2 + 0.1), 0.6),
        # acceleration is reached, velocity not: T = a/j + sqrt((a/j)^2 + 4 d/a)
        (0.2, 0.1 + math.sqrt(0.1**2 + 4.0 * 0.2 / 5.0)),
        # neither: T = 4 (d/(2j))^(1/3)
        (0.01, 4.0 * (0.01 / 100.0) ** (1.0 / 3.0)),
        # as long as acceleration is just reached: d = 2 a^3/j^2
        (2.0 * 125.0 / 2500.0, 0.4),
        (0.0, 0.0),
    ],
)
def test_duration_is_the_least_known_in_closed_form(length, duration):
    move = JerkLimitedMove([0.0], [length], 1.0, 5.0, 50.0)
    assert move.duration == pytest.approx(duration, rel=1e-12)


def test_velocity_reached_without_constant_acceleration():
    # a = 100 is out of reach of v = 1 with j = 50: T = d/v + 2 sqrt(v/j)
    move = JerkLimitedMove([0.0], [2.0], 1.0, 100.0, 50.0)
    assert move.duration == pytest.approx(2.0 + 2.0 * math.sqrt(1.0 / 50.0), rel=1e-13)
    assert np.abs(extremes(move).acceleration).max() == pytest.approx(math.sqrt(50.0))


@pytest.mark.parametrize("length", [3.0, 0.2, 0.01])
def test_symmetry_in_time_and_derivatives(length):
    move = JerkLimitedMove([0.1, -0.2], [0.1 + 0.6 * length, -0.2 - 0.8 * length], 1.0, 5.0, 50.0)
    t = np.linspace(0.0, move.duration, 1001)
    there, back = move.at(t), move.at(move.duration - t)
    ends = move.at(0.0).position + move.at(move.duration).position
    np.testing.assert_allclose(there.position + back.position, ends[None].repeat(1001, 0))
    np.testing.assert_allclose(there.velocity, back.velocity, atol=1e-12)
    # piecewise polynomials: central differences are exact but for the changes of jerk
    h = 1e-5
    slope = (move.at(t + h).position - move.at(t - h).position) / (2 * h)
    np.testing.assert_allclose(slope, there.velocity, atol=50.0 * h**2 + 1e-9)
    slope = (move.at(t + h).velocity - move.at(t - h).velocity) / (2 * h)
    np.testing.assert_allclose(slope, there.acceleration, atol=50.0 * h)


def test_axes_share_the_limits_of_the_line_and_ends_are_exact():
    move = JerkLimitedMove((0.1, 0.7, -1.3), (0.4, -0.3, 1e-3), 0.5, 3.0, 40.0)
    assert move.at(move.duration).position.tolist() == [0.4, -0.3, 1e-3]
    assert move.at(9e9).position.tolist() == [0.4, -0.3, 1e-3]
    assert move.at(-1.0).position.tolist() == [0.1, 0.7, -1.3]
    speed = np.linalg.norm(extremes(move).velocity, axis=-1)
    assert speed.max() == pytest.approx(0.5, rel=1e-12)


@settings(max_examples=200, deadline=None)
@given(st.floats(0.0, 10.0), st.floats(1e-5, 100.0), positive, positive)
def test_reachable_speed_takes_the_length_that_it_is_given(first, length, a, j):
    last = reachable_speed(first, length, a, j)
    assert last >= first
    # the change of the speed is known to the rounding of the speed only
    rounding = 4e-16 * last / max(last - first, 4e-16 * last)
    taken = speed_change_length(first, last, a, j)
    assert taken == pytest.approx(length, rel=1e-11 + 4.0 * rounding)


@pytest.mark.parametrize(("first", "length"), [(0.0, 0.3), (0.7, 0.002), (0.7, 0.4), (2.0, 1e-5)])
def test_reachable_speed_is_the_root_found_by_bisection(first, length):
    root = brentq(
        lambda v: speed_change_length(first, v, 5.0, 50.0) - length, first, first + 9.0, xtol=1e-14
    )
    assert reachable_speed(first, length, 5.0, 50.0) == pytest.approx(root, rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0.0], [1.0], 0.0, 1.0, 1.0), "velocity is 0.0"),
        (([0.0], [1.0], 1.0, math.nan, 1.0), "acceleration is nan"),
        (([0.0], [1.0], 1.0, 1.0, math.inf), "jerk is inf"),
        (([0.0], [1.0, 2.0], 1.0, 1.0, 1.0), "end has 2 axes; 1"),
        (([0.0], [math.nan], 1.0, 1.0, 1.0), "end"),
    ],
)
def test_nonsense_is_refused_by_name(arguments, message):
    with pytest.raises(TrajectoryError, match=message):
        JerkLimitedMove(*arguments)
