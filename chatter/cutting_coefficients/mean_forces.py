"""Mean forces of cuts over whole revolutions: start angle, runout and vibration drop out."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.description import FORCE, Channel

#: channels that need no description, along x, y and z of the cut, on the tool
_USUAL = ("Fx", "Fy", "Fz")
#: revolutions of which a mean has a scatter
FEWEST_REVOLUTIONS = 4
#: samples of which a clock has a step
_FEWEST_SAMPLES = 2
#: share of its value by which a force is uncertain at the least: gain and crosstalk of a
#: dynamometer
GAIN = 0.01


class MeanForce(NamedTuple):
    """Mean of one force channel of one cut."""

    run: str
    channel: str
    direction: tuple[float, float, float]  # of the force on the tool, in the axes of the cut
    has_sign: bool  # whether the sense of the direction is known
    value: float  # N
    deviation: float  # standard deviation, N
    revolutions: int


def mean_forces(measurement: Measurement) -> list[MeanForce]:
    """Mean forces of all runs.

    Raises
    ------
    InputError
        If a run has no time, no force with a known direction, or less than four revolutions.
    """
    found = [one for run in measurement.runs for one in _of_run(measurement, run)]
    if not found:
        raise InputError(f"{measurement.folder}: no run has a force with a known direction")
    return found


def _of_run(measurement: Measurement, run: Run) -> list[MeanForce]:
    own = run.of(measurement.case)
    where = measurement.folder / run.name
    if "time" not in run.signals:
        raise InputError(f"{where}: column time is missing; there are {', '.join(run.signals)}")
    channels = force_channels(measurement, run)
    if not channels:
        raise InputError(f"{where}: no force has a known direction; [channels.NAME] direction says")
    time = run.signals["time"]
    if time.size < _FEWEST_SAMPLES:
        raise InputError(f"{where}: {time.size} sample is no record of a cut")
    count, revolutions = _whole_revolutions(own, time)
    if revolutions < FEWEST_REVOLUTIONS:
        raise InputError(
            f"{where}: {revolutions} whole revolutions at {own.cut.spindle_speed_rpm:.0f} rpm; at "
            f"least {FEWEST_REVOLUTIONS} are required"
        )
    return [
        _mean(run, name, sense, has_sign, run.signals[name][:count], revolutions)
        for name, (sense, has_sign) in channels.items()
    ]


def _whole_revolutions(case: Case, time: Array) -> tuple[int, int]:
    """Samples of whole revolutions from the start, and how many revolutions they are."""
    period = 2.0 * math.pi / case.cut.spindle_speed
    step = float(np.median(np.diff(time)))
    revolutions = int((time.size * step) / period + 1e-6)
    return min(round(revolutions * period / step), time.size), revolutions


def _mean(
    run: Run,
    name: str,
    direction: tuple[float, float, float],
    has_sign: bool,
    values: Array,
    revolutions: int,
) -> MeanForce:
    """Mean, with the scatter of the means of revolutions and what no repetition shows."""
    edges = np.linspace(0, values.size, revolutions + 1).round().astype(np.intp)
    each = np.array([values[low:high].mean() for low, high in itertools.pairwise(edges)])
    value = float(values.mean())
    scatter = float(each.std(ddof=1)) / math.sqrt(revolutions)
    return MeanForce(
        run.name, name, direction, has_sign, value, math.hypot(scatter, GAIN * value), revolutions
    )


def force_channels(
    measurement: Measurement, run: Run
) -> Mapping[str, tuple[tuple[float, float, float], bool]]:
    """Return the direction of the force on the tool by channel, and whether its sense is known."""
    described = {} if measurement.record is None else dict(measurement.record.channels)
    found: dict[str, tuple[tuple[float, float, float], bool]] = {}
    for axis, name in enumerate(_USUAL):
        if name in run.signals and name not in described:
            found[name] = (_unit(axis), True)
    for name, channel in described.items():
        if name in run.signals and channel.quantity == FORCE and channel.direction is not None:
            found[name] = (_on_tool(channel), channel.has_sign)
    return found


def _unit(axis: int) -> tuple[float, float, float]:
    x, y, z = np.eye(3)[axis].tolist()
    return x, y, z


def _on_tool(channel: Channel) -> tuple[float, float, float]:
    """Direction as of a force on the tool: that on the workpiece is opposite."""
    sense = 1.0 if channel.on == "tool" else -1.0
    x, y, z = (sense * part for part in channel.direction)
    return x, y, z


def channels_of(means: Sequence[MeanForce]) -> list[str]:
    """Names of channels, each once."""
    return list(dict.fromkeys(one.channel for one in means))
