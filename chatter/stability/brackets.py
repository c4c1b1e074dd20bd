"""The depth at which growth rate is zero, in brackets between two depths, all at once."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array, IntegerArray

#: growth rate at points: (indices of speeds, depths) -> (n,)
GrowthRate = Callable[[IntegerArray, Array], Array]

#: growth rate that is none
_GROWTH_TOLERANCE = 1e-9
#: a root is found when the growth rate left, over its slope, is this share of the tolerance
_ROOT_SHARE = 0.2
_MOST_ITERATIONS = 60
#: steps after which straight lines alone are trusted
_MOST_CURVED = 8
#: every so many steps keep off the ends, where one is far steeper than the other, by a share of the
#: bracket while curves are trusted, later by another
_KEEP_OFF, _SMALL_SHARE, _LARGE_SHARE = 3, 0.02, 0.5
#: a root is taken without another evaluation when it has moved by this share of the tolerance
_UNSEEN = 0.5


class Brackets(NamedTuple):
    """Between two depths of a speed stability changes."""

    speed: IntegerArray
    low: Array
    high: Array
    at_low: Array  # growth_rate
    at_high: Array
    beside: Array  # depths next to the two, nan where there is none (2, n)
    at_beside: Array  # (2, n)


def bracket(
    speed: IntegerArray, one: Array, at_one: Array, other: Array, at_other: Array
) -> Brackets:
    """Brackets between two depths in either order."""
    swap = other < one
    return Brackets(
        speed,
        np.where(swap, other, one),
        np.where(swap, one, other),
        np.where(swap, at_other, at_one),
        np.where(swap, at_one, at_other),
        np.full((2, one.size), np.nan),
        np.full((2, one.size), np.nan),
    )


class _Narrowing:
    """Brackets that get smaller with every depth that is evaluated."""

    def __init__(self, brackets: Brackets) -> None:
        self.low, self.high = brackets.low.copy(), brackets.high.copy()
        self.at_low, self.at_high = brackets.at_low.copy(), brackets.at_high.copy()
        # the Illinois method scales the value of an end down where it is stuck
        self.scaled_low, self.scaled_high = self.at_low.copy(), self.at_high.copy()
        self.last_side = np.zeros(self.low.size, dtype=np.int64)
        self.x = np.stack([self.low, self.high, *brackets.beside])
        self.y = np.stack([self.at_low, self.at_high, *brackets.at_beside])
        # roots by inverse interpolation through up to four points
        self.interpolated = _inverse_interpolation(self.x, self.y, self.low)

    def next_depth(self, k: IntegerArray, iteration: int) -> Array:
        """Next depth to evaluate in brackets k."""
        low, high, at_high = self.low[k], self.high[k], self.scaled_high[k]
        width = high - low
        straight = high - at_high * width / (at_high - self.scaled_low[k])
        # interpolation that does not close in gives way
        curving = iteration < _MOST_CURVED
        share = _SMALL_SHARE if curving else _LARGE_SHARE
        margin = (share if iteration % _KEEP_OFF == _KEEP_OFF - 1 else 0.0) * width
        curved = self.interpolated[k]
        inside = (curved > low + margin) & (curved < high - margin)
        return np.clip(np.where(inside & curving, curved, straight), low + margin, high - margin)

    def slope(self, k: IntegerArray, depth: Array, value: Array) -> Array:
        """Slope of the growth rate in brackets k, on the flatter side: a jump has none."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.fmin(
                np.abs(value - self.at_low[k]) / (depth - self.low[k]),
                np.abs(self.at_high[k] - value) / (self.high[k] - depth),
            )

    def take(self, k: IntegerArray, depth: Array, value: Array) -> None:
        """Make a depth within brackets k an end of theirs."""
        self.x[:, k], self.y[:, k] = _with_point(
            self.x[:, k], self.y[:, k], self.low[k], self.high[k], depth, value
        )
        upper = (value > 0.0) == (self.at_high[k] > 0.0)
        self.high[k[upper]], self.low[k[~upper]] = depth[upper], depth[~upper]
        for values in (self.scaled_high, self.at_high):
            values[k[upper]] = value[upper]
        for values in (self.scaled_low, self.at_low):
            values[k[~upper]] = value[~upper]
        side = np.where(upper, 1, -1)
        stuck = self.last_side[k] == side
        self.scaled_low[k[stuck & upper]] *= 0.5
        self.scaled_high[k[stuck & ~upper]] *= 0.5
        self.last_side[k] = side
        self.interpolated[k] = _inverse_interpolation(self.x[:, k], self.y[:, k], self.low[k])


