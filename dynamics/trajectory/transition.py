"""Transitions between lines and arcs: clothoids, so that the curvature does not jump.

A clothoid has a curvature that is linear in its length. Of the length L, from a line to an arc of
the radius R, it turns by L / (2 R) and moves the arc off the line by p = L^2 / (24 R) in the first
order (Walton and Meek 2009, "G2 curve design with a pair of Pythagorean hodograph or clothoid
spirals"); the arc keeps its radius and is moved along its bisector.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.trajectory.motion import TrajectoryError, axes_vector, require_positive
from dynamics.trajectory.spatial_path import PathPoint, SpatialArc, SpatialLine

_ROUNDING = 1e-7
#: Gauss-Legendre points over a length; exact to rounding for the angles allowed
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_LARGEST_TURN = 2.0  # rad
#: Newton steps to the point of a clothoid nearest to another
_NEWTON_STEPS = 8
#: share of the angle of an arc that one transition takes, and of a line, at the most
_SHARE_OF_ARC, _SHARE_OF_LINE = 0.25, 0.5
#: of the length, so that the terms of higher order stay within the tolerance
_SHORTER = 0.998


@dataclass(frozen=True)
class Clothoid:
    """Plane curve whose curvature goes linearly from one value to another.

    TrajectoryError if tangent and normal are not perpendicular unit vectors, the length is not
    above 0, or it turns by more than two radians.
    """

    start: tuple[float, float, float]  # m
    tangent: tuple[float, float, float]  # at the start
    normal: tuple[float, float, float]  # at the start, to the side of positive curvature
    length: float  # m
    curvature: tuple[float, float]  # at start and end, 1/m

    def __post_init__(self) -> None:
        for key in ("start", "tangent", "normal"):
            axes_vector("clothoid", key, getattr(self, key), 3)
        require_positive("clothoid", "length", self.length)
        frame = np.array([self.tangent, self.normal])
        if np.abs(frame @ frame.T - np.eye(2)).max() > _ROUNDING:
            raise TrajectoryError("clothoid: tangent and normal are no perpendicular unit vectors")
        if self.length * max(map(abs, self.curvature)) > _LARGEST_TURN:
            raise TrajectoryError(f"clothoid: it turns by more than {_LARGEST_TURN:g} rad")

    @property
    def rate(self) -> float:
        """Change of the curvature with the length, 1/m^2."""
        return (self.curvature[1] - self.curvature[0]) / self.length

    @property
    def bend(self) -> float:
        """Largest size of d2p/ds2, 1/m."""
        return max(map(abs, self.curvature))

    @property
    def twist(self) -> float:
        """Largest size of d3p/ds3, 1/m^2."""
        return math.hypot(self.rate, self.bend**2)

    def _angle(self, length: NDArray[np.float64]) -> NDArray[np.float64]:
        return length * (self.curvature[0] + 0.5 * length * self.rate)

    def at(self, length: NDArray[np.float64]) -> PathPoint:
        """Places at lengths (...), m."""
        s = np.asarray(length, dtype=np.float64)
        between = 0.5 * s[..., None] * (1.0 + _POINTS)
        angles = self._angle(between)
        along = 0.5 * s * (np.cos(angles) @ _WEIGHTS)
        across = 0.5 * s * (np.sin(angles) @ _WEIGHTS)
        tangent, normal = np.asarray(self.tangent), np.asarray(self.normal)
        angle = self._angle(s)
        cosine, sine = np.cos(angle)[..., None], np.sin(angle)[..., None]
        curvature = (self.curvature[0] + self.rate * s)[..., None]
        return PathPoint(
            np.asarray(self.start) + along[..., None] * tangent + across[..., None] * normal,
            cosine * tangent + sine * normal,
            curvature * (cosine * normal - sine * tangent),
        )

    def distance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance of points (n, 3) from the element, m."""
        s = np.clip((points - np.asarray(self.start)) @ np.asarray(self.tangent), 0.0, self.length)
        for _ in range(_NEWTON_STEPS):
            place = self.at(s)
            off = points - place.position
            slope = 1.0 - np.sum(off * place.bend, axis=1)
            s = s + np.sum(off * place.tangent, axis=1) / np.maximum(slope, 0.1)
            s = np.clip(s, 0.0, self.length)
        return np.linalg.norm(points - self.at(s).position, axis=1)


class EasedArc(NamedTuple):
    """An arc with its transitions, and by how much the lines before and after it end earlier."""

    into: Clothoid
    arc: SpatialArc
    out: Clothoid
    shortened: float  # m, each


def eased_arc(
    before: SpatialLine, arc: SpatialArc, after: SpatialLine, tolerance: float
) -> EasedArc | None:
    """Arc between two tangent lines with transitions, off it by the tolerance (m) at the most.

    None where there is no room, or the arc is a helix.
    """
    radius, sweep = arc.radius, arc.sweep
    if sweep >= 0.9 * math.pi or math.hypot(*arc.rise) > 0.0:
        return None
    # the arc as a whole moves along its bisector by the offset / cos(sweep / 2)
    length = _SHORTER * math.sqrt(24.0 * radius * tolerance * math.cos(0.5 * sweep))
    turn = 0.5 * length / radius
    if turn > _SHARE_OF_ARC * sweep:
        return None
    first, second = np.asarray(arc.first) / radius, np.asarray(arc.second) / radius
    into = Clothoid((0.0, 0.0, 0.0), tuple(second), tuple(-first), length, (0.0, 1.0 / radius))
    end = into.at(np.array(length)).position
    offset = float(end @ -first) + radius * math.cos(turn) - radius
    back = offset * math.tan(0.5 * sweep)
    shortened = float(end @ second) - radius * math.sin(turn) + back
    if shortened > _SHARE_OF_LINE * min(before.length, after.length):
        return None
    start = np.asarray(arc.centre) + radius * first - shortened * second
    centre = np.asarray(arc.centre) - offset * first - back * second
    moved = SpatialArc(
        tuple(centre),
        tuple(radius * (math.cos(turn) * first + math.sin(turn) * second)),
        tuple(radius * (math.cos(turn) * second - math.sin(turn) * first)),
        sweep - 2.0 * turn,
    )
    last = moved.at(np.array(moved.length))
    normal = last.bend * radius
    out = Clothoid(
        tuple(last.position), tuple(last.tangent), tuple(normal), length, (1.0 / radius, 0.0)
    )
    into = Clothoid(tuple(start), into.tangent, into.normal, length, into.curvature)
    return EasedArc(into, moved, out, shortened)
