"""Uncut work about a tool whose axis is inclined: which points of its edges stand in it.

Seen in the axes of the cut (x along the feed, z normal to the finished surface) the axis points
along (sin lead, cos lead sin tilt, cos lead cos tilt): it leans by the lead towards the feed and by
the tilt towards +y. In the axes of the tool, which turn with lead and tilt but not with the
spindle, edges are what they are on an upright tool; the feed has the direction (cos lead, 0,
sin lead) there. A point of an edge is in the cut where it lies ahead of what the tool has swept
(its outward normal points along the feed), below the uncut surface, and beside what the pass before
has left. The tool is convex, so that nothing else has been swept before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.tool.cutter import Cutter, corner_height

Array = NDArray[np.float64]

#: normals for which the outline of the tool seen along the feed is taken: chords of a circle of
#: 10 mm lie 1 nm off it
_NORMALS = 4000
#: shank above the corner that belongs to the outline, in diameters
_SHANK = 50.0


class ToolAxis(NamedTuple):
    """Inclination of the tool axis against the normal of the surface, rad."""

    lead: float = 0.0  # towards the feed, +x
    tilt: float = 0.0  # towards +y

    @property
    def frame(self) -> Array:
        """Axes of the tool as columns (3, 3) in those of the cut."""
        sl, cl = math.sin(self.lead), math.cos(self.lead)
        st, ct = math.sin(self.tilt), math.cos(self.tilt)
        return np.array([[cl, 0.0, sl], [-sl * st, ct, cl * st], [-sl * ct, -st, cl * ct]])

    @property
    def direction(self) -> Array:
        """Unit vector (3,) from the tip towards the shank."""
        return self.frame[:, 2]


@dataclass(frozen=True)
class InclinedEngagement:
    """Uncut work about a convex tool with an inclined axis.

    Parameters
    ----------
    cutter : Cutter
        Its edge stands steeper than the axis leans: the lowest point lies on its corner or end.
    axis : ToolAxis
    axial_depth : float
        From the uncut surface down to the lowest point of the tool, m.
    side : {"up", "down", "slot"}
        Where the uncut work lies: towards +y, -y, or all around.
    stepover : float, optional
        From the pass before, of the same tool at the same height, m.
    radial_depth : float, optional
        From a wall along the feed and z to the outermost point of the corner across the feed, m.

    Notes
    -----
    Lengths are from the tip of the tool, which lies on its axis.
    """

    cutter: Cutter
    axis: ToolAxis
    axial_depth: float
    side: Literal["up", "down", "slot"]
    stepover: float | None = None
    radial_depth: float | None = None

    @cached_property
    def frame(self) -> Array:
        """Axes of the tool as columns (3, 3) in those of the cut."""
        return self.axis.frame

    @property
    def along_feed(self) -> float:
        """Part of the feed across the tool axis."""
        return math.cos(self.axis.lead)

    @property
    def along_axis(self) -> float:
        """Part of the feed along the tool axis, towards the shank."""
        return math.sin(self.axis.lead)

    @property
    def _outwards(self) -> float:
        return -1.0 if self.side == "down" else 1.0

    @property
    def side_of_work(self) -> float:
        """Sign of y on which the work lies; 0 where it lies on both."""
        return self._outwards if self._is_bounded else 0.0

    @property
    def _is_bounded(self) -> bool:
        given = self.stepover is not None or self.radial_depth is not None
        return given and self.side != "slot"

    @cached_property
    def beside(self) -> tuple[Array, Array]:
        """Heights (m,) in order and where, outwards, what lies beside the cut ends there, m."""
        if not self._is_bounded:
            return np.zeros(1), np.zeros(1)
        if self.stepover is None:
            return np.zeros(1), np.array([self._outermost - (self.radial_depth or 0.0)])
        reach, rise = self.outline
        return rise, self._outwards * reach - self.stepover

    def _outline_points(self, slope: Array) -> tuple[Array, Array]:
        """Outermost points (y, z), m, of the tool whose normals rise by angles from -z, rad.

        Towards +y, for angles above 0; the point of a convex body furthest along the normal.
        """
        cutter, (_, across, up) = self.cutter, self.axis.direction
        normal = np.stack([np.zeros_like(slope), np.sin(slope), -np.cos(slope)])
        along = across * normal[1] + up * normal[2]
        radial = np.sqrt(np.maximum(1.0 - along**2, 1e-24))
        rising = np.arctan2(radial, -along)
        kappa = np.minimum(rising, cutter.edge_angle)
        corner, shank = cutter.corner_radius, _SHANK * cutter.diameter
        on_shank = rising > cutter.edge_angle
        radius = cutter.radius - corner + corner * np.sin(kappa)
        radius = np.where(on_shank, cutter.radius_at(shank), radius)
        height = np.where(on_shank, shank, corner * (1.0 - np.cos(kappa)))
        away = radius / radial
        y = away * (normal[1] - along * across) + height * across
        z = away * (normal[2] - along * up) + height * up
        return y, z

    @cached_property
    def floor(self) -> float:
        """Height of the lowest point of the tool, m, relative to its tip along z: not above 0."""
        return float(self._outline_points(np.array([0.0]))[1][0])

    @cached_property
    def outline(self) -> tuple[Array, Array]:
        """Reach (n,) of the tool towards the uncut side, m, at rising heights z (n,), m."""
        slope = self._outwards * math.pi * (np.arange(_NORMALS) + 0.5) / _NORMALS
        y, z = self._outline_points(slope)
        rising = np.append(True, np.diff(np.maximum.accumulate(z)) > 0.0)
        return y[rising], z[rising]

    @property
    def width(self) -> float:
        """Width of what the tool cuts, m, seen along the feed at the uncut surface."""
        other: Literal["up", "down"] = "up" if self.side == "down" else "down"
        sides = self.outline, replace(self, side=other).outline
        surface = self.floor + self.axial_depth
        ends = [float(np.interp(surface, rise, reach)) for reach, rise in sides]
        whole = abs(ends[0] - ends[1])
        if self.side == "slot":
            return whole
        if self.stepover is not None:
            return min(self.stepover, whole)
        wall = self._outermost - (self.radial_depth or 0.0)
        return min(max(self._outwards * ends[0] - wall, 0.0), whole)

    @property
    def top(self) -> float:
        """Height along the axis, m, above which no edge reaches down into the cut.

        Of the cone, or cylinder, that holds the tool; its widening counts as well. Infinite where
        the flank of a taper lies down on the work.
        """
        cutter, up = self.cutter, float(self.axis.direction[2])
        lean = math.sqrt(max(1.0 - up * up, 0.0))
        widening = 1.0 / math.tan(cutter.edge_angle) if cutter.edge_angle < 0.5 * math.pi else 0.0
        foot = cutter.radius - cutter.corner_radius * (1.0 - math.sin(cutter.edge_angle))
        foot -= widening * corner_height(cutter)
        rise = up - widening * lean
        return (self.floor + self.axial_depth + foot * lean) / rise if rise > 0.0 else math.inf

    def position(self, height: Array, radius: Array, angle: Array) -> tuple[Array, Array]:
        """Position across the feed and along z, m, of points of edges at angles about the axis."""
        x, y = radius * np.sin(angle), radius * np.cos(angle)
        frame = self.frame
        return (
            frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * height,
            frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * height,
        )

    def below_surface(self, z: Array) -> Array:
        """Distance of heights z below the uncut surface, m; below zero in the air."""
        return self.floor + self.axial_depth - z

    def beside_pass(self, y: Array, z: Array) -> Array:
        """Distance, m, of points from what lies beside the cut; below zero in the air."""
        if not self._is_bounded:
            return np.ones_like(y)
        return self._outwards * y - np.interp(z, *self.beside)

    @property
    def _outermost(self) -> float:
        """Reach of the corner across the feed, m, towards the uncut side."""
        cutter, across = self.cutter, float(self.axis.direction[1])
        corner = cutter.corner_radius
        wide = (cutter.radius - corner) * math.sqrt(1.0 - across * across) + corner
        return self._outwards * corner * across + wide

    def ahead(self, immersion: Array, angle: Array) -> Array:
        """Chip over the feed, 1: outward normal of an edge along the feed.

        By the axial immersion angle and the angle about the axis, rad.
        """
        in_plane = np.sin(immersion) * self.along_feed * np.sin(angle)
        return in_plane - np.cos(immersion) * self.along_axis

    @property
    def floor_point(self) -> tuple[float, float]:
        """Angle about the axis and axial immersion, rad, of the lowest point of the tool."""
        down = -self.frame[2]
        return math.atan2(down[0], down[1]), math.acos(max(-1.0, min(1.0, -down[2])))
