"""Following the boundary of stability over speed and depth, at a stated tolerance.

Multi-dimensional bisection (Bachrathy and Stepan 2012, Period. Polytech. Mech. Eng. 56) of the sign
of growth_rate: a coarse grid over all speeds and depths, then speeds halfway between, where only
the depths are evaluated around which the columns on either side change sign or differ. What is left
is one bracket a crossing at every speed, refined to the tolerance. An island is missed if it fits
between the columns of the coarse grid, or between two depths where nothing beside it comes near
zero (see `crossings`).
"""

from collections.abc import Callable

import numpy as np

from chatter.description.arrays import Array, BooleanArray, IntegerArray
from chatter.description.progress import Progress, no_progress
from chatter.stability.brackets import GrowthRate
from chatter.stability.crossings import find_crossings

#: of the columns of the coarse grid every so many depths are evaluated first, a power of two
_DEPTH_STRIDE = 4
#: parts of the depths of a column that are evaluated one after the other, and the growth rate in a
#: period from which on it is far above zero
_PARTS, _FAR_ABOVE = 16, 5.0
#: growth rate of a peak or valley that the columns beside may have above or below zero
_NEARLY_ZERO = 0.2
#: share of the time that the coarse grid takes, about
_SCREENING = 0.6


def continued_crossings(
    speed_count: int,
    depths: Array,
    growth_rate: GrowthRate,
    tolerance: float = 5e-3,
    stride: int = 8,
    progress: Progress = no_progress,
    refined: GrowthRate | None = None,
) -> list[Array]:
    """Depths of all changes of stability at each speed.

    Speeds are numbered in the order of their size; every `stride`, a power of two, makes the coarse
    grid, with the depths (m,), m, ascending, > 0. The growth rate is the logarithm of the spectral
    radius; `refined` is that for the refinement of limits, the same by default. The tolerance of a
    limit is relative to its depth; progress counts speeds. Returned for each speed are depths, m,
    ascending; stability is lost at even indices and regained at odd ones.
    """
    values = np.full((speed_count, depths.size), np.nan)
    columns = np.unique(np.append(np.arange(0, speed_count, stride), speed_count - 1))
    evaluated = np.zeros(values.shape, dtype=bool)

    def finished(share: float) -> None:
        progress(int(share * speed_count), speed_count)

    def screened(share: float) -> None:
        finished(_SCREENING * share)

    evaluated[columns] = _screen(values, columns, depths, growth_rate, screened)
    levels = stride.bit_length()
    while stride > 1:
        stride //= 2
        between = np.setdiff1d(np.arange(0, speed_count, stride), columns)
        before = columns[np.searchsorted(columns, between) - 1]
        after = columns[np.searchsorted(columns, between)]
        wanted = _near_boundary(values[before]) | _near_boundary(values[after])
        wanted |= (values[before] > 0.0) != (values[after] > 0.0)
        # where both sides agree and nothing changes nearby the sign is taken over
        values[between] = values[before]
        _evaluate(values, between, wanted, depths, growth_rate)
        evaluated[between] = _widen(values, between, wanted, depths, growth_rate)
        columns = np.sort(np.append(columns, between))
        finished(_SCREENING + (1.0 - _SCREENING) * (1.0 - stride.bit_length() / levels))
    return find_crossings(values, depths, growth_rate, tolerance, evaluated, refined)


