"""Tool geometry: teeth around the axis, and their edges cut into slices along it."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

#: an edge may trail by this much within a slice, rad: the error goes with its square over 24
_LARGEST_SLICE_LAG = 0.1
#: a curved profile turns by at most this within a slice, rad
_LARGEST_SLICE_TURN = math.radians(5.0)
#: Gauss points of order 2 lie at this share of half the height of a slice
GAUSS_POINT = 1.0 / math.sqrt(3.0)
#: slices within one wave of a serrated edge
_SLICES_A_WAVE = 16
#: heights within this share of the depth are one
_SAME_HEIGHT = 1e-9
#: tools that are kept cut into slices: the runs of a measurement, once with each of two tools
_KEPT = 32


@dataclass(frozen=True)
class Serration:
    """Sinusoidal wave of the edge along the axis, shifted from tooth to tooth by 1/N of a wave."""

    depth: float  # crest to valley, m
    wavelength: float  # m

    def radius_change(self, height: NDArray[np.float64], tooth: int, teeth: int) -> NDArray:
        """Return the change of the radius, m, zero at a crest and -depth in a valley."""
        phase = 2.0 * math.pi * (height / self.wavelength + tooth / teeth)
        return 0.5 * self.depth * (np.cos(phase) - 1.0)


@dataclass(frozen=True)
class Cutter:
    """A milling tool; lengths in m, angles in rad.

    Parameters
    ----------
    diameter : float
        At the tip, where the profile is a cone or has a corner: of the cylinder that the corner
        blends into.
    helix : tuple of float
        One for each tooth; a point at height z trails the tip by z tan(helix)/R.
    pitch : tuple of float
        Angle from each tooth to the next one; they make a turn.
    corner_radius : float
        0 for a sharp corner, half the diameter for a ball.
    edge_angle : float
        Angle between the axis and the normal of the straight part of the edge: pi/2 for a
        cylinder, less for a taper or a face mill with a lead angle.
    runout_offset, runout_angle : float
        The axis of the teeth lies off the spindle axis by the offset, in the direction `angle`
        of the tool.
    radial_error, axial_error : tuple of float
        Of each tooth; positive is further out and further down; empty for none.
    serration : Serration, optional
    """

    diameter: float
    helix: tuple[float, ...]
    pitch: tuple[float, ...]
    corner_radius: float = 0.0
    edge_angle: float = 0.5 * math.pi
    runout_offset: float = 0.0
    runout_angle: float = 0.0
    radial_error: tuple[float, ...] = ()
    axial_error: tuple[float, ...] = ()
    serration: Serration | None = None

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return len(self.pitch)

    @property
    def radius(self) -> float:
        """Half the diameter, m."""
        return 0.5 * self.diameter

    @property
    def is_cylindrical(self) -> bool:
        """Whether the edge lies on a cylinder down to the tip: no corner, no cone."""
        return self.corner_radius == 0.0 and self.edge_angle >= 0.5 * math.pi - 1e-9

    def radius_at(self, height: float) -> float:
        """Radius of the nominal edge at a height above the tip, m; for a ball sqrt(h (D - h))."""
        arc = self.corner_radius * (1.0 - math.cos(self.edge_angle))
        if height < arc:
            drop = self.corner_radius - height
            return self.radius - self.corner_radius + math.sqrt(self.corner_radius**2 - drop**2)
        slope = 1.0 / math.tan(self.edge_angle) if self.edge_angle < 0.5 * math.pi else 0.0
        foot = self.radius - self.corner_radius * (1.0 - math.sin(self.edge_angle))
        return foot + slope * (height - arc)

    @property
    def tooth_angles(self) -> NDArray[np.float64]:
        """Angle (N,) of each tooth on the tool, rad; zero for the first."""
        return np.concatenate([[0.0], np.cumsum(self.pitch)[:-1]])

    @property
    def radial_offsets(self) -> NDArray[np.float64]:
        """Deviation (N,) of the radius of each tooth by runout and setting error, m."""
        runout = self.runout_offset * np.cos(self.runout_angle - self.tooth_angles)
        return runout + self._each(self.radial_error)

    @property
    def axial_offsets(self) -> NDArray[np.float64]:
        """Deviation (N,) of each tooth along the axis, m; positive reaches deeper."""
        return self._each(self.axial_error)

    def _each(self, given: tuple[float, ...]) -> NDArray[np.float64]:
        return np.asarray(given, dtype=np.float64) if given else np.zeros(self.teeth)


@dataclass(frozen=True, eq=False)
class EdgeSlices:
    """Edges of a tool cut into L slices along the axis, for N teeth."""

    height: NDArray[np.float64]  # (L,), of the middle of the slice above the tip, m
    thickness: NDArray[np.float64]  # (L,), along the axis, m
    radius: NDArray[np.float64]  # (L,), of the nominal edge, m
    #: (L,), axial immersion angle: between the axis and the normal of the edge, rad
    immersion: NDArray[np.float64]
    edge_length: NDArray[np.float64]  # (L,), length of edge in the plane of its profile, m
    angle: NDArray[np.float64]  # (N, L), of the middle of the slice on the tool, rad
    lag: NDArray[np.float64]  # (N, L), by which the upper end trails the lower one, rad
    #: (N, L), deviation of the edge from its nominal place along its normal, outwards, m
    normal_offset: NDArray[np.float64]
    #: (N, L), by which it grows up to the upper end as the normal tilts, m
    offset_rise: NDArray[np.float64]
    #: (L,), by which the normal tilts from the lower end of the slice to the upper one, rad
    tilt: NDArray[np.float64]
    lower_radius: NDArray[np.float64]  # (L,), of the nominal edge at the lower Gauss point, m
    upper_radius: NDArray[np.float64]  # (L,), at the upper Gauss point, m


Part = tuple[NDArray[np.float64], ...]


def _corner(cutter: Cutter, bounds: NDArray[np.float64]) -> Part:
    """Slices of the corner arc between axial immersion angles, rad."""
    corner = cutter.corner_radius
    middle = 0.5 * (bounds[1:] + bounds[:-1])
    height = corner * (1.0 - np.cos(middle))
    thickness = corner * -np.diff(np.cos(bounds))
    start = cutter.radius - corner
    radius = start + corner * np.sin(middle)
    tilt = np.diff(bounds)
    lower, upper = (
        start + corner * np.sin(middle + side * 0.5 * tilt) for side in (-GAUSS_POINT, GAUSS_POINT)
    )
    return height, thickness, radius, middle, corner * tilt, tilt, lower, upper


def _straight(cutter: Cutter, bounds: NDArray[np.float64]) -> Part:
    """Slices of the straight part of the edge between heights, m."""
    middle = 0.5 * (bounds[1:] + bounds[:-1])
    thickness = np.diff(bounds)
    slope = 1.0 / math.tan(cutter.edge_angle) if cutter.edge_angle < 0.5 * math.pi else 0.0
    start = cutter.radius - cutter.corner_radius * (1.0 - math.sin(cutter.edge_angle))
    radius = start + slope * (middle - corner_height(cutter))
    rise = 0.5 * GAUSS_POINT * slope * thickness
    immersion = np.full(middle.size, cutter.edge_angle)
    length = thickness / math.sin(cutter.edge_angle)
    tilt = np.zeros(middle.size)
    return middle, thickness, radius, immersion, length, tilt, radius - rise, radius + rise


def corner_height(cutter: Cutter) -> float:
    """Height at which the corner arc runs into the straight edge, m."""
    return cutter.corner_radius * (1.0 - math.cos(cutter.edge_angle))


def slice_counts(
    cutter: Cutter, depth: float, largest_lag: float = _LARGEST_SLICE_LAG
) -> tuple[int, int]:
    """Slices of the corner and of the straight edge that resolve lag, curvature and waves.

    Down to an axial depth, m, with a largest lag within a slice, rad.
    """
    arc_top = min(depth, corner_height(cutter))
    lag_per_height = max(abs(math.tan(helix)) for helix in cutter.helix) / cutter.radius
    wave = cutter.serration.wavelength / _SLICES_A_WAVE if cutter.serration else math.inf

    def count(height: float) -> int:
        return max(math.ceil(height * lag_per_height / largest_lag), math.ceil(height / wave))

    corner = 0
    if arc_top > 0.0:
        turn = math.acos(1.0 - arc_top / cutter.corner_radius)
        corner = max(math.ceil(turn / _LARGEST_SLICE_TURN), count(arc_top))
    straight = max(1, count(depth - arc_top)) if depth > arc_top else 0
    return corner, straight


def edge_slices(cutter: Cutter, depth: float, counts: tuple[int, int]) -> EdgeSlices:
    """Cut the edges of a tool into slices from the tip to an axial depth.

    Depth in m; counts as from `slice_counts`. Geometry of the general cutter after Engin and
    Altintas 2001, Int. J. Mach. Tools Manuf. 41, section 2, with constant lead: the lag is z
    tan(helix)/R at every height.
    """
    corner, straight = counts
    arc_top = min(depth, corner_height(cutter))
    parts: list[Part] = []
    if corner:
        last = math.acos(1.0 - arc_top / cutter.corner_radius)
        parts.append(_corner(cutter, np.linspace(0.0, last, corner + 1)))
    if straight:
        parts.append(_straight(cutter, np.linspace(arc_top, depth, straight + 1)))
    return _of_parts(cutter, parts)


def slices_between(cutter: Cutter, bounds: NDArray[np.float64]) -> EdgeSlices:
    """Cut the edges of a tool into slices between heights.

    Parameters
    ----------
    cutter : Cutter
    bounds : (L + 1,) array of float
        Heights above the tip in rising order, m; that at which a corner runs into the straight
        edge is one of them where it lies between the first and the last.

    Returns
    -------
    EdgeSlices
    """
    return _slices_between(cutter, tuple(bounds.tolist()))


@lru_cache(_KEPT)
def _slices_between(cutter: Cutter, heights: tuple[float, ...]) -> EdgeSlices:
    """Slices of a tool that is often set up again with another force law or structure."""
    bounds = np.array(heights)
    top = corner_height(cutter)
    near = _SAME_HEIGHT * bounds[-1]
    parts: list[Part] = []
    corner, straight = bounds[bounds <= top + near], bounds[bounds >= top - near]
    if corner.size > 1:
        cosine = 1.0 - np.minimum(corner, top) / cutter.corner_radius
        parts.append(_corner(cutter, np.arccos(cosine)))
    if straight.size > 1:
        parts.append(_straight(cutter, straight))
    return _of_parts(cutter, parts)


def _of_parts(cutter: Cutter, parts: list[Part]) -> EdgeSlices:
    """Slices of all teeth from those of corner and straight edge."""
    height, thickness, radius, immersion, length, tilt, lower, upper = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    lag_per_height = np.tan(np.asarray(cutter.helix)) / cutter.radius
    # the wave of a serrated edge stays that of the middle: teeth then share the chip exactly
    below, above = (
        _normal_offset(cutter, height, immersion + side * GAUSS_POINT * tilt)
        for side in (-0.5, 0.5)
    )
    return EdgeSlices(
        height=height,
        thickness=thickness,
        radius=radius,
        immersion=immersion,
        edge_length=length,
        angle=cutter.tooth_angles[:, None] - np.outer(lag_per_height, height),
        lag=np.outer(lag_per_height, thickness),
        normal_offset=_normal_offset(cutter, height, immersion),
        offset_rise=(above - below) / GAUSS_POINT,
        tilt=tilt,
        lower_radius=lower,
        upper_radius=upper,
    )


def _normal_offset(
    cutter: Cutter, height: NDArray[np.float64], immersion: NDArray[np.float64]
) -> NDArray[np.float64]:
    radial = np.repeat(cutter.radial_offsets[:, None], height.size, axis=1)
    if cutter.serration is not None:
        radial += np.array(
            [
                cutter.serration.radius_change(height, tooth, cutter.teeth)
                for tooth in range(cutter.teeth)
            ]
        )
    return radial * np.sin(immersion) + np.outer(cutter.axial_offsets, np.cos(immersion))
