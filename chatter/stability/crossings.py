"""Where stability is lost or regained along depth: net, then refinement of every bracket at once.

A stretch that fits between two depths of the net is not passed over where the growth beside it
nearly reaches zero: the top of such a peak, or the floor of such a valley, is looked for.

The search knows nothing of the method: it asks for the growth (logarithm of the spectral radius)
at batches of points, which the sweep spreads over the threads.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: growth at points: (indices of speeds, depths) -> (n,)
Growth = Callable[[NDArray[np.int64], NDArray[np.float64]], NDArray[np.float64]]

#: a limit is found when its bracket is this small, relative to the depth
_DEPTH_TOLERANCE = 1e-7
_GROWTH_TOLERANCE = 1e-9
#: or when the growth left, over its slope, is this share of the tolerance
_ROOT_SHARE = 0.2
_MOST_ITERATIONS = 60
#: steps after which straight lines alone are trusted
_MOST_CURVED = 8
#: a root is taken without another look when it has moved by this share of the tolerance
_UNSEEN = 0.5
#: growth on the net may be off by this much
_DOUBTFUL_GROWTH = 0.05
#: a peak may rise above the net by this share of its height over the depths beside it
_PEAK_REACH = 1.5
_PEAK_STEPS = 4


def growth_on_net(
    speed_count: int, depths: NDArray[np.float64], plain: Growth, refined: Growth
) -> NDArray[np.float64]:
    """Growth (speeds, depths) on the net, refined where its sign matters and is in doubt."""
    speed, depth = (
        part.ravel() for part in np.meshgrid(np.arange(speed_count), depths, indexing="ij")
    )
    growth = plain(speed, depth).reshape(speed_count, depths.size)
    settled = np.zeros(growth.shape, dtype=bool)
    # a refined value may change its sign and so put its neighbour in doubt
    while refined is not plain:
        row, column = np.nonzero(_in_doubt(growth) & ~settled)
        if row.size == 0:
            break
        growth[row, column] = refined(row, depths[column])
        settled[row, column] = True
    return growth


def _in_doubt(growth: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Points beside a change of sign, and peaks and valleys that nearly reach zero."""
    before = np.concatenate([np.full((growth.shape[0], 1), -1e-12), growth[:, :-1]], axis=1)
    after = np.concatenate([growth[:, 1:], growth[:, -1:]], axis=1)
    changes = ((before > 0.0) != (growth > 0.0)) | ((after > 0.0) != (growth > 0.0))
    near = np.abs(growth) < _DOUBTFUL_GROWTH
    peak = (growth <= 0.0) & (growth >= before) & (growth >= after)
    valley = (growth > 0.0) & (growth <= before) & (growth <= after)
    return changes | (near & (peak | valley))


class _Brackets(NamedTuple):
    """Between two depths of a speed stability changes."""

    speed: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    at_low: NDArray[np.float64]  # growth
    at_high: NDArray[np.float64]
    beside: NDArray[np.float64]  # depths next to the two, nan where there is none (2, n)
    at_beside: NDArray[np.float64]  # (2, n)


