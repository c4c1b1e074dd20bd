"""Leaving out what findings say is no good: samples, channels, runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.explain.data_checks.clock import mended
from chatter.explain.data_checks.finding import CHANNEL, RUN, SAMPLES, SignalFinding
from chatter.explain.measurement import USABLE, Measurement, Run

#: a step of the clock of more than this many is a hole
_HOLE = 1.6


def left_out(measurement: Measurement, found: Sequence[SignalFinding]) -> Measurement:
    """Measurement without what is no good.

    Samples that are no good are bridged by a straight line, and marked as not usable in a column
    of their own; holes in a clock are filled likewise.
    """
    dropped = {one.run for one in found if one.severity == RUN}
    runs = [run for run in measurement.runs if run.name not in dropped]
    return replace(measurement, runs=tuple(_mended(run, found) for run in runs))


def _mended(run: Run, found: Sequence[SignalFinding]) -> Run:
    own = [one for one in found if one.run == run.name]
    signals = dict(run.signals)
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
            before = signals.get(USABLE, np.ones(one.samples.size))
            signals[USABLE] = before * ~one.samples
    if any(one.channel == "time" for one in own) and "time" in signals:
        signals["time"] = mended(signals["time"])
        signals = _evened(signals)
    angle = signals.get("spindle_angle")
    if angle is not None and not np.all(np.isfinite(angle)) and np.isfinite(angle).any():
        signals["spindle_angle"] = bridged(angle, ~np.isfinite(angle))
    return replace(run, signals=signals)


def bridged(values: NDArray[np.float64], bad: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Values with a straight line across bad samples."""
    good = np.flatnonzero(~bad & np.isfinite(values))
    if not good.size:
        return np.zeros(values.size)
    place = np.arange(values.size)
    return np.where(bad, np.interp(place, good, values[good]), values)


def _evened(signals: dict[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Signals on an even clock; what falls into holes of the old one is not usable."""
    time = signals["time"]
    steps = np.diff(time)
    step = float(np.median(steps))
    holes = np.flatnonzero(steps > _HOLE * step)
    count = round(float(time[-1] - time[0]) / step) + 1
    if count > 10 * time.size:
        return signals  # a clock that jumps by more than the record is long
    even = time[0] + step * np.arange(count)
    usable = np.interp(even, time, signals.get(USABLE, np.ones(time.size))) > 0.999
    for place in holes:
        usable &= ~((even > time[place] + 0.5 * step) & (even < time[place + 1] - 0.5 * step))
    found = {
        name: np.interp(even, time, values)
        for name, values in signals.items()
        if values.size == time.size
    }
    return {**found, "time": even, USABLE: usable.astype(np.float64)}
