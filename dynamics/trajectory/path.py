"""Plane paths of lines and circular arcs by their length, and the errors of a motion along them.

The contour error is the distance from the measured position to the nearest place of the path; the
tracking error is the distance to where the axis should be at that time (Altintas 2012,
Manufacturing Automation, chapter 5).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.motion import TrajectoryError, axes_vector, require_positive

#: of ends that meet, and of lengths that vanish, over the size of the path
_ROUNDING = 1e-9


class Foot(NamedTuple):
    """Nearest place on an element, for each point, (n,)."""

    length: NDArray[np.float64]  # from the start of the element, m
    distance: NDArray[np.float64]  # m, not negative
    left: NDArray[np.float64]  # way from the foot, across the direction of travel, m


@dataclass(frozen=True)
class Line:
    """Straight element; start and end (2,), m."""

    start: tuple[float, float]
    end: tuple[float, float]

    curvature = 0.0  # 1/m

    def __post_init__(self):
        first = axes_vector("line", "start", self.start, 2)
        last = axes_vector("line", "end", self.end, 2)
        require_positive("line", "length", float(np.linalg.norm(last - first)))

    @property
    def length(self) -> float:
        """From start to end, m."""
        return math.dist(self.start, self.end)

    def at(self, length: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return position, m, and unit tangent at lengths, m; each (..., 2)."""
        tangent = np.subtract(self.end, self.start) / self.length
        position = np.asarray(self.start) + length[..., None] * tangent
        return position, np.broadcast_to(tangent, position.shape)

    def nearest_length(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the length of the foot of points (n, 2), m."""
        tangent = np.subtract(self.end, self.start) / self.length
        return np.clip((points - np.asarray(self.start)) @ tangent, 0.0, self.length)


@dataclass(frozen=True)
class Arc:
    """Circular element; radius, m, start angle and sweep, rad, sweep > 0 counter-clockwise."""

    centre: tuple[float, float]
    radius: float
    start_angle: float
    sweep: float

    def __post_init__(self):
        axes_vector("arc", "centre", self.centre, 2)
        require_positive("arc", "radius", self.radius)
        require_positive("arc", "size of the sweep", abs(self.sweep))
        axes_vector("arc", "start angle", self.start_angle, 1)
        if abs(self.sweep) > 2.0 * math.pi * (1.0 + _ROUNDING):
            raise TrajectoryError(f"arc: sweep is {self.sweep:g} rad; a full turn at most")

    @property
    def length(self) -> float:
        """From start to end, m."""
        return self.radius * abs(self.sweep)

    @property
    def curvature(self) -> float:
        """1/m; > 0 turns left."""
        return math.copysign(1.0 / self.radius, self.sweep)

    def at(self, length: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return position, m, and unit tangent at lengths, m; each (..., 2)."""
        sense = math.copysign(1.0, self.sweep)
        angle = self.start_angle + sense * length / self.radius
        outward = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        tangent = sense * np.stack([-outward[..., 1], outward[..., 0]], axis=-1)
        return np.asarray(self.centre) + self.radius * outward, tangent

    def nearest_length(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the length of the foot of points (n, 2), m."""
        off = points - np.asarray(self.centre)
        sense = math.copysign(1.0, self.sweep)
        turned = sense * (np.arctan2(off[:, 1], off[:, 0]) - self.start_angle)
        turned = np.mod(turned, 2.0 * math.pi)
        # outside of the sweep the nearer end is nearest
        over, span = turned - abs(self.sweep), abs(self.sweep)
        ends = np.where(over < 2.0 * math.pi - turned, span, 0.0)
        return self.radius * np.where(over > 0.0, ends, turned)


def foot(element: Line | Arc, points: NDArray[np.float64]) -> Foot:
    """Return the nearest place on an element for points (n, 2), m."""
    length = element.nearest_length(points)
    position, tangent = element.at(length)
    offset = points - position
    left = tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]
    return Foot(length, np.hypot(offset[:, 0], offset[:, 1]), left)


@dataclass(frozen=True)
class Path:
    """Elements one after the other.

    Parameters
    ----------
    elements : sequence of Line and Arc
        Each starts where the one before ends.

    Raises
    ------
    TrajectoryError
        If there is none, or an element does not start where the one before ends.
    """

    elements: tuple[Line | Arc, ...]

    def __post_init__(self):
        object.__setattr__(self, "elements", tuple(self.elements))
        if not self.elements:
            raise TrajectoryError("path: no element given")
        size = self.length
        for i, (one, two) in enumerate(pairwise(self.elements)):
            end, start = one.at(np.array(one.length))[0], two.at(np.array(0.0))[0]
            if math.dist(end, start) > _ROUNDING * size:
                raise TrajectoryError(
                    f"path: element {i} ends at {end.tolist()}, element {i + 1} starts at "
                    f"{start.tolist()}"
                )

    @property
    def length(self) -> float:
        """From start to end, m."""
        return math.fsum(element.length for element in self.elements)

    @property
    def breaks(self) -> NDArray[np.float64]:
        """Lengths at which elements start, and the end of the last, m, (n + 1,)."""
        return np.cumsum([0.0, *(element.length for element in self.elements)])

    def at(self, length: ArrayLike) -> tuple[NDArray, NDArray, NDArray]:
        """Return position (..., 2), unit tangent (..., 2), curvature (...) at lengths, m."""
        breaks = self.breaks
        s = np.clip(np.asarray(length, dtype=np.float64), 0.0, breaks[-1])
        which = np.clip(np.searchsorted(breaks, s, "right") - 1, 0, len(self.elements) - 1)
        position, tangent = np.empty((*s.shape, 2)), np.empty((*s.shape, 2))
        curvature = np.empty(s.shape)
        for i in np.unique(which):
            here = which == i
            position[here], tangent[here] = self.elements[i].at(s[here] - breaks[i])
            curvature[here] = self.elements[i].curvature
        return position, tangent, curvature


def circle(centre: ArrayLike, radius: float, start_angle: float = 0.0, direction: int = 1) -> Path:
    """Return one full revolution; direction -1: clockwise."""
    return Path((Arc(tuple(centre), radius, start_angle, math.copysign(2.0 * math.pi, direction)),))


def polyline(points: ArrayLike, fillet_radius: float = 0.0) -> Path:
    """Return a line through points (n, 2), m, with corners rounded by tangent arcs.

    Parameters
    ----------
    points : (n, 2) array_like of float
        m; a corner with no turn is left out.
    fillet_radius : float
        m; 0: sharp corners.

    Raises
    ------
    TrajectoryError
        If there are too few or equal points, or an arc does not fit between its neighbours.
    """
    corners = np.asarray(points, dtype=np.float64)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 2:
        raise TrajectoryError(f"polyline: points of shape {corners.shape}; two at least, (n, 2)")
    if not (np.isfinite(corners).all() and math.isfinite(fillet_radius) and fillet_radius >= 0.0):
        raise TrajectoryError(f"polyline: finite points and fillet radius >= 0, {fillet_radius}")
    sides = np.diff(corners, axis=0)
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    if lengths.min() <= _ROUNDING * lengths.max():
        raise TrajectoryError(f"polyline: points {lengths.argmin()} and next are the same")
    unit = sides / lengths[:, None]
    turning = np.arctan2(
        unit[:-1, 0] * unit[1:, 1] - unit[:-1, 1] * unit[1:, 0], (unit[:-1] * unit[1:]).sum(axis=1)
    )
    cuts = np.zeros(len(corners))
    cuts[1:-1] = fillet_radius * np.abs(np.tan(0.5 * turning))
    short = lengths * (1.0 + _ROUNDING) - cuts[:-1] - cuts[1:]
    if short.min() < 0.0:
        i = int(short.argmin())
        raise TrajectoryError(
            f"polyline: fillets of radius {fillet_radius:g} m take {cuts[i] + cuts[i + 1]:g} m of "
            f"side {i}, which is {lengths[i]:g} m long"
        )
    return Path(_rounded(corners, unit, turning, cuts, fillet_radius, lengths.max()))


def square(side: float, fillet_radius: float, centre: ArrayLike = (0.0, 0.0)) -> Path:
    """Return a counter-clockwise square, from the middle of its lower side and back.

    Parameters
    ----------
    side, fillet_radius : float
        m.
    centre : (2,) array_like of float
        m.

    Raises
    ------
    TrajectoryError
        If the side is not above 0, or the fillets do not fit.
    """
    require_positive("square", "side", side)
    turn = np.array([(0.0, -1), (1, -1), (1, 1), (-1, 1), (-1, -1), (0.0, -1)])
    return polyline(axes_vector("square", "centre", centre, 2) + 0.5 * side * turn, fillet_radius)


def _rounded(
    corners: NDArray[np.float64],
    unit: NDArray[np.float64],
    turning: NDArray[np.float64],
    cuts: NDArray[np.float64],
    radius: float,
    size: float,
) -> Sequence[Line | Arc]:
    """Lines between the cuts of the corners, and arcs over them."""
    elements: list[Line | Arc] = []
    begin = corners[0]
    for i, direction in enumerate(unit):
        turn = turning[i] if i < len(turning) else math.inf
        if abs(turn) <= _ROUNDING:
            continue
        end = corners[i + 1] - cuts[i + 1] * direction
        if math.dist(begin, end) > _ROUNDING * size:
            elements.append(Line(tuple(begin), tuple(end)))
        begin = end
        if radius > 0.0 and i < len(turning):
            sense = math.copysign(1.0, turn)
            inward = sense * np.array([-direction[1], direction[0]])
            angle = math.atan2(-inward[1], -inward[0])
            elements.append(Arc(tuple(end + radius * inward), radius, angle, turn))
            begin = corners[i + 1] + cuts[i + 1] * unit[i + 1]
    return tuple(elements)


#: of two distances that count as the same
_SAME = 1e-9


class ContourError(NamedTuple):
    """Against a path, at each measured position, (n,)."""

    error: NDArray[np.float64]  # m; > 0: left of the path, seen in the direction of travel
    length: NDArray[np.float64]  # where on the path the nearest place is, m


def contour_error(path: Path, position: ArrayLike) -> ContourError:
    """Return the signed distance of positions (n, 2), m, to a path.

    Raises
    ------
    TrajectoryError
        If the positions are no finite (n, 2).

    Notes
    -----
    The nearest place of the whole path counts, so that an error must be small against the
    distance of branches that cross or touch. Outside of a sharp corner both its sides are as
    near; the side is decided by the one that the point lies further across of.
    """
    points = np.asarray(position, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise TrajectoryError(f"contour error: positions of shape {points.shape}; finite (n, 2)")
    distance, left = np.full(len(points), np.inf), np.zeros(len(points))
    length = np.zeros(len(points))
    for begin, element in zip(path.breaks[:-1], path.elements, strict=True):
        there = foot(element, points)
        nearer = there.distance < distance * (1.0 - _SAME)
        same = ~nearer & (there.distance <= distance * (1.0 + _SAME))
        taken = nearer | (same & (np.abs(there.left) > np.abs(left)))
        distance = np.where(taken, there.distance, distance)
        left = np.where(taken, there.left, left)
        length = np.where(taken, begin + there.length, length)
    return ContourError(np.copysign(distance, left), length)


def tracking_error(set_position: ArrayLike, position: ArrayLike) -> NDArray[np.float64]:
    """Return set minus measured position of each axis, m; both (n, axes) at the same times.

    Raises
    ------
    TrajectoryError
        If the shapes differ.
    """
    wanted, measured = np.asarray(set_position), np.asarray(position)
    if wanted.shape != measured.shape:
        raise TrajectoryError(
            f"tracking error: set positions of shape {wanted.shape}, measured {measured.shape}"
        )
    return wanted.astype(np.float64) - measured