def find_crossings(
    net: NDArray[np.float64],
    depths: NDArray[np.float64],
    growth: Growth,
    tolerance: float = _DEPTH_TOLERANCE,
    looked_at: NDArray[np.bool_] | None = None,
    refined: Growth | None = None,
) -> list[NDArray[np.float64]]:
    """Depths of all changes of stability at each speed.

    Parameters
    ----------
    net : (n, m) array of float
        Growth at n speeds and m depths.
    depths : (m,) array of float
        m, ascending, > 0. At zero depth the damped structure is stable.
    growth : callable
        Where a peak may be hidden, and at the end of a bracket.
    tolerance : float
        Of a limit, relative to its depth.
    looked_at : (n, m) array of bool, optional
        Where the growth of the net has the right sign alone, it is False; beside changes it is not.
    refined : callable, optional
        Growth for the refinement of brackets; `growth` by default.

    Returns
    -------
    list of n arrays
        m, ascending; stability is lost at even places and regained at odd ones.
    """
    edges = np.concatenate([[0.0], depths])
    at_zero = np.full((net.shape[0], 1), -np.inf)
    values = np.concatenate([at_zero, net], axis=1)
    seen = values if looked_at is None else values.copy()
    if looked_at is not None:
        seen[:, 1:][~looked_at] = np.nan
    parts = [_on_the_net(values, seen, edges, growth), *_between(seen, edges, growth)]
    brackets = _Brackets(*(np.concatenate(field, axis=-1) for field in zip(*parts, strict=True)))
    limit = _refine(brackets, refined or growth, tolerance)
    return [np.sort(limit[brackets.speed == i]) for i in range(net.shape[0])]


def moved_crossings(
    speed: NDArray[np.int64],
    depth: NDArray[np.float64],
    reach: float,
    growth: Growth,
    tolerance: float,
) -> NDArray[np.float64]:
    """Changes of stability next to those of a like problem.

    Parameters
    ----------
    speed, depth : (n,) array
        Those of the like problem; depths in m.
    reach : float
        How far they may have moved, relative to their depth.
    growth : callable
    tolerance : float
        Relative to the depth.

    Returns
    -------
    (n,) array of float
        m, nan where stability does not change within reach.
    """
    low, high = (1.0 - reach) * depth, (1.0 + reach) * depth
    brackets = _bracket(speed, low, growth(speed, low), high, growth(speed, high))
    changes = (brackets.at_low > 0.0) != (brackets.at_high > 0.0)
    return np.where(changes, _refine(brackets, growth, tolerance), np.nan)


def _on_the_net(
    values: NDArray[np.float64],
    seen: NDArray[np.float64],
    edges: NDArray[np.float64],
    growth: Growth,
) -> _Brackets:
    """Changes of sign between neighbouring depths."""
    unstable = values > 0.0
    speed, place = np.nonzero(unstable[:, 1:] != unstable[:, :-1])
    at_low = values[speed, place]
    unknown = np.flatnonzero(~np.isfinite(at_low))
    at_low[unknown] = growth(speed[unknown], edges[place[unknown]])
    # at zero depth there is no cut to make it unstable, whatever rounding says
    at_low[unknown] = np.minimum(at_low[unknown], -1e-12)
    beside = np.stack([place - 1, place + 2])
    there = (beside >= 0) & (beside < edges.size)
    beside = np.clip(beside, 0, edges.size - 1)
    at_beside = seen[speed, beside]
    there &= np.isfinite(at_beside)
    return _Brackets(
        speed, edges[place], edges[place + 1], at_low, values[speed, place + 1],
        np.where(there, edges[beside], np.nan), np.where(there, at_beside, np.nan),
    )  # fmt: skip


def _between(
    values: NDArray[np.float64], edges: NDArray[np.float64], growth: Growth
) -> list[_Brackets]:
    """Changes of sign about peaks and valleys that only reach across zero between the depths."""
    middle, before, after = values[:, 1:-1], values[:, :-2], values[:, 2:]
    side = np.where(middle > 0.0, -1.0, 1.0)
    with np.errstate(invalid="ignore"):
        peak = (side * middle >= side * before) & (side * middle >= side * after)
        step = np.maximum(
            np.where(np.isfinite(before), np.abs(middle - before), 0.0), np.abs(middle - after)
        )
        same = ((before > 0.0) == (middle > 0.0)) & ((after > 0.0) == (middle > 0.0))
        speed, place = np.nonzero(peak & same & (np.abs(middle) < _PEAK_REACH * step))
    x = np.stack([edges[place], edges[place + 1], edges[place + 2]])
    y = np.stack([before[speed, place], middle[speed, place], after[speed, place]])
    found: list[_Brackets] = []
    for _ in range(_PEAK_STEPS):
        known = np.all(np.isfinite(y), axis=0)
        speed, x, y = speed[known], x[:, known], y[:, known]
        if speed.size == 0:
            break
        place = _vertex(x, y)
        value = growth(speed, place)
        across = (value > 0.0) != (y[1] > 0.0)
        k = np.flatnonzero(across)
        # of the two old middles and ends, those next to the new place
        left = np.where(place < x[1], 0, 1)
        for end in (left[k], left[k] + 1):
            found.append(_bracket(speed[k], place[k], value[k], x[end, k], y[end, k]))
        speed, x, y = _narrowed(speed, x, y, place, value, ~across)
    return found


