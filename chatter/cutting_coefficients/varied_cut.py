"""One cut whose feed, depth or width is varied: its parts, as a series of cuts."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.explain.measurement import Measurement, Run

#: columns of a record that tell how the cut was varied, and how each is shown
_VARIED = {
    "feed_per_tooth": (1e3, "mm"),
    "feed_rate": (6e4, "mm/min"),
    "axial_depth": (1e3, "mm"),
    "radial_depth": (1e3, "mm"),
}
#: share of the largest value within which one is the same, and parts of a cut that has no steps
_SAME, _PARTS = 0.01, 8
#: revolutions of a part, at the least
_LEAST_REVOLUTIONS = 6
#: share of the record that steps must hold, or it is a ramp
_STEPS = 0.5


def with_parts(measurement: Measurement) -> Measurement:
    """Return the measurement with each varied cut in parts that are cuts of their own.

    The columns feed_per_tooth, feed_rate, axial_depth and radial_depth tell how a cut was varied.
    Steps are parts; a ramp is divided evenly, and each part counts with its mean.
    """
    runs = [part for run in measurement.runs for part in _parts(run, measurement.case)]
    return measurement.with_runs(runs)


def _parts(run: Run, declared: Case) -> list[Run]:
    told = [name for name in _VARIED if name in run.signals]
    if not told or "time" not in run.signals:
        return [run]
    columns = np.array([run.signals[name] for name in told])
    size = np.maximum(np.abs(columns).max(axis=1, keepdims=True), 1e-300)
    least = _least_samples(run, declared)
    steps = [one for one in _steps(columns / size) if one.stop - one.start >= least]
    if sum(one.stop - one.start for one in steps) < _STEPS * columns.shape[1]:
        count = max(1, min(_PARTS, columns.shape[1] // least))
        edges = np.linspace(0, columns.shape[1], count + 1).astype(int)
        steps = [slice(int(low), int(high)) for low, high in itertools.pairwise(edges)]
    return [_part(run, told, one, declared) for one in steps]


def _least_samples(run: Run, declared: Case) -> int:
    turn = 2.0 * math.pi / run.of(declared).cut.spindle_speed
    return max(2, math.ceil(_LEAST_REVOLUTIONS * turn / run.step))


def _steps(columns: Array) -> list[slice]:
    """Stretches in which no column moves from where the stretch began."""
    found, begin = [], 0
    for sample in range(1, columns.shape[1] + 1):
        if sample == columns.shape[1] or np.any(
            np.abs(columns[:, sample] - columns[:, begin]) > _SAME
        ):
            found.append(slice(begin, sample))
            begin = sample
    return found


def _part(run: Run, told: Sequence[str], chosen: slice, declared: Case) -> Run:
    """Part of a run, whose columns override the case."""
    signals = {name: values[chosen] for name, values in run.signals.items() if name not in told}
    values = {name: float(np.mean(run.signals[name][chosen])) for name in told}
    words = [
        f"{name} {_VARIED[name][0] * value:.4g} {_VARIED[name][1]}"
        for name, value in values.items()
    ]
    if "feed_rate" in values:
        cut, teeth = run.of(declared).cut, declared.tool.teeth
        turns = cut.spindle_speed / (2.0 * math.pi)
        values["feed_per_tooth"] = values.pop("feed_rate") / (teeth * turns)
    return replace(
        run,
        name=f"{run.name}, {', '.join(words)}",
        signals=signals,
        overrides={**run.overrides, **{f"cut.{name}": value for name, value in values.items()}},
    )
