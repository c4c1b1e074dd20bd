"""At which lines, conditions and directions FRFs are off, against their scatter."""

import math

import numpy as np
from numpy.typing import NDArray

from chatter.explain.criteria import AT_NOISE
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.finding import Bars, Curve, Curves, Finding
from chatter.explain.residuals.natural_modes import natural_modes
from chatter.explain.residuals.residual import Residual, over_noise

Array = NDArray[np.float64]
Group = tuple[str, str]

#: lines over which the residual is averaged
_SMOOTHED = 9
_NEAR = 3.0


def _groups(residual: Residual) -> dict[Group, list[ChannelResidual]]:
    found: dict[Group, list[ChannelResidual]] = {}
    for part in residual.parts:
        found.setdefault((part.run.condition or "measured", part.run.direction), []).append(part)
    return found


def by_condition(residual: Residual) -> Finding:
    """How far FRFs are above their scatter, by condition and direction."""
    levels = {group: over_noise(parts) for group, parts in _groups(residual).items()}
    conditions = tuple(dict.fromkeys(condition for condition, _ in levels))
    directions = tuple(dict.fromkeys(direction for _, direction in levels))
    above = {group: level for group, level in levels.items() if level > AT_NOISE}
    series = {
        direction: np.array([levels.get((condition, direction), 0.0) for condition in conditions])
        for direction in directions
    }
    listed = "; ".join(
        f"{level:.3g} times the scatter {condition.replace('_', ' ')} in {direction}"
        for (condition, direction), level in sorted(above.items(), key=lambda item: -item[1])
    )
    quiet = [f"{c.replace('_', ' ')} in {d}" for c, d in levels if (c, d) not in above]
    description = (
        f"The residual is {listed}" + (f"; {', '.join(quiet)}: scatter alone." if quiet else ".")
        if above
        else f"The residual is scatter in every condition ({', '.join(quiet)})."
    )
    numbers = {"over_noise": {f"{c} {d}": level for (c, d), level in levels.items()}}
    panel = Bars(
        tuple(c.replace("_", " ") for c in conditions), series, "residual over scatter", floor=1.0
    )
    return Finding("condition and direction", description, bool(above), numbers, panel)


def over_lines(residual: Residual) -> Finding:
    """Where over the frequency FRFs are above their scatter."""
    curves, listed, numbers = [], [], {}
    modes = natural_modes(residual.case)
    for (condition, direction), parts in _groups(residual).items():
        frequency = parts[0].run.signals["frequency"]
        alike = [p for p in parts if p.normalised.size == frequency.size]
        squares = np.mean([part.normalised**2 for part in alike], axis=0)
        smooth = np.sqrt(np.convolve(squares, np.ones(_SMOOTHED) / _SMOOTHED, mode="same"))
        name = f"{condition.replace('_', ' ')}, {direction}"
        curves.append(Curve(frequency, smooth, name))
        most = int(np.argmax(smooth))
        at = float(frequency[most])
        nearest = min(modes, key=lambda mode: abs(mode.frequency - at), default=None)
        near = nearest is not None and abs(nearest.frequency - at) < max(
            _NEAR * nearest.damping * nearest.frequency, 3.0 * float(np.diff(frequency).min())
        )
        # four degrees of freedom a line and repetition, smoothed
        least = 1.0 + 5.0 / math.sqrt(_SMOOTHED * 2.0 * len(alike))
        numbers[name] = {"largest_at_Hz": at, "over_noise_there": float(smooth[most])}
        if over_noise(parts) > AT_NOISE and smooth[most] > least:
            beside = (
                f"near the natural frequency {nearest.frequency:.4g} Hz of the case"
                if near
                else "near no natural frequency of the case"
            )
            listed.append(f"{name}: most at {at:.4g} Hz ({smooth[most]:.3g} times), {beside}")
    description = f"Over the frequency, {'; '.join(listed)}." if listed else "frequency"
    panel = Curves(
        tuple(curves),
        "frequency [Hz]",
        "residual over scatter",
        {"natural frequency": tuple(mode.frequency for mode in modes)},
        floor=1.0,
        logarithmic="y",
    )
    return Finding("frequency", description, bool(listed), numbers, panel)
