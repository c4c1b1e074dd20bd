"""Following the boundary of stability over speed and depth, at a stated tolerance.

Multi-dimensional bisection (Bachrathy and Stepan 2012, Period. Polytech. Mech. Eng. 56) of the sign
of growth: a coarse net over all speeds and depths, then speeds halfway between, where only the
depths are looked at around which the columns on either side change sign or differ. What is left is
one bracket a crossing at every speed, refined to the tolerance. An island is missed if it fits
between the columns of the coarse net, or between two depths where nothing beside it comes near zero
(see `crossings`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress, no_progress
from chatter.stability.brackets import Growth
from chatter.stability.crossings import find_crossings

#: of the columns of the coarse net every so many depths are looked at first, a power of two
_DEPTH_STRIDE = 4
#: growth of a peak or valley that the columns beside may have above or below zero
_NEARLY_ZERO = 0.2


def followed_crossings(
    speed_count: int,
    depths: NDArray[np.float64],
    growth: Growth,
    tolerance: float = 5e-3,
    stride: int = 8,
    progress: Progress = no_progress,
    refined: Growth | None = None,
) -> list[NDArray[np.float64]]:
    """Depths of all changes of stability at each speed.

    Parameters
    ----------
    speed_count : int
        Speeds, numbered in the order of their size.
    depths : (m,) array of float
        Coarse net, m, ascending, > 0.
    growth : callable
        Logarithm of the spectral radius.
    tolerance : float
        Of a limit, relative to its depth.
    stride : int
        Every so many speeds make the coarse net; a power of two.
    progress : callable, optional
        Called with (done, total) speeds.
    refined : callable, optional
        Growth for the refinement of limits; `growth` by default.

    Returns
    -------
    list of arrays
        m, ascending; stability is lost at even places and regained at odd ones.
    """
    values = np.full((speed_count, depths.size), np.nan)
    columns = np.unique(np.append(np.arange(0, speed_count, stride), speed_count - 1))
    looked_at = np.zeros(values.shape, dtype=bool)
    looked_at[columns] = _look_along(values, columns, depths, growth)
    progress(len(columns), max(speed_count, len(columns) + 1))
    while stride > 1:
        stride //= 2
        between = np.setdiff1d(np.arange(0, speed_count, stride), columns)
        before = columns[np.searchsorted(columns, between) - 1]
        after = columns[np.searchsorted(columns, between)]
        wanted = _worth_a_look(values[before]) | _worth_a_look(values[after])
        wanted |= (values[before] > 0.0) != (values[after] > 0.0)
        # where both sides agree and nothing changes nearby the sign is taken over
        values[between] = values[before]
        _look_at(values, between, wanted, depths, growth)
        looked_at[between] = _widen(values, between, wanted, depths, growth)
        columns = np.sort(np.append(columns, between))
        progress(len(columns) - 1, speed_count)
    return find_crossings(values, depths, growth, tolerance, looked_at, refined)


def _look_along(
    values: NDArray[np.float64],
    columns: NDArray[np.int64],
    depths: NDArray[np.float64],
    growth: Growth,
) -> NDArray[np.bool_]:
    """Fill in columns: all depths, but for some of those that lie deep in what is unstable.

    Between two of every few depths that are unstable, with a growth well above what it changes by
    from the one to the other, growth is taken to follow the line. Returns what has been seen.
    """
    last = depths.size - 1
    step = _DEPTH_STRIDE
    seen = np.zeros((columns.size, depths.size), dtype=bool)
    seen[:, ::step] = seen[:, last] = True
    _look_at(values, columns, seen, depths, growth)
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
        _look_at(values, columns, wanted, depths, growth)
        seen |= wanted
    seen |= _widen(values, columns, seen, depths, growth)
    return seen


def _look_at(
    values: NDArray[np.float64],
    columns: NDArray[np.int64],
    wanted: NDArray[np.bool_],
    depths: NDArray[np.float64],
    growth: Growth,
) -> None:
    """Fill in the growth at the wanted places of some columns."""
    row, place = np.nonzero(wanted)
    if row.size:
        values[columns[row], place] = growth(columns[row], depths[place])


def _beside_changes(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Depths on both sides of a change of sign; before the first depth all is stable."""
    unstable = values > 0.0
    before = np.concatenate([np.zeros((len(values), 1), dtype=bool), unstable[:, :-1]], axis=1)
    changes = unstable != before
    below = np.concatenate([changes[:, 1:], np.zeros((len(values), 1), dtype=bool)], axis=1)
    return changes | below


def _worth_a_look(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Depths beside a change of sign, or at peaks and valleys of growth that nearly reach zero."""
    padded = np.pad(values, ((0, 0), (1, 1)), mode="edge")
    before, after = padded[:, :-2], padded[:, 2:]
    side = np.where(values > 0.0, -1.0, 1.0)
    # a doubtful place beyond the first and the last depth is none
    inner = np.arange(values.shape[1]) < values.shape[1] - 1
    peak = (side * values >= side * before) & (side * values >= side * after) & inner
    near = np.pad(peak & (np.abs(values) < _NEARLY_ZERO), ((0, 0), (1, 1)))
    return _beside_changes(values) | near[:, 1:-1] | near[:, :-2] | near[:, 2:]


def _widen(
    values: NDArray[np.float64],
    columns: NDArray[np.int64],
    seen: NDArray[np.bool_],
    depths: NDArray[np.float64],
    growth: Growth,
) -> NDArray[np.bool_]:
    """Look beside changes of sign of which one side was only taken over; returns what is seen."""
    seen = seen.copy()
    while True:
        wanted = _beside_changes(values[columns]) & ~seen
        if not wanted.any():
            return seen
        _look_at(values, columns, wanted, depths, growth)
        seen |= wanted
