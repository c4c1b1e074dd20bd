"""Where the residual of a measurement lives, and what it hangs on."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.explain.kind import Kind
from chatter.explain.measurement import Measurement, Run

#: bins of a variable over which the residual is averaged
_BINS = 24
#: lines told of a spectrum
_LINES = 5


def signature_of(measurement: Measurement, kind: Kind, case: Case) -> dict[str, Any]:
    """Shares of the residual by run and channel, its strongest frequencies, and its dependences.

    A dependence is the share of the residual's variance that its mean over bins of a variable
    explains; that over the strongest variable is given as a table, as a lead.
    """
    shares, lines, dependences = {}, {}, {}
    tables: dict[str, list] = {}
    for run in measurement.runs:
        own = run.of(case)
        predicted = kind.predict(own, run)
        for channel in kind.channels(run):
            left = run.signals[channel] - predicted[channel]
            left = left * run.usable(left.size)
            level = float(np.sqrt(np.mean(run.signals[channel] ** 2)))
            share = float(np.sqrt(np.mean(left**2))) / max(level, 1e-300)
            shares.setdefault(channel, {})[run.name] = share
            if "time" in run.signals and run.signals["time"].size == left.size:
                lines.setdefault(channel, []).append(_strongest(run, left))
            for name, values in _variables(own, run, left.size).items():
                explained, table = _dependence(values, left)
                dependences.setdefault(channel, {}).setdefault(name, []).append(explained)
                tables.setdefault(f"{channel} over {name}", table)
    means = {
        channel: {name: float(np.mean(parts)) for name, parts in found.items()}
        for channel, found in dependences.items()
    }
    best = max(
        (
            (value, channel, name)
            for channel, found in means.items()
            for name, value in found.items()
        ),
        default=(0.0, "", ""),
    )
    return {
        "relative_residual": shares,
        "strongest_frequencies_Hz": lines,
        "explained_by": means,
        "lead": {"residual": best[1], "over": best[2], "share": best[0]},
        "lead_table": tables.get(f"{best[1]} over {best[2]}", []),
    }


def _strongest(run: Run, left: NDArray[np.float64]) -> list[float]:
    step = float(np.median(np.diff(run.signals["time"])))
    spectrum = np.abs(np.fft.rfft((left - left.mean()) * np.hanning(left.size)))
    frequency = np.fft.rfftfreq(left.size, step)
    inner = (spectrum[1:-1] > spectrum[:-2]) & (spectrum[1:-1] >= spectrum[2:])
    places = 1 + np.flatnonzero(inner)
    best = places[np.argsort(spectrum[places])[::-1][:_LINES]]
    return [float(value) for value in frequency[best]]


def _variables(case: Case, run: Run, size: int) -> dict[str, NDArray[np.float64]]:
    """What the residual may hang on, sample by sample."""
    signals = run.signals
    found = {}
    for name in ("position", "velocity", "frequency"):
        if name in signals and signals[name].size == size:
            found[name] = signals[name]
    if "time" in signals and signals["time"].size == size:
        found["time"] = signals["time"]
    if "spindle_angle" in signals and signals["spindle_angle"].size == size:
        angle = signals["spindle_angle"]
        found["spindle angle"] = np.mod(angle, 2.0 * math.pi)
        found["tooth angle"] = np.mod(angle, 2.0 * math.pi / case.tool.teeth)
        found["feed position"] = angle / (2.0 * math.pi) * case.tool.teeth * case.cut.feed_per_tooth
    return found


def _dependence(
    values: NDArray[np.float64], left: NDArray[np.float64]
) -> tuple[float, list[list[float]]]:
    """Share of the variance that means over bins explain beyond chance, and the means."""
    edges = np.linspace(values.min(), values.max() + 1e-300, _BINS + 1)
    place = np.clip(np.digitize(values, edges) - 1, 0, _BINS - 1)
    counts = np.bincount(place, minlength=_BINS)
    sums = np.bincount(place, weights=left, minlength=_BINS)
    means = np.divide(sums, counts, out=np.zeros(_BINS), where=counts > 0)
    total = float(np.mean((left - left.mean()) ** 2))
    between = float(np.mean((means[place] - left.mean()) ** 2))
    chance = _BINS / max(left.size, 1)
    explained = max(0.0, between / max(total, 1e-300) - chance)
    middles = 0.5 * (edges[1:] + edges[:-1])
    return explained, [
        [float(x), float(y)] for x, y, n in zip(middles, means, counts, strict=True) if n
    ]
