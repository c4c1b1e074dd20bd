"""Segments of the edges of all teeth with the arcs in which they cut."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.edge_segments.earlier_passes import GAUSS, Edges
from cutting.edge_segments.edge_profile import EdgeLine
from cutting.engagement.immersion import slice_engagement
from cutting.engagement.uncut_band import UncutBand
from cutting.tool.cutter import Cutter
from cutting.tool.tooth_passes import earlier_passes

Pair = NDArray[np.float64] | tuple[float, float]

#: arcs shorter than this are none, rad
_SHORTEST_ARC = 1e-9


class Segment(NamedTuple):
    """A segment of an edge and one of its arcs; of a pair the value at the low and the high end."""

    bottom: float  # height of the low end above the tip, m
    thickness: float  # along the axis, m
    length: float  # of edge, m
    angle: Pair  # position on the tool, rad
    entry: Pair  # rad
    exit: Pair  # rad
    delay: Pair  # angle since the pass that left the surface, rad
    immersion: Pair  # axial immersion angle, rad
    radius: Pair  # m
    cutting: NDArray[np.float64]  # slope at the reference chip: tangential .. axial, N/m^2 (3,)
    radial_offset: Pair  # by which the earlier edge reaches further out, m
    axial_offset: float  # and further towards the work, m
    corner: float  # radius of the corner that it lies on, m; 0 for none
    vanishing: int  # 1, 2: there is no chip at the entry, at the exit


class Owner(NamedTuple):
    """Whose segment it is."""

    segment: int  # number along the edge
    tooth: int
    earlier: int  # tooth that left the surface


def segments_of_one_pass(
    cutter: Cutter, line: EdgeLine, band: UncutBand, slopes: list[NDArray[np.float64]]
) -> tuple[list[Segment], list[Owner]]:
    """Segments of teeth that each cut what the one before them has left.

    Slopes (3,) of the force law of each tooth at the reference chip, N/m^2.
    Returned with the owner of each segment.
    """
    lag = np.tan(np.asarray(cutter.helix)) / cutter.radius
    segments: list[Segment] = []
    owners: list[Owner] = []
    entry, leave = _arcs_at_borders(cutter, line, band)
    for segment in range(line.length.size):
        ends = slice(segment, segment + 2)
        middle = 0.5 * (line.height[segment] + line.height[segment + 1])
        angle = cutter.tooth_angles[:, None] - np.outer(lag, [*line.height[ends], middle])
        kappa = line.immersion[segment]
        arc = _arc_of_segment(entry[ends], leave[ends], band)
        if arc is None:
            continue
        earlier, ahead = earlier_passes(angle[:, 2:])
        for tooth in range(cutter.teeth):
            other = int(earlier[tooth, 0, 0])
            # flutes of different helix are not as far ahead at the ends as in the middle
            apart = angle[other] - angle[tooth]
            gaps = ahead[tooth, 0, 0] + apart - apart[2]
            owners.append(Owner(segment, tooth, other))
            segments.append(
                Segment(
                    line.height[segment], line.height[segment + 1] - line.height[segment],
                    line.length[segment], angle[tooth, :2], arc[0], arc[1], gaps[:2], kappa,
                    line.radius[ends], slopes[tooth], (0.0, 0.0), 0.0,
                    cutter.corner_radius if kappa[0] < kappa[1] else 0.0, 0,
                )
            )  # fmt: skip
    return segments, owners


def segments_of_passes(
    edges: Edges,
    line: EdgeLine,
    max_depth: float,
    slopes: list[NDArray[np.float64]],
    relative_length: float,
) -> tuple[list[Segment], list[Owner]]:
    """Segments of teeth for each of which the earlier pass is found that left the surface.

    Depth in m, slopes as of `segments_of_one_pass`, relative length 1 or less. Returned with the
    owner of each segment.
    """
    borders = _borders_up_to(edges, line, max_depth)
    segments: list[Segment] = []
    owners: list[Owner] = []
    for tooth in range(edges.cutter.teeth):
        found, of_tooth = _segments_of_tooth(edges, tooth, slopes[tooth], borders, relative_length)
        segments += found
        owners += of_tooth
    return segments, owners


def segments_of_like_teeth(
    edges: Edges,
    line: EdgeLine,
    max_depth: float,
    slopes: list[NDArray[np.float64]],
    relative_length: float,
) -> tuple[list[Segment], list[Owner]]:
    """The same of teeth of one helix that each cut what the one before them has left.

    The first tooth stands for all: the others are turned on the tool, at their own delays.
    """
    borders = _borders_up_to(edges, line, max_depth)
    first, of_first = _segments_of_tooth(edges, 0, slopes[0], borders, relative_length)
    place = edges.cutter.tooth_angles
    earlier, ahead = earlier_passes(place[:, None])
    segments: list[Segment] = []
    owners: list[Owner] = []
    for tooth in range(edges.cutter.teeth):
        gap, other = float(ahead[tooth, 0, 0]), int(earlier[tooth, 0, 0])
        segments += [
            one._replace(
                angle=np.asarray(one.angle) + place[tooth], delay=(gap, gap), cutting=slopes[tooth]
            )
            for one in first
        ]
        owners += [owner._replace(tooth=tooth, earlier=other) for owner in of_first]
    return segments, owners


def _borders_up_to(edges: Edges, line: EdgeLine, max_depth: float) -> NDArray[np.float64]:
    """Borders of the segments of a line, as lengths of edge beyond the tip, up to a height, m."""
    borders = np.concatenate([[0.0], np.cumsum(line.length)])
    # the line runs on to the end of the corner
    borders = np.minimum(borders, edges.position(max_depth))
    return np.append(borders[borders < borders[-1]], borders[-1])


def _segments_of_tooth(
    edges: Edges, tooth: int, slope: NDArray[np.float64], borders: NDArray[np.float64],
    relative_length: float,
) -> tuple[list[Segment], list[Owner]]:  # fmt: skip
    """The same of one tooth.

    What bends along a segment is the line through its values at two Gauss points: so the area in
    the cut, and all that is linear along it, is right to the fourth order.
    """
    positions = edges.segment_borders(tooth, borders, relative_length)
    low, high = positions[:-1], positions[1:]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    own = np.full(middle.size, tooth)
    inner = (middle - GAUSS * half, middle + GAUSS * half)
    at_ends, at_middle = edges.profile(positions), edges.profile(middle)
    radial = _through(*(edges.radial(edges.profile(position).height) for position in inner))
    angle, between = edges.angle(at_ends.height), edges.angle(at_middle.height)
    ahead = edges.ahead(own, at_middle.height)
    one, other, central = (edges.arcs(own, position) for position in (*inner, middle))
    alike = np.all(one.kind == other.kind, axis=1)
    ends = np.where(
        alike[:, None, None], _through(one.angle, other.angle), central.angle[..., None]
    )
    met = np.where(alike[:, None], one.tooth, central.tooth)
    vanishing = _where_chip_vanishes(np.where(alike[:, None], one.kind, central.kind))
    axial, corner = edges.cutter.axial_offsets, edges.cutter.corner_radius
    segments: list[Segment] = []
    owners: list[Owner] = []
    for segment, arc in zip(*np.nonzero(met >= 0), strict=True):
        k, pair = int(met[segment, arc]), slice(segment, segment + 2)
        apart = angle[pair, k] - angle[pair, tooth]
        gaps = ahead[segment, k] + apart - (between[segment, k] - between[segment, tooth])
        owners.append(Owner(int(segment), tooth, k))
        segments.append(
            Segment(
                at_ends.height[segment], at_ends.height[segment + 1] - at_ends.height[segment],
                high[segment] - low[segment], angle[pair, tooth],
                ends[segment, arc], ends[segment, arc + 1], gaps, at_ends.immersion[pair],
                at_ends.radius[pair], slope, radial[segment, k] - radial[segment, tooth],
                axial[k] - axial[tooth], corner if middle[segment] < edges.on_corner else 0.0,
                vanishing[segment, arc],
            )
        )  # fmt: skip
    return segments, owners


def _where_chip_vanishes(kind: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where the chip of each arc (P, W) vanishes: at its entry (1), at its exit (2), or not.

    For a chip against the surface of one pass it is so where the arc borders on air.
    """
    air = np.pad(kind, ((0, 0), (1, 1)), constant_values=-1) // 4 == 0
    inner = np.pad(kind, ((0, 0), (1, 1)), constant_values=-1) % 4 >= 2
    begins = inner[:, 1:-1] & (air[:, :-2] | (np.arange(kind.shape[1]) == 0))
    ends = air[:, 2:] & inner[:, 2:]
    return np.where(begins, 1, np.where(ends, 2, 0))


