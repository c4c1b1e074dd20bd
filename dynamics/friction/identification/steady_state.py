"""Friction curve from moves at constant speed.

As in "Time domain coupled simulation of machine tool dynamics and cutting forces considering the
influences of nonlinear friction characteristics and process damping", section 3: the mean torque of
each constant-speed move is set against its speed.
"""

import math
from dataclasses import dataclass

import numpy as np

from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.intervals import correlation_length
from dynamics.friction.identification.record import DriveRecord


@dataclass(frozen=True)
class SteadyPoint:
    """Mean of one segment at constant speed."""

    velocity: float  # m/s or rad/s, with its sign
    effort: float  # N or N m
    standard_error: float  # of the mean effort, allowing for ripple
    start: float  # of the segment, s
    end: float  # of the segment, s


def constant_speed_points(
    record: DriveRecord,
    *,
    low_pass: LowPass,
    minimum_duration: float,
    settling: float,
    minimum_speed: float,
    tolerance: float = 0.05,
) -> list[SteadyPoint]:
    """Find the segments at constant speed, in order of time, and average their effort.

    The low-pass is for the velocity that is judged; the effort is averaged as it is. A segment
    lasts the minimum duration, s, after the settling time, s, that is left out of its start:
    presliding after a reversal and the ringing of the controller. Segments slower than the minimum
    speed, m/s or rad/s, are rest. The tolerance is the largest deviation of the low-passed speed
    within a segment, of the segment's first speed. MeasurementError if the record has no such
    segment.
    """
    velocity = low_pass.apply(record.velocity, record.sample_time)
    settled = round(settling / record.sample_time)
    # the braking that follows begins before the low-passed velocity leaves its tolerance
    blurred = 2 * round(low_pass.settling / record.sample_time)
    points = []
    start = 0
    while start < len(velocity):
        reference = velocity[start]
        away = np.abs(velocity[start:] - reference) > tolerance * abs(reference)
        length = int(np.argmax(away)) if away.any() else len(away)
        if abs(reference) < minimum_speed:
            start += max(length, 1) if reference == 0.0 else 1
            continue
        segment = slice(start + settled, start + length - blurred)
        long_enough = (segment.stop - segment.start) * record.sample_time >= minimum_duration
        if not long_enough:
            start += 1
            continue
        points.append(_mean(record, segment))
        start += length
    if not points:
        raise MeasurementError(
            f"{record.name}: no segment of {minimum_duration:g} s at a speed constant within "
            f"{100 * tolerance:g} % after {settling:g} s of settling"
        )
    return points


def _mean(record: DriveRecord, segment: slice) -> SteadyPoint:
    effort = record.effort[segment]
    repeats = correlation_length(effort)
    error = float(np.std(effort)) * math.sqrt(2.0 * repeats / len(effort))
    return SteadyPoint(
        float(np.mean(record.velocity[segment])),
        float(np.mean(effort)),
        error,
        float(record.time[segment][0]),
        float(record.time[segment][-1]),
    )
