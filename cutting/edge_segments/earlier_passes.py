"""Which earlier pass has left the surface, all along the edges of a tool.

At a position of an edge the chip against the pass k is rise[k] sin(phi) - radial_offset[k]: the
thinnest counts, and below zero there is no cut. So every position has a list of arcs, each of them
cut out of the surface of one pass. Along the edge the arcs move smoothly as long as their list
stays the same one; where a interval of arc comes or goes it opens or closes like a root, so that an
edge is cut into segments there, and into ever smaller ones towards that position.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.engagement.immersion import slice_engagement
from cutting.engagement.uncut_band import UncutBand
from cutting.tool.cutter import Cutter

Array = NDArray[np.float64]

_REVOLUTION = 2.0 * math.pi
#: arcs shorter than this are none, rad
_SHORTEST_ARC = 1e-9
#: positions closer than this share of the edge are one
_SAME_POSITION = 1e-9
#: a change is searched to this power of two of the distance of the positions looked at
_HALVINGS = 36
#: changes between two positions that are evaluated
_MOST_CHANGES = 12
#: positions looked at within a wave of a serrated edge, and between two borders
_SAMPLES_PER_WAVELENGTH = 64
_SAMPLES = 4
#: share of the distance of two borders by which the first look is beside one
_BESIDE = 1e-6
#: segments between two changes at the relative_length 1
_SEGMENTS = 10
#: fewer by this where nothing changes
_SMOOTHER = 5
#: of a wave, between two changes: shorter ones take fewer segments
_LONG = 0.2
#: Gauss points of two on [-1, 1] lie at these
GAUSS = 1.0 / math.sqrt(3.0)


class Profile(NamedTuple):
    """Nominal edge at positions along it (P,)."""

    height: Array  # above the tip, m
    radius: Array  # m
    immersion: Array  # axial immersion angle, rad


class Arcs(NamedTuple):
    """Arcs at positions along edges: (P, W) each, in order, the rest of a row empty.

    An arc goes from its angle to the next one in the row, which ends it.
    """

    angle: Array  # at which an arc begins, or the one before it ends, rad
    tooth: NDArray[np.int64]  # that passed before and left the surface; -1 in the air
    kind: NDArray[np.int64]  # equal rows: the same arcs, bounded by the same; -1 in the rest


class Edges:
    """Edges of a tool in a cut.

    Parameters
    ----------
    cutter : Cutter
    band : UncutBand
    feed_per_revolution : float
        m.
    """

    def __init__(self, cutter: Cutter, band: UncutBand, feed_per_revolution: float) -> None:
        self.cutter, self.band = cutter, band
        self.feed_per_revolution = feed_per_revolution
        self.on_corner = cutter.corner_radius * cutter.edge_angle
        self.lag = np.tan(np.asarray(cutter.helix)) / cutter.radius
        self.start = cutter.tooth_angles
        self._radial, self._axial = cutter.radial_offsets, cutter.axial_offsets

    def profile(self, position: Array) -> Profile:
        """Nominal edge at lengths of edge beyond the tip, m."""
        cutter = self.cutter
        corner, angle = cutter.corner_radius, cutter.edge_angle
        kappa = np.full_like(position, angle)
        if corner > 0.0:
            kappa = np.minimum(position / corner, angle)
        beyond = np.maximum(position - self.on_corner, 0.0)
        height = corner * (1.0 - np.cos(kappa)) + beyond * math.sin(angle)
        across = math.cos(angle) if angle < 0.5 * math.pi else 0.0
        radius = cutter.radius - corner + corner * np.sin(np.where(corner, kappa, 0.0))
        return Profile(height, radius + beyond * across, kappa)

    def position(self, height: float) -> float:
        """Length of edge from the tip to a height, m."""
        corner, angle = self.cutter.corner_radius, self.cutter.edge_angle
        top = corner * (1.0 - math.cos(angle))
        if height < top:
            return corner * math.acos(1.0 - height / corner)
        return self.on_corner + (height - top) / math.sin(angle)

    def angle(self, height: Array) -> Array:
        """Place on the tool of every tooth (P, N), rad."""
        return self.start - np.multiply.outer(height, self.lag)

    def radial(self, height: Array) -> Array:
        """Deviation of the radius of every tooth (P, N), m."""
        out = np.repeat(self._radial[None, :], height.size, axis=0)
        wave = self.cutter.serration
        if wave is not None:
            for tooth in range(self.cutter.teeth):
                out[:, tooth] += wave.radius_change(height, tooth, self.cutter.teeth)
        return out

    def ahead(self, tooth: NDArray[np.int64], height: Array) -> Array:
        """Angle to the last pass of every tooth (P, N), rad, in (0, 2 pi]."""
        angle = self.angle(height)
        own = np.take_along_axis(angle, tooth[:, None], axis=1)
        ahead = np.mod(angle - own, _REVOLUTION)
        return np.where(ahead < 1e-9, _REVOLUTION, ahead)

    def arcs(self, tooth: NDArray[np.int64], position: Array) -> Arcs:
        """Arcs of teeth (P,) at positions (P,)."""
        profile = self.profile(position)
        sine, cosine = np.sin(profile.immersion)[:, None], np.cos(profile.immersion)[:, None]
        out = sine * self.radial(profile.height) + cosine * self._axial
        radial_offset = out - np.take_along_axis(out, tooth[:, None], axis=1)
        rise = sine * self.feed_per_revolution / _REVOLUTION * self.ahead(tooth, profile.height)
        entry, leave = slice_engagement(self.band, np.maximum(profile.radius, 1e-12))
        stock = entry < leave
        return _arcs(rise, radial_offset, np.where(stock, entry, 0.0), np.where(stock, leave, 0.0))

    def segment_borders(self, tooth: int, borders: Array, relative_length: float) -> Array:
        """Borders (L,) of the segments of a tooth, m; see the function of this name."""
        return segment_borders(self, tooth, borders, relative_length)


def _marks(rise: Array, radial_offset: Array, entry: Array, leave: Array) -> Array:
    """Angles (P, M) in order at which two chips may be alike, or one may vanish."""
    ones, others = np.triu_indices(rise.shape[1], 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        sines = np.concatenate(
            [
                radial_offset / rise,
                (radial_offset[:, ones] - radial_offset[:, others])
                / (rise[:, ones] - rise[:, others]),
            ],
            axis=1,
        )
        turns = np.arcsin(sines)  # none where there is no such angle
    turns = np.where(np.isnan(turns) | (turns < 0.0), entry[:, None], turns)
    marks = np.concatenate([entry[:, None], turns, math.pi - turns, leave[:, None]], axis=1)
    return np.sort(np.clip(marks, entry[:, None], leave[:, None]), axis=1)


def _arcs(rise: Array, radial_offset: Array, entry: Array, leave: Array) -> Arcs:
    """Arcs at P positions from the chips (P, K) against the passes and the arc of stock (P,)."""
    marks = _marks(rise, radial_offset, entry, leave)
    middle = 0.5 * (marks[:, 1:] + marks[:, :-1])
    chip = rise[:, None, :] * np.sin(middle)[:, :, None] - radial_offset[:, None, :]
    thinnest = np.argmin(chip, axis=2)
    cuts = np.take_along_axis(chip, thinnest[:, :, None], axis=2)[:, :, 0] > 0.0
    met = np.where(cuts, thinnest, -1)
    # intervals too short to be any go with what comes before them
    there = np.diff(marks, axis=1) > _SHORTEST_ARC
    last = np.maximum.accumulate(np.where(there, np.arange(there.shape[1]), -1), axis=1)
    met = np.where(last < 0, -1, np.take_along_axis(met, np.maximum(last, 0), axis=1))
    air = np.full((len(met), 1), -1)
    met = np.concatenate([air, met, air], axis=1)
    row, change = np.nonzero(met[:, 1:] != met[:, :-1])
    column = np.arange(row.size) - np.searchsorted(row, row)
    shape = marks.shape
    angle, tooth, kind = np.zeros(shape), np.full(shape, -1), np.full(shape, -1)
    at, new = marks[row, change], met[row, change + 1]
    # the border of the stock, or of two surfaces where the chip grows or where it falls
    side = np.where(at > 0.5 * math.pi, 3, 2)
    side = np.where(at <= entry[row] + _SHORTEST_ARC, 0, side)
    side = np.where(at >= leave[row] - _SHORTEST_ARC, 1, side)
    angle[row, column], tooth[row, column], kind[row, column] = at, new, 4 * (new + 1) + side
    return Arcs(angle, tooth, kind)


def _samples(borders: Array, cutter: Cutter) -> Array:
    """Places along an edge at which its arcs are evaluated, none of them on a border, m."""
    spacing = math.inf
    if cutter.serration is not None:
        spacing = cutter.serration.wavelength / _SAMPLES_PER_WAVELENGTH
    positions = []
    for low, high in itertools.pairwise(borders):
        count = max(_SAMPLES, math.ceil((high - low) / spacing))
        shares = np.concatenate([[_BESIDE], np.arange(1, count) / count, [1.0 - _BESIDE]])
        positions.append(low + (high - low) * shares)
    return np.concatenate(positions)


def _changes(edges: Edges, tooth: int, positions: Array) -> Array:
    """Places at which the list of arcs of a tooth changes, in order, m."""

    def kinds(position: Array) -> NDArray[np.int64]:
        return edges.arcs(np.full(position.size, tooth), position).kind

    found = kinds(positions)
    differ = np.any(found[1:] != found[:-1], axis=1)
    low, end = positions[:-1][differ], positions[1:][differ]
    before, after = found[:-1][differ], found[1:][differ]
    changes = [np.empty(0)]
    for _ in range(_MOST_CHANGES):
        if low.size == 0:
            break
        high = end.copy()
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            same = np.all(kinds(middle) == before, axis=1)
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        changes.append(0.5 * (low + high))
        low, before = high, kinds(high)
        more = np.any(before != after, axis=1)
        low, end, before, after = low[more], end[more], before[more], after[more]
    return np.sort(np.concatenate(changes))


def segment_borders(edges: Edges, tooth: int, borders: Array, relative_length: float) -> Array:
    """Borders of the segments of a tooth, so close that arcs vary nearly linearly between them.

    Borders (B,) are lengths of edge beyond the tip, m, between which the nominal edge is smooth;
    the relative length is 1 or less. Returned (L,), m.
    """
    changes = _changes(edges, tooth, _samples(borders, edges.cutter))
    same = _SAME_POSITION * borders[-1]
    positions = np.concatenate([changes, borders])
    marks = np.concatenate([np.ones(changes.size, dtype=bool), np.zeros(borders.size, dtype=bool)])
    order = np.argsort(positions, kind="stable")
    positions, marks = positions[order], marks[order]
    # of a border and a change at the same position the border stays, and counts as a change
    group = np.cumsum(np.append(0, np.diff(positions) > same))
    positions = np.array([positions[group == g][-1] for g in range(group[-1] + 1)])
    marks = np.array([marks[group == g].any() for g in range(group[-1] + 1)])
    count = _SEGMENTS / math.sqrt(relative_length)
    long = borders[-1]
    if edges.cutter.serration is not None:
        long = min(long, _LONG * edges.cutter.serration.wavelength)
    segments = [positions[:1]]
    for i in range(positions.size - 1):
        share = (positions[i + 1] - positions[i]) / long
        # errors of a short one matter less
        share = share**0.25 if share < 1.0 else share**0.75
        part = _graded(math.ceil(count * share), bool(marks[i]), bool(marks[i + 1]))
        segments.append(positions[i] + (positions[i + 1] - positions[i]) * part[1:])
    return np.concatenate(segments)


def _graded(count: int, low: bool, high: bool) -> Array:
    """Borders of segments on [0, 1], close together at the ends that are changes."""
    if not (low or high):
        count = max(1, count // _SMOOTHER)
    part = np.linspace(0.0, 1.0, count + 1)
    if low and high:
        return part * part * (3.0 - 2.0 * part)
    if low:
        return part * part
    return part * (2.0 - part) if high else part