def _screen(
    values: Array,
    columns: IntegerArray,
    depths: Array,
    growth_rate: GrowthRate,
    screened: Callable[[float], None],
) -> BooleanArray:
    """Fill in columns: all depths, but for some of those that lie deep in what is unstable.

    Between two of every few depths that are unstable, with a growth rate well above what it changes
    by from the one to the other, growth rate is taken to follow the line; so it is below depths
    from which on it only rises far above. `screened` is called with the share that is done. Returns
    what has been seen.
    """
    last = depths.size - 1
    step = _DEPTH_STRIDE
    coarse = np.unique(np.append(np.arange(0, last, step), last))
    seen = _descend(values, columns, coarse, depths, growth_rate)
    screened(1.0 / step)
    while step > 1:
        step //= 2
        between = np.arange(step, last, 2 * step)
        below, above = between - step, np.minimum(between + step, last)
        a, b = values[columns][:, below], values[columns][:, above]
        share = (depths[between] - depths[below]) / (depths[above] - depths[below])
        values[np.ix_(columns, between)] = a + share * (b - a)
        nearest = np.minimum(np.abs(a), np.abs(b))
        doubtful = (a <= 0.0) | (b <= 0.0) | (nearest < np.maximum(_NEARLY_ZERO, np.abs(b - a)))
        wanted = np.zeros(seen.shape, dtype=bool)
        wanted[:, between] = doubtful & ~seen[:, between]
        _evaluate(values, columns, wanted, depths, growth_rate)
        seen |= wanted
        # every step-th of all depths is known
        screened(1.0 / step)
    seen |= _widen(values, columns, seen, depths, growth_rate)
    return seen


def _descend(
    values: Array,
    columns: IntegerArray,
    coarse: IntegerArray,
    depths: Array,
    growth_rate: GrowthRate,
) -> BooleanArray:
    """Fill in some depths of columns, part by part from the shallowest on; returns what is seen.

    A column ends with a part over which the growth rate rises, far above zero: a cut many times
    deeper than its limit takes longest, and tells nothing.
    """
    seen = np.zeros((columns.size, depths.size), dtype=bool)
    on = np.arange(columns.size)
    parts = np.array_split(coarse, min(_PARTS, coarse.size))
    for number, part in enumerate(parts):
        wanted = np.zeros_like(seen)
        wanted[np.ix_(on, part)] = True
        _evaluate(values, columns, wanted, depths, growth_rate)
        seen |= wanted
        first, last = values[columns[on], part[0]], values[columns[on], part[-1]]
        ended = (first > _FAR_ABOVE) & (last > first)
        rest = np.concatenate([[part[-1]], *parts[number + 1 :]])[1:]
        slope = (last - first)[ended] / (depths[part[-1]] - depths[part[0]])
        beyond = depths[rest] - depths[part[-1]]
        values[np.ix_(columns[on[ended]], rest)] = last[ended][:, None] + np.outer(slope, beyond)
        on = on[~ended]
    return seen


def _evaluate(
    values: Array,
    columns: IntegerArray,
    wanted: BooleanArray,
    depths: Array,
    growth_rate: GrowthRate,
) -> None:
    """Fill in the growth rate at the wanted positions of some columns."""
    row, position = np.nonzero(wanted)
    if row.size:
        values[columns[row], position] = growth_rate(columns[row], depths[position])


def _beside_changes(values: Array) -> BooleanArray:
    """Depths on both sides of a change of sign; before the first depth all is stable."""
    unstable = values > 0.0
    before = np.concatenate([np.zeros((len(values), 1), dtype=bool), unstable[:, :-1]], axis=1)
    changes = unstable != before
    below = np.concatenate([changes[:, 1:], np.zeros((len(values), 1), dtype=bool)], axis=1)
    return changes | below


def _near_boundary(values: Array) -> BooleanArray:
    """Depths beside a change of sign, or at peaks and valleys that nearly reach zero."""
    padded = np.pad(values, ((0, 0), (1, 1)), mode="edge")
    before, after = padded[:, :-2], padded[:, 2:]
    side = np.where(values > 0.0, -1.0, 1.0)
    # a doubtful position beyond the first and the last depth is none
    inner = np.arange(values.shape[1]) < values.shape[1] - 1
    peak = (side * values >= side * before) & (side * values >= side * after) & inner
    near = np.pad(peak & (np.abs(values) < _NEARLY_ZERO), ((0, 0), (1, 1)))
    return _beside_changes(values) | near[:, 1:-1] | near[:, :-2] | near[:, 2:]


def _widen(
    values: Array, columns: IntegerArray, seen: BooleanArray, depths: Array, growth_rate: GrowthRate
) -> BooleanArray:
    """Look beside changes of sign of which one side was only taken over; returns what is seen."""
    seen = seen.copy()
    while True:
        wanted = _beside_changes(values[columns]) & ~seen
        if not wanted.any():
            return seen
        _evaluate(values, columns, wanted, depths, growth_rate)
        seen |= wanted
