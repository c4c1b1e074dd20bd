"""Slices of the edges of a tool with an inclined axis, each with one of its arcs."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.compile.inclined_axis import inclined_engagement
from chatter.description.case import Case
from cutting.edge_segments.earlier_passes import GAUSS
from cutting.edge_segments.points_about_axis import FIRST_ANGLE
from cutting.edge_segments.segments import inclined_line
from cutting.engagement.inclined_tool import InclinedEngagement
from cutting.force.force_spectrum import slices_at
from cutting.tool.cutter import Cutter, EdgeSlices, slices_between

Array = NDArray[np.float64]

_TURN = 2.0 * math.pi
#: geometries kept: a run asks for its own several times
_KEPT = 32
#: an arc that goes on behind `FIRST_ANGLE` reaches this much further, rad: an edge that passes
#: there is seen on one side of it, as a whole
_BEYOND = 1.0
#: arcs shorter than this are none, rad
_SHORTEST = 1e-9


class InclinedSlices(NamedTuple):
    """Slices of what is in the cut, those with several arcs as often."""

    bounds: Array  # heights along the axis between which the slices of the edge lie, m, (B,)
    slices: EdgeSlices  # (L,)
    entry: Array  # at the lower and upper Gauss point, rad, (L, 2)
    exit: Array  # rad, (L, 2)

    @property
    def longest_arc(self) -> float:
        """Longest arc, rad."""
        return float(min((self.exit - self.entry).max(initial=0.0), _TURN))

    @property
    def reach(self) -> tuple[float, float]:
        """Least entry and largest exit angle about the axis of the tool, rad."""
        last = FIRST_ANGLE + _TURN
        entry = float(self.entry.min(initial=last))
        return max(FIRST_ANGLE, entry), min(last, float(self.exit.max(initial=FIRST_ANGLE)))


def inclined_slices(
    case: Case, cutter: Cutter, largest_lag: float, refinement: float
) -> InclinedSlices:
    """Slices of the edges of an inclined tool, within which lag (rad) and arcs change little.

    The arcs are those of teeth without runout: the chip tells what is in the air.
    """
    true = replace(cutter, runout_offset=0.0, radial_error=(), axial_error=())
    engaged = inclined_engagement(case, true)
    bounds, index, entry, leave = _arcs(engaged, largest_lag, refinement)
    slices = slices_at(slices_between(cutter, bounds), index)
    return InclinedSlices(bounds, slices, entry, leave)


@lru_cache(_KEPT)
def _arcs(
    engaged: InclinedEngagement, largest_lag: float, refinement: float
) -> tuple[Array, NDArray[np.int64], Array, Array]:
    """Heights between slices, m (B,); slices (L,) of arcs, and their ends (L, 2), rad."""
    cutter = engaged.cutter
    # the arcs do not know of the feed
    edges, line, top = inclined_line(engaged, 1.0, refinement)
    borders = np.concatenate([[0.0], np.cumsum(line.length)])
    borders = np.minimum(borders, edges.position(top))
    borders = np.append(borders[borders < borders[-1]], borders[-1])
    position = edges.segment_borders(0, borders, refinement)
    position = position[np.append(True, np.diff(position) > 1e-9 * position[-1])]
    position = _with_lag(position, edges.profile(position).height, cutter, largest_lag)
    middle, half = 0.5 * (position[1:] + position[:-1]), 0.5 * np.diff(position)
    first = np.zeros(middle.size, dtype=np.int64)
    low, high, central = (
        edges.arcs(first, middle + share * half) for share in (-GAUSS, GAUSS, 0.0)
    )
    alike = np.all(low.kind == high.kind, axis=1)[:, None]
    at_low, at_high = (np.where(alike, one.angle, central.angle) for one in (low, high))
    met = np.where(alike, low.tooth, central.tooth)
    index, arc = np.nonzero(met >= 0)
    entry, leave = (
        np.stack([at_low[index, arc + k], at_high[index, arc + k]], axis=1) for k in (0, 1)
    )
    last = FIRST_ANGLE + _TURN
    entry = np.where(entry <= FIRST_ANGLE + _SHORTEST, entry - _BEYOND, entry)
    leave = np.where(leave >= last - _SHORTEST, leave + _BEYOND, leave)
    bounds = edges.profile(position).height
    if not index.size:
        return bounds, index, entry, leave
    # what lies above the cut is no slice
    kept = bounds[: int(index.max()) + 2]
    return kept, index, entry, leave


def _with_lag(position: Array, height: Array, cutter: Cutter, largest_lag: float) -> Array:
    """Positions with others between, so that no edge trails by more than a lag, rad, between."""
    steep = max(abs(math.tan(helix)) for helix in cutter.helix) / cutter.radius
    parts = np.maximum(np.ceil(np.diff(height) * steep / largest_lag).astype(int), 1)
    pieces = [
        np.linspace(low, high, count + 1)[:-1]
        for low, high, count in zip(position[:-1], position[1:], parts, strict=True)
    ]
    return np.append(np.concatenate(pieces), position[-1])
