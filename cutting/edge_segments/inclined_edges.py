"""Arcs of edges of a tool whose axis is inclined: every height of the edge has its own."""

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cutting.edge_segments.earlier_passes import GAUSS, Arcs, Edges
from cutting.edge_segments.points_about_axis import EdgePoints, Work
from cutting.engagement.inclined_tool import InclinedEngagement
from cutting.engagement.uncut_band import SLOT

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

_TURN = 2.0 * math.pi
#: share of half a segment by which its ends are looked at from within
_INSIDE = 1e-6
#: angle by which an arc may bend within a segment, times its share of the edge in the cut, rad; the
#: same for what an arc is longer at one end of a segment within which it opens or closes; and how
#: often a segment is halved
_BEND, _OPENING, _MOST_HALVINGS = 2e-4, 4e-5, 18
#: marks of a row of `Arcs`: each pass, the surface and what lies beside can end an arc twice
_MOST_MARKS = 32


class InclinedEdges(Edges):
    """Edges of a tool with an inclined axis.

    Parameters
    ----------
    engagement : InclinedEngagement
    feed_per_revolution : float
        m.
    """

    def __init__(self, engagement: InclinedEngagement, feed_per_revolution: float) -> None:
        super().__init__(engagement.cutter, SLOT, feed_per_revolution)
        self.engagement = engagement

    @property
    def all_teeth_equal(self) -> bool:
        """Whether every tooth has the arcs of the first, in what the one before it has left."""
        cutter = self.cutter
        alike = len(set(cutter.helix)) == 1 and cutter.serration is None
        offset = np.ptp(cutter.radial_offsets) > 0.0 or np.ptp(cutter.axial_offsets) > 0.0
        return alike and not offset

    def arcs(self, tooth: Indices, position: Array) -> Arcs:
        """Arcs of teeth (P,) at positions (P,), within the turn from `FIRST_ANGLE`."""
        # here: an upright tool needs no compiler
        from cutting.edge_segments.inclined_arcs import inclined_arcs

        return Arcs(*inclined_arcs(self._points(tooth, position), self._work, _MOST_MARKS))

    @cached_property
    def _work(self) -> Work:
        engaged = self.engagement
        side, (rise, bound) = engaged.side_of_work, engaged.beside
        frame, surface = np.ascontiguousarray(engaged.frame), engaged.floor + engaged.axial_depth
        return Work(frame, engaged.along_feed, engaged.along_axis, surface, side, rise, bound)

    def _points(self, tooth: Indices, position: Array) -> EdgePoints:
        profile = self.profile(position)
        sine, cosine = np.sin(profile.immersion), np.cos(profile.immersion)
        out = sine[:, None] * self.radial(profile.height)
        out = out + cosine[:, None] * self.cutter.axial_offsets
        offset = out - np.take_along_axis(out, tooth[:, None], axis=1)
        rise = self.feed_per_revolution / _TURN * self.ahead(tooth, profile.height)
        return EdgePoints(profile.height, profile.radius, sine, cosine, rise, offset)

    def segment_borders(self, tooth: int, borders: Array, relative_length: float) -> Array:
        """Borders (L,) of the segments of a tooth, m, halved until its arcs hardly bend between."""
        low, high = borders[:-1], borders[1:]
        done = [borders]
        whole = 0.0
        for _ in range(_MOST_HALVINGS):
            if low.size == 0:
                break
            bend, opening, length = self._unevenness(tooth, low, high)
            whole = whole or float((high - low) @ (length > 0.0))
            share = (high - low) / max(whole, 1e-300)
            limit = relative_length**2
            rough = (bend * share > limit * _BEND) | (opening * share > limit * _OPENING)
            low, high = low[rough], high[rough]
            middle = 0.5 * (low + high)
            done.append(middle)
            low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        return np.sort(np.concatenate(done))

    def _unevenness(self, tooth: int, low: Array, high: Array) -> tuple[Array, Array, Array]:
        """By how much arcs bend, open or close, and how long they are, within segments, rad."""
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        places = (-1.0 + _INSIDE, -GAUSS, 0.0, GAUSS, 1.0 - _INSIDE)
        at = np.concatenate([middle + place * half for place in places])
        found = self.arcs(np.full(at.size, tooth), at)
        length = np.sum(np.diff(found.angle, axis=1) * (found.tooth[:, :-1] >= 0), axis=1)
        widest = length.reshape(len(places), -1).max(axis=0)
        _, first, between, last, _ = found.angle.reshape(len(places), low.size, -1)
        kinds = found.kind.reshape(len(places), low.size, -1)
        alike = np.all(kinds == kinds[0], axis=(0, 2))
        bend = np.where(alike, np.abs(between - 0.5 * (first + last)).max(axis=1), 0.0)
        return bend, np.where(alike, 0.0, widest), widest
