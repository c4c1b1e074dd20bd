"""Heights between which an edge is cut into slices, graded over what of it is engaged.

Within a slice the lag, the normal of the edge and the angles of entry and exit are taken as linear,
so a slice is as high as each of them allows.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cutting.engagement.immersion import slice_engagement
from cutting.engagement.uncut_band import UncutBand
from cutting.tool.cutter import Cutter, corner_height

#: points at which a part of the edge is looked at
_POINTS = 600
#: arc of an edge that only rounding brings into the cut, rad
_LEAST_ARC = 1e-6
#: slices that only rounding asks for
_ROUNDING = 1e-9
#: heights kept: one geometry a run of a few dozen, before and after a change
_KEPT = 128
#: an edge that is engaged over less than this share of the depth is not
_LEAST_SHARE = 1e-9


@dataclass(frozen=True)
class SliceLimits:
    """What may change within a slice.

    Parameters
    ----------
    lag : float
        Of the upper end behind the lower one, rad.
    tilt : float
        Of the normal of the edge, rad.
    arc : float
        Of the angle in the cut, as a share of the largest one.
    wavelength : float
        Of the waves of a serrated edge, as a share of theirs.
    """

    lag: float
    tilt: float
    arc: float
    wavelength: float = 1.0 / 16.0

    def refined(self, factor: float) -> SliceLimits:
        """Limits times a factor."""
        lag, tilt, arc, wavelength = (
            factor * one for one in (self.lag, self.tilt, self.arc, self.wavelength)
        )
        return SliceLimits(lag, tilt, arc, wavelength)


def slice_bounds(
    cutter: Cutter,
    depth: float,
    band: UncutBand | None,
    limits: SliceLimits,
    count: int | None = None,
    borders: Sequence[float] = (),
) -> NDArray[np.float64]:
    """Heights between which the slices of an edge lie.

    Parameters
    ----------
    cutter : Cutter
    depth : float
        Axial depth, m.
    band : UncutBand or None
        Uncut work; None where it may be anywhere.
    limits : SliceLimits
    count : int, optional
        Slices of what is engaged; by default they follow from the limits.
    borders : sequence of float
        Heights that no slice reaches across, m.

    Returns
    -------
    (L + 1,) array of float
        Rising from 0 to the depth, m; what lies lower than the engaged part is one slice.
    """
    return _slice_bounds(cutter, depth, band, limits, count, tuple(borders)).copy()


@lru_cache(_KEPT)
def _slice_bounds(
    cutter: Cutter,
    depth: float,
    band: UncutBand | None,
    limits: SliceLimits,
    count: int | None,
    borders: tuple[float, ...],
) -> NDArray[np.float64]:
    """Heights of `slice_bounds`, which a fit of forces asks for again and again."""
    knots = _knots(cutter, depth, band, borders)
    parts = [_Part(cutter, low, high, band, limits) for low, high in itertools.pairwise(knots)]
    needed = np.array([part.slices for part in parts])
    if count is not None:
        # what needs none at all is shared by its height
        share = needed if needed.any() else np.diff(knots)
        needed = share * count / share.sum()
    bounds = [np.zeros(1)]
    for part, slices in zip(parts, needed, strict=True):
        bounds.append(part.bounds(max(1, math.ceil(slices - _ROUNDING)))[1:])
    return np.concatenate(bounds)


def _knots(
    cutter: Cutter, depth: float, band: UncutBand | None, borders: Sequence[float]
) -> list[float]:
    """Heights at which something about the edge changes its kind, m."""
    knots = [0.0, depth]
    top = corner_height(cutter)
    between = [top, *borders]
    if band is not None:
        between += [_height_of(cutter, border.tangent_radius) for border in band.borders]
    near = _LEAST_SHARE * depth
    for height in sorted(between):
        if all(abs(height - knot) > near for knot in knots) and 0.0 < height < depth:
            knots.append(height)
    return sorted(knots)


def _height_of(cutter: Cutter, radius: float) -> float:
    """Height at which the edge has a radius, m; below zero where it is wider everywhere."""
    corner, angle = cutter.corner_radius, cutter.edge_angle
    start = cutter.radius - corner
    if radius <= start:
        return -1.0
    if radius <= start + corner * math.sin(angle):
        # rounding may take it beyond 1 at the full radius
        sine = min(1.0, (radius - start) / corner)
        return corner * (1.0 - math.sqrt(1.0 - sine * sine))
    if angle >= 0.5 * math.pi - 1e-9:
        return math.inf
    beyond = radius - start - corner * math.sin(angle)
    return corner_height(cutter) + beyond * math.tan(angle)


class _Part:
    """Part of an edge of one kind, from a height to another, and the slices it needs."""

    def __init__(
        self, cutter: Cutter, low: float, high: float, band: UncutBand | None, limits: SliceLimits
    ) -> None:
        self._low, self._high = low, high
        on_corner = high <= corner_height(cutter) * (1.0 + _LEAST_SHARE)
        # close at the lower end, where the arc of an edge that just touches grows as a root
        share = np.linspace(0.0, 1.0, _POINTS + 1) ** 2
        if on_corner:
            corner = cutter.corner_radius
            ends = [math.acos(1.0 - height / corner) for height in (low, min(high, corner))]
            tilted = ends[0] + share * (ends[1] - ends[0])
            self._height = corner * (1.0 - np.cos(tilted))
            radius = cutter.radius - corner + corner * np.sin(tilted)
        else:
            tilted = np.zeros_like(share)
            self._height = low + share * (high - low)
            start = cutter.radius - cutter.corner_radius * (1.0 - math.sin(cutter.edge_angle))
            radius = start + (self._height - corner_height(cutter)) / math.tan(cutter.edge_angle)
        lag = max(abs(math.tan(helix)) for helix in cutter.helix) / cutter.radius
        needed = [np.diff(self._height) * lag / limits.lag, np.diff(tilted) / limits.tilt]
        if band is not None and band.borders:
            entry, leave = slice_engagement(band, radius)
            arc = np.where(entry < leave, leave - entry, 0.0)
            if arc.max() <= _LEAST_ARC:
                # never in the cut but for rounding
                needed = []
            else:
                needed.append(np.abs(np.diff(arc)) / (limits.arc * arc.max()))
        if cutter.serration is not None:
            needed.append(np.diff(self._height) / cutter.serration.wavelength / limits.wavelength)
        every = np.max(needed, axis=0) if needed else np.zeros(_POINTS)
        self._needed = np.concatenate([[0.0], np.cumsum(every)])

    @property
    def slices(self) -> float:
        """Slices that are needed, also in part."""
        return float(self._needed[-1])

    def bounds(self, count: int) -> NDArray[np.float64]:
        """Heights (count + 1,) that share the slices that are needed evenly, m."""
        if self.slices == 0.0:
            return np.linspace(self._low, self._high, count + 1)
        at = np.linspace(0.0, self.slices, count + 1)
        heights = np.interp(at, self._needed, self._height)
        heights[0], heights[-1] = self._low, self._high
        return heights
