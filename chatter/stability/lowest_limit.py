"""The lowest limit over a range of speeds: between samples as well."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.description.progress import Progress, no_progress
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limits_by_depth import few_depths
from chatter.stability.model import MillingModel
from chatter.stability.stability_method import StabilityMethod

#: method whose limits cost too little to count, so that more of them may be computed
_QUICK = "collocation"
#: lowest minima of the samples that are looked into, speeds between neighbours of each, and rounds
_MINIMA, _BETWEEN, _ROUNDS = 3, 9, 2


class LowestLimit(NamedTuple):
    """Lowest limit of a diagram; nan where no speed has one."""

    spindle_speed: float  # rad/s
    critical_depth: float  # m
    chatter_frequency: float  # Hz


def lowest_limit(
    method: StabilityMethod,
    model: MillingModel,
    curve: LimitCurve,
    depths: Array,
    progress: Progress = no_progress,
) -> LowestLimit:
    """Lowest limit over the speeds of a curve, refined between them where limits cost little.

    Depths (m,), m, ascending, are those on which limits are searched. About the lowest minima of
    the samples, limits at speeds between their neighbours are computed, and again about the lowest
    of these: what is left is a 1/64 of the spacing. None is looked for below the highest of these
    minima. `progress` is called with (done, total).
    """
    found = [_of(curve, index) for index in _minima(curve.critical_depth)]
    if not found:
        return LowestLimit(np.nan, np.nan, np.nan)
    if method.name != _QUICK or curve.spindle_speed.size < 2 or model.depends_on_speed:
        return found[0]
    spacing = float(np.diff(curve.spindle_speed).max())
    # on the same grid, so that the cuts of an inclined tool are those of the curve
    grid = few_depths(depths) if model.is_inclined else depths
    first, last = float(curve.spindle_speed[0]), float(curve.spindle_speed[-1])
    for number in range(_ROUNDS):
        speeds = np.unique(
            [
                np.clip(np.linspace(-spacing, spacing, _BETWEEN) + one.spindle_speed, first, last)
                for one in found
            ]
        )
        enough = grid[: 1 + int(np.searchsorted(grid, found[-1].critical_depth))]
        finer = method.limits(model, speeds, enough, None, _of_round(progress, number))
        found = sorted(
            [*found, *(_of(finer, index) for index in _minima(finer.critical_depth))],
            key=lambda one: one.critical_depth,
        )[:_MINIMA]
        spacing *= 2.0 / (_BETWEEN - 1)
    return found[0]


def _of_round(progress: Progress, number: int) -> Progress:
    """Progress of one of all rounds."""
    return lambda done, total: progress(number * total + done, _ROUNDS * total)


def _minima(depth: Array) -> list[int]:
    """Samples no higher than their neighbours, the lowest first, some at the most."""
    around = np.concatenate([[np.inf], depth, [np.inf]])
    low = np.isfinite(depth) & (depth <= around[:-2]) & (depth <= around[2:])
    return sorted(np.flatnonzero(low).tolist(), key=lambda index: depth[index])[:_MINIMA]


def _of(curve: LimitCurve, index: int) -> LowestLimit:
    return LowestLimit(
        float(curve.spindle_speed[index]),
        float(curve.critical_depth[index]),
        float(curve.chatter_frequency[index]),
    )
