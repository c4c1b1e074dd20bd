"""Lines into and out of a trajectory that begins and ends at speed."""

import numpy as np
import pytest

from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.motion import TrajectoryError
from dynamics.trajectory.periodic import CircleMotion, ConstantSpeedMove
from dynamics.trajectory.run_in import WithRunIn

#: m/s, m/s^2, m/s^3: v j = 2 > a^2 = 1, so that a run-in lasts v / a + a / j = 0.15 s
SPEED, ACCELERATION, JERK = 0.1, 1.0, 20.0
LEAD = 0.15
STRAIGHT = ConstantSpeedMove([0.02, 0.0], [0.02, -0.05], SPEED)
CIRCLE = CircleMotion([-0.05, 0.0], 0.05, SPEED, -1.5)


@pytest.mark.parametrize("inner", [STRAIGHT, CIRCLE])
def test_it_begins_and_ends_at_rest_and_does_not_jump(inner):
    motion = WithRunIn(inner, ACCELERATION, JERK)
    assert motion.part == pytest.approx((LEAD, LEAD + inner.duration))
    assert motion.duration == pytest.approx(2.0 * LEAD + inner.duration)
    time = np.linspace(0.0, motion.duration, 40001)
    moved = motion.at(time)
    assert moved.velocity[[0, -1]] == pytest.approx(np.zeros((2, 2)), abs=1e-12)
    speed = np.linalg.norm(moved.velocity, axis=1)
    assert np.max(speed) == pytest.approx(SPEED)
    assert np.max(np.abs(np.diff(moved.velocity, axis=0))) < 2.0 * ACCELERATION * time[1]
    # velocity and acceleration are the derivatives of the position, but for their corners
    assert np.gradient(moved.position, time, axis=0)[1:-1] == pytest.approx(
        moved.velocity[1:-1], abs=ACCELERATION * time[1]
    )


def test_the_trajectory_itself_is_kept():
    motion = WithRunIn(CIRCLE, ACCELERATION, JERK)
    time = np.linspace(0.0, CIRCLE.duration, 52)[1:-1]
    for mine, wanted in zip(motion.at(motion.part[0] + time), CIRCLE.at(time), strict=True):
        assert mine == pytest.approx(wanted, abs=1e-12)


def test_the_length_of_the_run_in_is_by_its_mean_speed():
    begin = WithRunIn(STRAIGHT, ACCELERATION, JERK).at(0.0).position
    assert begin == pytest.approx([0.02, 0.5 * SPEED * LEAD])


def test_a_trajectory_from_rest_needs_none():
    with pytest.raises(TrajectoryError, match="run-in: speed is 0"):
        WithRunIn(JerkLimitedMove([0.0], [0.01], SPEED, ACCELERATION, JERK), ACCELERATION, JERK)
