"""Paths in space of lines, circular arcs and helices, by their length.

They are exact: no arc is cut into lines. A path knows its position, tangent and second derivative
over the length, and how far a point is from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.trajectory.motion import TrajectoryError, axes_vector, require_positive

#: of ends that meet, over the size of the path
_ROUNDING = 1e-7


class PathPoint(NamedTuple):
    """Places on a path by their length; each (..., 3)."""

    position: NDArray[np.float64]  # m
    tangent: NDArray[np.float64]  # dp/ds
    bend: NDArray[np.float64]  # d2p/ds2, 1/m


@dataclass(frozen=True)
class SpatialLine:
    """Straight element; TrajectoryError if start and end are the same."""

    start: tuple[float, float, float]  # m
    end: tuple[float, float, float]  # m

    bend = 0.0  # size of d2p/ds2, 1/m
    twist = 0.0  # size of d3p/ds3, 1/m^2

    def __post_init__(self) -> None:
        first = axes_vector("line", "start", self.start, 3)
        last = axes_vector("line", "end", self.end, 3)
        require_positive("line", "length", float(np.linalg.norm(last - first)))

    @property
    def length(self) -> float:
        """From start to end, m."""
        return math.dist(self.start, self.end)

    def at(self, length: NDArray[np.float64]) -> PathPoint:
        """Places at lengths (...), m."""
        tangent = np.subtract(self.end, self.start) / self.length
        position = np.asarray(self.start) + length[..., None] * tangent
        return PathPoint(
            position, np.broadcast_to(tangent, position.shape), np.zeros_like(position)
        )

    def distance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance of points (n, 3) from the element, m."""
        tangent = np.subtract(self.end, self.start) / self.length
        along = np.clip((points - np.asarray(self.start)) @ tangent, 0.0, self.length)
        return np.linalg.norm(points - self.at(along).position, axis=1)


@dataclass(frozen=True)
class SpatialArc:
    """Circular arc or helix: centre + cos(t) first + sin(t) second + t / sweep rise.

    TrajectoryError if first and second are not perpendicular and of one length, the radius, or the
    sweep is not above 0.
    """

    centre: tuple[float, float, float]  # m
    first: tuple[float, float, float]  # from the centre to the start, m
    second: tuple[float, float, float]  # a quarter of a revolution on, m
    sweep: float  # angle, rad; above 0
    rise: tuple[float, float, float] = (0.0, 0.0, 0.0)  # over the whole sweep, along the axis, m

    def __post_init__(self) -> None:
        for key in ("centre", "first", "second", "rise"):
            axes_vector("arc", key, getattr(self, key), 3)
        require_positive("arc", "sweep", self.sweep)
        radius = self.radius
        require_positive("arc", "radius", radius)
        skew = abs(float(np.dot(self.first, self.second))) / radius**2
        if skew > _ROUNDING or abs(math.hypot(*self.second) / radius - 1.0) > _ROUNDING:
            raise TrajectoryError("arc: its two radii are not perpendicular and of one length")

    @property
    def radius(self) -> float:
        """Of the circle, m."""
        return math.hypot(*self.first)

    @property
    def length(self) -> float:
        """From start to end, m."""
        return math.hypot(self.radius * self.sweep, *self.rise)

    @property
    def bend(self) -> float:
        """Size of d2p/ds2, 1/m."""
        return self.radius * (self.sweep / self.length) ** 2

    @property
    def twist(self) -> float:
        """Size of d3p/ds3, 1/m^2."""
        return self.radius * (self.sweep / self.length) ** 3

    def at(self, length: NDArray[np.float64]) -> PathPoint:
        """Places at lengths (...), m."""
        rate = self.sweep / self.length
        return self._at_angle(rate * length, rate)

    def _at_angle(self, angle: NDArray[np.float64], rate: float) -> PathPoint:
        first, second, rise = (np.asarray(one) for one in (self.first, self.second, self.rise))
        cosine, sine = np.cos(angle)[..., None], np.sin(angle)[..., None]
        outward = cosine * first + sine * second
        along = rise / self.sweep
        return PathPoint(
            np.asarray(self.centre) + outward + angle[..., None] * along,
            rate * (cosine * second - sine * first + along),
            -(rate**2) * outward,
        )

    def distance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance of points (n, 3) from the element, m.

        Exact for arcs; of a helix to the point at the angle of the point, which is farther by a
        share of (rise / circumference)^2 / 2.
        """
        off = points - np.asarray(self.centre)
        turned = np.arctan2(off @ np.asarray(self.second), off @ np.asarray(self.first))
        turned = np.mod(turned, 2.0 * math.pi)
        whole = 2.0 * math.pi
        turns = max(1, math.ceil(self.sweep / whole))
        best = np.full(len(points), np.inf)
        for turn in range(turns):
            angle = turned + turn * whole
            for one in (np.clip(angle, 0.0, self.sweep), np.zeros_like(angle)):
                place = self._at_angle(one, 1.0).position
                best = np.minimum(best, np.linalg.norm(points - place, axis=1))
        return best


Element = SpatialLine | SpatialArc


class PathElement(Protocol):
    """What a path is made of: a line, an arc, or a transition between them."""

    @property
    def length(self) -> float:
        """From start to end, m."""

    @property
    def bend(self) -> float:
        """Largest size of d2p/ds2, 1/m."""

    @property
    def twist(self) -> float:
        """Largest size of d3p/ds3, 1/m^2."""

    def at(self, length: NDArray[np.float64]) -> PathPoint:
        """Places at lengths (...), m."""

    def distance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance of points (n, 3) from the element, m."""


