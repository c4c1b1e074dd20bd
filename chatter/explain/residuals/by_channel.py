"""What is left by run and channel, against the noise."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from chatter.explain.residuals.finding import Bars, Finding
from chatter.explain.residuals.normalised_residual import Left, Residual

#: what is left over the noise up to which a channel is at its noise
AT_NOISE = 1.12


def over_noise(parts: tuple[Left, ...]) -> float:
    """Root mean square over that of the noise, of several runs."""
    return math.sqrt(float(np.mean([part.over_noise**2 for part in parts])))


def is_above(residual: Residual, channel: str) -> bool:
    """Whether a channel is above its noise; of noise nobody asks what it hangs on."""
    return over_noise(residual.of(channel)) > AT_NOISE


def above_noise(residual: Residual, channels: Sequence[str]) -> list[str]:
    """Those of some channels that are above their noise."""
    return [channel for channel in channels if is_above(residual, channel)]


def by_channel(residual: Residual) -> Finding:
    """How far every channel of every run is above its noise."""
    levels = {channel: over_noise(residual.of(channel)) for channel in residual.channels}
    above = {channel: level for channel, level in levels.items() if level > AT_NOISE}
    names = tuple(_short(run.name) for run in residual.measurement.runs)
    found = {(part.channel, part.run.name): part.over_noise for part in residual.parts}
    series = {
        channel: np.array(
            [found.get((channel, run.name), np.nan) for run in residual.measurement.runs]
        )
        for channel in residual.channels
    }
    return Finding(
        "run and channel",
        _sentence(residual, levels, above),
        bool(above),
        {
            "over_noise": levels,
            "by_run": {
                channel: {part.run.name: part.over_noise for part in residual.of(channel)}
                for channel in residual.channels
            },
        },
        Bars(names, series, "left over noise", floor=1.0),
    )


def _sentence(residual: Residual, levels: dict[str, float], above: dict[str, float]) -> str:
    if not above:
        told = ", ".join(f"{channel} {level:.2f}" for channel, level in levels.items())
        return f"What is left is noise in every channel (times the noise: {told})."
    parts = []
    for channel, level in sorted(above.items(), key=lambda item: -item[1]):
        most = max(residual.of(channel), key=lambda part: part.over_noise)
        parts.append(
            f"{level:.3g} times the noise in {channel} (most in {_short(most.run.name)}, "
            f"{most.over_noise:.3g} times)"
        )
    rest = [channel for channel in levels if channel not in above]
    quiet = f"; {', '.join(rest)} {'is' if len(rest) == 1 else 'are'} at the noise" if rest else ""
    return f"What is left is {'; '.join(parts)}{quiet}."


def _short(name: str) -> str:
    return name.rpartition(".")[0] or name
