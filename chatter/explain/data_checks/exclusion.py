"""Exclusion of what findings call unusable: samples, channels, runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.explain.data_checks.clock import HOLE, evened
from chatter.explain.data_checks.finding import CHANNEL, RUN, SAMPLES, SignalFinding
from chatter.explain.measurement import Measurement, Run


def excluding(measurement: Measurement, found: Sequence[SignalFinding]) -> Measurement:
    """Measurement without what is unusable.

    Samples that are unusable are bridged by a straight line and marked; holes in a clock are filled
    likewise.
    """
    dropped = {one.run for one in found if one.severity == RUN}
    runs = [run for run in measurement.runs if run.name not in dropped]
    return replace(measurement, runs=tuple(_without(run, found) for run in runs))


def _without(run: Run, found: Sequence[SignalFinding]) -> Run:
    own = [one for one in found if one.run == run.name]
    signals, usable = dict(run.signals), run.usable
    for one in own:
        if one.severity == CHANNEL:
            for name in one.channel.split(", "):
                signals.pop(name, None)
    marked = [one for one in own if one.severity == SAMPLES and one.samples is not None]
    for one in marked:
        if one.channel == "stable":
            signals["stable"] = np.where(one.samples, np.nan, signals["stable"])
        elif one.channel in signals:
            signals[one.channel] = bridged(signals[one.channel], one.samples)
            usable = (1.0 if usable is None else usable) * ~one.samples
    if any(one.channel == "time" for one in own) and "time" in signals:
        signals["time"] = evened(signals["time"])
        signals, usable = _on_even_clock(signals, usable)
    angle = signals.get("spindle_angle")
    if angle is not None and not np.all(np.isfinite(angle)) and np.isfinite(angle).any():
        signals["spindle_angle"] = bridged(angle, ~np.isfinite(angle))
    return replace(run, signals=signals, usable=usable)


def bridged(values: NDArray[np.float64], bad: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Values with a straight line across bad samples."""
    good = np.flatnonzero(~bad & np.isfinite(values))
    if not good.size:
        return np.zeros(values.size)
    return np.where(bad, np.interp(np.arange(values.size), good, values[good]), values)


def _on_even_clock(
    signals: dict[str, NDArray[np.float64]], usable: NDArray[np.float64] | None
) -> tuple[dict[str, NDArray[np.float64]], NDArray[np.float64] | None]:
    """Signals on an even clock, and which samples are usable: none in holes of the old one."""
    time = signals["time"]
    steps = np.diff(time)
    step = float(np.median(steps))
    holes = np.flatnonzero(steps > HOLE * step)
    count = round(float(time[-1] - time[0]) / step) + 1
    if count > 10 * time.size:
        return signals, usable  # a clock that jumps by more than the record is long
    even = time[0] + step * np.arange(count)
    kept = np.interp(even, time, np.ones(time.size) if usable is None else usable) > 0.999
    for hole in holes:
        kept &= ~((even > time[hole] + 0.5 * step) & (even < time[hole + 1] - 0.5 * step))
    found = {
        name: np.interp(even, time, values)
        for name, values in signals.items()
        if values.size == time.size
    }
    return {**found, "time": even}, kept.astype(np.float64)
