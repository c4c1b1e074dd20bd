"""Limits of a cut whose arcs change with the depth: that of a tool with an inclined axis.

Methods lay a cut out once, for all depths up to the deepest, as an upright tool allows. Here every
depth has a cut of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.progress import no_progress
from chatter.stability.brackets import GrowthRate
from chatter.stability.crossings import find_crossings
from chatter.stability.limit_curve import LimitCurve, limits_at
from chatter.stability.shared_depths import SharedDepths
from cutting.edge_segments.segments import period_angle

if TYPE_CHECKING:
    from chatter.stability.stability_method import StabilityMethod, Sweep

#: depths of the grid that are evaluated, at the most
_MOST_DEPTHS = 40
#: limits are found when their bracket is this small, relative to the depth
_TOLERANCE = 2e-4
#: up to this many speeds limits are those of multipliers that have converged
_FEW_SPEEDS = 8
#: chatter frequencies at depths beside each other that differ by less are of one mode, relative
_ALIKE = 0.005
#: of the frequency of the period: a chatter frequency so close to a multiple of half of it is a
#: flip
_FLIP = 1e-3


def few_depths(depths: Array) -> Array:
    """Grid of depths thinned to what is evaluated, the deepest kept."""
    few = depths[:: -(-len(depths) // _MOST_DEPTHS)]
    return few if few[-1] == depths[-1] else np.append(few, depths[-1])


def limits_by_depth(method: StabilityMethod, sweep: Sweep) -> LimitCurve:
    """Limits by a method that gives the spectral radius, each depth with a cut of its own."""
    model, speeds, few, steps = sweep.model, sweep.speeds, few_depths(sweep.depths), sweep.steps
    columns = []
    for number, depth in enumerate(few):
        points = sweep._replace(depths=np.full(len(speeds), depth), progress=no_progress)
        columns.append(_growth(radius_by_depth(method, points)))
        sweep.progress(number + 1, len(few))

    def at_once(index: IntegerArray, at: Array) -> Array:
        points = sweep._replace(speeds=speeds[index], depths=at, progress=no_progress)
        return _growth(radius_by_depth(method, points))

    def converged(index: IntegerArray, at: Array) -> Array:
        found = [
            abs(method.multiplier(model.at_cut(float(speeds[i]), float(depth)), steps).value)
            for i, depth in zip(index, at, strict=True)
        ]
        return _growth(np.array(found))

    def at_depth(index: IntegerArray, depth: float) -> Array:
        return at_once(index, np.full(index.size, depth))

    def frequency(index: IntegerArray, at: Array) -> Array:
        points = sweep._replace(speeds=speeds[index], depths=at, progress=no_progress)
        return _by_depth(method.chatter_frequencies_of, points)

    grid = np.stack(columns, axis=1)
    shared = SharedDepths(grid, few, at_depth, at_once)
    refined = converged if len(speeds) <= _FEW_SPEEDS else shared

    def at_limits(index: IntegerArray, at: Array) -> tuple[list[str], Array]:
        if len(speeds) <= _FEW_SPEEDS:
            found = frequency(index, at)
        else:
            found = _interpolated(frequency, index, at, *shared.beside(at))
        return _kinds(found * period_angle(model.cutter) / speeds[index]), found

    crossings = find_crossings(grid, few, refined, _TOLERANCE)
    return limits_at(at_limits, speeds, crossings, np.zeros(len(speeds), dtype=np.int64))


def radius_by_depth(method: StabilityMethod, sweep: Sweep) -> Array:
    """Spectral radius at points, those of one depth together."""
    return _by_depth(method.radius_of, sweep)


def _by_depth(of_points: Callable[[Sweep], Array], sweep: Sweep) -> Array:
    """Values at points, those of one depth together."""
    found = np.empty(len(sweep.speeds))
    different, group = np.unique(sweep.depths, return_inverse=True)
    for number, depth in enumerate(different):
        own = np.flatnonzero(group == number)
        one = sweep._replace(
            speeds=sweep.speeds[own], depths=np.full(own.size, depth), progress=no_progress
        )
        found[own] = of_points(one)
        sweep.progress(number + 1, different.size)
    return found


def _interpolated(
    value: GrowthRate, index: IntegerArray, at: Array, low: Array, high: Array
) -> Array:
    """Values (k,) at depths between two each, on a line where those at the two are alike."""
    found = np.full(at.size, np.nan)
    inside = np.flatnonzero(np.isfinite(low))
    if inside.size:
        speeds = np.tile(index[inside], 2)
        ends = value(speeds, np.concatenate([low[inside], high[inside]]))
        below, above = ends.reshape(2, -1)
        share = (at - low)[inside] / (high - low)[inside]
        alike = np.abs(above - below) <= _ALIKE * below
        found[inside] = np.where(alike, below + share * (above - below), np.nan)
    rest = np.flatnonzero(np.isnan(found))
    if rest.size:
        found[rest] = value(index[rest], at[rest])
    return found


def _growth(radius: Array) -> Array:
    """Logarithm of the spectral radius."""
    return np.log(np.maximum(radius, 1e-13))


def _kinds(cycles: Array) -> list[str]:
    """Bifurcations by chatter frequencies in cycles of the period."""
    share = np.abs(cycles - np.floor(cycles) - 0.5)
    return ["flip" if one < _FLIP else "hopf" for one in share]
