"""The lowest limit over a range of speeds: between samples as well."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.description.progress import Progress, no_progress
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limits_by_depth import few_depths
from chatter.stability.model import MillingModel
from chatter.stability.stability_method import StabilityMethod

#: lowest minima of the samples that are looked into, speeds between neighbours of each, and rounds
_MINIMA, _BETWEEN, _ROUNDS = 3, 9, 2


class LowestLimit(NamedTuple):
    """Lowest limit of a diagram; nan where no speed has one."""

    spindle_speed: float  # rad/s
    critical_depth: float  # m
    chatter_frequency: float  # Hz


_NONE = LowestLimit(np.nan, np.nan, np.nan)
#: limits at speeds, rad/s, up to a depth, m, in a round
LimitsBetween = Callable[[Array, float, int], "list[LowestLimit]"]


def is_between_speeds(method: StabilityMethod) -> bool:
    """Whether the lowest limit is looked for between speeds too: cuts in time cost too much."""
    return method.is_linear


def lowest_limit(
    method: StabilityMethod,
    model: MillingModel,
    curve: LimitCurve,
    depths: Array,
    progress: Progress = no_progress,
) -> LowestLimit:
    """Lowest limit over the speeds of a curve, and between them; of cuts in time at them alone.

    Depths (m,), m, ascending, are those on which limits are searched. About the lowest minima of
    the samples, limits at speeds between their neighbours are computed, and again about the lowest
    of these: what is left is a 1/64 of the spacing. None is looked for below the highest of these
    minima. `progress` is called with (done, total).
    """
    samples = [_of(curve, index) for index in range(curve.spindle_speed.size)]
    if not is_between_speeds(method):
        return next(iter(_lowest(samples)), _NONE)
    # on the same grid, so that the cuts of an inclined tool are those of the curve
    grid = few_depths(depths) if model.is_inclined else depths

    def between(speeds: Array, highest: float, number: int) -> list[LowestLimit]:
        enough = grid[: 1 + int(np.searchsorted(grid, highest))]
        finer = method.limits(model, speeds, enough, None, _of_round(progress, number))
        return [_of(finer, index) for index in range(finer.spindle_speed.size)]

    return lowest_between(samples, between)


def lowest_between(samples: Sequence[LowestLimit], between: LimitsBetween) -> LowestLimit:
    """Lowest limit of samples over rising speeds, and of speeds between them.

    `between` gives limits at speeds, rad/s, up to a depth, m, in a round. See `lowest_limit`.
    """
    found = _lowest(samples)
    if not found or len(samples) < 2:
        return found[0] if found else _NONE
    speeds = [one.spindle_speed for one in samples]
    spacing = float(np.diff(speeds).max())
    for number in range(_ROUNDS):
        tried = np.unique(
            [
                np.clip(
                    np.linspace(-spacing, spacing, _BETWEEN) + one.spindle_speed,
                    speeds[0],
                    speeds[-1],
                )
                for one in found
            ]
        )
        finer = _lowest(between(tried, found[-1].critical_depth, number))
        found = sorted([*found, *finer], key=_depth)[:_MINIMA]
        spacing *= 2.0 / (_BETWEEN - 1)
    return found[0]


def _of_round(progress: Progress, number: int) -> Progress:
    """Progress of one of all rounds."""
    return lambda done, total: progress(number * total + done, _ROUNDS * total)


def _lowest(samples: Sequence[LowestLimit]) -> list[LowestLimit]:
    """Samples no higher than their neighbours, the lowest first, some at the most."""
    depth = np.array([one.critical_depth for one in samples])
    around = np.concatenate([[np.inf], depth, [np.inf]])
    low = np.isfinite(depth) & (depth <= around[:-2]) & (depth <= around[2:])
    return sorted((samples[index] for index in np.flatnonzero(low)), key=_depth)[:_MINIMA]


def _depth(one: LowestLimit) -> float:
    return one.critical_depth


def _of(curve: LimitCurve, index: int) -> LowestLimit:
    return LowestLimit(
        float(curve.spindle_speed[index]),
        float(curve.critical_depth[index]),
        float(curve.chatter_frequency[index]),
    )
