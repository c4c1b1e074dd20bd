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

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.edge_segments.earlier_passes import Edges
from cutting.edge_segments.edge_profile import edge_line, straight_borders
from cutting.edge_segments.engagement_arcs import Piece, pieces_of_one_pass, pieces_of_passes
from cutting.edge_segments.segment_groups import chains_of, turning_ends
from cutting.engagement.immersion import MillingMode
from cutting.force.force_law import ExponentialLaw, ForceLaw
from cutting.process_damping.ploughing import Ploughing
from cutting.process_damping.viscous import ViscousProcessDamping
from cutting.tool.cutter import Cutter

_TURN = 2.0 * math.pi
#: a corner turns by this much within a piece, and its arc changes by it, rad
_PIECE_TURN = math.radians(1.2)
#: the same where the earlier passes are looked for: the arcs are taken at two places within
_PIECE_TURN_OF_PASSES = math.radians(2.5)
#: shapes of the columns of a table of no pieces
_NO_PIECES = (0, 0, 0, (0, 2), (0, 2), (0, 2), (0, 2), (0, 2), (0, 2), (0, 3), (0, 2), 0, 0, 0)


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
    heights = straight_borders(cutter, deepest, mode, radial_depth, own_passes, turn, fineness)
    line = edge_line(cutter, deepest, mode, radial_depth, heights, turn)
    slopes = [_reference_slope(law) for law in laws]
    if own_passes:
        edges = Edges(cutter, mode, radial_depth, feed_per_turn)
        pieces, owners = pieces_of_passes(edges, line, deepest, slopes, fineness)
    else:
        pieces, owners = pieces_of_one_pass(cutter, line, mode, radial_depth, slopes)
    turning = turning_ends(pieces, owners, wave)
    sized = isinstance(laws[0], ExponentialLaw) and laws[0].exponent < 1.0
    order, chain = chains_of(pieces, owners, sized=sized, apart=wave and sized)
    pieces = [pieces[i] for i in order]
    feed = feed_per_turn / _TURN
    return _as_arrays(pieces, turning[order], chain, cutter, laws[0], flank, feed)


def _reference_slope(law: ForceLaw) -> NDArray[np.float64]:
    if isinstance(law, ExponentialLaw):
        return law.exponent * np.asarray(law.cutting)
    return np.asarray(law.cutting)


def _as_arrays(
    pieces: list[Piece],
    turning: NDArray[np.int64],
    chain: NDArray[np.int64],
    cutter: Cutter,
    law: ForceLaw,
    flank: ViscousProcessDamping | Ploughing | None,
    feed: float,
) -> EdgePieces:
    count = len(pieces)
    # where no edge reaches the stock the shapes are those of one piece
    columns = [np.zeros(shape) for shape in _NO_PIECES]
    if count:
        columns = [np.array(column, dtype=np.float64) for column in zip(*pieces, strict=True)]
    table = Piece(*columns)
    delay = table.delay
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
        bottom=table.bottom, thickness=table.thickness, length=table.length, angle=table.angle,
        entry=table.entry, exit=table.exit, delay=delay, immersion=table.immersion,
        radius=table.radius, group=group, group_delay=np.array(groups), cutting=table.cutting,
        feed=feed, inset=table.inset, axial_inset=table.axial_inset, corner=table.corner,
        vanishing=table.vanishing.astype(np.int64), exponent=exponent, reference=reference,
        damping=damping, turning=turning, chain=chain,
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
    angle, offset, axial = cutter.tooth_angles, cutter.radial_offsets, cutter.axial_offsets
    for parts in range(cutter.teeth, 1, -1):
        if cutter.teeth % parts:
            continue
        step = cutter.teeth // parts
        turned = np.mod(np.roll(angle, -step) - angle, _TURN)
        alike = (
            np.allclose(turned, _TURN / parts, rtol=0.0, atol=1e-9)
            and np.allclose(np.roll(offset, -step), offset, rtol=0.0, atol=1e-12)
            and np.allclose(np.roll(axial, -step), axial, rtol=0.0, atol=1e-12)
            and np.allclose(np.roll(cutter.helix, -step), cutter.helix, rtol=0.0, atol=1e-12)
        )
        if alike and cutter.serration is None:
            return _TURN / parts
    return _TURN
