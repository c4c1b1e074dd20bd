"""Arcs of an NC program: centre or radius -> circular arc or helix that meets both ends."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from chatter.description.arrays import Array
from dynamics.trajectory.spatial_path import SpatialArc

#: by which the radii at start and end may differ, of the radius and m: programs round coordinates
_OFF_SHARE, _OFF = 1e-3, 5e-6
#: of a radius by which half a chord may exceed it
_SHORT = 1e-6
#: distance below which both ends are one, m: what rounding leaves of a sum of increments
_SAME_END = 1e-9


@dataclass(frozen=True)
class ArcEnds:
    """An arc to be: its ends, the plane of its circle and the sense."""

    start: Array  # (3,), m
    end: Array  # (3,), m
    plane: tuple[int, int]  # axes, from the first to the second counter-clockwise
    clockwise: bool

    @property
    def chord(self) -> Array:
        """From start to end in the plane, (2,), m; 0 where they are one."""
        chord = (self.end - self.start)[list(self.plane)]
        return chord if np.linalg.norm(chord) > _SAME_END else np.zeros(2)


def arc_by_radius(ends: ArcEnds, radius: float) -> SpatialArc:
    """Arc of a radius, m: the shorter one, the longer one where it is below 0.

    ValueError, in a sentence, if there is no such arc.
    """
    half = 0.5 * float(np.linalg.norm(ends.chord))
    size = abs(radius)
    if size == 0.0:
        raise ValueError("the radius is 0")
    if half == 0.0:
        raise ValueError("a full circle has no radius alone; give its centre")
    if half > size * (1.0 + _SHORT):
        raise ValueError(
            f"the radius is {size * 1e3:g} mm, but half the way to the end is {half * 1e3:.6g} mm"
        )
    height = math.sqrt(max(size**2 - half**2, 0.0))
    left = np.array([-ends.chord[1], ends.chord[0]]) / (2.0 * half)
    # the centre of a short arc lies to the left of the chord if it turns to the left
    side = math.copysign(1.0, radius) * (-1.0 if ends.clockwise else 1.0)
    return _arc(ends, 0.5 * ends.chord + side * height * left)


def arc_by_centre(ends: ArcEnds, centre: Array) -> SpatialArc:
    """Arc about a centre (2,) in the plane, from the start, m.

    A centre that is off by rounding is moved so that the arc meets both ends. ValueError, in a
    sentence, if the ends are not equally far from it.
    """
    radius = float(np.linalg.norm(centre))
    if radius == 0.0:
        raise ValueError("the centre is the start of the arc")
    other = float(np.linalg.norm(ends.chord - centre))
    if abs(other - radius) > max(_OFF, _OFF_SHARE * radius):
        raise ValueError(
            f"the start is {radius * 1e3:.6g} mm from the centre and the end {other * 1e3:.6g} mm"
        )
    chord = float(np.linalg.norm(ends.chord))
    if chord > 0.0:
        # onto the line of equal distances from both ends
        along = ends.chord / chord
        centre = centre + (0.5 * chord - float(centre @ along)) * along
    return _arc(ends, centre)


def _arc(ends: ArcEnds, centre: Array) -> SpatialArc:
    """Arc about a centre (2,) from the start, equally far from both ends."""
    first = -centre
    sense = -1.0 if ends.clockwise else 1.0
    second = sense * np.array([-first[1], first[0]])
    last = ends.chord - centre
    sweep = math.atan2(float(last @ second), float(last @ first)) % (2.0 * math.pi)
    if np.linalg.norm(ends.chord) == 0.0 or sweep == 0.0:
        sweep = 2.0 * math.pi
    plane = list(ends.plane)
    rise = ends.end - ends.start
    rise[plane] = 0.0
    middle = ends.start.copy()
    middle[plane] += centre
    return SpatialArc(
        tuple(middle), _in_space(plane, first), _in_space(plane, second), sweep, tuple(rise)
    )


def _in_space(plane: list[int], vector: Array) -> tuple[float, float, float]:
    full = np.zeros(3)
    full[plane] = vector
    return tuple(full.tolist())
