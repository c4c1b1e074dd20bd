"""Growth rate between depths at which it is evaluated, for cuts that each depth has anew."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from chatter.description.arrays import Array, BooleanArray, IntegerArray
from chatter.stability.brackets import GrowthRate

#: depths that a step of the grid is divided by
_PARTS = 8
#: an interpolated growth rate counts where parabolas through neighbouring points differ by less
_AGREEMENT = 2e-4
#: growth rate (k,) of some speeds, by their index, at one depth (m)
AtDepth = Callable[[IntegerArray, float], Array]


class SharedDepths:
    """Growth rate of speeds at any depth, by cubics through depths that all speeds share.

    To lay out a cut takes longer than to solve it for many speeds: points are evaluated at depths
    of a lattice, those of one depth together, and between them interpolated. A depth within the
    lowest step, and one about which the growth rate bends sharply, has a cut of its own.

    Parameters
    ----------
    grid : (n, m) array of float
        Growth rate at n speeds and the depths of the grid.
    depths : (m,) array of float
        m, ascending, > 0.
    at_depth : callable
        Evaluates some of the speeds at one depth.
    at_points : callable
        Evaluates points, each at a depth of its own.
    """

    def __init__(
        self, grid: Array, depths: Array, at_depth: AtDepth, at_points: GrowthRate
    ) -> None:
        steps = np.arange(depths.size - 1)[:, None] + np.arange(_PARTS) / _PARTS
        lattice = np.interp(steps.ravel(), np.arange(depths.size), depths)
        self._depths = np.append(lattice, depths[-1])
        self._values = np.full((grid.shape[0], self._depths.size), np.nan)
        self._values[:, ::_PARTS] = grid
        self._at_depth, self._at_points = at_depth, at_points

    def __call__(self, speed: IntegerArray, depth: Array) -> Array:
        """Growth rate (k,) at points of speed (index) and depth, m."""
        found = np.empty(depth.size)
        own = ~self._is_within(depth)
        if not np.all(own):
            found[~own], agree = self._interpolated(speed[~own], depth[~own])
            own[~own] = ~agree
        if np.any(own):
            found[own] = self._at_points(speed[own], depth[own])
        return found

    def beside(self, depth: Array) -> tuple[Array, Array]:
        """Depths of the lattice, m, below and above depths (k,); nan for one that is off it."""
        cell = np.clip(np.searchsorted(self._depths, depth), 1, self._depths.size - 1)
        low, high = self._depths[cell - 1], self._depths[cell]
        within = self._is_within(depth)
        return np.where(within, low, np.nan), np.where(within, high, np.nan)

    def _is_within(self, depth: Array) -> BooleanArray:
        """Whether depths lie on the lattice, which takes four depths."""
        if self._depths.size < 4:
            return np.zeros(depth.size, dtype=bool)
        return (depth >= self._depths[0]) & (depth <= self._depths[-1])

    def _interpolated(self, speed: IntegerArray, depth: Array) -> tuple[Array, BooleanArray]:
        """Growth rate by cubics, and whether the parabolas that each is made of agree."""
        cell = np.searchsorted(self._depths, depth, side="right") - 1
        first = np.clip(cell - 1, 0, self._depths.size - 4)
        columns = first[:, None] + np.arange(4)
        self._evaluate(np.repeat(speed, 4), columns.ravel())
        x, y = self._depths[columns], self._values[speed[:, None], columns]
        low, high = (_parabola(x[:, k : k + 3], y[:, k : k + 3], depth) for k in (0, 1))
        share = (depth - x[:, 0]) / (x[:, 3] - x[:, 0])
        return low + share * (high - low), np.abs(high - low) <= _AGREEMENT

    def _evaluate(self, speed: IntegerArray, column: IntegerArray) -> None:
        """Fill in what is not known yet."""
        missing = np.isnan(self._values[speed, column])
        speed, column = speed[missing], column[missing]
        for one in np.unique(column):
            asked = np.unique(speed[column == one])
            self._values[asked, one] = self._at_depth(asked, float(self._depths[one]))


def _parabola(x: Array, y: Array, at: Array) -> Array:
    """Value (n,) at places of parabolas through three points (n, 3)."""
    first, second, third = (at - x[:, k] for k in range(3))
    a, b, c = x[:, 1] - x[:, 0], x[:, 2] - x[:, 1], x[:, 2] - x[:, 0]
    return (
        y[:, 0] * second * third / (a * c)
        - y[:, 1] * first * third / (a * b)
        + y[:, 2] * first * second / (b * c)
    )
