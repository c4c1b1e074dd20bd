"""Residual by run and channel, against the noise."""

from __future__ import annotations

import numpy as np

from chatter.explain.residuals.finding import Bars, Finding
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
        Bars(tuple(map(_short, names)), series, "residual over noise", floor=1.0),
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
            f"{levels[channel]:.3g} times the noise in {channel} (most in {_short(most.run.name)}, "
            f"{most.over_noise:.3g} times)"
        )
    rest = [channel for channel in levels if channel not in above]
    quiet = f"; {', '.join(rest)} {'is' if len(rest) == 1 else 'are'} at the noise" if rest else ""
    return f"The residual is {'; '.join(parts)}{quiet}."


def _short(name: str) -> str:
    return name.rpartition(".")[0] or name