def roots_in(brackets: Brackets, growth_rate: GrowthRate, tolerance: float) -> Array:
    """Root in each bracket by inverse interpolation through up to four points, all at once.

    Where that leaves the bracket, the Illinois method. Interpolation through a point that has just
    been evaluated is far closer to the root than that point: it is taken without it when it has
    moved by half a tolerance.

    The tolerance of a root is relative to its depth. Roots (n,) are in m; where the growth rate
    does not change its sign, the end at which it is closer to zero.
    """
    narrowing = _Narrowing(brackets)
    at_low, at_high = brackets.at_low, brackets.at_high
    root = np.where(np.abs(at_low) < np.abs(at_high), brackets.low, brackets.high)
    k = np.flatnonzero((at_low > 0.0) != (at_high > 0.0))
    for iteration in range(_MOST_ITERATIONS):
        if k.size == 0:
            break
        depth = narrowing.next_depth(k, iteration)
        value = growth_rate(brackets.speed[k], depth)
        close = tolerance * depth * narrowing.slope(k, depth, value)
        narrowing.take(k, depth, value)
        low, high = narrowing.low[k], narrowing.high[k]
        following = narrowing.interpolated[k]
        within = (following >= low) & (following <= high)
        root[k] = np.where(within, following, depth)
        left = np.abs(value)
        done = (left < _GROWTH_TOLERANCE) | (high - low <= tolerance * high)
        done |= left <= _ROOT_SHARE * close
        small = within & (left <= 2.0 * _UNSEEN * close)
        done |= small & (np.abs(following - depth) <= _UNSEEN * tolerance * depth)
        k = k[~done]
    return root


def _with_point(
    x: Array, y: Array, low: Array, high: Array, point: Array, value: Array
) -> tuple[Array, Array]:
    """Four points a column with a new one in the point of the furthest that is no end."""
    distance = np.abs(x - point)
    distance = np.where(np.isfinite(distance), distance, np.inf)
    distance = np.where((x == low) | (x == high), -1.0, distance)
    furthest = np.arange(4)[:, None] == np.argmax(distance, axis=0)
    return np.where(furthest, point, x), np.where(furthest, value, y)


def _inverse_interpolation(x: Array, y: Array, low: Array) -> Array:
    """Place (n,) at which the polynomial x(y) through up to four points has y = 0.

    Points (4, n) are nan where there is none. Above the point `low` (n,) y changes its sign. Beside
    it and the next, those points are taken towards which y goes on in the same sense: elsewhere x
    is no function of y.
    """
    order = np.argsort(np.where(np.isfinite(x), x, np.inf), axis=0)
    x, y = np.take_along_axis(x, order, axis=0), np.take_along_axis(y, order, axis=0)
    n = np.arange(x.shape[1])
    first = np.minimum(np.argmax(x == low, axis=0), 2)
    sense = np.sign(y[first + 1, n] - y[first, n])
    with np.errstate(invalid="ignore"):
        goes_on = sense * np.diff(y, axis=0) > 0.0
    point = np.arange(4)[:, None]
    kept = (point == first) | (point == first + 1)
    for step in (1, 2):
        for end, further in ((first + step, first + step + 1), (first + 1 - step, first - step)):
            there = (further >= 0) & (further <= 3)
            at, interval = np.clip(further, 0, 3), np.clip(np.minimum(end, further), 0, 2)
            kept[at, n] |= there & goes_on[interval, n] & kept[np.clip(end, 0, 3), n]
    result = np.zeros(x.shape[1])
    with np.errstate(invalid="ignore", divide="ignore"):
        for i in range(4):
            share = np.ones(x.shape[1])
            for j in range(4):
                if j != i:
                    share *= np.where(kept[i] & kept[j], y[j] / (y[j] - y[i]), 1.0)
            result += np.where(kept[i], x[i] * share, 0.0)
    return result
