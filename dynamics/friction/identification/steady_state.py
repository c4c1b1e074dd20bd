"""Friction curve from moves at constant speed, and its shares about the motor and along the slide.

As in "Time domain coupled simulation of machine tool dynamics and cutting forces considering the
influences of nonlinear friction characteristics and process damping", section 3: the mean torque of
each constant-speed move is set against its speed, and rotational and translational friction share
the torque about the motor shaft, there equally.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.dynamic_fit import FrictionLaw
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.intervals import Estimate, correlation_length
from dynamics.friction.identification.law_fit import law_parameters, search
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


@dataclass(frozen=True)
class SteadyFit:
    """Result of `fit_steady_state`."""

    law: FrictionLaw  # with the fitted values
    offset: float  # effort that does not turn with the motion (weight, preload), N or N m
    estimates: dict[str, Estimate]  # fitted parameters with 95 % intervals
    residual: float  # root mean square over the points, N or N m
    unsupported: tuple[str, ...]  # parameters that the points do not decide


def fit_steady_state(
    points: Sequence[SteadyPoint],
    guess: FrictionLaw,
    free: Sequence[str],
    *,
    starts: int = 8,
    seed: int = 0,
) -> SteadyFit:
    """Fit the sliding part of a friction law to mean efforts at constant speeds.

    Points are more than there are parameters; each counts alike. Free are parameters of the law,
    and ``"offset"``, which needs moves in both directions; those that are not, presliding above
    all, stay as in the guess. The seed is that of the starts of the search after the first.
    MeasurementError if there are too few points, or only one direction for an offset; ValueError if
    a parameter is unknown or its guess is out of range.
    """
    of_law = [name for name in free if name != "offset"]
    first = law_parameters(guess, of_law)
    velocity = np.array([point.velocity for point in points])
    effort = np.array([point.effort for point in points])
    if len(points) <= len(free):
        raise MeasurementError(
            f"constant-speed moves: {len(points)} points for {len(free)} parameters; more points "
            "than parameters are needed"
        )
    signed = {}
    if "offset" in free:
        if not (np.any(velocity > 0.0) and np.any(velocity < 0.0)):
            raise MeasurementError("constant-speed moves: an offset needs moves in both directions")
        first["offset"] = 0.0
        signed["offset"] = float(np.max(np.abs(effort)))

    def law(values: dict[str, float]) -> FrictionLaw:
        return replace(guess, **{name: values[name] for name in of_law})

    def residual(values: dict[str, float]) -> NDArray[np.float64]:
        return law(values).steady_state_force(velocity) + values.get("offset", 0.0) - effort

    found = search(residual, first, signed=signed, starts=starts, seed=seed, fewest=1)
    return SteadyFit(
        law(found.values),
        found.values.get("offset", 0.0),
        found.estimates,
        float(np.sqrt(np.mean(found.residual**2))),
        found.unsupported,
    )
