"""Surface that passing edges leave: envelope of their arcs, roughness, waviness, its place.

A wall lies at +y (`side` = +1) or -y (-1) of a tool that moves along x. Each pass of an edge cuts
an arc about the place of the tool axis at that moment; what stands behind is the furthest reach of
all passes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]

_TURN = 2.0 * math.pi
#: constant of the Gaussian filter: half of a wave of the cut-off length passes
_ALPHA = math.sqrt(math.log(2.0) / math.pi)
#: steps of the search for the moment at which an edge is at a place along the feed
_STEPS_TO_MOMENT = 2
#: longest spacing of marks and the cut-off that belongs to it, m
_CUT_OFFS = ((0.04e-3, 0.08e-3), (0.13e-3, 0.25e-3), (0.4e-3, 0.8e-3), (1.3e-3, 2.5e-3))
_LONGEST_CUT_OFF = 8e-3


class ToolMotion:
    """Place of the tool over the angle of the spindle.

    Parameters
    ----------
    spindle_angle : (n,) array of float
        Increasing, rad; n >= 4.
    place : (n, 3) array of float
        Of the tool, feed and displacement together, m.
    """

    def __init__(self, spindle_angle: Array, place: Array) -> None:
        self.first, self.last = float(spindle_angle[0]), float(spindle_angle[-1])
        self.place = np.asarray(place, dtype=np.float64)
        self.at = CubicSpline(spindle_angle, self.place, axis=0)

    def passes(self, edge_angle: Array, direction: float, margin: float) -> tuple[Array, NDArray]:
        """Spindle angles at which edges point in a direction.

        Parameters
        ----------
        edge_angle : (N,) array of float
            Of the edges on the tool, rad.
        direction : float
            Angle clockwise from +y, rad.
        margin : float
            Kept from both ends of the motion, rad.

        Returns
        -------
        angle : (P,) array of float
            Rising, rad.
        edge : (P,) array of int
            Which edge it was.
        """
        first, last = self.first + margin, self.last - margin
        found = []
        for number, angle in enumerate(edge_angle):
            start = first + np.mod(direction - angle - first, _TURN)
            moments = np.arange(start, max(last, start - 1.0), _TURN)
            found.append(np.column_stack([moments, np.full(moments.size, number)]))
        table = np.concatenate(found)
        table = table[np.argsort(table[:, 0])]
        return table[:, 0], table[:, 1].astype(int)


@dataclass(frozen=True)
class WallPasses:
    """Passes of the edges by a wall at one height of the tool.

    Parameters
    ----------
    angle : (P,) array of float
        Of the spindle when the edge points at the wall, rad.
    radius : (P,) array of float
        Of the edge that passes, m.
    radius_per_lift : float
        Change of the radius at a fixed height as the tool rises, minus the cotangent of the axial
        immersion angle; 0 for a cylinder.
    side : float
        +1 for a wall at +y, -1 for one at -y.
    """

    angle: Array
    radius: Array
    radius_per_lift: float
    side: float

    def reach_at_pass(self, motion: ToolMotion) -> tuple[Array, Array]:
        """Place x and furthest reach (P,) of every pass, m."""
        place = motion.at(self.angle)
        return place[:, 0], self.side * place[:, 1] + self._radius(self.radius, place[:, 2])

    def _radius(self, radius: Array, lift: Array) -> Array:
        return radius + self.radius_per_lift * lift


def width_of_influence(motion: ToolMotion, passes: WallPasses) -> float:
    """Distance from its middle beyond which no pass shapes the wall, m.

    An arc of radius r lies d^2/2r below its peak at a distance d; the peaks differ by no more
    than the motion and the edges do, and a gap g between passes lowers the envelope by g^2/8r.
    """
    x, reach = passes.reach_at_pass(motion)
    lift = np.ptp(motion.place[:, 2]) * abs(passes.radius_per_lift)
    spread = np.ptp(motion.place[:, 1]) + np.ptp(passes.radius) + lift
    largest = float(passes.radius.max())
    gap = float(np.diff(x).max()) if x.size > 1 else 0.0
    sway = 2.0 * np.ptp(reach) if x.size > 1 else 0.0
    drop = min(spread, sway + 0.25 * spread) + gap**2 / (8.0 * largest)
    return 1.05 * min(math.sqrt(2.0 * largest * drop), 0.5 * largest)


def wall_reach(motion: ToolMotion, passes: WallPasses, x: Array, width: float) -> Array:
    """Furthest reach of the edges towards a wall over the feed.

    Parameters
    ----------
    motion : ToolMotion
    passes : WallPasses
    x : (n,) array of float
        Evenly spaced, m.
    width : float
        As from `width_of_influence`, m.

    Returns
    -------
    (n,) array of float
        Distance of the wall from y = 0, m; -inf where no edge came by.

    Notes
    -----
    Each point is cut at the moment the edge is at its x: the tool moves while the edge passes, so
    the arcs are trochoids with the vibration on them.
    """
    spacing = x[1] - x[0]
    middle = motion.at(passes.angle)[:, 0]
    count = math.ceil(2.0 * width / spacing) + 1
    start = np.ceil((middle - width - x[0]) / spacing).astype(int)
    index = start[:, None] + np.arange(count)
    radius = np.broadcast_to(passes.radius[:, None], index.shape)
    angle = np.broadcast_to(passes.angle[:, None], index.shape)
    known = (index >= 0) & (index < x.size)
    index, radius, angle = index[known], radius[known], angle[known]
    place = np.broadcast_to(motion.at(passes.angle)[:, None, :], (*known.shape, 3))[known]
    for _ in range(_STEPS_TO_MOMENT):
        sine = (x[index] - place[:, 0]) / passes._radius(radius, place[:, 2])
        turned = passes.side * np.arcsin(np.clip(sine, -0.9, 0.9))
        place = motion.at(angle + turned)
    edge = passes._radius(radius, place[:, 2])
    ahead = np.minimum(np.abs(x[index] - place[:, 0]), edge)
    reach = np.full(x.size, -np.inf)
    np.maximum.at(reach, index, passes.side * place[:, 1] + np.sqrt(edge**2 - ahead**2))
    return reach


def floor_height(x: Array, place: Array, height: Array, corner: float, flat: float) -> Array:
    """Floor left by corners that pass over a line along the feed.

    Parameters
    ----------
    x : (n,) array of float
        m.
    place : (P,) array of float
        x of the deepest point of the corner at each pass, m.
    height : (P,) array of float
        Its height, m.
    corner : float
        Radius of the arc that a pass cuts in the plane of the feed and the axis, m; 0 for a sharp
        corner.
    flat : float
        Length behind a sharp corner over which the end of the tooth cuts, m.

    Returns
    -------
    (n,) array of float
        m; inf where nothing passed.

    Notes
    -----
    Circles of radius r a feed f apart leave cusps of f^2/(8 r).
    """
    order = np.argsort(place)
    place, height = place[order], height[order]
    half = corner if corner > 0.0 else 0.5 * flat
    middle = place if corner > 0.0 else place - half
    first = np.searchsorted(x, middle - half - 1e-12)
    last = np.searchsorted(x, middle + half, side="right")
    floor = np.full(x.size, np.inf)
    # the cusp between neighbours bounds how far an arc matters
    if corner > 0.0 and place.size > 1:
        gap = float(np.diff(place).max())
        reach = math.sqrt(2.0 * corner * np.ptp(height) + gap**2)
        first = np.maximum(first, np.searchsorted(x, middle - reach))
        last = np.minimum(last, np.searchsorted(x, middle + reach, side="right"))
    for low, high, at, z in zip(first, last, middle, height, strict=True):
        rise = 0.0
        if corner > 0.0:
            rise = corner - np.sqrt(np.maximum(corner**2 - (x[low:high] - at) ** 2, 0.0))
        floor[low:high] = np.minimum(floor[low:high], z + rise)
    return floor


@dataclass(frozen=True)
class HeightParameters:
    """Heights of a profile about its mean line after ISO 4287, m.

    Parameters
    ----------
    mean : float
        Arithmetic mean deviation, Ra or Wa.
    rms : float
        Root mean square deviation, Rq or Wq.
    depth : float
        Highest peak to deepest valley, mean over the sampling lengths: Rz or Wz.
    """

    mean: float
    rms: float
    depth: float


def height_parameters(profile: Array, samples: int) -> HeightParameters:
    """Heights of a profile about its mean.

    Parameters
    ----------
    profile : (n,) array of float
        m.
    samples : int
        Points of a sampling length; the profile counts as one if it is shorter than two.
    """
    off = profile - profile.mean()
    parts = np.array_split(off, max(1, off.size // max(samples, 1)))
    return HeightParameters(
        mean=float(np.abs(off).mean()),
        rms=float(np.sqrt(np.mean(off**2))),
        depth=float(np.mean([np.ptp(part) for part in parts])),
    )


def mean_line(profile: Array, spacing: float, cut_off: float) -> Array:
    """Waviness of a profile by the Gaussian filter of ISO 16610-21.

    Parameters
    ----------
    profile : (..., n) array of float
    spacing : float
        Between points, m.
    cut_off : float
        Wavelength of which half the amplitude passes, m.

    Returns
    -------
    (..., n) array of float
        Within half a cut-off of the ends the weights are renormed to the points that there are.
    """
    half = min(int(cut_off / spacing), profile.shape[-1] - 1)
    place = np.arange(-half, half + 1) * spacing / (_ALPHA * cut_off)
    weight = np.exp(-math.pi * place**2)
    share = np.convolve(np.ones(profile.shape[-1]), weight)[half:-half or None]
    rows = profile.reshape(-1, profile.shape[-1])
    smooth = [np.convolve(row, weight)[half:-half or None] / share for row in rows]
    return np.array(smooth).reshape(profile.shape)


def cut_off_for(mark_spacing: float) -> float:
    """Cut-off of ISO 4288 for periodic profiles with this spacing of marks, m."""
    return next((cut for most, cut in _CUT_OFFS if mark_spacing <= most), _LONGEST_CUT_OFF)


@dataclass(frozen=True)
class Texture:
    """Roughness and waviness of profiles over the feed.

    Parameters
    ----------
    roughness : HeightParameters
    waviness : HeightParameters or None
        None where the profile is shorter than two cut-offs; roughness is then unfiltered.
    cut_off : float
        m.
    length : float
        Evaluated, m.
    """

    roughness: HeightParameters
    waviness: HeightParameters | None
    cut_off: float
    length: float


def texture(profiles: Array, weight: Array, spacing: float, cut_off: float) -> Texture:
    """Split profiles into roughness and waviness.

    Parameters
    ----------
    profiles : (L, n) array of float
        m.
    weight : (L,) array of float
        Of each profile in the means that are returned.
    spacing : float
        Between points, m.
    cut_off : float
        m.
    """
    length = profiles.shape[1] * spacing
    if length < 2.0 * cut_off:
        rough = [height_parameters(row, row.size) for row in profiles]
        return Texture(_weighted(rough, weight), None, cut_off, length)
    samples, end = round(cut_off / spacing), round(0.5 * cut_off / spacing)
    kept = slice(end, profiles.shape[1] - end)
    waves = mean_line(profiles, spacing, cut_off)
    rough = [height_parameters(row[kept], samples) for row in profiles - waves]
    wavy = [height_parameters(row[kept], row.size) for row in waves]
    return Texture(
        _weighted(rough, weight), _weighted(wavy, weight), cut_off, length - 2.0 * end * spacing
    )


def _weighted(found: list[HeightParameters], weight: Array) -> HeightParameters:
    table = np.array([(one.mean, one.rms, one.depth) for one in found])
    return HeightParameters(*(float(value) for value in weight @ table / weight.sum()))


def location_error(deviation: Array, weight: Array) -> tuple[Array, float]:
    """Surface location error at each height and over the wall.

    Parameters
    ----------
    deviation : (L, n) array of float
        Of the wall beyond its nominal place, m; positive where too much was removed.
    weight : (L,) array of float

    Returns
    -------
    by_height : (L,) array of float
        Mean over the feed, m.
    mean : float
        m.
    """
    by_height = deviation.mean(axis=1)
    return by_height, float(weight @ by_height / weight.sum())
