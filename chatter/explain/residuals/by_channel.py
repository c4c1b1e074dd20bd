"""Residual by run and channel against the noise, and whether it changes within a run."""

import math
import re

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.finding import Bars, Curve, Curves, Finding
from chatter.explain.residuals.residual import Residual


def by_channel(residual: Residual) -> Finding:
    """How far every channel of every run is above its noise."""
    levels = {channel: residual.over_noise(channel) for channel in residual.channels}
    runs = {
        channel: {part.run.name: part.over_noise for part in residual.of(channel)}
        for channel in residual.channels
    }
    names = [run.name for run in residual.measurement.runs]
    series = {
        channel: np.array([found.get(name, np.nan) for name in names])
        for channel, found in runs.items()
    }
    return Finding(
        "run and channel",
        _sentence(residual, levels),
        bool(residual.above_noise),
        {"over_noise": levels, "by_run": runs},
        Bars(tuple(map(short_name, names)), series, "residual over noise", floor=1.0),
    )


def _sentence(residual: Residual, levels: dict[str, float]) -> str:
    above = residual.above_noise
    if not above:
        listed = ", ".join(f"{channel} {level:.2f}" for channel, level in levels.items())
        return f"The residual is noise in every channel (times the noise: {listed})."
    parts = []
    for channel in sorted(above, key=lambda name: -levels[name]):
        most = max(residual.of(channel), key=lambda part: part.over_noise)
        parts.append(
            f"{levels[channel]:.3g} times the noise in {channel} "
            f"(most in {short_name(most.run.name)}, {most.over_noise:.3g} times)"
        )
    rest = [channel for channel in levels if channel not in above]
    quiet = f"; {', '.join(rest)} {'is' if len(rest) == 1 else 'are'} at the noise" if rest else ""
    return f"The residual is {'; '.join(parts)}{quiet}."


def short_name(name: str) -> str:
    """Name of a run without its extension, "move01, part 3" of "move01.csv, part 3 of 12"."""
    return re.sub(r"\.\w+(?=,|$)| of \d+$", "", name)


_SEGMENTS = 12
#: factor in size that counts, and significance level, all channels together
_FACTOR, _SIGNIFICANCE = 1.25, 2e-3
_FEWEST_RUNS = 4


def over_time(residual: Residual) -> Finding:
    """Size of the residual from the start of a run to its end, over the noise."""
    curves, listed, numbers = [], [], {}
    for channel in residual.channels:
        parts = residual.of(channel)
        sizes = np.array([_sizes(part) for part in parts])
        curves.append(
            Curve(
                (np.arange(_SEGMENTS) + 0.5) / _SEGMENTS, np.sqrt(np.mean(sizes, axis=0)), channel
            )
        )
        factor, p_value = _end_over_start(sizes)
        numbers[channel] = {"end_over_start": factor, "p_value": p_value}
        big = max(factor, 1.0 / factor) > _FACTOR
        if (
            big
            and residual.is_above_noise(channel)
            and p_value < _SIGNIFICANCE / len(residual.channels)
        ):
            listed.append(
                f"{channel} is {max(factor, 1.0 / factor):.2g} times as large in the "
                f"{'last' if factor > 1.0 else 'first'} third of a run"
            )
    description = (
        f"The residual does not stay the same within a run: {'; '.join(listed)}."
        if listed
        else "the time within a run"
    )
    panel = Curves(tuple(curves), "share of the run", "residual over noise", floor=1.0)
    return Finding("time", description, bool(listed), numbers, panel)


def _sizes(part: ChannelResidual) -> NDArray[np.float64]:
    return np.array([np.mean(cut**2) for cut in np.array_split(part.normalised, _SEGMENTS)])


def _end_over_start(sizes: NDArray[np.float64]) -> tuple[float, float]:
    """Size of the last third over that of the first, and how likely chance gives as much."""
    third = _SEGMENTS // 3
    change = 0.5 * (
        np.log(np.mean(sizes[:, -third:], axis=1)) - np.log(np.mean(sizes[:, :third], axis=1))
    )
    factor = math.exp(float(np.mean(change)))
    if len(change) < _FEWEST_RUNS or np.ptp(change) == 0.0:
        return factor, 1.0
    return factor, float(scipy.stats.ttest_1samp(change, 0.0).pvalue)
