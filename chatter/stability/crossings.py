"""Where stability is lost or regained along depth: grid, then the root in every bracket.

A interval that fits between two depths of the grid is not passed over where the growth rate beside
it nearly reaches zero: the top of such a peak, or the floor of such a valley, is searched.

The search knows nothing of the method: it asks for the growth_rate (logarithm of the spectral
radius) at batches of points, which the sweep spreads over the threads.
"""

import itertools

import numpy as np

from chatter.description.arrays import Array, BooleanArray, IntegerArray
from chatter.stability.brackets import Brackets, GrowthRate, bracket, roots_in

#: of a limit, relative to its depth
_DEPTH_TOLERANCE = 1e-7
#: growth_rate on the grid may be off by this much
_DOUBTFUL_GROWTH = 0.05
#: a peak may rise above the grid by this share of its height over the depths beside it
_PEAK_REACH = 1.5
_PEAK_STEPS = 4


def growth_rate_on_grid(
    speed_count: int, depths: Array, plain: GrowthRate, refined: GrowthRate
) -> Array:
    """Growth rate (speeds, depths) on the grid, refined where its sign matters and is in doubt."""
    speed, depth = (
        part.ravel() for part in np.meshgrid(np.arange(speed_count), depths, indexing="ij")
    )
    growth_rate = plain(speed, depth).reshape(speed_count, depths.size)
    settled = np.zeros(growth_rate.shape, dtype=bool)
    # a refined value may change its sign and so put its neighbour in doubt
    while refined is not plain:
        row, column = np.nonzero(_in_doubt(growth_rate) & ~settled)
        if row.size == 0:
            break
        growth_rate[row, column] = refined(row, depths[column])
        settled[row, column] = True
    return growth_rate


def _in_doubt(growth_rate: Array) -> BooleanArray:
    """Points beside a change of sign, and peaks and valleys that nearly reach zero."""
    before = np.concatenate(
        [np.full((growth_rate.shape[0], 1), -1e-12), growth_rate[:, :-1]], axis=1
    )
    after = np.concatenate([growth_rate[:, 1:], growth_rate[:, -1:]], axis=1)
    changes = ((before > 0.0) != (growth_rate > 0.0)) | ((after > 0.0) != (growth_rate > 0.0))
    near = np.abs(growth_rate) < _DOUBTFUL_GROWTH
    peak = (growth_rate <= 0.0) & (growth_rate >= before) & (growth_rate >= after)
    valley = (growth_rate > 0.0) & (growth_rate <= before) & (growth_rate <= after)
    return changes | (near & (peak | valley))


def find_crossings(
    grid: Array,
    depths: Array,
    growth_rate: GrowthRate,
    tolerance: float = _DEPTH_TOLERANCE,
    evaluated: BooleanArray | None = None,
    refined: GrowthRate | None = None,
) -> list[Array]:
    """Depths of all changes of stability at each speed.

    The grid (n, m) holds the growth rate at n speeds and m depths, m, ascending, > 0; at zero depth
    the damped structure is stable. `growth_rate` is asked where a peak may be hidden and at the end
    of a bracket, `refined` (the same by default) in the refinement of brackets. `evaluated` (n, m)
    is False where the growth rate of the grid has the right sign alone; beside changes it is not.
    The tolerance of a limit is relative to its depth. Returned for each speed are depths, m,
    ascending; stability is lost at even indices and regained at odd ones.
    """
    edges = np.concatenate([[0.0], depths])
    at_zero = np.full((grid.shape[0], 1), -np.inf)
    values = np.concatenate([at_zero, grid], axis=1)
    seen = values if evaluated is None else values.copy()
    if evaluated is not None:
        seen[:, 1:][~evaluated] = np.nan
    parts = [_on_the_grid(values, seen, edges, growth_rate), *_between(seen, edges, growth_rate)]
    brackets = Brackets(*(np.concatenate(field, axis=-1) for field in zip(*parts, strict=True)))
    limit = roots_in(brackets, refined or growth_rate, tolerance)
    order = np.lexsort((limit, brackets.speed))
    first = np.searchsorted(brackets.speed[order], np.arange(grid.shape[0] + 1))
    return [limit[order[low:high]] for low, high in itertools.pairwise(first.tolist())]


