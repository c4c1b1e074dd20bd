"""Limits of a diagram under a slider: those of the last one are corrected, not searched anew."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array, BooleanArray, IntegerArray
from chatter.description.progress import Progress
from chatter.engine.parallel import kept_threads
from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.brackets import GrowthRate
from chatter.stability.limit_curve import LimitCurve, limits_at
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import ElementCut, element_cut
from chatter.stability.methods.collocation.varying_speed import LOOSE_FIT, varies
from chatter.stability.model import MillingModel

#: points per element and wavelengths of the highest mode in one, enough for a picture
_POINTS, _WAVELENGTHS = 6, 1.0
#: of a limit, relative to its depth, and speeds from one to the next that are searched first
_TOLERANCE, _STRIDE = 5e-3, 8
#: calls after which all speeds and all depths of the grid have been looked at
_TURNS = 16
#: step of a limit, relative, that its slope is trusted for without another evaluation
_TRUSTED = 0.02
#: largest relative move of a limit in a step, and of all steps together
_LARGEST_STEP, _FURTHEST = 0.2, 0.5
_MOST_STEPS = 4
#: logarithm of the ratio of limits at neighbouring speeds from which depths between are looked at
_APART, _DEPTHS_BETWEEN = 0.25, 5
#: share of the speeds that are searched one by one before all are searched together
_MANY = 0.25


class _Boundary(NamedTuple):
    """Changes of stability (n,), ordered by speed and depth."""

    column: IntegerArray  # index of the speed
    depth: Array  # m
    slope: Array  # of the growth rate over the logarithm of the depth; nan where unknown

    def of(self, column: int) -> Array:
        """Depths at one speed."""
        first, last = np.searchsorted(self.column, [column, column + 1])
        return self.depth[first:last]

    def by_column(self, count: int) -> list[Array]:
        return [self.of(column) for column in range(count)]

    def without(self, columns: IntegerArray) -> _Boundary:
        """All but those of some speeds."""
        kept = ~np.isin(self.column, columns)
        return _Boundary(self.column[kept], self.depth[kept], self.slope[kept])

    def joined(self, other: _Boundary) -> _Boundary:
        parts = (np.concatenate(pair) for pair in zip(self, other, strict=True))
        column, depth, slope = parts
        order = np.lexsort((depth, column))
        return _Boundary(column[order], depth[order], slope[order])

    def changes_below(
        self, column: IntegerArray, depth: Array
    ) -> tuple[IntegerArray, BooleanArray]:
        """Number of changes (n,) above points of the diagram, and which points are close to one."""
        far = 2.0 * max(np.max(depth, initial=0.0), np.max(self.depth, initial=0.0)) + 1.0
        index = np.searchsorted(self.column + self.depth / far, column + depth / far)
        below = index - np.searchsorted(self.column, column)
        close = np.zeros(len(column), dtype=np.bool_)
        for k in (index - 1, index):
            there = (k >= 0) & (k < len(self.column))
            there[there] = self.column[k[there]] == column[there]
            share = np.abs(self.depth[k[there]] / depth[there] - 1.0)
            close[there] |= share < 2.0 * _TOLERANCE
        return below, close

    def lost(self) -> IntegerArray:
        """Speeds whose changes are out of order, or whose growth rate does not cross zero there."""
        first = np.searchsorted(self.column, self.column)
        rising = (np.arange(len(self.column)) - first) % 2 == 0
        wrong = ~(self.slope * np.where(rising, 1.0, -1.0) > 0.0) | ~np.isfinite(self.depth)
        wrong[1:] |= (np.diff(self.column) == 0) & ~(np.diff(self.depth) > 0.0)
        return np.unique(self.column[wrong])


class _Step:
    """Limits of one call: those before corrected, and then checked."""

    def __init__(self, cut: ElementCut, speeds: Array, depths: Array, before: _Boundary) -> None:
        self._cut, self._speeds, self._depths = cut, speeds, depths
        self._evaluated = collocation.evaluated_points(cut, speeds)
        self._growth_rate = collocation.growth_rate_of(cut, speeds)
        self._searched = np.empty(0, dtype=np.int64)
        moved, depth = _moved(before, self._evaluated.growth_rate, self._growth_rate)
        self._lost = moved.lost()
        inside = moved.depth <= depths[-1]
        self.boundary = _Boundary(*(part[inside] for part in moved))
        self._followed, self._followed_depth = self.boundary, depth[inside]

    def correct(self) -> bool:
        """Search the speeds that were lost; False where they are too many."""
        return self._search(self._lost)

    def check(self, rotating: IntegerArray, call: int) -> bool:
        """Look for changes of stability that were not there before; False where many are found.

        `rotating` are speeds at which the grid is looked at; the number of the call says which of
        every two points beside jumps of the limit.
        """
        depths, stride = self._depths, _STRIDE // 2
        wanted = _grid(rotating, depths[stride - 1 :: stride])
        while True:
            doubtful = _doubtful_points(self.boundary, len(self._speeds), float(depths[-1]))
            column, depth = (part[call % 2 :: 2] for part in doubtful)
            points = np.append(wanted[0], column), np.append(wanted[1], depth)
            contradicted = _contradicted(self.boundary, *points, self._growth_rate)
            found = np.setdiff1d(contradicted, self._searched)
            if found.size == 0:
                return True
            if not self._search(found):
                return False
            wanted = column[:0], depth[:0]

    def curve(self) -> LimitCurve:
        """Limits as they are known by now."""
        by_column = self.boundary.by_column(len(self._speeds))
        resolution = collocation.points_of_periods(self._cut, self._speeds, self._depths)
        return limits_at(self._at_limits, self._speeds, by_column, resolution)

    def _search(self, columns: IntegerArray) -> bool:
        self._searched = np.union1d(self._searched, columns)
        if self._searched.size > _MANY * len(self._speeds):
            return False
        if columns.size:
            found = _searched(columns, self._depths, self._growth_rate)
            self.boundary = self.boundary.without(columns).joined(found)
        return True

    def _at_limits(self, column: IntegerArray, depth: Array) -> tuple[list[str], Array]:
        """Next to a limit that was followed, at the depth that was evaluated."""
        followed = self._followed.column
        place = np.minimum(np.searchsorted(followed, column), max(len(followed) - 1, 0))
        known = ~np.isin(column, self._searched)
        near = self._followed_depth[place] if len(followed) else depth
        return self._evaluated.at_limits(column, np.where(known, near, depth))


class FollowedLimits:
    """Limits by collocation to 0.5 %, corrected from those of the call before.

    Each limit is corrected by Newton's method from the last one; where that does not lead to a
    change of stability, the speed is searched. The first call, and one with other speeds or depths,
    searches all. `check`, once the limits are drawn, looks at points between them and searches the
    speeds at which one is not as stable as the limits say: at some of the speeds, other ones each
    time, and at half the points beside which limits jump or end. An island that is not there yet
    may appear some calls late.
    """

    def __init__(self) -> None:
        self._speeds, self._depths = np.empty(0), np.empty(0)
        self._cut: ElementCut | None = None
        self._boundary: _Boundary | None = None
        self._step: _Step | None = None
        self._calls = 0

    def limits(
        self,
        model: MillingModel,
        speeds: Array,
        depths: Array,
        steps: int | None,  # noqa: ARG002  (the signature of a method)
        progress: Progress,
    ) -> LimitCurve:
        """Limits at speeds (n,), rad/s, searched on depths (m,), m, as `StabilityMethod.limits`."""
        cut = element_cut(model, float(depths[-1]), _POINTS, _WAVELENGTHS).with_fit(LOOSE_FIT)
        same = np.array_equal(speeds, self._speeds) and np.array_equal(depths, self._depths)
        self._cut, self._speeds, self._depths, self._step = cut, speeds, depths, None
        with kept_threads():
            if not same or self._boundary is None or varies(cut):
                return self._all_searched(progress)
            before, self._calls = self._boundary, self._calls + 1
            # beside a corner of the boundary a slope may be that of the lobe before
            before.slope[np.isin(before.column, self._rotating())] = np.nan
            step = _Step(cut, speeds, depths, before)
            progress(len(speeds) // 2, len(speeds))
            if not step.correct():
                return self._all_searched(progress)
            self._step, self._boundary = step, step.boundary
            progress(len(speeds), len(speeds))
            return step.curve()

    def check(self, progress: Progress) -> LimitCurve | None:
        """Limits with what the correction did not see; None where that is nothing."""
        step, self._step = self._step, None
        if step is None:
            return None
        with kept_threads():
            before = step.boundary
            if not step.check(self._rotating(), self._calls):
                return self._all_searched(progress)
            self._boundary = step.boundary
            return None if step.boundary is before else step.curve()

    def _rotating(self) -> IntegerArray:
        """Speeds that are looked at in this call."""
        return np.arange(self._calls % _TURNS, len(self._speeds), _TURNS)

    def _all_searched(self, progress: Progress) -> LimitCurve:
        curve = collocation.limit_curve(
            self._cut, self._speeds, self._depths, progress, _TOLERANCE, _STRIDE
        )
        self._boundary = _unknown_slopes(np.arange(len(self._speeds)), curve.crossings)
        return curve


def _unknown_slopes(columns: IntegerArray, crossings: tuple[Array, ...] | list[Array]) -> _Boundary:
    column = np.repeat(columns, [len(found) for found in crossings])
    depth = np.concatenate([*crossings, np.empty(0)])
    return _Boundary(column, depth, np.full(len(depth), np.nan))


def _moved(
    before: _Boundary, first: GrowthRate, growth_rate: GrowthRate
) -> tuple[_Boundary, Array]:
    """Changes of stability by Newton's method, and the depths (n,) that were evaluated last.

    Where it fails the slope is nan. `first` is the growth rate that is remembered.
    """
    column, depth, slope = (part.copy() for part in before)
    value = first(column, depth)
    unknown = np.flatnonzero(~np.isfinite(slope))
    near = (1.0 + _TRUSTED) * depth[unknown]
    slope[unknown] = (growth_rate(column[unknown], near) - value[unknown]) / math.log1p(_TRUSTED)
    for _ in range(_MOST_STEPS):
        step = _step(value, slope)
        k = np.flatnonzero((np.abs(step) > _TRUSTED) & np.isfinite(slope))
        if k.size == 0:
            break
        new_depth = depth[k] * np.exp(step[k])
        new_value = first(column[k], new_depth)
        slope[k] = (new_value - value[k]) / step[k]
        depth[k], value[k] = new_depth, new_value
        far = np.abs(np.log(depth / before.depth)) > _FURTHEST
        slope[far] = np.nan
    step = _step(value, slope)
    slope[np.abs(step) > _TRUSTED] = np.nan
    return _Boundary(column, depth * np.exp(step), slope), depth


def _step(value: Array, slope: Array) -> Array:
    """Newton's step in the logarithm of the depth."""
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.clip(-value / slope, -_LARGEST_STEP, _LARGEST_STEP)
    return np.where(np.isfinite(step), step, 0.0)


