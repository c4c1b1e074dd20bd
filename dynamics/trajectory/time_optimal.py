"""Time-optimal motion along blocks within the limits of every axis: velocity, acceleration, jerk.

With b = v^2 over the length s of a path q(s), the acceleration of an axis q' b'/2 + q'' b is linear
in b; its jerk is the change of that over s times sqrt(b) (Verscheure et al. 2009, "Time-optimal
path tracking for robots: a convex optimization approach"; with jerk Van Loock, Pipeleers and
Swevers 2015). 1 / sqrt(b) is replaced by its tangent at the solution before, which is below it, so
that every solution keeps the limits: linear programs, until the time is that of the one before.
What stops is planned by parts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.block_motion import Block, BlockMotion, PathLimits, passed
from dynamics.trajectory.motion import Motion, TrajectoryError
from dynamics.trajectory.spatial_path import SpatialPath

Array = NDArray[np.float64]
#: points of a part: on every element at the least, over all, and at the most
_POINTS_AN_ELEMENT, _POINTS, _MOST_POINTS = 16, 2500, 20_000
#: linear programs at the most, and gain of time below which the last one stands
_MOST_PROGRAMS, _NO_GAIN = 25, 1e-4
#: smallest v^2 about which 1 / sqrt(b) is replaced by its tangent, as a share of the largest
_SMALLEST = 1e-10
#: instants of the motion that the first solution is read from
_INSTANTS = 20_001
#: v^2 / (2 s) of a motion from rest at the jerk j, over (s j^2)^(1/3)
_FROM_REST = 6.0 ** (4.0 / 3.0) / 8.0


class _Part(NamedTuple):
    """Motion from rest to rest over a part of the path."""

    time: Array  # from the start of the part, s, (n,)
    length: Array  # on the part, m, (n,)
    dwell: float  # behind it, s


@dataclass(frozen=True)
class TimeOptimalMotion:
    """Fastest motion along blocks in three coordinates, from rest to rest.

    The limits are those of each axis; feeds of blocks are kept as well. Between the points of the
    solution the length covered is a cubic spline over time. TrajectoryError if blocks do not join,
    or no solution is found.
    """

    blocks: tuple[Block, ...]
    limits: PathLimits
    path: SpatialPath = field(init=False, repr=False)
    duration: float = field(init=False)  # s
    begins: tuple[float, ...] = field(init=False, repr=False)  # time of every block, s
    #: time and length at which each part begins, and its length over time
    _parts: tuple[tuple[float, float, scipy.interpolate.CubicSpline], ...] = field(
        init=False, repr=False
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "blocks", tuple(self.blocks))
        if not self.blocks:
            raise TrajectoryError("time-optimal motion: nothing moves")
        path = SpatialPath(tuple(one.element for one in self.blocks))
        parts, begins = [], []
        begin, covered = 0.0, 0.0
        for blocks in _between_stops(self.blocks):
            part = _planned(blocks, self.limits)
            spline = scipy.interpolate.CubicSpline(part.time, part.length, bc_type="clamped")
            parts.append((begin, covered, spline))
            breaks = np.cumsum([0.0, *(one.element.length for one in blocks[:-1])])
            begins += (begin + np.interp(breaks, part.length, part.time)).tolist()
            begin += float(part.time[-1]) + part.dwell
            covered += float(part.length[-1])
        object.__setattr__(self, "path", path)
        object.__setattr__(self, "duration", begin)
        object.__setattr__(self, "begins", tuple(begins))
        object.__setattr__(self, "_parts", tuple(parts))

    def along(self, time: ArrayLike) -> tuple[Array, Array, Array]:
        """Return length covered, m, speed, m/s, and tangential acceleration at times, s."""
        given = np.asarray(time, dtype=np.float64)
        starts = np.array([begin for begin, _, _ in self._parts])
        which = np.clip(np.searchsorted(starts, given, "right") - 1, 0, len(starts) - 1)
        # arrays of one time too: rows of one array would be numbers, which hold no values
        covered, speed, gain = (np.zeros(given.shape) for _ in range(3))
        for number in np.unique(which):
            begin, before, spline = self._parts[number]
            here = which == number
            last = float(spline.x[-1])
            t = np.clip(given[here] - begin, 0.0, last)
            moving = (given[here] > begin) & (given[here] < begin + last)
            covered[here] = before + spline(t)
            speed[here] = np.where(moving, spline(t, 1), 0.0)
            gain[here] = np.where(moving, spline(t, 2), 0.0)
        return covered, speed, gain

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of the coordinates at times, s."""
        covered, speed, gain = self.along(time)
        place = self.path.at(covered)
        return Motion(
            place.position,
            speed[..., None] * place.tangent,
            gain[..., None] * place.tangent + (speed**2)[..., None] * place.bend,
        )


def _between_stops(blocks: Sequence[Block]) -> list[list[Block]]:
    """Blocks in groups that are run through without a stop."""
    groups = [[blocks[0]]]
    for one, two in pairwise(blocks):
        if passed(one, two):
            groups[-1].append(two)
        else:
            groups.append([two])
    return groups


class _Grid(NamedTuple):
    """Path at points, and matrices from v^2 there to what is limited."""

    length: Array  # m, (n,)
    fastest: Array  # largest v^2, (n,)
    acceleration: scipy.sparse.csr_matrix  # of three axes between the points, (3 (n - 1), n)
    jerk: scipy.sparse.csr_matrix  # of three axes at the inner points, over v, (3 (n - 2), n)


