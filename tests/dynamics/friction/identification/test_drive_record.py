"""Records: checks, conversion from current, filters and derivatives."""

import math

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.record import DriveRecord, record_from_current

T = 1e-3 * np.arange(1000)
X = 0.01 * np.sin(2 * np.pi * T)
V = 0.02 * np.pi * np.cos(2 * np.pi * T)


def test_effort_of_a_screw_drive_from_its_current():
    """1 N m at a pitch of 40 mm is 2 pi / 0.04 = 157.08 N."""
    record = record_from_current(
        T, X, V, np.full(1000, 2.0), torque_constant=0.5, transmission=2 * math.pi / 0.04
    )
    assert record.effort == pytest.approx(157.0796, abs=1e-4)
    with pytest.raises(ValueError, match="torque_constant"):
        record_from_current(T, X, V, V, torque_constant=0.0)
    with pytest.raises(ValueError, match="transmission"):
        record_from_current(T, X, V, V, torque_constant=1.0, transmission=0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"effort": V[:-1]}, "one value for each sample"),
        ({"effort": np.where(T[4] == T, np.nan, V)}, "effort is nan at sample 5"),
        ({"velocity": 1e3 * V}, "drift apart"),
        ({"velocity": -V}, "drift apart"),
        ({"position": 0 * X, "velocity": 0 * V}, "does not move"),
        ({"time": np.where(T > 0.5, T + 0.1, T)}, "even sampling"),
        ({"time": -T}, "does not ascend"),
        ({"time": T[:4], "position": X[:4], "velocity": V[:4], "effort": V[:4]}, "at least 16"),
    ],
)
def test_bad_records_are_told(change, message):
    signals = {"time": T, "position": X, "velocity": V, "effort": V} | change
    with pytest.raises(MeasurementError, match=message):
        DriveRecord(**signals)


def test_part_of_a_record():
    record = DriveRecord(T, X, V, V, name="move")
    part = record.part(0.2, 0.4)
    assert (part.time[0], part.time[-1]) == pytest.approx((0.2, 0.4))
    assert part.name == "move from 0.2 to 0.4 s"
    with pytest.raises(MeasurementError, match="between 2 and 3 s"):
        record.part(2.0, 3.0)


def test_low_pass_has_the_gain_of_two_butterworth_passes():
    """|H|^2 of one pass is 1 / (1 + (f / fc)^8): the gain of both."""
    t = 1e-4 * np.arange(20000)
    for f in (5.0, 20.0, 35.0):
        out = LowPass(20.0).apply(np.sin(2 * np.pi * f * t), 1e-4)[5000:15000]
        expected = 1.0 / (1.0 + (f / 20.0) ** 8)
        reference = np.sin(2 * np.pi * f * t[5000:15000])
        assert out == pytest.approx(expected * reference, abs=2e-3 * max(expected, 0.05))
    with pytest.raises(MeasurementError, match="sampling rate"):
        LowPass(600.0).apply(V, 1e-3)
    with pytest.raises(MeasurementError, match="more than"):
        LowPass(1.0).apply(V[:400], 1e-3)
    with pytest.raises(ValueError, match="cutoff"):
        LowPass(-1.0)