def _grid(columns: IntegerArray, depths: Array) -> tuple[IntegerArray, Array]:
    return np.repeat(columns, len(depths)), np.tile(depths, len(columns))


def _doubtful_points(boundary: _Boundary, count: int, deepest: float) -> tuple[IntegerArray, Array]:
    """Points at which changes of stability enter a speed: from the next speed, or from below.

    The deepest point where it is stable; where the first limits of two neighbours are far apart,
    depths between them at the speed of the higher one, into which a lobe spreads from the other;
    where one has more limits, depths between them at the other.
    """
    first = np.full(count, deepest)
    column, place = np.unique(boundary.column, return_index=True)
    first[column] = boundary.depth[place]
    many = np.bincount(boundary.column, minlength=count)
    stable = np.flatnonzero(many % 2 == 0)
    left = np.flatnonzero(np.abs(np.diff(np.log(first))) > _APART)
    higher = np.where(first[left] > first[left + 1], left, left + 1)
    between = np.geomspace(first[left], first[left + 1], _DEPTHS_BETWEEN + 2, axis=1)[:, 1:-1]
    points = [
        (stable, np.full(len(stable), deepest)),
        (np.repeat(higher, _DEPTHS_BETWEEN), between.ravel()),
    ]
    for one in np.flatnonzero(np.diff(many) != 0).tolist():
        for here, neighbour in ((one, one + 1), (one + 1, one)):
            edges = np.array([0.0, *boundary.of(neighbour), deepest])
            points.append((np.full(len(edges) - 1, here), 0.5 * (edges[1:] + edges[:-1])))
    columns, depths = zip(*points, strict=True)
    return np.concatenate(columns), np.concatenate(depths)


def _contradicted(
    boundary: _Boundary, column: IntegerArray, depth: Array, growth_rate: GrowthRate
) -> IntegerArray:
    """Speeds at which a point is not as stable as the limits say."""
    below, close = boundary.changes_below(column, depth)
    column, depth, below = column[~close], depth[~close], below[~close]
    unstable = growth_rate(column, depth) > 0.0
    return np.unique(column[unstable != (below % 2 == 1)])


def _searched(columns: IntegerArray, depths: Array, growth_rate: GrowthRate) -> _Boundary:
    """Changes of stability at some of the speeds, with no knowledge of any before."""

    def here(index: IntegerArray, depth: Array) -> Array:
        return growth_rate(columns[index], depth)

    return _unknown_slopes(columns, continued_crossings(len(columns), depths, here, _TOLERANCE, 1))