def _planned(blocks: Sequence[Block], limits: PathLimits) -> _Part:
    slower = BlockMotion(tuple(blocks), limits)
    grid = _grid(blocks, slower.path, limits)
    time = np.linspace(0.0, slower.duration, _INSTANTS)
    covered, speed, _ = slower.along(time)
    squares = np.interp(grid.length, covered, speed) ** 2
    best = math.inf
    for _ in range(_MOST_PROGRAMS):
        found = _faster(grid, squares, limits)
        needed = float(_times(grid.length, found)[-1])
        if needed < best:
            best, kept = needed, found
        if needed > (1.0 - _NO_GAIN) * best and needed != best:
            break
        squares = found
    return _Part(_times(grid.length, kept), grid.length, blocks[-1].dwell)


def _grid(blocks: Sequence[Block], path: SpatialPath, limits: PathLimits) -> _Grid:
    counts = [
        max(_POINTS_AN_ELEMENT, round(_POINTS * one.element.length / path.length)) for one in blocks
    ]
    if sum(counts) > _MOST_POINTS:
        raise TrajectoryError(
            f"time-optimal motion: {len(blocks)} blocks without a stop need more than "
            f"{_MOST_POINTS} points; plan them by blocks"
        )
    s = np.concatenate(
        [[0.0]]
        + [
            begin + one.element.length * _spread(count, number == 0, number == len(blocks) - 1)
            for number, (begin, one, count) in enumerate(
                zip(path.breaks[:-1], blocks, counts, strict=True)
            )
        ]
    )
    feeds = np.concatenate(
        [np.full(count, one.feed) for one, count in zip(blocks, counts, strict=True)]
    )
    tangent = np.abs(path.at(s).tangent)
    fastest = (limits.velocity / np.maximum(tangent.max(axis=1), 1e-12)) ** 2
    # a point between two blocks keeps both feeds
    fastest[1:] = np.minimum(fastest[1:], feeds**2)
    fastest[:-1] = np.minimum(fastest[:-1], feeds**2)
    fastest[[0, -1]] = 0.0
    step, middle = np.diff(s), 0.5 * (s[1:] + s[:-1])
    count, place = len(s), path.at(middle)
    slope = scipy.sparse.diags([-0.5 / step, 0.5 / step], [0, 1], shape=(count - 1, count))
    mean = scipy.sparse.diags([np.full(count - 1, 0.5)] * 2, [0, 1], shape=(count - 1, count))
    change = scipy.sparse.diags(
        [-1.0 / np.diff(middle), 1.0 / np.diff(middle)], [0, 1], shape=(count - 2, count - 1)
    )
    axes = [
        scipy.sparse.diags(place.tangent[:, axis]) @ slope
        + scipy.sparse.diags(place.bend[:, axis]) @ mean
        for axis in range(3)
    ]
    return _Grid(
        s,
        fastest,
        scipy.sparse.vstack(axes).tocsr(),
        scipy.sparse.vstack([change @ one for one in axes]).tocsr(),
    )


def _spread(count: int, from_rest: bool, to_rest: bool) -> Array:
    """Shares (n,) of an element at which points are; closer where the motion is at rest."""
    u = np.arange(1, count + 1) / count
    if not (from_rest or to_rest):
        return u
    low, high = 0.0 if from_rest else 0.5, 1.0 if to_rest else 0.5
    u = low + (high - low) * u
    smooth, ends = u**2 * (3.0 - 2.0 * u), np.array([low, high])
    first, last = ends**2 * (3.0 - 2.0 * ends)
    return (smooth - first) / (last - first)


def _faster(grid: _Grid, squares: Array, limits: PathLimits) -> Array:
    """Solve for v^2 (n,) about a solution before; unknown is its ratio to that."""
    step, count = np.diff(grid.length), len(squares)
    about = np.maximum(squares[1:-1], _SMALLEST * squares.max())
    ratio = np.concatenate([[1.0], about, [1.0]])
    # jerk / v <= j / sqrt(b), by the tangent of it
    speeds = scipy.sparse.diags(np.tile(np.sqrt(about), 3))
    jerk = speeds @ grid.jerk @ scipy.sparse.diags(ratio)
    inner = scipy.sparse.diags(
        [np.full(count - 2, 0.5 * limits.jerk)], [1], shape=(count - 2, count)
    )
    tangent = scipy.sparse.vstack([inner] * 3)
    most = np.full(3 * (count - 2), 1.5 * limits.jerk)
    # from rest at constant jerk: v^2 at the end of the first step over twice its length
    accelerations = np.full(count - 1, limits.acceleration)
    for end in (0, -1):
        from_rest = _FROM_REST * (step[end] * limits.jerk**2) ** (1.0 / 3.0)
        accelerations[end] = min(accelerations[end], from_rest)
    accelerations = np.tile(accelerations, 3)
    acceleration = grid.acceleration @ scipy.sparse.diags(ratio)
    weights = np.zeros(count)
    weights[1:-1] = -0.5 * (step[1:] + step[:-1]) / np.sqrt(about)
    solved = scipy.optimize.linprog(
        weights,
        A_ub=scipy.sparse.vstack(
            [acceleration, -acceleration, tangent + jerk, tangent - jerk]
        ).tocsr(),
        b_ub=np.concatenate([accelerations, accelerations, most, most]),
        bounds=np.column_stack([np.zeros(count), grid.fastest / ratio]),
        method="highs",
    )
    if solved.status != 0:
        raise TrajectoryError(f"time-optimal motion: no solution is found: {solved.message}")
    found = np.clip(ratio * solved.x, 0.0, grid.fastest)
    found[1:-1] = np.maximum(found[1:-1], _SMALLEST * found.max())
    return found


def _times(length: Array, squares: Array) -> Array:
    """Times (n,) at which points are passed, s, at constant acceleration in between."""
    speeds = np.sqrt(squares)
    return np.concatenate([[0.0], np.cumsum(2.0 * np.diff(length) / (speeds[1:] + speeds[:-1]))])
