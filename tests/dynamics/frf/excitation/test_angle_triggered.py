"""Passages of a spindle through an angle."""

import numpy as np
import pytest

from dynamics.frf.excitation.angle_triggered import (
    angle_at_constant_speed,
    angle_triggered_pulses,
    passages,
)
from dynamics.frf.excitation.signal import ExcitationError

TURN = 2.0 * np.pi


@pytest.mark.parametrize("speed", [TURN, -TURN])
def test_constant_speed_passes_once_a_turn(speed):
    angle = angle_at_constant_speed(speed, 4001, 1e-3)
    np.testing.assert_array_equal(
        passages(angle, np.sign(speed) * 0.25 * TURN), [250, 1250, 2250, 3250]
    )
    np.testing.assert_array_equal(passages(angle, 0.0), [0, 1000, 2000, 3000, 4000])


def test_encoder_angle_that_starts_anew_gives_the_same_as_a_running_one():
    time = 1e-3 * np.arange(5000)
    running = 3.0 * TURN * time + 0.4 * np.sin(5.0 * time) + 1.0
    for at in (0.0, 1.0001, 2.0, -1.0, 9.0):
        found = passages(running, at)
        np.testing.assert_array_equal(passages(running % TURN, at), found)
        turns = (running - at) / TURN
        np.testing.assert_array_equal(np.floor(turns[found]), np.ceil(turns[found - 1]))
        assert found.size == np.floor(turns[-1]) - np.floor(turns[0])


def test_swinging_over_the_angle_counts_once():
    angle = np.array([0.9, 1.1, 0.9, 1.1, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 7.4, 7.2, 7.4])
    np.testing.assert_array_equal(passages(angle, 1.0), [1, 10])


def test_pulses_every_some_revolutions():
    angle = angle_at_constant_speed(TURN * 10.0, 1000, 1e-3)
    train = angle_triggered_pulses(angle, 0.5 * TURN, np.array([1.0, 2.0]), 1e-3, revolutions=3)
    np.testing.assert_array_equal(train.starts, [50, 350, 650, 950])
    np.testing.assert_array_equal(train.values[train.starts], 1.0)
    np.testing.assert_array_equal(train.values[train.starts + 1], 2.0)
    assert train.values.sum() == 12.0


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: passages(np.array([0.1, 0.2]), 1.0), "never comes"),
        (lambda: passages(np.array([0.1, np.nan]), 1.0), "finite"),
        (lambda: angle_at_constant_speed(0.0, 10, 1e-3), "speed is 0"),
        (lambda: angle_triggered_pulses(np.arange(9.0), 1.0, np.ones(2), 1e-3, 0), "revolutions"),
        (lambda: angle_triggered_pulses(np.arange(20.0), 1.0, np.ones(8), 1e-3), "does not end"),
        (lambda: angle_triggered_pulses(np.arange(9.0), 1.0, np.ones(9), 1e-3), "too late"),
    ],
)
def test_senseless_angles_are_told(make, told):
    with pytest.raises(ExcitationError, match=told):
        make()
