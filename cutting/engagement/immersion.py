"""Engagement of the teeth: entry and exit angles, cutting speed, removal rate."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.engagement.uncut_band import UncutBand
from cutting.tool.cutter import Cutter, corner_height


class Engagement(NamedTuple):
    """Angles between which a tooth is in the cut, measured clockwise from +y."""

    entry: float  # rad, 0 <= entry < exit
    exit: float  # rad, up to pi


def engagement(band: UncutBand, radius: float) -> Engagement:
    """Entry and exit angle of an edge of one radius, m.

    Raises
    ------
    ValueError
        If the edge does not reach the band.

    Notes
    -----
    phi = acos(y / R) at a border y from the tool axis; up-milling runs from 0 to acos(1 - a_e/R),
    down-milling from pi - acos(1 - a_e/R) to pi (Altintas 2012, Manufacturing Automation,
    section 2.4).
    """
    entry, leave = slice_engagement(band, np.array([radius]))
    if not entry[0] < leave[0]:
        raise ValueError(f"an edge of the radius {radius * 1e3:g} mm does not reach the work")
    return Engagement(float(entry[0]), float(leave[0]))


def slice_engagement(
    band: UncutBand, slice_radius: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Entry and exit angle of each slice of a tool whose radius varies along the axis.

    Radii of slices (L,), m. A pair (L,), rad; entry above exit where a slice does not reach the
    band.
    """
    # a ball has no radius at its tip
    radius = np.maximum(slice_radius, 1e-300)
    upper, lower = band.upper.at(radius) / radius, band.lower.at(radius) / radius
    none = (lower >= 1.0) | (upper <= -1.0) | (lower >= upper)
    entry, leave = np.arccos(np.clip(upper, -1.0, 1.0)), np.arccos(np.clip(lower, -1.0, 1.0))
    return np.where(none, np.inf, entry), np.where(none, -np.inf, leave)


def slice_arcs(
    band: UncutBand, points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Entry and exit angle at two points of each slice of a tool whose radius varies.

    Parameters
    ----------
    band : UncutBand
    points : (L, 2) array of float
        Radius at both points, m, alike far from the middle.

    Returns
    -------
    pair of (L, 2) arrays of float
        rad; entry above exit where a slice does not reach the band with its middle.
    """
    entry, leave = (angle.reshape(points.shape) for angle in slice_engagement(band, points.ravel()))
    # a point that just does not reach the band has an arc of no width
    touch = np.pi if band.side < 0 else 0.0
    entry, leave = (np.where(np.isfinite(angle), angle, touch) for angle in (entry, leave))
    middle = slice_engagement(band, points.mean(axis=1))
    outside = middle[0] > middle[1]
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
    cutter: Cutter, band: UncutBand, depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Area that the tool sweeps through the band, seen along the feed.

    At axial depths (n,), m, > 0. (n,), m^2; times the feed speed it is the removal rate.
    """
    deepest = float(np.max(depths))
    edge = np.linspace(0.0, deepest, _POINTS + 1)
    height = 0.5 * (edge[1:] + edge[:-1])
    width = band.width(_radius(cutter, height))
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