def _through(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (..., 2) at the ends of lines through those at two Gauss points."""
    middle, rise = 0.5 * (one + other), 0.5 / GAUSS * (other - one)
    return np.stack([middle - rise, middle + rise], axis=-1)


def _arcs_at_borders(
    cutter: Cutter, line: EdgeLine, band: UncutBand
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Entry and exit (L + 1,) at the borders of segments, rad, whose mean each segment has.

    Within a segment the arc follows a chord, which all along lies on one side of it. At a border
    the arc is taken off by the mean distance (Simpson) on both sides of it: what a force is short
    of falls with the fourth power of the length of the segments, not the second.
    """

    def arcs(radius: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return slice_engagement(band, np.maximum(radius, 1e-12))

    bent = line.immersion[:, 0] < line.immersion[:, 1]
    on_corner = cutter.corner_radius * (1.0 - np.sin(line.immersion.mean(axis=1)))
    straight = 0.5 * (line.radius[:-1] + line.radius[1:])
    middle = arcs(np.where(bent, cutter.radius - on_corner, straight))
    ends = arcs(line.radius)
    inside = (ends[1] - ends[0] > _SHORTEST_ARC) & (ends[1] - ends[0] < math.pi - _SHORTEST_ARC)
    both = inside[:-1] & inside[1:]
    for at_ends, at_middle in zip(ends, middle, strict=True):
        apart = np.zeros(line.length.size)
        chord = 0.5 * (at_ends[:-1][both] + at_ends[1:][both])
        apart[both] = (at_middle[both] - chord) * 2.0 / 3.0
        beside = np.append(both, False).astype(float) + np.append(False, both)
        shift = np.append(apart, 0.0) + np.append(0.0, apart)
        at_ends[inside] += shift[inside] / np.maximum(beside[inside], 1.0)
    return ends


def _arc_of_segment(
    entry: NDArray[np.float64], leave: NDArray[np.float64], band: UncutBand
) -> NDArray[np.float64] | None:
    """Entry and exit at both ends (2, 2); where one end is out of the stock its arc is a point."""
    cuts = entry < leave
    if not cuts.any():
        return None
    if not cuts.all():
        # the arc shrinks towards the side on which the band lies
        position = math.pi if band.side < 0 else 0.0
        entry, leave = np.where(cuts, entry, position), np.where(cuts, leave, position)
    return np.stack([entry, leave])
