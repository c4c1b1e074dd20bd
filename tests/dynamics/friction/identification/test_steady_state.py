"""Friction curves from moves at constant speed."""

import math

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.steady_state import constant_speed_points
from tests.dynamics.friction.identification.made_up_records import back_and_forth, noisy


def test_constant_stretches_are_found_and_averaged():
    t, x, v, a = back_and_forth((0.01, 0.05, 0.2), 1.0, 1.0, 1e-3)
    ripple = 3.0 * np.sin(2 * math.pi * 17.0 * t)
    force = 40.0 * np.sign(np.round(v, 9)) + 100.0 * v + 200.0 * a + ripple
    record = noisy(t, x, v, force, np.random.default_rng(0), effort_noise=2.0, velocity_noise=2e-4)
    found = constant_speed_points(
        record, low_pass=LowPass(20.0), minimum_duration=0.5, settling=0.1, minimum_speed=5e-3
    )
    speeds = [0.01, -0.01, 0.05, -0.05, 0.2, -0.2]
    assert [p.velocity for p in found] == pytest.approx(speeds, rel=5e-3)
    expected = [40.0 * np.sign(s) + 100.0 * s for s in speeds]
    for point, effort in zip(found, expected, strict=True):
        assert point.effort == pytest.approx(effort, abs=0.5)
        assert point.end - point.start >= 0.5
        assert 0.0 < point.standard_error < 1.0
    with pytest.raises(MeasurementError, match="no segment of 5 s"):
        constant_speed_points(
            record, low_pass=LowPass(20.0), minimum_duration=5.0, settling=0.1, minimum_speed=5e-3
        )
