"""Profile of the edge of a tool: where the segments border on each other along its length."""

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.engagement.uncut_band import Border, UncutBand
from cutting.tool.cutter import Cutter, corner_height

_REVOLUTION = 2.0 * math.pi
#: an edge trails by this much within a segment, rad, or a cone widens by this share of its radius
_SEGMENT_LAG = 0.03
#: parts of the first step of an arc at which segments border as well
_HALVED = 0.5 ** np.arange(1, 4)


class EdgeLine(NamedTuple):
    """Profile of the edge at segment borders: heights, radii, immersion angles, lengths between."""

    height: NDArray[np.float64]  # (L+1,)
    radius: NDArray[np.float64]  # (L+1,)
    immersion: NDArray[np.float64]  # at both ends of every segment (L, 2)
    length: NDArray[np.float64]  # (L,)


def _radii_of_even_arcs(cutter: Cutter, band: UncutBand, arc_step: float) -> NDArray[np.float64]:
    """Radii at which a border is crossed at even steps of angle, over half a revolution.

    Where the edge first meets the stock its arc grows steeply, and again where it is no more cut
    all around; the steps are halved towards these.
    """
    arcs = np.linspace(0.0, math.pi, math.ceil(math.pi / arc_step) + 1)
    graded = arcs[1] * _HALVED
    arcs = np.unique(np.concatenate([arcs, graded, math.pi - graded]))
    crossed = [border.radii(arcs) for border in _borders_in_reach(cutter, band)]
    return np.concatenate([np.empty(0), *crossed])


def _borders_in_reach(cutter: Cutter, band: UncutBand) -> list[Border]:
    return [border for border in band.borders if border.tangent_radius < cutter.radius]


def _cone_heights(cutter: Cutter, band: UncutBand, arc_step: float) -> list[float]:
    """Heights of even arcs on a cone whose edge first meets the stock on it, or nearly so.

    As it is cut all around at its tip but for a little, or hardly touches: the arc is then steep.
    """
    top, slope = corner_height(cutter), math.tan(cutter.edge_angle)
    start = cutter.radius - cutter.corner_radius * (1.0 - math.sin(cutter.edge_angle))
    if all(one.tangent_radius * (1.0 + _SEGMENT_LAG) <= start for one in band.borders):
        return []
    radius = _radii_of_even_arcs(cutter, band, arc_step)
    return list(top + (radius[radius > start] - start) * slope)


def _corner_angles(cutter: Cutter, band: UncutBand, arc_step: float) -> NDArray[np.float64]:
    """Immersion angles of the segment borders within the corner, rad."""
    count = max(1, math.ceil(cutter.edge_angle / arc_step))
    angles = np.linspace(0.0, cutter.edge_angle, count + 1)
    radius = _radii_of_even_arcs(cutter, band, arc_step)
    sine = (radius - cutter.radius + cutter.corner_radius) / cutter.corner_radius
    inside = (sine > 0.0) & (sine < math.sin(cutter.edge_angle))
    angles = np.append(angles, np.arcsin(sine[inside]))
    angles = np.sort(angles)
    return angles[np.append(True, np.diff(angles) > 1e-6)]


def edge_line(
    cutter: Cutter, max_depth: float, band: UncutBand, heights: list[float], arc_step: float
) -> EdgeLine:
    """Profile of the nominal edge from the tip to a height.

    Depth in m; `heights` are borders of segments above the corner, m; by `arc_step`, rad, a corner
    turns within a segment, and its arc changes.
    """
    corner = cutter.corner_radius
    height, radius = [0.0], [cutter.radius - corner]
    immersion: list[tuple[float, float]] = []
    length: list[float] = []
    if corner > 0.0:
        angles = _corner_angles(cutter, band, arc_step)
        height = list(corner * (1.0 - np.cos(angles)))
        radius = list(cutter.radius - corner + corner * np.sin(angles))
        immersion = list(itertools.pairwise(angles))
        length = list(corner * np.diff(angles))
    top = corner_height(cutter)
    if max_depth > top:
        slope = 1.0 / math.tan(cutter.edge_angle) if cutter.edge_angle < 0.5 * math.pi else 0.0
        start = radius[-1]
        for position in sorted({h for h in heights if top < h < max_depth} | {max_depth}):
            length.append((position - height[-1]) / math.sin(cutter.edge_angle))
            height.append(position)
            radius.append(start + slope * (position - top))
            immersion.append((cutter.edge_angle, cutter.edge_angle))
    return EdgeLine(np.array(height), np.array(radius), np.array(immersion), np.array(length))


def _even_heights(spacing: float, max_depth: float) -> list[float]:
    return list(spacing * np.arange(1, math.ceil(max_depth / spacing)))


def _cone_borders(cutter: Cutter, max_depth: float, share: float, slope: float) -> list[float]:
    """Heights between which a cone widens by no more than a share of its radius.

    Nor does the edge trail by more than that, rad; it does so by `slope`, rad/m.
    """
    top, widening = corner_height(cutter), 1.0 / math.tan(cutter.edge_angle)
    start = cutter.radius - cutter.corner_radius * (1.0 - math.sin(cutter.edge_angle))
    heights = [top]
    while heights[-1] < max_depth:
        radius = max(cutter.radius, start + widening * (heights[-1] - top))
        heights.append(heights[-1] + share / max(widening / radius, slope))
    return heights[1:-1]


def crossing_heights(cutter: Cutter, max_depth: float) -> list[float]:
    """Heights at which two flutes lie on the same side of the axis: their order changes."""
    slope = np.tan(np.asarray(cutter.helix)) / cutter.radius
    angle = cutter.tooth_angles
    heights = []
    for i in range(cutter.teeth):
        for j in range(i):
            rate = slope[i] - slope[j]
            if abs(rate) * max_depth < 1e-9:
                continue
            gap = angle[i] - angle[j]
            for revolution in range(-4, 5):
                height = (gap + _REVOLUTION * revolution) / rate
                if 0.0 < height < max_depth:
                    heights.append(height)
    return heights


def straight_borders(
    cutter: Cutter,
    max_depth: float,
    band: UncutBand,
    own_passes: bool,
    arc_step: float,
    relative_length: float,
) -> list[float]:
    """Heights of the segment borders above the corner, m; arguments as of `edge_line`.

    Where runout or setting errors give flutes of different helix passes of their own, and along a
    cone, the segments are short.
    """
    heights = crossing_heights(cutter, max_depth)
    several = len(set(cutter.helix)) > 1
    slope = max(abs(math.tan(helix)) for helix in cutter.helix) / cutter.radius
    if own_passes and several and cutter.serration is None:
        heights += _even_heights(relative_length * _SEGMENT_LAG / slope, max_depth)
    if cutter.edge_angle < 0.5 * math.pi - 1e-9:
        # the radius, and with it the arc, changes along a cone
        heights += _cone_borders(cutter, max_depth, relative_length * _SEGMENT_LAG, slope)
        heights += _cone_heights(cutter, band, arc_step)
    return heights
