"""Cross-section of what a tool removes: a rectangle for a cylinder, less for other tools."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cutting.engagement.immersion import MillingMode
from cutting.tool.cutter import Cutter, corner_height

_POINTS = 2000


def removed_section(
    cutter: Cutter, mode: MillingMode, radial_depth: float, depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Area that the tool sweeps through the stock, seen along the feed.

    Parameters
    ----------
    cutter : Cutter
    mode : {"up", "down", "slot"}
    radial_depth : float
        m; not used for a slot.
    depths : (n,) array of float
        Axial depths, m, > 0.

    Returns
    -------
    (n,) array of float
        m^2; times the feed speed it is the removal rate.

    Notes
    -----
    The stock ends R - a_e from the axis; at a height where the edge has the radius r the tool takes
    r - (R - a_e) of it, and no more than 2 r.
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
