"""Edges of a tool as pieces along their length, for the linear analysis of stability.

A piece belongs to one tooth and cuts, between an entry and an exit angle, the surface that one
certain earlier pass has left. Along it place on the tool and delay vary linearly with the height,
and the arc with the length.
Pieces of a tooth that follow one another and cut what the same earlier tooth has left make a chain:
along it all is smooth, so that a force is summed up over a run of its pieces at once.
An upright edge in a tool of one helix is one piece from the tip to any height; corners are cut
into pieces by their curvature; where runout, setting errors or serration decide which pass left the
surface, every pass has its own arc.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.edge_passes import GAUSS, Edges, piece_borders
from cutting.engagement import MillingMode, slice_engagement
from cutting.force_law import ExponentialLaw, ForceLaw
from cutting.ploughing import Ploughing
from cutting.process_damping import ViscousProcessDamping
from cutting.regeneration import earlier_passes
from cutting.tool import Cutter, corner_height

_TURN = 2.0 * math.pi
#: a corner turns by this much within a piece, and its arc changes by it, rad
_PIECE_TURN = math.radians(1.2)
#: the same where the earlier passes are looked for: the arcs are taken at two places within
_PIECE_TURN_OF_PASSES = math.radians(2.5)
#: an edge trails, or a cone widens, by this much within a piece, rad
_PIECE_LAG = 0.03
#: with a size effect a chain on a corner ends where its inclination has grown by this factor: at
#: the tip the slope of the force law is infinite
_CHAIN_GROWTH = 3.0
#: shapes of the columns of a table of no pieces
_NO_PIECES = (0, 0, 0, (0, 2), (0, 2), (0, 2), (0, 2), (0, 2), (0, 2), (0, 3), (0, 2), 0, 0, 0)
#: arcs shorter than this are none, rad
_SHORTEST_ARC = 1e-9


class EdgePieces(NamedTuple):
    """Pieces of all edges; the last axis of a pair holds the value at the low and the high end."""

    bottom: NDArray[np.float64]  # height of the low end above the tip, m (P,)
    thickness: NDArray[np.float64]  # along the axis, m (P,)
    length: NDArray[np.float64]  # of edge, m (P,)
    angle: NDArray[np.float64]  # place on the tool, rad (P, 2)
    entry: NDArray[np.float64]  # rad (P, 2)
    exit: NDArray[np.float64]  # rad (P, 2)
    delay: NDArray[np.float64]  # angle since the pass that left the surface, rad (P, 2)
    immersion: NDArray[np.float64]  # axial immersion angle, rad (P, 2)
    radius: NDArray[np.float64]  # m (P, 2)
    corner: NDArray[np.float64]  # radius of the corner that the piece lies on, m; 0 for none (P,)
    group: NDArray[np.int64]  # pieces of equal, constant delay; -1 where it varies (P,)
    group_delay: NDArray[np.float64]  # rad (G,)
    cutting: NDArray[np.float64]  # slope at the reference chip: tangential .. axial, N/m^2 (P, 3)
    inset: NDArray[np.float64]  # by which the earlier edge reaches further out, m (P, 2)
    axial_inset: NDArray[np.float64]  # and further towards the work, m (P,)
    vanishing: NDArray[np.int64]  # 1, 2: there is no chip at the entry, at the exit (P,)
    feed: float  # by which the work moves for an angle turned, m/rad
    exponent: float  # of the slope: slope = cutting (chip/reference)^exponent, 0 for a linear law
    reference: float  # m
    turning: NDArray[np.int64]  # 1 where an edge first meets or last leaves the stock within (P, 2)
    outline: NDArray[np.float64]  # radius at the tip's cylinder, corner radius, edge angle (3,)
    chain: NDArray[np.int64]  # first piece of each chain, and the number of pieces (C + 1,)
    damping: NDArray[
        np.float64
    ]  # force per edge length, rate and 1/V: tangential, radial, N/m (2,)


class _Line(NamedTuple):
    """Profile of the edge at piece borders: heights, radii, immersion angles, lengths between."""

    height: NDArray[np.float64]  # (L+1,)
    radius: NDArray[np.float64]  # (L+1,)
    immersion: NDArray[np.float64]  # at both ends of every piece (L, 2)
    length: NDArray[np.float64]  # (L,)


def _radii_of_even_arcs(
    cutter: Cutter, mode: MillingMode, radial_depth: float, turn: float
) -> NDArray[np.float64]:
    """Radii at which the arc has grown by even steps, from none to half a turn.

    Where the edge first meets the stock its arc grows steeply, and again where it is no more cut
    all around.
    """
    reach = cutter.radius - radial_depth
    if mode == "slot" or abs(reach) >= cutter.radius:
        return np.empty(0)
    arcs = np.linspace(0.0, math.pi, math.ceil(math.pi / turn) + 1)
    with np.errstate(divide="ignore"):
        radius = reach / np.cos(arcs)
    return radius[radius > 0.0]


def _cone_heights(
    cutter: Cutter, mode: MillingMode, radial_depth: float, turn: float
) -> list[float]:
    """Heights of even arcs on a cone on which the edge first meets the stock."""
    top, slope = corner_height(cutter), math.tan(cutter.edge_angle)
    start = cutter.radius - cutter.corner_radius * (1.0 - math.sin(cutter.edge_angle))
    if abs(cutter.radius - radial_depth) <= start:
        return []
    radius = _radii_of_even_arcs(cutter, mode, radial_depth, turn)
    return list(top + (radius[radius > start] - start) * slope)


def _corner_angles(
    cutter: Cutter, mode: MillingMode, radial_depth: float, turn: float
) -> NDArray[np.float64]:
    """Immersion angles of the piece borders within the corner, rad."""
    count = max(1, math.ceil(cutter.edge_angle / turn))
    angles = np.linspace(0.0, cutter.edge_angle, count + 1)
    radius = _radii_of_even_arcs(cutter, mode, radial_depth, turn)
    sine = (radius - cutter.radius + cutter.corner_radius) / cutter.corner_radius
    inside = (sine > 0.0) & (sine < math.sin(cutter.edge_angle))
    angles = np.append(angles, np.arcsin(sine[inside]))
    angles = np.sort(angles)
    return angles[np.append(True, np.diff(angles) > 1e-6)]


def _line(
    cutter: Cutter,
    deepest: float,
    mode: MillingMode,
    radial_depth: float,
    heights: list[float],
    turn: float,
) -> _Line:
    corner = cutter.corner_radius
    height, radius = [0.0], [cutter.radius - corner]
    immersion: list[tuple[float, float]] = []
    length: list[float] = []
    if corner > 0.0:
        angles = _corner_angles(cutter, mode, radial_depth, turn)
        height = list(corner * (1.0 - np.cos(angles)))
        radius = list(cutter.radius - corner + corner * np.sin(angles))
        immersion = list(itertools.pairwise(angles))
        length = list(corner * np.diff(angles))
    top = corner_height(cutter)
    if deepest > top:
        slope = 1.0 / math.tan(cutter.edge_angle) if cutter.edge_angle < 0.5 * math.pi else 0.0
        start = radius[-1]
        for place in sorted({h for h in heights if top < h < deepest} | {deepest}):
            length.append((place - height[-1]) / math.sin(cutter.edge_angle))
            height.append(place)
            radius.append(start + slope * (place - top))
            immersion.append((cutter.edge_angle, cutter.edge_angle))
    return _Line(np.array(height), np.array(radius), np.array(immersion), np.array(length))


def _even_heights(spacing: float, deepest: float) -> list[float]:
    return list(spacing * np.arange(1, math.ceil(deepest / spacing)))


def crossing_heights(cutter: Cutter, deepest: float) -> list[float]:
    """Heights at which two flutes lie on the same side of the axis: their order changes."""
    slope = np.tan(np.asarray(cutter.helix)) / cutter.radius
    angle = cutter.tooth_angles
    heights = []
    for i in range(cutter.teeth):
        for j in range(i):
            rate = slope[i] - slope[j]
            if abs(rate) * deepest < 1e-9:
                continue
            gap = angle[i] - angle[j]
            for turn in range(-4, 5):
                height = (gap + _TURN * turn) / rate
                if 0.0 < height < deepest:
                    heights.append(height)
    return heights


def _borders_of_straight(
    cutter: Cutter,
    deepest: float,
    mode: MillingMode,
    radial_depth: float,
    own_passes: bool,
    turn: float,
    fineness: float,
) -> list[float]:
    heights = crossing_heights(cutter, deepest)
    several = len(set(cutter.helix)) > 1
    slope = max(abs(math.tan(helix)) for helix in cutter.helix) / cutter.radius
    if own_passes and several and cutter.serration is None:
        heights += _even_heights(fineness * _PIECE_LAG / slope, deepest)
    if cutter.edge_angle < 0.5 * math.pi - 1e-9:
        # the radius, and with it the arc, changes along a cone
        rate = 1.0 / math.tan(cutter.edge_angle) / cutter.radius
        heights += _even_heights(fineness * _PIECE_LAG / max(rate, slope), deepest)
        heights += _cone_heights(cutter, mode, radial_depth, turn)
    return heights


def edge_pieces(
    cutter: Cutter,
    laws: list[ForceLaw],
    mode: MillingMode,
    radial_depth: float,
    feed_per_turn: float,
    deepest: float,
    flank: ViscousProcessDamping | Ploughing | None = None,
    fineness: float = 1.0,
) -> EdgePieces:
    """Cut the edges of a tool into pieces from the tip to a height.

    Parameters
    ----------
    cutter : Cutter
    laws : list of ForceLaw
        One for each tooth.
    mode : {"up", "down", "slot"}
    radial_depth, feed_per_turn, deepest : float
        m.
    flank : ViscousProcessDamping or Ploughing, optional
        Ploughing is taken for small vibration; see `small_vibration_coefficient`.
    fineness : float
        Factor on how much an edge turns, trails or widens within a piece.

    Returns
    -------
    EdgePieces
    """
    wave = cutter.serration is not None
    own_passes = wave or np.ptp(cutter.radial_offsets) > 0.0 or np.ptp(cutter.axial_offsets) > 0.0
    turn = fineness * (_PIECE_TURN_OF_PASSES if own_passes else _PIECE_TURN)
    heights = _borders_of_straight(cutter, deepest, mode, radial_depth, own_passes, turn, fineness)
    line = _line(cutter, deepest, mode, radial_depth, heights, turn)
    slopes = [_reference_slope(law) for law in laws]
    if own_passes:
        edges = Edges(cutter, mode, radial_depth, feed_per_turn)
        rows, owners = _rows_of_passes(edges, line, deepest, slopes, fineness)
    else:
        rows, owners = _rows_of_one_pass(cutter, line, mode, radial_depth, slopes)
    turning = _turning(rows, owners, wave)
    sized = isinstance(laws[0], ExponentialLaw) and laws[0].exponent < 1.0
    order, chain = _chains(rows, owners, sized=sized, apart=wave and sized)
    rows = [rows[i] for i in order]
    feed = feed_per_turn / _TURN
    return _as_arrays(rows, turning[order], chain, cutter, laws[0], flank, feed)


def _rows_of_one_pass(
    cutter: Cutter,
    line: _Line,
    mode: MillingMode,
    radial_depth: float,
    slopes: list[NDArray[np.float64]],
) -> tuple[list[tuple], list[tuple[int, int, int]]]:
    """Pieces of teeth that each cut what the one before them has left."""
    lag = np.tan(np.asarray(cutter.helix)) / cutter.radius
    rows: list[tuple] = []
    owners: list[tuple[int, int, int]] = []
    entry, leave = _arcs_at_borders(cutter, line, mode, radial_depth)
    for piece in range(line.length.size):
        ends = slice(piece, piece + 2)
        middle = 0.5 * (line.height[piece] + line.height[piece + 1])
        angle = cutter.tooth_angles[:, None] - np.outer(lag, [*line.height[ends], middle])
        kappa = line.immersion[piece]
        arc = _arc_of_piece(entry[ends], leave[ends])
        if arc is None:
            continue
        earlier, ahead = earlier_passes(angle[:, 2:])
        for tooth in range(cutter.teeth):
            other = int(earlier[tooth, 0, 0])
            # flutes of different helix are not as far ahead at the ends as in the middle
            apart = angle[other] - angle[tooth]
            gaps = ahead[tooth, 0, 0] + apart - apart[2]
            owners.append((piece, tooth, other))
            rows.append(
                (
                    line.height[piece], line.height[piece + 1] - line.height[piece],
                    line.length[piece], angle[tooth, :2], arc[0], arc[1], gaps[:2], kappa,
                    line.radius[ends], slopes[tooth], (0.0, 0.0), 0.0,
                    cutter.corner_radius if kappa[0] < kappa[1] else 0.0, 0,
                )
            )  # fmt: skip
    return rows, owners


def _rows_of_passes(
    edges: Edges,
    line: _Line,
    deepest: float,
    slopes: list[NDArray[np.float64]],
    fineness: float,
) -> tuple[list[tuple], list[tuple[int, int, int]]]:
    """Pieces of teeth for each of which the earlier pass is found that left the surface."""
    borders = np.concatenate([[0.0], np.cumsum(line.length)])
    # the line runs on to the end of the corner
    borders = np.minimum(borders, edges.place(deepest))
    borders = np.append(borders[borders < borders[-1]], borders[-1])
    rows: list[tuple] = []
    owners: list[tuple[int, int, int]] = []
    for tooth in range(edges.cutter.teeth):
        found, of_tooth = _rows_of_tooth(edges, tooth, slopes[tooth], borders, fineness)
        rows += found
        owners += of_tooth
    return rows, owners


def _rows_of_tooth(
    edges: Edges, tooth: int, slope: NDArray[np.float64], borders: NDArray[np.float64],
    fineness: float,
) -> tuple[list[tuple], list[tuple[int, int, int]]]:  # fmt: skip
    """The same of one tooth.

    What bends along a piece is the line through its values at two Gauss points: so the area in
    the cut, and all that is linear along it, is right to the fourth order.
    """
    places = piece_borders(edges, tooth, borders, fineness)
    low, high = places[:-1], places[1:]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    own = np.full(middle.size, tooth)
    inner = (middle - GAUSS * half, middle + GAUSS * half)
    at_ends, at_middle = edges.profile(places), edges.profile(middle)
    radial = _through(*(edges.radial(edges.profile(place).height) for place in inner))
    angle, between = edges.angle(at_ends.height), edges.angle(at_middle.height)
    ahead = edges.ahead(own, at_middle.height)
    one, other, central = (edges.arcs(own, place) for place in (*inner, middle))
    alike = np.all(one.kind == other.kind, axis=1)
    ends = np.where(
        alike[:, None, None], _through(one.angle, other.angle), central.angle[..., None]
    )
    met = np.where(alike[:, None], one.tooth, central.tooth)
    vanishing = _where_chip_vanishes(np.where(alike[:, None], one.kind, central.kind))
    axial, corner = edges.cutter.axial_offsets, edges.cutter.corner_radius
    rows: list[tuple] = []
    owners: list[tuple[int, int, int]] = []
    for piece, arc in zip(*np.nonzero(met >= 0), strict=True):
        k, pair = int(met[piece, arc]), slice(piece, piece + 2)
        apart = angle[pair, k] - angle[pair, tooth]
        gaps = ahead[piece, k] + apart - (between[piece, k] - between[piece, tooth])
        owners.append((int(piece), tooth, k))
        rows.append(
            (
                at_ends.height[piece], at_ends.height[piece + 1] - at_ends.height[piece],
                high[piece] - low[piece], angle[pair, tooth],
                ends[piece, arc], ends[piece, arc + 1], gaps, at_ends.immersion[pair],
                at_ends.radius[pair], slope, radial[piece, k] - radial[piece, tooth],
                axial[k] - axial[tooth], corner if middle[piece] < edges.on_corner else 0.0,
                vanishing[piece, arc],
            )
        )  # fmt: skip
    return rows, owners


def _where_chip_vanishes(kind: NDArray[np.int64]) -> NDArray[np.int64]:
    """Tell for each arc (P, W) whether its chip is none at its entry (1), at its exit (2), or not.

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