def _bracket(
    speed: NDArray[np.int64],
    one: NDArray[np.float64],
    at_one: NDArray[np.float64],
    other: NDArray[np.float64],
    at_other: NDArray[np.float64],
) -> _Brackets:
    """Brackets between two depths in either order."""
    swap = other < one
    return _Brackets(
        speed,
        np.where(swap, other, one),
        np.where(swap, one, other),
        np.where(swap, at_other, at_one),
        np.where(swap, at_one, at_other),
        np.full((2, one.size), np.nan),
        np.full((2, one.size), np.nan),
    )


def _vertex(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Place of the extremum of the parabolas through three points, kept off the points."""
    left, right = x[1] - x[0], x[2] - x[1]
    rise, fall = (y[1] - y[0]) / left, (y[1] - y[2]) / right
    with np.errstate(invalid="ignore", divide="ignore"):
        vertex = x[1] + 0.5 * (rise * right - fall * left) / (rise + fall) * np.where(
            rise + fall == 0.0, 0.0, 1.0
        )
    vertex = np.where(np.isfinite(vertex), vertex, x[1])
    wider = np.where(left > right, -0.3 * left, 0.3 * right)
    near = np.abs(vertex - x[1]) < 0.1 * np.minimum(left, right)
    vertex = np.where(near, x[1] + wider, vertex)
    return np.clip(vertex, x[0] + 0.1 * left, x[2] - 0.1 * right)


def _narrowed(
    speed: NDArray[np.int64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    place: NDArray[np.float64],
    value: NDArray[np.float64],
    kept: NDArray[np.bool_],
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Triples about the extremum that the new values leave."""
    speed, x, y, place, value = speed[kept], x[:, kept], y[:, kept], place[kept], value[kept]
    side = np.where(y[1] > 0.0, -1.0, 1.0)
    further, beyond = side * value > side * y[1], place > x[1]
    low = np.where(further, np.where(beyond, 1, 0), np.where(beyond, 0, 3))
    middle = np.where(further, 3, 1)
    high = np.where(further, np.where(beyond, 2, 1), np.where(beyond, 3, 2))
    all_x, all_y = np.vstack([x, place]), np.vstack([y, value])
    picked, column = np.stack([low, middle, high]), np.arange(speed.size)
    return speed, all_x[picked, column], all_y[picked, column]


def _refine(brackets: _Brackets, growth: Growth, tolerance: float) -> NDArray[np.float64]:
    """Root in each bracket by inverse interpolation through up to four points, all at once.

    Where that leaves the bracket, the Illinois method. Interpolation through a point that has just
    been looked at is far closer to the root than that point: it is taken unseen when it has moved
    by half a tolerance.
    """
    speed = brackets.speed
    low, high = brackets.low.copy(), brackets.high.copy()
    at_low, at_high = brackets.at_low.copy(), brackets.at_high.copy()
    true_low, true_high = at_low.copy(), at_high.copy()
    # Illinois scales the value of an end down where it is stuck; the points keep theirs
    x = np.stack([low, high, brackets.beside[0], brackets.beside[1]])
    y = np.stack([at_low, at_high, brackets.at_beside[0], brackets.at_beside[1]])
    root = np.where(np.abs(at_low) < np.abs(at_high), low, high)
    k = np.flatnonzero((at_low > 0.0) != (at_high > 0.0))
    last_side = np.zeros(speed.size, dtype=np.int64)
    for iteration in range(_MOST_ITERATIONS):
        if k.size == 0:
            break
        width = high[k] - low[k]
        straight = high[k] - at_high[k] * width / (at_high[k] - at_low[k])
        # now and then keep off the ends, where one end is far steeper than the other
        share = 0.02 if iteration < _MOST_CURVED else 0.5
        margin = (share if iteration % 3 == 2 else 0.0) * width
        curved = _inverse_interpolation(x[:, k], y[:, k], low[k])
        inside = (curved > low[k] + margin) & (curved < high[k] - margin)
        # interpolation that does not close in gives way
        trusted = inside & (iteration < _MOST_CURVED)
        middle = np.where(trusted, curved, straight)
        middle = np.clip(middle, low[k] + margin, high[k] - margin)
        value = growth(speed[k], middle)
        # the flatter side: a jump must not pass for a slope
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = np.fmin(
                np.abs(value - true_low[k]) / (middle - low[k]),
                np.abs(true_high[k] - value) / (high[k] - middle),
            )
        x[:, k], y[:, k] = _with_point(x[:, k], y[:, k], low[k], high[k], middle, value)
        upper = (value > 0.0) == (at_high[k] > 0.0)
        high[k[upper]], low[k[~upper]] = middle[upper], middle[~upper]
        for values in (at_high, true_high):
            values[k[upper]] = value[upper]
        for values in (at_low, true_low):
            values[k[~upper]] = value[~upper]
        side = np.where(upper, 1, -1)
        stuck = last_side[k] == side
        at_low[k[stuck & upper]] *= 0.5
        at_high[k[stuck & ~upper]] *= 0.5
        last_side[k] = side
        following = _inverse_interpolation(x[:, k], y[:, k], low[k])
        within = (following >= low[k]) & (following <= high[k])
        root[k] = np.where(within, following, middle)
        done = (np.abs(value) < _GROWTH_TOLERANCE) | (high[k] - low[k] <= tolerance * high[k])
        done |= np.abs(value) <= _ROOT_SHARE * tolerance * middle * slope
        small = np.abs(value) <= 2.0 * _UNSEEN * tolerance * middle * slope
        done |= within & small & (np.abs(following - middle) <= _UNSEEN * tolerance * middle)
        k = k[~done]
    return root


def _with_point(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    place: NDArray[np.float64],
    value: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Four points a column with a new one in the place of the furthest that is no end."""
    distance = np.abs(x - place)
    distance = np.where(np.isfinite(distance), distance, np.inf)
    distance = np.where((x == low) | (x == high), -1.0, distance)
    furthest = np.arange(4)[:, None] == np.argmax(distance, axis=0)
    return np.where(furthest, place, x), np.where(furthest, value, y)


def _inverse_interpolation(
    x: NDArray[np.float64], y: NDArray[np.float64], low: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Place (n,) at which the polynomial x(y) through up to four points has y = 0.

    Parameters
    ----------
    x, y : (4, n) array of float
        nan where there is no point.
    low : (n,) array of float
        Point above which y changes its sign. Beside it and the next, those points are taken
        towards which y goes on in the same sense: elsewhere x is no function of y.
    """
    order = np.argsort(np.where(np.isfinite(x), x, np.inf), axis=0)
    x, y = np.take_along_axis(x, order, axis=0), np.take_along_axis(y, order, axis=0)
    n = np.arange(x.shape[1])
    first = np.minimum(np.argmax(x == low, axis=0), 2)
    sense = np.sign(y[first + 1, n] - y[first, n])
    with np.errstate(invalid="ignore"):
        goes_on = sense * np.diff(y, axis=0) > 0.0
    place = np.arange(4)[:, None]
    kept = (place == first) | (place == first + 1)
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
