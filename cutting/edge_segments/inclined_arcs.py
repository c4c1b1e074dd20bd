"""Where points of the edges of an inclined tool meet the work, around the axis: kernels."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED, njit
from cutting.edge_segments.points_about_axis import FIRST_ANGLE, EdgePoints, Work

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

#: called from Python, in several threads at once
_DRIVER = {"cache": True, "error_model": "numpy", "nogil": True}

_TURN = 2.0 * math.pi
#: places around the axis that are looked at; an arc that fits between two of them is not seen
_ANGLES = 360
_HALVINGS = 30
#: how the end of an arc is marked in `Arcs.kind`; see `engagement_arcs`
_SURFACE, _BESIDE, _CHIP = 0, 1, 2
#: the work is met
_MET = -1


@register_jitable(**INLINED)
def _bound_at(work: Work, z: float) -> float:
    """Bound at a height, between those on the list."""
    rise, bound = work.rise, work.bound
    if z <= rise[0]:
        return bound[0]
    if z >= rise[-1]:
        return bound[-1]
    at = np.searchsorted(rise, z, side="right") - 1
    share = (z - rise[at]) / (rise[at + 1] - rise[at])
    return bound[at] + share * (bound[at + 1] - bound[at])


@register_jitable(**INLINED)
def _thinnest(points: EdgePoints, row: int, ahead: float) -> tuple[int, float]:
    """Tooth that left the surface, and the chip, m."""
    tooth, thinnest = -1, math.inf
    for k in range(points.rise.shape[1]):
        chip = points.rise[row, k] * ahead - points.offset[row, k]
        if chip < thinnest:
            tooth, thinnest = k, chip
    return tooth, thinnest


@register_jitable(**INLINED)
def _look(points: EdgePoints, work: Work, row: int, sine: float, cosine: float) -> tuple[int, int]:
    """Tooth that left the surface which a point meets at an angle, -1 in the air; what keeps it."""
    ahead = points.sine[row] * work.along_feed * sine - points.cosine[row] * work.along_axis
    tooth, chip = _thinnest(points, row, ahead)
    if not chip > 0.0:
        return -1, _CHIP
    frame, height = work.frame, points.height[row]
    x, y = points.radius[row] * sine, points.radius[row] * cosine
    z = frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * height
    if not work.surface - z > 0.0:
        return -1, _SURFACE
    if work.outwards != 0.0:
        across = frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * height
        if not work.outwards * across - _bound_at(work, z) > 0.0:
            return -1, _BESIDE
    return tooth, _MET


@register_jitable(**INLINED)
def _change(
    points: EdgePoints, work: Work, row: int, low: float, high: float, before: int
) -> tuple[float, int, int]:
    """Angle of a change between two angles, the tooth met after it, and how it is marked."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        met, _ = _look(points, work, row, math.sin(middle), math.cos(middle))
        if met == before:
            low = middle
        else:
            high = middle
    after, side = _look(points, work, row, math.sin(high), math.cos(high))
    if before < 0:
        _, side = _look(points, work, row, math.sin(low), math.cos(low))
    elif after >= 0:
        side = _CHIP
    return 0.5 * (low + high), after, side


@njit(**_DRIVER)
def inclined_arcs(points: EdgePoints, work: Work, most: int) -> tuple[Array, Indices, Indices]:
    """Arcs (P, most) of points of edges, as `Arcs`, within the turn from `FIRST_ANGLE`.

    IndexError where there are more marks of arcs than `most`.
    """
    count = points.height.size
    angle = FIRST_ANGLE + _TURN * np.arange(_ANGLES + 1) / _ANGLES
    sine, cosine = np.sin(angle), np.cos(angle)
    at = np.zeros((count, most))
    tooth, kind = np.full((count, most), -1), np.full((count, most), -1)
    for row in range(count):
        column = 0
        before, _ = _look(points, work, row, sine[0], cosine[0])
        if before >= 0:
            at[row, 0], tooth[row, 0], kind[row, 0] = angle[0], before, 4 * (before + 1) + _SURFACE
            column = 1
        for k in range(_ANGLES):
            met, _ = _look(points, work, row, sine[k + 1], cosine[k + 1])
            if met != before:
                if column == most:
                    raise IndexError("more arcs around the axis than have room")
                where, after, side = _change(points, work, row, angle[k], angle[k + 1], before)
                at[row, column], tooth[row, column] = where, after
                kind[row, column] = 4 * (after + 1) + side
                column += 1
                before = met
        if before >= 0:
            if column == most:
                raise IndexError("more arcs around the axis than have room")
            at[row, column], kind[row, column] = angle[-1], _SURFACE
    return at, tooth, kind