def moved_crossings(
    speed: IntegerArray, depth: Array, reach: float, growth_rate: GrowthRate, tolerance: float
) -> Array:
    """Changes of stability (n,), m, next to those of a like problem; nan where none is in reach.

    Speeds and depths (n,), m, are those of the like problem; `reach`, how far they may have moved,
    and `tolerance` are relative to the depth.
    """
    low, high = (1.0 - reach) * depth, (1.0 + reach) * depth
    brackets = bracket(speed, low, growth_rate(speed, low), high, growth_rate(speed, high))
    changes = (brackets.at_low > 0.0) != (brackets.at_high > 0.0)
    return np.where(changes, roots_in(brackets, growth_rate, tolerance), np.nan)


def _on_the_grid(values: Array, seen: Array, edges: Array, growth_rate: GrowthRate) -> Brackets:
    """Changes of sign between neighbouring depths."""
    unstable = values > 0.0
    speed, column = np.nonzero(unstable[:, 1:] != unstable[:, :-1])
    at_low = values[speed, column]
    unknown = np.flatnonzero(~np.isfinite(at_low))
    at_low[unknown] = growth_rate(speed[unknown], edges[column[unknown]])
    # at zero depth there is no cut to make it unstable, whatever rounding says
    at_low[unknown] = np.minimum(at_low[unknown], -1e-12)
    beside = np.stack([column - 1, column + 2])
    there = (beside >= 0) & (beside < edges.size)
    beside = np.clip(beside, 0, edges.size - 1)
    at_beside = seen[speed, beside]
    there &= np.isfinite(at_beside)
    return Brackets(
        speed, edges[column], edges[column + 1], at_low, values[speed, column + 1],
        np.where(there, edges[beside], np.nan), np.where(there, at_beside, np.nan),
    )  # fmt: skip


def _between(values: Array, edges: Array, growth_rate: GrowthRate) -> list[Brackets]:
    """Changes of sign about peaks and valleys that only reach across zero between the depths."""
    middle, before, after = values[:, 1:-1], values[:, :-2], values[:, 2:]
    side = np.where(middle > 0.0, -1.0, 1.0)
    with np.errstate(invalid="ignore"):
        peak = (side * middle >= side * before) & (side * middle >= side * after)
        step = np.maximum(
            np.where(np.isfinite(before), np.abs(middle - before), 0.0), np.abs(middle - after)
        )
        same = ((before > 0.0) == (middle > 0.0)) & ((after > 0.0) == (middle > 0.0))
        speed, column = np.nonzero(peak & same & (np.abs(middle) < _PEAK_REACH * step))
    x = np.stack([edges[column], edges[column + 1], edges[column + 2]])
    y = np.stack([before[speed, column], middle[speed, column], after[speed, column]])
    found: list[Brackets] = []
    for _ in range(_PEAK_STEPS):
        known = np.all(np.isfinite(y), axis=0)
        speed, x, y = speed[known], x[:, known], y[:, known]
        if speed.size == 0:
            break
        depth = _vertex(x, y)
        value = growth_rate(speed, depth)
        across = (value > 0.0) != (y[1] > 0.0)
        k = np.flatnonzero(across)
        # of the two old middles and ends, those next to the new depth
        left = np.where(depth < x[1], 0, 1)
        for end in (left[k], left[k] + 1):
            found.append(bracket(speed[k], depth[k], value[k], x[end, k], y[end, k]))
        speed, x, y = _narrowed(speed, x, y, depth, value, ~across)
    return found


def _vertex(x: Array, y: Array) -> Array:
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
    speed: IntegerArray, x: Array, y: Array, depth: Array, value: Array, kept: BooleanArray
) -> tuple[IntegerArray, Array, Array]:
    """Triples about the extremum that the new values leave."""
    speed, x, y, depth, value = speed[kept], x[:, kept], y[:, kept], depth[kept], value[kept]
    side = np.where(y[1] > 0.0, -1.0, 1.0)
    further, beyond = side * value > side * y[1], depth > x[1]
    low = np.where(further, np.where(beyond, 1, 0), np.where(beyond, 0, 3))
    middle = np.where(further, 3, 1)
    high = np.where(further, np.where(beyond, 2, 1), np.where(beyond, 3, 2))
    all_x, all_y = np.vstack([x, depth]), np.vstack([y, value])
    picked, column = np.stack([low, middle, high]), np.arange(speed.size)
    return speed, all_x[picked, column], all_y[picked, column]
