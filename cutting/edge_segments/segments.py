"""Edges of a tool as segments along their length, for the linear analysis of stability.

A segment belongs to one tooth and cuts, between an entry and an exit angle, the surface that one
certain earlier pass has left. Along it position on the tool and delay vary linearly with the
height, and the arc with the length. Segments of a tooth that follow one another and cut what the
same earlier tooth has left make a group: along it all is smooth, so that a force is summed up over
an interval of its segments at once. An straight cylindrical edge in a tool of one helix is one
segment from the tip to any height; corners are cut into segments by their curvature; where runout,
setting errors or serration decide which pass left the surface, every pass has its own arc.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.edge_segments.earlier_passes import Edges
from cutting.edge_segments.edge_profile import EdgeLine, edge_line, straight_borders
from cutting.edge_segments.engagement_arcs import (
    Owner,
    Segment,
    segments_of_like_teeth,
    segments_of_one_pass,
    segments_of_passes,
)
from cutting.edge_segments.inclined_edges import InclinedEdges
from cutting.edge_segments.segment_ends import TURNING, WITHIN_WAVES
from cutting.engagement.inclined_tool import InclinedEngagement
from cutting.engagement.uncut_band import SLOT, UncutBand
from cutting.force.law import ForceLaw, SlopePower
from cutting.process_damping.flank import ProcessDampingLaw
from cutting.process_damping.linear_flank import LinearFlank, bare_flank
from cutting.tool.cutter import Cutter

_REVOLUTION = 2.0 * math.pi
#: a corner turns by this much within a segment, and its arc changes by it, rad
_SEGMENT_TURN = math.radians(1.2)
#: the same where the earlier passes are searched: the arcs are taken at two positions within
_SEGMENT_TURN_OF_PASSES = math.radians(2.5)
#: inclined tools whose segments are kept; every depth of a search is one
_KEPT_GEOMETRIES = 512
#: shapes of the columns of a table of no segments
_NO_SEGMENTS = (0, 0, 0, (0, 2), (0, 2), (0, 2), (0, 2), (0, 2), (0, 2), (0, 3), (0, 2), 0, 0, 0)


class EdgeSegments(NamedTuple):
    """Segments of all edges; the last axis of a pair holds the values at the low and high end."""

    bottom: NDArray[np.float64]  # height of the low end above the tip, m (P,)
    thickness: NDArray[np.float64]  # along the axis, m (P,)
    length: NDArray[np.float64]  # of edge, m (P,)
    angle: NDArray[np.float64]  # position on the tool, rad (P, 2)
    entry: NDArray[np.float64]  # rad (P, 2)
    exit: NDArray[np.float64]  # rad (P, 2)
    delay: NDArray[np.float64]  # angle since the pass that left the surface, rad (P, 2)
    immersion: NDArray[np.float64]  # axial immersion angle, rad (P, 2)
    radius: NDArray[np.float64]  # m (P, 2)
    corner: NDArray[np.float64]  # radius of the corner that the segment lies on, m; 0 for none (P,)
    delay_index: NDArray[np.int64]  # of the constant delay; -1 where it varies (P,)
    distinct_delay: NDArray[np.float64]  # constant delays, each once, rad (G,)
    cutting: NDArray[np.float64]  # slope at the reference chip: tangential .. axial, N/m^2 (P, 3)
    radial_offset: NDArray[np.float64]  # by which the earlier edge reaches further out, m (P, 2)
    axial_offset: NDArray[np.float64]  # and further towards the work, m (P,)
    vanishing: NDArray[np.int64]  # 1, 2: there is no chip at the entry, at the exit (P,)
    feed: float  # by which the work moves in the plane of rotation for an angle turned, m/rad
    axial_feed: float  # by which it moves along the tool axis, m/rad; 0 for an upright tool
    #: height on the edge above the depth of cut that it is engaged up to, m; 0 for an upright tool,
    #: whose arcs are the same at every depth. Others are segments of one depth alone
    lift: float
    #: of the slope: slope = cutting (chip/reference)^exponent, 0 for a linear law; where directions
    #: differ the lowest, by which the chip that vanishes is integrated
    exponent: float
    above_exponent: NDArray[np.float64]  # exponent of each direction above that (3,)
    directional: bool  # whether the three differ
    reference: float  # m
    #: `TURNING` where an edge first meets or last leaves the stock, `WITHIN_WAVES` where it does so
    #: from wave to wave, else 0 (P, 2)
    turning: NDArray[np.int64]
    outline: NDArray[np.float64]  # radius at the tip's cylinder, corner radius, edge angle (3,)
    first_of_group: NDArray[np.int64]  # first segment of each group, then their number (C + 1,)
    flank: LinearFlank


def edge_segments(
    cutter: Cutter,
    laws: list[ForceLaw],
    band: UncutBand,
    feed_per_revolution: float,
    max_depth: float,
    flank: ProcessDampingLaw | None = None,
    relative_length: float = 1.0,
) -> EdgeSegments:
    """Cut the edges of a tool into segments from the tip to a height.

    Parameters
    ----------
    cutter : Cutter
    laws : list of ForceLaw
        One for each tooth.
    band : UncutBand
    feed_per_revolution, max_depth : float
        m.
    flank : ProcessDampingLaw, optional
        Ploughing is taken about a still tool; see `ProcessDampingLaw.linear`.
    relative_length : float
        Factor on how much an edge turns, trails or widens within a segment.
    """
    wave = cutter.serration is not None
    own_passes = wave or np.ptp(cutter.radial_offsets) > 0.0 or np.ptp(cutter.axial_offsets) > 0.0
    arc_step = relative_length * (_SEGMENT_TURN_OF_PASSES if own_passes else _SEGMENT_TURN)
    heights = straight_borders(cutter, max_depth, band, own_passes, arc_step, relative_length)
    line = edge_line(cutter, max_depth, band, heights, arc_step)
    slopes = [law.slope_power.cutting for law in laws]
    if own_passes:
        edges = Edges(cutter, band, feed_per_revolution)
        segments, owners = segments_of_passes(edges, line, max_depth, slopes, relative_length)
    else:
        segments, owners = segments_of_one_pass(cutter, line, band, slopes)
    turning = turning_ends(segments, owners, wave)
    power = laws[0].slope_power
    sized = power.lowest_exponent != 0.0
    order, first_of_group = segment_groups(segments, owners, sized=sized, apart=wave and sized)
    segments = [segments[i] for i in order]
    feed = (feed_per_revolution / _REVOLUTION, 0.0)
    table = _as_arrays(segments, turning[order], first_of_group, cutter, feed, 0.0)
    return _with_law(table, power, flank, cutter)


def inclined_edge_segments(
    engagement: InclinedEngagement,
    laws: list[ForceLaw],
    feed_per_revolution: float,
    flank: ProcessDampingLaw | None = None,
    relative_length: float = 1.0,
) -> EdgeSegments:
    """Cut the edges of a tool with an inclined axis into segments, for its axial depth alone.

    In the axes of the tool. Parameters as of `edge_segments`.
    """
    power = laws[0].slope_power
    geometry = _inclined_geometry(
        engagement, feed_per_revolution, relative_length, power.lowest_exponent != 0.0
    )
    slopes = np.array([law.slope_power.cutting for law in laws])
    segments = geometry.segments._replace(cutting=slopes[geometry.tooth])
    return _with_law(segments, power, flank, engagement.cutter)


class _Geometry(NamedTuple):
    """Segments without a force law, and the tooth of each."""

    segments: EdgeSegments
    tooth: NDArray[np.int64]  # (P,)


@lru_cache(maxsize=_KEPT_GEOMETRIES)
def _inclined_geometry(
    engagement: InclinedEngagement, feed_per_revolution: float, relative_length: float, sized: bool
) -> _Geometry:
    """Segments of an inclined tool, kept for other coefficients: arcs do not depend on them."""
    edges, line, top = inclined_line(engagement, feed_per_revolution, relative_length)
    no_law = [np.zeros(3)] * engagement.cutter.teeth
    of_teeth = segments_of_like_teeth if edges.all_teeth_equal else segments_of_passes
    segments, owners = of_teeth(edges, line, top, no_law, relative_length)
    turning = turning_ends(segments, owners, serrated=False)
    order, first_of_group = segment_groups(segments, owners, sized=sized, apart=False)
    segments = [segments[i] for i in order]
    highest = max((one.bottom + one.thickness for one in segments), default=top)
    feed = feed_per_revolution / _REVOLUTION
    along = (feed * engagement.along_feed, feed * engagement.along_axis)
    table = _as_arrays(
        segments, turning[order], first_of_group, engagement.cutter, along,
        highest - engagement.axial_depth,
    )  # fmt: skip
    return _Geometry(table, np.array([owners[i].tooth for i in order], dtype=np.int64))


def inclined_line(
    engagement: InclinedEngagement, feed_per_revolution: float, relative_length: float = 1.0
) -> tuple[InclinedEdges, EdgeLine, float]:
    """Edges of an inclined tool, their profile, and the height that they may be engaged to, m."""
    cutter, top = engagement.cutter, engagement.top
    step = relative_length * _SEGMENT_TURN_OF_PASSES
    heights = straight_borders(cutter, top, SLOT, True, step, relative_length)
    line = edge_line(cutter, top, SLOT, heights, step)
    return InclinedEdges(engagement, feed_per_revolution), line, top


def _as_arrays(
    segments: list[Segment],
    turning: NDArray[np.int64],
    first_of_group: NDArray[np.int64],
    cutter: Cutter,
    feed: tuple[float, float],
    lift: float,
) -> EdgeSegments:
    """Table of segments without size effect and flank."""
    count = len(segments)
    # where no edge reaches the stock the shapes are those of one segment
    columns = [np.zeros(shape) for shape in _NO_SEGMENTS]
    if count:
        columns = [np.array(column, dtype=np.float64) for column in zip(*segments, strict=True)]
    table = Segment(*columns)
    delay = table.delay
    constant = np.abs(delay[:, 0] - delay[:, 1]) < 1e-12 if count else np.zeros(0, dtype=bool)
    distinct: list[float] = []
    delay_index = np.full(count, -1, dtype=np.int64)
    for position in np.flatnonzero(constant):
        value = 0.5 * (delay[position, 0] + delay[position, 1])
        near = [i for i, other in enumerate(distinct) if abs(other - value) < 1e-10]
        if not near:
            distinct.append(value)
        delay_index[position] = near[0] if near else len(distinct) - 1
    return EdgeSegments(
        bottom=table.bottom, thickness=table.thickness, length=table.length, angle=table.angle,
        entry=table.entry, exit=table.exit, delay=delay, immersion=table.immersion,
        radius=table.radius, delay_index=delay_index, distinct_delay=np.array(distinct),
        cutting=table.cutting, feed=feed[0], axial_feed=feed[1], lift=lift,
        radial_offset=table.radial_offset,
        axial_offset=table.axial_offset, corner=table.corner,
        vanishing=np.asarray(table.vanishing, dtype=np.int64),
        exponent=0.0, above_exponent=np.zeros(3), directional=False, reference=1.0,
        turning=turning, flank=bare_flank(), first_of_group=first_of_group,
        outline=np.array([cutter.radius, cutter.corner_radius, cutter.edge_angle]),
    )  # fmt: skip


def _with_law(
    segments: EdgeSegments, power: SlopePower, flank: ProcessDampingLaw | None, cutter: Cutter
) -> EdgeSegments:
    """The segments with the size effect of a force law and a flank."""
    return segments._replace(
        exponent=power.lowest_exponent,
        above_exponent=power.above_lowest,
        directional=bool(np.any(power.above_lowest != 0.0)),
        reference=power.reference,
        flank=segments.flank if flank is None else flank.linear(cutter.radius),
    )


def period_angle(cutter: Cutter) -> float:
    """Angle after which the tool repeats itself, rad: a revolution over a whole number."""
    angle, offset, axial = cutter.tooth_angles, cutter.radial_offsets, cutter.axial_offsets
    for parts in range(cutter.teeth, 1, -1):
        if cutter.teeth % parts:
            continue
        step = cutter.teeth // parts
        turned = np.mod(np.roll(angle, -step) - angle, _REVOLUTION)
        alike = (
            np.allclose(turned, _REVOLUTION / parts, rtol=0.0, atol=1e-9)
            and np.allclose(np.roll(offset, -step), offset, rtol=0.0, atol=1e-12)
            and np.allclose(np.roll(axial, -step), axial, rtol=0.0, atol=1e-12)
            and np.allclose(np.roll(cutter.helix, -step), cutter.helix, rtol=0.0, atol=1e-12)
        )
        if alike and cutter.serration is None:
            return _REVOLUTION / parts
    return _REVOLUTION


#: with a size effect a group on a corner ends where its inclination has grown by this factor: at
#: the tip the slope of the force law is infinite
_GROUP_GROWTH = 3.0


def segment_groups(
    segments: list[Segment], owners: list[Owner], sized: bool, apart: bool
) -> tuple[list[int], NDArray[np.int64]]:
    """Order of the segments along groups, and the first of each group, then their number (C + 1,).

    The chip on a serrated edge is not smooth from segment to segment: with a size effect every
    segment is a group apart.
    """
    met: dict[tuple[int, int, int], int] = {}
    keys = []
    for owner in owners:
        segment, tooth, other = owner
        met[owner] = met.get(owner, -1) + 1
        keys.append((tooth, other, met[owner], segment))
    order = sorted(range(len(segments)), key=lambda i: keys[i])
    starts: list[int] = []
    lowest = 0.0  # inclination at the start of the group
    for position, i in enumerate(order):
        kappa, corner = segments[i].immersion, segments[i].corner
        before = order[position - 1]
        follows = position > 0 and keys[i] == (*keys[before][:3], keys[before][3] + 1)
        smooth = follows and not apart and segments[before].corner == corner
        if not smooth or (sized and corner > 0.0 and kappa[1] > _GROUP_GROWTH * lowest):
            starts.append(position)
            lowest = max(kappa[0], 1e-12)
    return order, np.array([*starts, len(order)], dtype=np.int64)


def turning_ends(segments: list[Segment], owners: list[Owner], serrated: bool) -> NDArray[np.int64]:
    """Mark the ends (P, 2) of segments at which an edge first meets the stock, or last leaves it.

    There the spindle angle of entry or exit turns round along the edge, or the edge ends, or it
    is no more cut all around, or the surface of another earlier pass is the nearest from there on;
    not along a serrated edge, on which that changes from wave to wave for a small part each. Those
    of a serrated edge are marked `WITHIN_WAVES`.
    """
    marks = np.zeros((len(segments), 2), dtype=np.int64)
    position = {owner: i for i, owner in enumerate(owners)}
    there = {owner[: 2 if serrated else 3] for owner in owners}
    for owner, i in position.items():
        segment, tooth, other = owner
        following = position.get((segment + 1, tooth, other))
        key = (tooth,) if serrated else (tooth, other)
        marks[i, 0] |= segment > 0 and (segment - 1, *key) not in there
        marks[i, 1] |= (segment + 1, *key) not in there
        if following is None:
            continue
        this, that = segments[i], segments[following]
        angle, next_angle = this.angle, that.angle
        for one, next_one, end in ((this.entry, that.entry, 0.0), (this.exit, that.exit, math.pi)):
            whole = one[0] == one[1] == end
            marks[i, 1] |= whole and not next_one[0] == next_one[1] == end
            rise = (one[1] - one[0]) - (angle[1] - angle[0])
            marks[i, 1] |= (
                rise * ((next_one[1] - next_one[0]) - (next_angle[1] - next_angle[0])) < 0.0
            )
    return marks * (WITHIN_WAVES if serrated else TURNING)
