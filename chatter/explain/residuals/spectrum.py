"""At which frequencies a residual of milling lives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.formatting import to_digits
from chatter.explain.criteria import AT_NOISE
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.finding import Curve, Curves, Finding
from chatter.explain.residuals.natural_modes import natural_modes
from chatter.explain.residuals.residual import Residual
from chatter.explain.residuals.spindle_harmonics import SpindleHarmonics, Split
from dynamics.modal.modes import Mode

Array = NDArray[np.float64]

#: half widths of a mode on each side that count as near it, and lines at least
_NEAR, _NEAR_LINES = 3.0, 1.5
#: of a line: over the level beside it, and probability that noise makes one in a run
_OUTSTANDING, _SIGNIFICANCE = 10.0, 1e-3
#: lines that a line fills on each side
_FILLED = 2
#: standard deviations beyond which a class is reported, and the least share of it
_BEYOND, _LEAST_SHARE = 5.0, 0.05
#: relative spread over the runs below which lines follow a rule
_FOLLOWS, _CLEARLY = 0.08, 2.0
_FEWEST_RUNS = 4
#: frequencies of a picture, and of these how many make a band
_GRID, _BAND = 240, 9

CLASSES = (
    "harmonics of the tooth frequency",
    "other harmonics of the spindle",
    "near natural frequencies",
    "other lines",
    "broad",
)


class Shares(NamedTuple):
    """Squares beyond the noise by class, their scatter, and the lines of one run."""

    squares: Array
    scatter: Array
    lines: Array  # Hz, strongest first
    split: Split
    residual: ChannelResidual


def spectrum(residual: Residual) -> Finding:
    """Shares of the residual by frequency."""
    by_channel: dict[str, list[Shares]] = {channel: [] for channel in residual.channels}
    for run in residual.measurement.runs:
        parts = [part for part in residual.parts if part.run is run]
        if not parts:
            continue
        harmonics = SpindleHarmonics(parts[0])
        for part in parts:
            by_channel[part.channel].append(_shares(part, harmonics.split(part)))
    numbers, reported = {}, {}
    for channel, found in by_channel.items():
        squares = np.sum([one.squares for one in found], axis=0)
        scatter = np.sqrt(np.sum([one.scatter**2 for one in found], axis=0))
        everything = max(float(np.sum(np.maximum(squares, 0.0))), 1e-300)
        shares = np.maximum(squares, 0.0) / everything
        sure = (squares > _BEYOND * scatter) & (shares > _LEAST_SHARE)
        level = residual.over_noise(channel)
        rule = _rule(found) if sure[3] or sure[2] else None
        numbers[channel] = {
            "shares_beyond_noise": dict(zip(CLASSES, map(float, shares), strict=True)),
            "over_noise": level,
            "strongest_orders": _strongest_orders(found),
            "lines_Hz": {one.residual.run.name: [float(f) for f in one.lines[:3]] for one in found},
            "lines_follow": rule,
        }
        if level > AT_NOISE and sure.any():
            reported[channel] = (level, shares, sure, rule)
    levels = {channel: numbers[channel]["over_noise"] for channel in numbers}
    pooled = _pooled(max(reported or levels, key=levels.get), by_channel)
    description = "frequency"
    if reported:
        description = _sentence(reported, by_channel, numbers) + _strongest(pooled)
    return Finding("frequency", description, bool(reported), numbers, _panel(pooled))


def _shares(residual: ChannelResidual, split: Split) -> Shares:
    teeth = residual.case.tool.teeth
    tooth = split.orders % teeth == 0
    spacing = float(split.frequency[1])
    near = np.zeros(split.frequency.size, dtype=bool)
    for mode in natural_modes(residual.case):
        width = max(_NEAR * mode.damping * mode.frequency, _NEAR_LINES * spacing)
        near |= np.abs(split.frequency - mode.frequency) <= width
    lines, filled = _lines(split, near)
    rest = ~near & ~filled
    squares = np.array(
        [
            np.sum(split.at_orders[tooth] - 2.0),
            np.sum(split.at_orders[~tooth] - 2.0),
            2.0 * np.sum(split.density[near] - 1.0),
            2.0 * np.sum((split.density - split.beside)[filled]),
            2.0 * np.sum(split.density[rest] - 1.0) + 2.0 * np.sum(split.beside[filled] - 1.0),
        ]
    )
    # what harmonics take is missing between them
    taken = 2.0 * split.orders.size / split.samples
    squares[2:] += 2.0 * taken * np.array([near.sum(), 0, rest.sum() + filled.sum()])
    counts = np.array([2 * tooth.sum(), 2 * (~tooth).sum(), 2 * near.sum(), 0, 2 * rest.sum()])
    # beside a window of Hann lines are not independent
    scatter = np.sqrt(2.0 * np.maximum(counts, 1)) * np.array([1.0, 1.0, 1.4, 1.0, 1.4])
    return Shares(squares, scatter, lines, split, residual)


def _lines(split: Split, near: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
    """Frequencies of lines away from natural frequencies, and the samples that they fill."""
    density = split.density
    least = -math.log(_SIGNIFICANCE / density.size)
    level = np.maximum(_OUTSTANDING * split.beside, least)
    inner = np.zeros(density.size, dtype=bool)
    inner[1:-1] = (density[1:-1] > density[:-2]) & (density[1:-1] >= density[2:])
    found = np.flatnonzero(inner & (density > level) & ~near)
    found = found[np.argsort(density[found])[::-1]]
    filled = np.zeros(density.size, dtype=bool)
    for line in found:
        filled[max(0, line - _FILLED) : line + _FILLED + 1] = True
    return split.frequency[found], filled & ~near


def _strongest_orders(found: list[Shares]) -> list[int]:
    most = max(one.split.orders.size for one in found)
    total = np.zeros(most)
    for one in found:
        total[: one.split.orders.size] += one.split.at_orders - 2.0
    best = np.argsort(total)[::-1][:3]
    return [int(order) + 1 for order in best if total[order] > 0.0]


def _rule(found: list[Shares]) -> dict[str, float | str] | None:
    """What lines between the harmonics keep to from run to run."""
    frequency, offset, spindle, feed = [], [], [], []
    for one in found:
        if one.lines.size == 0:
            continue
        rotation = one.residual.case.cut.spindle_speed / (2.0 * math.pi)
        tooth = rotation * one.residual.case.tool.teeth
        strongest = one.lines[:4]
        frequency.append(float(strongest[0]))
        aside = np.abs(strongest - tooth * np.round(strongest / tooth))
        offset.append(float(np.median(aside)))
        spindle.append(rotation)
        feed.append(tooth * one.residual.case.cut.feed_per_tooth)
    if len(frequency) < _FEWEST_RUNS:
        return None
    trials = {
        "one frequency": (np.array(frequency), "Hz"),
        "order of the spindle": (np.array(frequency) / spindle, ""),
        "sidebands at one distance": (np.array(offset), "Hz"),
        "sidebands at a share of the spindle frequency": (np.array(offset) / spindle, ""),
        "sidebands in proportion to the feed speed": (np.array(feed) / offset, "m"),
    }
    spreads = {name: _spread(values) for name, (values, _) in trials.items()}
    order = sorted(spreads, key=spreads.get)
    best = order[0]
    if spreads[best] > _FOLLOWS or spreads[order[1]] < _CLEARLY * spreads[best]:
        return None
    values, unit = trials[best]
    return {"rule": best, "value": float(np.median(values)), "unit": unit, "runs": len(frequency)}


def _spread(values: Array) -> float:
    middle = float(np.median(values))
    return 1.4826 * float(np.median(np.abs(values - middle))) / max(abs(middle), 1e-300)


def _sentence(reported: dict, by_channel: dict[str, list[Shares]], numbers: dict) -> str:
    channel = max(reported, key=lambda name: reported[name][0])
    level, shares, sure, rule = reported[channel]
    parts = []
    for index in np.argsort(shares)[::-1]:
        if not sure[index]:
            continue
        words = f"{to_digits(100.0 * shares[index])} % {_AT[index]}"
        if index in (0, 1):
            orders = numbers[channel]["strongest_orders"]
            words += f" (strongest orders of the spindle: {', '.join(map(str, orders))})"
            if index == 1 and any("strongest" in part for part in parts):
                words = words.partition(" (")[0]
        if index == 3:
            first = next((one for one in by_channel[channel] if one.lines.size), None)
            if first is not None:
                words += f" (such as {first.lines[0]:.0f} Hz in {first.residual.run.name})"
        parts.append(words)
    text = (
        f"Of the residual of {channel} beyond the noise ({level:.3g} times the noise): "
        f"{', '.join(parts)}."
    )
    return text + (f" {_rule_in_words(rule)}" if rule else "")


_AT = (
    "at harmonics of the tooth frequency",
    "at the other harmonics of the spindle",
    "near natural frequencies of the case",
    "at lines that are none of these",
    "broad",
)


def _rule_in_words(rule: dict) -> str:
    value, runs = rule["value"], rule["runs"]
    sentences = {
        "one frequency": f"The lines lie at {value:.4g} Hz in {runs} runs, whatever the speed.",
        "order of the spindle": f"The lines lie at {value:.3f} times the spindle frequency "
        f"in {runs} runs.",
        "sidebands at one distance": f"They lie {value:.3g} Hz beside harmonics of the tooth "
        f"frequency in {runs} runs, whatever the speed.",
        "sidebands at a share of the spindle frequency": f"They lie {value:.3g} times the spindle "
        f"frequency beside harmonics of the tooth frequency in {runs} runs.",
        "sidebands in proportion to the feed speed": "They lie beside harmonics of the tooth "
        f"frequency at a distance in proportion to the feed speed in {runs} runs, as of something "
        f"that repeats every {1e3 * value:.3g} mm of feed.",
    }
    return sentences[rule["rule"]]


class _Pooled(NamedTuple):
    """Amplitude of a channel over its noise, root mean square over all runs."""

    channel: str
    frequency: Array
    whole: Array
    between: Array
    modes: Sequence[Mode]


def _pooled(channel: str, by_channel: dict[str, list[Shares]]) -> _Pooled:
    found = by_channel[channel]
    modes = natural_modes(found[0].residual.case)
    highest = min(float(one.split.frequency[-1]) for one in found)
    highest = min(highest, 4.0 * max((mode.frequency for mode in modes), default=math.inf))
    grid = np.linspace(highest / _GRID, highest, _GRID)
    whole, between = (
        np.sqrt(
            np.mean(
                [np.interp(grid, one.split.frequency, getattr(one.split, name)) for one in found],
                axis=0,
            )
        )
        for name in ("whole", "density")
    )
    return _Pooled(channel, grid, whole, between, modes)


def _strongest(pooled: _Pooled) -> str:
    """Where a band of frequencies stands out, in words."""
    squares = np.convolve(pooled.whole**2, np.ones(_BAND) / _BAND, mode="same")
    at = float(pooled.frequency[int(np.argmax(squares))])
    width = _BAND * float(pooled.frequency[1] - pooled.frequency[0])
    if not pooled.modes:
        return f" It is largest around {at:.0f} Hz; the tool of the case is rigid."
    nearest = min(pooled.modes, key=lambda mode: abs(mode.frequency - at))
    apart = abs(nearest.frequency - at)
    if apart <= max(width, _NEAR * nearest.damping * nearest.frequency):
        return f" It is largest around {at:.0f} Hz, by the natural frequency of a mode."
    return f" It is largest around {at:.0f} Hz, where the case has no natural frequency."


def _panel(pooled: _Pooled) -> Curves:
    return Curves(
        (
            Curve(pooled.frequency, pooled.whole, "everything"),
            Curve(pooled.frequency, pooled.between, "between the harmonics"),
        ),
        "frequency [Hz]",
        f"residual of {pooled.channel} over noise, all runs",
        {"natural frequency": tuple(mode.frequency for mode in pooled.modes)},
        floor=1.0,
        logarithmic="y",
    )
