"""Uncut work across the feed: where it begins and ends beside the tool axis.

Seen along the tool axis, y is across the feed (along x) and the teeth turn clockwise from +y. Ahead
of the tool the work fills a band along the feed; a point of an edge at radius r and angle phi is in
the cut where lower <= r cos(phi) <= upper.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MillingMode = Literal["up", "down", "slot"]
Side = Literal["+y", "-y"]


class Border(NamedTuple):
    """Border of the work along the feed, at offset + slope r where the edge has the radius r."""

    offset: float  # from the tool axis towards +y, m
    slope: float = 0.0  # 0 for a wall along the tool axis, 1 or -1 for what a pass before has left

    def at(self, radius: Array | float) -> Array | float:
        """Distance from the tool axis towards +y, m, at radii of the edge, m."""
        return self.offset + self.slope * radius

    @property
    def tangent_radius(self) -> float:
        """Radius of the edge that just touches the border, from one side or the other, m."""
        return abs(self.offset) / (1.0 + abs(self.slope))

    def radii(self, angle: Array) -> Array:
        """Radii (m), of those that there are, whose edge crosses the border at angles (n,), rad."""
        with np.errstate(divide="ignore", invalid="ignore"):
            radius = self.offset / (np.cos(angle) - self.slope)
        return radius[np.isfinite(radius) & (radius > 0.0)]


#: no border within reach of the tool
_FAR_BELOW, _FAR_ABOVE = Border(-math.inf), Border(math.inf)


class UncutBand(NamedTuple):
    """Band of uncut work across the feed."""

    lower: Border = _FAR_BELOW
    upper: Border = _FAR_ABOVE

    @property
    def borders(self) -> tuple[Border, ...]:
        """Borders that are anywhere."""
        return tuple(border for border in self if math.isfinite(border.offset))

    def width(self, radius: Array | float) -> Array:
        """Width that an edge of a radius (m) sweeps of the band, m, seen along the feed."""
        radius = np.asarray(radius, dtype=np.float64)
        high = np.minimum(self.upper.at(radius), radius)
        return np.maximum(high - np.maximum(self.lower.at(radius), -radius), 0.0)

    def middle(self, radius: float) -> float:
        """Middle of what an edge of a radius (m) sweeps of the band, m, towards +y."""
        return 0.5 * (min(self.upper.at(radius), radius) + max(self.lower.at(radius), -radius))

    def walls(self, radius: float) -> tuple[Side, ...]:
        """Sides on which a tool of a radius (m) leaves a wall, as the work goes on beyond it."""
        sides: list[Side] = []
        if self.upper.at(radius) > radius * (1.0 + 1e-9):
            sides.append("+y")
        if self.lower.at(radius) < -radius * (1.0 + 1e-9):
            sides.append("-y")
        return tuple(sides)

    @property
    def side(self) -> int:
        """1 where the band lies beyond the axis towards +y, -1 towards -y, 0 where it holds it.

        An edge that just reaches the band cuts at that side: at the angle 0 or pi.
        """
        if self.lower.slope == 0.0 and self.lower.offset > 0.0:
            return 1
        return -1 if self.upper.slope == 0.0 and self.upper.offset < 0.0 else 0


SLOT = UncutBand()


def band_beside_wall(mode: MillingMode, radial_depth: float, tool_radius: float) -> UncutBand:
    """Band of a peripheral cut: the work ends R - a_e from the tool axis, at every height.

    Parameters
    ----------
    mode : {"up", "down", "slot"}
        Up-milling starts with zero chip thickness, down-milling ends with it.
    radial_depth, tool_radius : float
        m; not used for a slot.

    Raises
    ------
    ValueError
        If the radial depth is not in (0, 2 R] or the mode is unknown.
    """
    if mode == "slot":
        return SLOT
    if not 0.0 < radial_depth <= 2.0 * tool_radius:
        raise ValueError(
            f"radial depth {radial_depth * 1e3:g} mm is not within (0, diameter = "
            f"{tool_radius * 2e3:g} mm]"
        )
    wall = tool_radius - radial_depth
    if mode == "up":
        return UncutBand(lower=Border(wall))
    if mode == "down":
        return UncutBand(upper=Border(-wall))
    raise ValueError(f'milling mode "{mode}" is not one of "up", "down", "slot"')


def band_beside_pass(mode: Literal["up", "down"], stepover: float) -> UncutBand:
    """Band that a straight pass of the same tool, a stepover (m) beside this one, has left.

    The pass before was at the same height; at a height where the edge has the radius r it has
    reached to r - stepover from this axis.
    """
    if mode == "up":
        return UncutBand(lower=Border(-stepover, 1.0))
    return UncutBand(upper=Border(stepover, -1.0))


def band_of_workpiece(width: float, tool_offset: float) -> UncutBand:
    """Band of a workpiece narrower than the tool, or not.

    Width and offset of the tool axis from the middle of the workpiece, towards +y, in m.
    """
    return UncutBand(Border(-tool_offset - 0.5 * width), Border(-tool_offset + 0.5 * width))


def band_between_angles(entry: float, leave: float, tool_radius: float) -> UncutBand:
    """Band that the full radius (m) of a tool enters and leaves at two angles (rad)."""
    lower = Border(tool_radius * math.cos(leave)) if leave < math.pi else _FAR_BELOW
    upper = Border(tool_radius * math.cos(entry)) if entry > 0.0 else _FAR_ABOVE
    return UncutBand(lower, upper)