def _chains(
    rows: list[tuple], owners: list[tuple[int, int, int]], sized: bool, apart: bool
) -> tuple[list[int], NDArray[np.int64]]:
    """Order of the pieces along chains, and the first place of each chain and the end (C + 1,).

    The chip on a serrated edge is not smooth from piece to piece: with a size effect every piece is
    a chain apart.
    """
    met: dict[tuple[int, int, int], int] = {}
    keys = []
    for owner in owners:
        piece, tooth, other = owner
        met[owner] = met.get(owner, -1) + 1
        keys.append((tooth, other, met[owner], piece))
    order = sorted(range(len(rows)), key=lambda i: keys[i])
    starts: list[int] = []
    lowest = 0.0  # inclination at the start of the chain
    for place, i in enumerate(order):
        kappa, corner = rows[i][7], rows[i][12]
        before = order[place - 1]
        follows = place > 0 and keys[i] == (*keys[before][:3], keys[before][3] + 1)
        smooth = follows and not apart and rows[before][12] == corner
        if not smooth or (sized and corner > 0.0 and kappa[1] > _CHAIN_GROWTH * lowest):
            starts.append(place)
            lowest = max(kappa[0], 1e-12)
    return order, np.array([*starts, len(order)], dtype=np.int64)


def _turning(
    rows: list[tuple], owners: list[tuple[int, int, int]], serrated: bool
) -> NDArray[np.int64]:
    """Mark the ends (P, 2) of pieces at which an edge first meets the stock, or last leaves it.

    There the spindle angle of entry or exit turns round along the edge, or the edge ends, or it
    is no more cut all around, or the surface of one earlier pass gives way to that of another; not
    along a serrated edge, on which it does so from wave to wave for a small part each.
    """
    marks = np.zeros((len(rows), 2), dtype=np.int64)
    place = {owner: i for i, owner in enumerate(owners)}
    there = {owner[: 2 if serrated else 3] for owner in owners}
    for owner, i in place.items():
        piece, tooth, other = owner
        following = place.get((piece + 1, tooth, other))
        key = (tooth,) if serrated else (tooth, other)
        marks[i, 0] |= piece > 0 and (piece - 1, *key) not in there
        marks[i, 1] |= (piece + 1, *key) not in there
        if following is None:
            continue
        for arc, end in ((4, 0.0), (5, math.pi)):
            one, next_one = rows[i][arc], rows[following][arc]
            whole = one[0] == one[1] == end
            marks[i, 1] |= whole and not next_one[0] == next_one[1] == end
            angle, next_angle = rows[i][3], rows[following][3]
            rise = (one[1] - one[0]) - (angle[1] - angle[0])
            marks[i, 1] |= (
                rise * ((next_one[1] - next_one[0]) - (next_angle[1] - next_angle[0])) < 0.0
            )
    return marks


