"""Surface that passing edges leave: the envelope of their arcs.

A wall lies at +y (`side` = +1) or -y (-1) of a tool that moves along x. Each pass of an edge cuts
an arc about the tool axis at that moment; what stands behind is the furthest reach of
all passes.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutting.cubic_spline import CubicSpline

Array = NDArray[np.float64]

_TURN = 2.0 * math.pi
#: steps of the search for the moment at which an edge is at a position along the feed
_STEPS_TO_MOMENT = 2
#: angle from the wall beyond which no edge is looked at, rad
_WIDEST_TURN = 0.6


class ToolMotion:
    """Place of the tool over the angle of the spindle.

    Parameters
    ----------
    spindle_angle : (n,) array of float
        Increasing, rad; n >= 4.
    position : (n, 3) array of float
        Of the tool, feed and displacement together, m.
    """

    def __init__(self, spindle_angle: Array, position: Array) -> None:
        self.first, self.last = float(spindle_angle[0]), float(spindle_angle[-1])
        self.position = np.asarray(position, dtype=np.float64)
        self.at = CubicSpline(spindle_angle, self.position)

    def passes(self, edge_angle: Array, direction: float, margin: float) -> tuple[Array, NDArray]:
        """Spindle angles at which edges point in a direction.

        Edges are at angles (N,) on the tool, rad; the direction is clockwise from +y, rad; the
        margin, rad, is kept from both ends of the motion. Returns the angles (P,), rising, rad, and
        which edge (P,) it was at each.
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
    """Passes of the edges by a wall at one height of the tool."""

    angle: Array  # (P,), of the spindle when the edge points at the wall, rad
    radius: Array  # (P,), of the edge that passes, m
    #: change of the radius at a fixed height as the tool rises, minus the cotangent of the axial
    #: immersion angle; 0 for a cylinder
    radius_per_lift: float
    side: float  # +1 for a wall at +y, -1 for one at -y

    def reach_at_pass(self, motion: ToolMotion) -> tuple[Array, Array]:
        """Place x and furthest reach (P,) of every pass, m."""
        position = motion.at(self.angle)
        return position[:, 0], self.side * position[:, 1] + self.edge(self.radius, position[:, 2])

    def edge(self, radius: Array, lift: Array) -> Array:
        """Radius at a fixed height of an edge of this radius on a tool that has risen, m."""
        return radius + self.radius_per_lift * lift


def width_of_influence(motion: ToolMotion, passes: WallPasses) -> float:
    """Distance from its middle beyond which no pass shapes the wall, m.

    Between two passes a gap g apart the wall is at most g^2/8r below the lower one of them; an
    edge matters as long as it may reach that far while it turns away from the wall.
    """
    x, reach = passes.reach_at_pass(motion)
    gap = float(np.diff(x).max()) if x.size > 1 else 0.0
    lowest = reach.min() - gap**2 / (8.0 * passes.radius.min())
    turned = np.linspace(-_WIDEST_TURN, _WIDEST_TURN, 121)
    position = motion.at(passes.angle[:, None] + turned)
    edge = passes.edge(passes.radius[:, None], position[..., 2])
    highest = (passes.side * position[..., 1] + edge * np.cos(turned)).max(axis=0)
    matters = np.abs(turned[highest > lowest])
    widest = matters.max(initial=0.0) + turned[1] - turned[0]
    return max(float(passes.radius.max()) * math.sin(widest), 0.55 * gap)


def wall_reach(motion: ToolMotion, passes: WallPasses, x: Array, width: float) -> Array:
    """Furthest reach of the edges towards a wall over the feed.

    At evenly spaced x (n,), m, with the width of `width_of_influence`, m: distance of the wall from
    y = 0 (n,), m; -inf where no edge came by. Each point is cut at the moment the edge is at its x:
    the tool moves while the edge passes, so the arcs are trochoids with the vibration on them.
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
    position = np.broadcast_to(motion.at(passes.angle)[:, None, :], (*known.shape, 3))[known]
    for _ in range(_STEPS_TO_MOMENT):
        sine = (x[index] - position[:, 0]) / passes.edge(radius, position[:, 2])
        turned = passes.side * np.arcsin(np.clip(sine, -0.9, 0.9))
        position = motion.at(angle + turned)
    edge = passes.edge(radius, position[:, 2])
    ahead = np.minimum(np.abs(x[index] - position[:, 0]), edge)
    reach = np.full(x.size, -np.inf)
    np.maximum.at(reach, index, passes.side * position[:, 1] + np.sqrt(edge**2 - ahead**2))
    return reach


def floor_height(x: Array, position: Array, height: Array, corner: float, flat: float) -> Array:
    """Floor left by corners that pass over a line along the feed.

    At x (n,), m, after passes (P,) with the deepest point of the corner at a position and height,
    m. `corner` is the radius of the arc that a pass cuts in the plane of the feed and the axis, m,
    0 for a sharp corner, `flat` the length behind a sharp corner over which the end of the tooth
    cuts, m. (n,), m; inf where nothing passed. Circles of radius r a feed f apart leave cusps of
    f^2/(8 r).
    """
    order = np.argsort(position)
    position, height = position[order], height[order]
    half = corner if corner > 0.0 else 0.5 * flat
    middle = position if corner > 0.0 else position - half
    first = np.searchsorted(x, middle - half - 1e-12)
    last = np.searchsorted(x, middle + half, side="right")
    floor = np.full(x.size, np.inf)
    # the cusp between neighbours bounds how far an arc matters
    if corner > 0.0 and position.size > 1:
        gap = float(np.diff(position).max())
        reach = math.sqrt(2.0 * corner * np.ptp(height) + gap**2)
        first = np.maximum(first, np.searchsorted(x, middle - reach))
        last = np.minimum(last, np.searchsorted(x, middle + reach, side="right"))
    for low, high, at, z in zip(first, last, middle, height, strict=True):
        rise = 0.0
        if corner > 0.0:
            rise = corner - np.sqrt(np.maximum(corner**2 - (x[low:high] - at) ** 2, 0.0))
        floor[low:high] = np.minimum(floor[low:high], z + rise)
    return floor
