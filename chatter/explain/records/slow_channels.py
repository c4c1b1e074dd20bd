"""Spindle power and drive torque of a cut: what the drives of spindle and axes tell of it.

A power is as slow as its sensor, which nobody tells: it is judged by its mean over a revolution,
which no ripple changes. Its level is that of the cut where the power in the air is known.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.measurement import Run
from chatter.explain.records.case_axes import Component
from chatter.explain.records.description import DRIVE_TORQUE, SPINDLE_POWER, Channel
from chatter.explain.residuals.channel_residual import white_level

Array = NDArray[np.float64]

#: name of the power in what is reported
POWER = "spindle_power"
#: least noise of a power, as a share of it: its meter is no better
_LEAST_NOISE = 0.01


def over_revolution(values: Array, time: Array, speed: float) -> Array:
    """Mean (n,) over the revolution around every sample, at the ends over what there is of it.

    Speed of the spindle, rad/s; times, s, are even.
    """
    step = float(time[-1] - time[0]) / (time.size - 1)
    half = max(round(np.pi / speed / step), 1)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    index = np.arange(values.size)
    first, last = np.maximum(index - half, 0), np.minimum(index + half, values.size)
    return (sums[last] - sums[first]) / (last - first)


def with_power(run: Run, channels: Mapping[str, Channel], idle: float | None, speed: float) -> Run:
    """Run with the power of the cut as a channel that is predicted, where its level is known.

    Idle is what the spindle takes in the air, W.
    """
    name = power_channel(channels)
    if name is None or name not in run.signals or idle is None:
        return run
    measured = run.signals[name] - idle
    mean = over_revolution(measured, run.signals["time"], speed)
    # neighbours of a mean share their samples: it counts with the noise of these
    noise = white_level(measured - mean)
    noise = float(np.hypot(noise, _LEAST_NOISE * np.sqrt(np.mean(mean**2))))
    component = Component(SPINDLE_POWER, (0.0, 0.0, 0.0), noise=noise)
    return replace(
        run, signals={**run.signals, POWER: mean}, components={**run.components, POWER: component}
    )


def with_torques(run: Run, channels: Mapping[str, Channel], case: Case) -> Run:
    """Run with the torques of the drives of a machine as channels that are predicted."""
    if not case.on_machine:
        return run
    drives = [name for name, one in case.machine_file().axis.items() if one.drive is not None]
    found = {
        name: Component(DRIVE_TORQUE, (0.0, 0.0, 0.0), axis=one.axis)
        for name, one in channels.items()
        if one.quantity == DRIVE_TORQUE and one.axis in drives and name in run.signals
    }
    return replace(run, components={**run.components, **found}) if found else run


def power_channel(channels: Mapping[str, Channel]) -> str | None:
    """Name of the channel of the spindle power; None where there is none."""
    return next((k for k, v in channels.items() if v.quantity == SPINDLE_POWER), None)
