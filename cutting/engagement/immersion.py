"""Engagement of the teeth: entry and exit angles, cutting speed, removal rate."""

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.tool.cutter import Cutter, corner_height

MillingMode = Literal["up", "down", "slot"]


class Engagement(NamedTuple):
    """Angles between which a tooth is in the cut, measured clockwise from +y."""

    entry: float  # rad, 0 <= entry < exit
    exit: float  # rad, up to pi


def engagement(mode: MillingMode, radial_depth: float, diameter: float) -> Engagement:
    """Entry and exit angle of a peripheral cut.

    Parameters
    ----------
    mode : {"up", "down", "slot"}
        Up-milling starts with zero chip thickness, down-milling ends with it.
    radial_depth, diameter : float
        m; the radial depth is not used for a slot.

    Raises
    ------
    ValueError
        If the radial depth is not in (0, diameter] or the mode is unknown.

    Notes
    -----
    Up-milling runs from 0 to acos(1 - a_e/R), down-milling from pi - acos(1 - a_e/R) to pi
    (Altintas 2012, Manufacturing Automation, section 2.4).
    """
    if mode == "slot":
        return Engagement(0.0, math.pi)
    if not 0.0 < radial_depth <= diameter:
        raise ValueError(
            f"radial depth {radial_depth * 1e3:g} mm is not within (0, diameter = "
            f"{diameter * 1e3:g} mm]"
        )
    arc = math.acos(1.0 - 2.0 * radial_depth / diameter)
    if mode == "up":
        return Engagement(0.0, arc)
    if mode == "down":
        return Engagement(math.pi - arc, math.pi)
    raise ValueError(f'milling mode "{mode}" is not one of "up", "down", "slot"')


def slice_engagement(
    mode: MillingMode, radial_depth: float, tool_radius: float, slice_radius: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Entry and exit angle of each slice of a tool whose radius varies along the axis.

    The stock ends at the same place for all of them, R - a_e from the axis.

    Depth and radii in m, those of slices (L,); the radial depth is not used for a slot. A pair
    (L,), rad; entry above exit where a slice does not reach the stock.
    """
    if mode == "slot":
        return np.zeros(slice_radius.size), np.full(slice_radius.size, math.pi)
    # a ball has no radius at its tip
    cosine = (tool_radius - radial_depth) / np.maximum(slice_radius, 1e-300)
    arc = np.arccos(np.clip(cosine, -1.0, 1.0))
    none = cosine >= 1.0
    if mode == "up":
        return np.where(none, np.inf, 0.0), np.where(none, -np.inf, arc)
    return np.where(none, np.inf, math.pi - arc), np.where(none, -np.inf, math.pi)


def slice_arcs(
    mode: MillingMode, radial_depth: float, tool_radius: float, points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Entry and exit angle at two points of each slice of a tool whose radius varies.

    Parameters
    ----------
    mode : {"up", "down", "slot"}
    radial_depth, tool_radius : float
        m; the radial depth is not used for a slot.
    points : (L, 2) array of float
        Radius at both points, m, alike far from the middle.

    Returns
    -------
    pair of (L, 2) arrays of float
        rad; entry above exit where a slice does not reach the stock with its middle.
    """
    entry, leave = (
        angle.reshape(points.shape)
        for angle in slice_engagement(mode, radial_depth, tool_radius, points.ravel())
    )
    # a point that just does not reach the stock has an arc of no width
    touch = np.pi if mode == "down" else 0.0
    entry, leave = (np.where(np.isfinite(angle), angle, touch) for angle in (entry, leave))
    if mode != "slot":
        outside = points.mean(axis=1) <= tool_radius - radial_depth
        entry[outside], leave[outside] = np.inf, -np.inf
    return entry, leave


def cutting_speed(diameter: float, spindle_speed: float) -> float:
    """Speed of the edge, m/s, from diameter in m and spindle speed in rad/s."""
    return 0.5 * diameter * spindle_speed


def removal_rate(
    axial_depth: float, radial_depth: float, teeth: int, feed_per_tooth: float, spindle_speed: float
) -> float:
    """Volume removed per time, m^3/s; lengths in m, spindle speed in rad/s."""
    feed_speed = feed_per_tooth * teeth * spindle_speed / (2.0 * math.pi)
    return axial_depth * radial_depth * feed_speed


_POINTS = 2000


def removed_section(
    cutter: Cutter, mode: MillingMode, radial_depth: float, depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Area that the tool sweeps through the stock, seen along the feed.

    At axial depths (n,), m, > 0; the radial depth, m, is not used for a slot. (n,), m^2; times the
    feed speed it is the removal rate. The stock ends R - a_e from the axis; at a height where the
    edge has the radius r the tool takes r - (R - a_e) of it, and no more than 2 r.
    """
    deepest = float(np.max(depths))
    edge = np.linspace(0.0, deepest, _POINTS + 1)
    height = 0.5 * (edge[1:] + edge[:-1])
    radius = _radius(cutter, height)
    if mode == "slot":
        width = 2.0 * radius
    else:
        width = np.clip(radius - (cutter.radius - radial_depth), 0.0, 2.0 * radius)
    area = np.concatenate([[0.0], np.cumsum(width * np.diff(edge))])
    return np.interp(depths, edge, area)


def _radius(cutter: Cutter, height: NDArray[np.float64]) -> NDArray[np.float64]:
    """Radius of the envelope at heights above the tip, m."""
    corner, top = cutter.corner_radius, corner_height(cutter)
    below = np.clip(corner - height, 0.0, corner)
    on_corner = cutter.radius - corner + np.sqrt(np.maximum(corner**2 - below**2, 0.0))
    slope = 0.0
    if cutter.edge_angle < 0.5 * math.pi - 1e-9:
        slope = 1.0 / math.tan(cutter.edge_angle)
    start = cutter.radius - corner * (1.0 - math.sin(cutter.edge_angle))
    return np.where(height < top, on_corner, start + slope * (height - top))
