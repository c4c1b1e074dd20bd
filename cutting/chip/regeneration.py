"""Set up the delayed chip: which teeth passed before, and where the tool was at that time."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.chip.delayed_chip import DelayedCut
from cutting.tool.cutter import GAUSS_POINT, EdgeSlices
from cutting.tool.edge_table import EdgeTable, edge_table
from cutting.tool.tooth_passes import earlier_passes

_TURN = 2.0 * math.pi
#: tools whose passes are kept: the runs of a measurement, once with each of two tools
_KEPT = 32


def delayed_cut(
    slices: EdgeSlices,
    arc: tuple[NDArray[np.float64], NDArray[np.float64]],
    law: NamedTuple,
    flank: NamedTuple,
    bins: int,
    path: NDArray[np.float64],
) -> DelayedCut:
    """Set up a cut from rest in full immersion.

    Parameters
    ----------
    slices : EdgeSlices
    arc : pair of (L, 2) arrays of float
        Entry and exit angle of each slice at its lower and upper Gauss point, rad; entry above
        exit where a slice cuts nothing.
    law, flank
        Tables of the force laws.
    bins : int
        Of a turn.
    path : (2 or 3, bins + 1) array of float
        Place of the tool over the last turn before the start, m, which comes last; the third row
        is along the tool axis.

    Returns
    -------
    DelayedCut
    """
    passes = _passes(slices, bins)
    entry, leave = (angle * bins / _TURN for angle in arc)
    cutting = np.isfinite(entry[:, 0])
    return DelayedCut(
        edges=passes.edges,
        law=law,
        flank=flank,
        entry=_middle(entry, cutting),
        exit=_middle(leave, cutting),
        entry_rise=_rise(entry, cutting),
        exit_rise=_rise(leave, cutting),
        arc=np.array([entry.min(), leave.max()]),
        reach=passes.reach,
        helices=passes.delay.shape[1],
        earlier=passes.earlier,
        delay=passes.delay,
        radial_offset=passes.radial_offset,
        history=motion_before(path),
        since=np.zeros((len(slices.angle), 3)),
    )


class _Passes(NamedTuple):
    """What the edges of a tool find of each other, whatever they cut."""

    edges: EdgeTable
    reach: NDArray[np.float64]
    earlier: NDArray[np.int64]
    delay: NDArray[np.float64]  # bins, of one piece where it is the same at all
    radial_offset: NDArray[np.float64]


@lru_cache(_KEPT)
def _passes(slices: EdgeSlices, bins: int) -> _Passes:
    """Passes of the teeth; slices are the same object where a tool is set up again."""
    earlier, ahead = earlier_passes(slices.angle)
    delay = ahead * bins / _TURN
    near = np.round(delay)
    delay = np.where(np.abs(delay - near) < 1e-9 * bins, near, delay)
    alike = np.all(np.abs(delay - delay[:, :1]) < 1e-9 * bins)
    # at the Gauss points above and below the middle of each slice
    rise = 0.5 * GAUSS_POINT * slices.offset_rise
    offset = np.stack([slices.normal_offset + rise, slices.normal_offset - rise], axis=-1)
    pieces = np.arange(offset.shape[1])[None, :, None]
    return _Passes(
        edges=edge_table(slices, bins),
        reach=_reach(slices, bins),
        earlier=earlier,
        delay=np.ascontiguousarray(delay[:, :1] if alike else delay),
        radial_offset=np.ascontiguousarray(offset[earlier, pieces] - offset[:, :, None]),
    )


def _middle(points: NDArray[np.float64], cutting: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Mean (L,) of values at the Gauss points of slices (L, 2); of no cut the value itself."""
    return np.where(cutting, 0.5 * points[:, 0] + 0.5 * points[:, 1], points[:, 0])


def _rise(points: NDArray[np.float64], cutting: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Change (L,) from the middle of slices to their upper ends, of values at Gauss points (L, 2).

    A line through both points keeps the mean of a square, which an arc that grows as a root has.
    """
    rise = np.zeros(len(points))
    rise[cutting] = 0.5 * np.diff(points[cutting], axis=1)[:, 0] / GAUSS_POINT
    return rise


def motion_before(path: NDArray[np.float64]) -> NDArray[np.float64]:
    """Motion over the last turn before the start, of a tool that has not vibrated: (2, bins, 3)."""
    bins = path.shape[1] - 1
    history = np.zeros((2, bins, 3))
    axes = len(path)
    history[0, :, :axes] = path[:, :-1].T
    slope = np.diff(path, axis=1)
    history[1, 1:, :axes] = 0.5 * (slope[:, 1:] + slope[:, :-1]).T
    history[1, 0, :axes] = slope[:, 0]
    return history


def _reach(slices: EdgeSlices, bins: int) -> NDArray[np.float64]:
    """How far each edge reaches behind and before its first slice, bins, (N, 2)."""
    offset = slices.angle - slices.angle[:, :1]
    half = 0.5 * np.abs(slices.lag)
    # half a bin more for the turn of a step, which blurs a straight edge
    low = (offset - half).min(axis=1) * bins / _TURN - 1.0
    high = (offset + half).max(axis=1) * bins / _TURN + 1.0
    reach = np.stack([low, high], axis=1)
    # an edge that winds around the tool is never known to be in the air as a whole
    reach[high - low > 0.5 * bins] = [-np.inf, np.inf]
    return reach