@dataclass(frozen=True)
class SpatialPath:
    """Elements one after the other.

    TrajectoryError if there is none, or one does not start where the one before ends.
    """

    elements: tuple[PathElement, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "elements", tuple(self.elements))
        if not self.elements:
            raise TrajectoryError("path: no element given")
        size = float(self.breaks[-1])
        for number in range(1, len(self.elements)):
            before, after = self.elements[number - 1], self.elements[number]
            gap = float(np.linalg.norm(end_of(before).position - start_of(after).position))
            if gap > _ROUNDING * size:
                raise TrajectoryError(
                    f"path: element {number} starts {gap:g} m off the end of the one before"
                )

    @property
    def length(self) -> float:
        """From start to end, m."""
        return float(self.breaks[-1])

    @cached_property
    def breaks(self) -> NDArray[np.float64]:
        """Lengths at which elements start, and the end of the last, m, (n + 1,)."""
        return np.cumsum([0.0, *(element.length for element in self.elements)])

    def at(self, length: ArrayLike) -> PathPoint:
        """Places at lengths (...), m; beyond the ends those of the ends."""
        breaks = self.breaks
        s = np.clip(np.asarray(length, dtype=np.float64), 0.0, breaks[-1])
        which = np.clip(np.searchsorted(breaks, s, "right") - 1, 0, len(self.elements) - 1)
        place = PathPoint(*(np.empty((*s.shape, 3)) for _ in PathPoint._fields))
        for i in np.unique(which):
            here = which == i
            found = self.elements[i].at(np.minimum(s[here] - breaks[i], self.elements[i].length))
            for all_of, part in zip(place, found, strict=True):
                all_of[here] = part
        return place

    def distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Distance of points (n, 3) from the path, m: the contour error without a side."""
        given = np.asarray(points, dtype=np.float64)
        best = np.full(len(given), np.inf)
        for element in self.elements:
            best = np.minimum(best, element.distance(given))
        return best


@dataclass(frozen=True)
class PathInSpace:
    """A path in space as some axes follow it: which of its coordinates they are, and where from."""

    path: SpatialPath
    coordinates: tuple[int, ...]  # of the path, one an axis

    def distance(self, travel: ArrayLike) -> NDArray[np.float64]:
        """Distance from the path of axes (n, axes) that have travelled from its start, m."""
        points = np.tile(self.path.at(0.0).position, (len(np.asarray(travel)), 1))
        points[:, list(self.coordinates)] += travel
        return self.path.distance(points)


def start_of(element: PathElement) -> PathPoint:
    """Point where an element begins; each (3,)."""
    return element.at(np.array(0.0))


def end_of(element: PathElement) -> PathPoint:
    """Point where an element ends; each (3,)."""
    return element.at(np.array(element.length))


def angle_between(before: PathElement, after: PathElement) -> float:
    """Angle between the end of an element and the start of the next, rad."""
    one, two = end_of(before).tangent, start_of(after).tangent
    return math.atan2(float(np.linalg.norm(np.cross(one, two))), float(one @ two))


def rounding_arc(before: SpatialLine, after: SpatialLine, tolerance: float) -> SpatialArc | None:
    """Tangent arc over the corner of two lines, off it by the tolerance (m) at the most.

    It takes half of either line at the most; None where the lines go on straight, or back.
    """
    turn = angle_between(before, after)
    half = 0.5 * turn
    if not 1e-6 < turn < math.pi - 1e-3:
        return None
    # the corner is off the arc by r (1 / cos(half) - 1), and the arc takes r tan(half) of a line
    radius = tolerance / (1.0 / math.cos(half) - 1.0)
    radius = min(radius, 0.5 * min(before.length, after.length) / math.tan(half))
    cut = radius * math.tan(half)
    one, two = end_of(before).tangent, start_of(after).tangent
    inward = two - one * float(one @ two)
    inward = inward / np.linalg.norm(inward)
    start = np.asarray(before.end) - cut * one
    return SpatialArc(
        tuple(start + radius * inward), tuple(-radius * inward), tuple(radius * one), turn
    )
