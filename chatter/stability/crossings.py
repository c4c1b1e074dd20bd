"""Where stability is lost or regained along depth: net, then refinement of every bracket at once.

The search knows nothing of the method: it asks for the growth (logarithm of the spectral radius)
at batches of points, which the sweep spreads over the threads.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

#: growth at points: (indices of speeds, depths) -> (n,)
Growth = Callable[[NDArray[np.int64], NDArray[np.float64]], NDArray[np.float64]]

#: a limit is found when its bracket is this small, relative to the depth
_DEPTH_TOLERANCE = 1e-7
_GROWTH_TOLERANCE = 1e-9
_MOST_ITERATIONS = 60
#: growth on the net may be off by this much
_DOUBTFUL_GROWTH = 0.05


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


def find_crossings(
    net: NDArray[np.float64],
    depths: NDArray[np.float64],
    growth: Growth,
    tolerance: float = _DEPTH_TOLERANCE,
) -> list[NDArray[np.float64]]:
    """Depths of all changes of stability at each speed.

    Parameters
    ----------
    net : (n, m) array of float
        Growth at n speeds and m depths.
    depths : (m,) array of float
        m, ascending, > 0. At zero depth the damped structure is stable.
    growth : callable
        For the refinement.
    tolerance : float
        Of a limit, relative to its depth.

    Returns
    -------
    list of n arrays
        m, ascending; stability is lost at even places and regained at odd ones.
    """
    unstable = np.concatenate([np.zeros((net.shape[0], 1), dtype=bool), net > 0.0], axis=1)
    speed, place = np.nonzero(unstable[:, 1:] != unstable[:, :-1])
    edges = np.concatenate([[0.0], depths])
    limit = _refine(speed, edges[place], edges[place + 1], growth, tolerance)
    return [limit[speed == i] for i in range(net.shape[0])]


def _refine(
    speed: NDArray[np.int64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    growth: Growth,
    tolerance: float,
) -> NDArray[np.float64]:
    """Root in each bracket by the Illinois method, all brackets at once."""
    low, high = low.copy(), high.copy()
    at_low, at_high = growth(speed, low), growth(speed, high)
    root = np.where(np.abs(at_low) < np.abs(at_high), low, high)
    open_brackets = np.flatnonzero((at_low > 0.0) != (at_high > 0.0))
    last_side = np.zeros(speed.size, dtype=np.int64)
    for iteration in range(_MOST_ITERATIONS):
        k = open_brackets
        if k.size == 0:
            break
        width = high[k] - low[k]
        middle = high[k] - at_high[k] * width / (at_high[k] - at_low[k])
        # now and then keep off the ends, where one end is far steeper than the other
        margin = (0.02 if iteration % 3 == 2 else 0.0) * width
        middle = np.clip(middle, low[k] + margin, high[k] - margin)
        value = growth(speed[k], middle)
        root[k] = middle
        upper = (value > 0.0) == (at_high[k] > 0.0)
        high[k[upper]], at_high[k[upper]] = middle[upper], value[upper]
        low[k[~upper]], at_low[k[~upper]] = middle[~upper], value[~upper]
        side = np.where(upper, 1, -1)
        stuck = last_side[k] == side
        at_low[k[stuck & upper]] *= 0.5
        at_high[k[stuck & ~upper]] *= 0.5
        last_side[k] = side
        done = (np.abs(value) < _GROWTH_TOLERANCE) | (high[k] - low[k] <= tolerance * high[k])
        open_brackets = k[~done]
    return root