def _arcs_at_borders(
    cutter: Cutter, line: _Line, mode: MillingMode, radial_depth: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Entry and exit (L + 1,) at the borders of the pieces, rad, of which each piece has the mean.

    Within a piece the arc follows a chord, which all along lies on one side of it. At a border the
    arc is taken off by the mean distance (Simpson) on both sides of it: what a force is short of
    falls with the fourth power of the length of the pieces, not the second.
    """

    def arcs(radius: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return slice_engagement(mode, radial_depth, cutter.radius, np.maximum(radius, 1e-12))

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


def _arc_of_piece(
    entry: NDArray[np.float64], leave: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Entry and exit at both ends (2, 2); where one end is out of the stock its arc is a point."""
    cuts = entry < leave
    if not cuts.any():
        return None
    if not cuts.all():
        inside = int(np.argmax(cuts))
        # down-milling ends at pi, up-milling starts at 0: the arc shrinks towards that side
        place = leave[inside] if leave[inside] > math.pi - 1e-12 else entry[inside]
        entry, leave = np.where(cuts, entry, place), np.where(cuts, leave, place)
    return np.stack([entry, leave])


def _reference_slope(law: ForceLaw) -> NDArray[np.float64]:
    if isinstance(law, ExponentialLaw):
        return law.exponent * np.asarray(law.cutting)
    return np.asarray(law.cutting)


def _as_arrays(
    rows: list[tuple],
    turning: NDArray[np.int64],
    chain: NDArray[np.int64],
    cutter: Cutter,
    law: ForceLaw,
    flank: ViscousProcessDamping | Ploughing | None,
    feed: float,
) -> EdgePieces:
    count = len(rows)
    columns = [np.array(column, dtype=np.float64) for column in zip(*rows, strict=True)]
    if count == 0:
        # the edge does not reach the stock; the shapes are those of one piece
        columns = [np.zeros(shape) for shape in _NO_PIECES]
    delay = columns[6]
    constant = np.abs(delay[:, 0] - delay[:, 1]) < 1e-12 if count else np.zeros(0, dtype=bool)
    groups: list[float] = []
    group = np.full(count, -1, dtype=np.int64)
    for place in np.flatnonzero(constant):
        value = 0.5 * (delay[place, 0] + delay[place, 1])
        near = [i for i, other in enumerate(groups) if abs(other - value) < 1e-10]
        if not near:
            groups.append(value)
        group[place] = near[0] if near else len(groups) - 1
    exponent, reference = 0.0, 1.0
    if isinstance(law, ExponentialLaw) and law.exponent < 1.0:
        exponent, reference = law.exponent - 1.0, law.reference_chip_thickness
    damping = np.zeros(2)
    if isinstance(flank, ViscousProcessDamping):
        damping = flank.coefficient * np.array([flank.friction, 1.0])
    elif isinstance(flank, Ploughing):
        damping = small_vibration_coefficient(flank) * np.array([flank.friction, 1.0])
    return EdgePieces(
        bottom=columns[0], thickness=columns[1], length=columns[2], angle=columns[3],
        entry=columns[4], exit=columns[5], delay=delay, immersion=columns[7], radius=columns[8],
        group=group, group_delay=np.array(groups), cutting=columns[9], feed=feed,
        inset=columns[10], axial_inset=columns[11], corner=columns[12],
        vanishing=columns[13].astype(np.int64), exponent=exponent,
        reference=reference, damping=damping, turning=turning, chain=chain,
        outline=np.array([cutter.radius, cutter.corner_radius, cutter.edge_angle]),
    )  # fmt: skip


def small_vibration_coefficient(law: Ploughing) -> float:
    """C of the dashpot, N/m, that a ploughing flank is for small vibration: K l^2/2.

    The land in contact, of length l, is pressed into the wave behind the edge: at a distance s the
    wave lies r(t) - r(t - s/V) = s r'/V lower, and the displaced volume a width is the sum of that.
    """
    return 0.5 * law.indentation_force * law.contact_length**2


def period_angle(cutter: Cutter) -> float:
    """Angle after which the tool looks the same again, rad: a turn over a whole number."""
    angle, offset = cutter.tooth_angles, cutter.radial_offsets
    for parts in range(cutter.teeth, 1, -1):
        if cutter.teeth % parts:
            continue
        step = cutter.teeth // parts
        turned = np.mod(np.roll(angle, -step) - angle, _TURN)
        alike = (
            np.allclose(turned, _TURN / parts, rtol=0.0, atol=1e-9)
            and np.allclose(np.roll(offset, -step), offset, rtol=0.0, atol=1e-12)
            and np.allclose(np.roll(cutter.axial_offsets, -step), cutter.axial_offsets, atol=1e-12)
            and np.allclose(np.roll(cutter.helix, -step), cutter.helix, rtol=0.0, atol=1e-12)
        )
        if alike and cutter.serration is None:
            return _TURN / parts
    return _TURN
