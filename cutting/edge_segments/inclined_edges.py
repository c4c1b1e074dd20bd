"""Arcs of edges of a tool whose axis is inclined: every height of the edge has its own."""

import math

import numpy as np
from numpy.typing import NDArray

from cutting.edge_segments.earlier_passes import GAUSS, Arcs, Edges, Profile
from cutting.engagement.inclined_tool import InclinedEngagement
from cutting.engagement.uncut_band import SLOT

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

#: angles about the axis run from here once around: behind the tool, where only a plunge cuts
FIRST_ANGLE = -0.5 * math.pi
_TURN = 2.0 * math.pi
#: places around the axis that are looked at; an arc that fits between two of them is not seen
_ANGLES = 360
_HALVINGS = 30
#: share of half a segment by which its ends are looked at from within
_INSIDE = 1e-6
#: angle by which an arc may bend within a segment, times its share of the edge in the cut, rad; the
#: same for what an arc is longer at one end of a segment within which it opens or closes; and how
#: often a segment is halved
_BEND, _OPENING, _MOST_HALVINGS = 2e-4, 4e-5, 18
#: marks of a row of `Arcs`: each pass, the surface and what lies beside can end an arc twice
_MOST_MARKS = 32
#: how the end of an arc is marked in `Arcs.kind`; see `engagement_arcs`
_SURFACE, _BESIDE, _CHIP = 0, 1, 2


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
        look = _Look(self, tooth, position)
        angle = FIRST_ANGLE + _TURN * np.arange(_ANGLES + 1) / _ANGLES
        rows = np.repeat(np.arange(position.size), angle.size)
        met = look.met(rows, np.tile(angle, position.size)).reshape(position.size, angle.size)
        row, column = np.nonzero(met[:, 1:] != met[:, :-1])
        low, high = angle[column], angle[column + 1]
        before = met[row, column]
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            same = look.met(row, middle) == before
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        after = look.met(row, high)
        side = look.border(row, np.where(before < 0, low, high))
        side = np.where((before >= 0) & (after >= 0), _CHIP, side)
        first, last = np.flatnonzero(met[:, 0] >= 0), np.flatnonzero(met[:, -1] >= 0)
        return _laid_out(
            position.size,
            np.concatenate([first, row, last]),
            np.concatenate(
                [np.full(first.size, angle[0]), 0.5 * (low + high), np.full(last.size, angle[-1])]
            ),
            np.concatenate([met[first, 0], after, np.full(last.size, -1)]),
            np.concatenate([np.full(first.size, _SURFACE), side, np.full(last.size, _SURFACE)]),
        )

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


class _Look:
    """Points of edges at positions, by their row, and what they meet."""

    def __init__(self, edges: InclinedEdges, tooth: Indices, position: Array) -> None:
        self._engagement = edges.engagement
        self._profile: Profile = edges.profile(position)
        profile = self._profile
        sine, cosine = np.sin(profile.immersion)[:, None], np.cos(profile.immersion)[:, None]
        out = sine * edges.radial(profile.height) + cosine * edges.cutter.axial_offsets
        self._offset = out - np.take_along_axis(out, tooth[:, None], axis=1)
        self._alike = not np.any(self._offset)
        ahead = edges.ahead(tooth, profile.height)
        self._latest = np.argmin(ahead, axis=1)
        self._rise = edges.feed_per_revolution / _TURN * ahead

    def _margins(self, row: Indices, angle: Array) -> tuple[Array, Array, Array]:
        """What an edge stands ahead, below the surface and beside the pass before."""
        engagement, profile = self._engagement, self._profile
        ahead = engagement.ahead(profile.immersion[row], angle)
        y, z = engagement.position(profile.height[row], profile.radius[row], angle)
        return ahead, engagement.below_surface(z), engagement.beside_pass(y, z)

    def _thinnest(self, row: Indices, ahead: Array) -> tuple[Indices, Array]:
        """Tooth that left the surface, and the chip, m."""
        if self._alike:
            return self._latest[row], ahead
        chip = self._rise[row] * ahead[:, None] - self._offset[row]
        thinnest = np.argmin(chip, axis=1)
        return thinnest, chip[np.arange(row.size), thinnest]

    def met(self, row: Indices, angle: Array) -> Indices:
        """Tooth (n,) that left the surface which edges meet at angles, rad; -1 in the air."""
        ahead, below, beside = self._margins(row, angle)
        tooth, chip = self._thinnest(row, ahead)
        return np.where((chip > 0.0) & (below > 0.0) & (beside > 0.0), tooth, -1)

    def border(self, row: Indices, angle: Array) -> Indices:
        """What keeps edges in the air at angles, rad."""
        ahead, below, _ = self._margins(row, angle)
        _, chip = self._thinnest(row, ahead)
        return np.where(chip <= 0.0, _CHIP, np.where(below <= 0.0, _SURFACE, _BESIDE))


def _laid_out(count: int, row: Indices, angle: Array, met: Indices, side: Indices) -> Arcs:
    """Marks of all rows, in order, as arcs."""
    order = np.lexsort((angle, row))
    row, angle, met, side = row[order], angle[order], met[order], side[order]
    column = np.arange(row.size) - np.searchsorted(row, row)
    shape = (count, _MOST_MARKS)
    at, tooth, kind = np.zeros(shape), np.full(shape, -1), np.full(shape, -1)
    at[row, column], tooth[row, column] = angle, met
    kind[row, column] = 4 * (met + 1) + side
    return Arcs(at, tooth, kind)
