"""Runs of pieces along a chain that are in the cut at once, and quadrature along them.

Leaves for compiled code.
"""

from __future__ import annotations

import math

from numba.extending import register_jitable

from cutting.compiled import INLINED
from cutting.edge_segments.coupling import chip_at, engaged_span, share_of_height

_TURN = 2.0 * math.pi
#: Gauss points that a table of quadratures goes up to
MOST_POINTS = 16
#: a run turns, bends and shifts by no more than this, rad
_LONGEST_RUN = 3.5
#: below this two points do
_SHORT_RUN = 0.15
#: a run of pieces is in the cut up to the end of a piece within this share of it
_WHOLE = 1.0 - 1e-12
#: digits (as a power of e) to which a power of the chip is integrated
_CHIP_DIGITS = 15.0
#: more points than this are spent better on crowding them towards an end
_MOST_POINTS_OF_CHIP = 6
#: points by which a run takes more where they crowd
_FOR_CROWDING = 6
#: ends of a run at which the chip vanishes
NO_END, LOW_END, HIGH_END, BOTH_ENDS = 0, 1, 2, 3


@register_jitable(**INLINED)
def reach_of_piece(pieces, tops, piece, reach):
    """Set reach (4,) to the spindle angles, rad, between which a piece is in the cut.

    Outside the first and the last nothing of it is, between the second and the third all of it.
    """
    a, b = pieces.angle[piece, 0], pieces.angle[piece, 1]
    entry, leave = pieces.entry[piece], pieces.exit[piece]
    reach[0] = min(entry[0], entry[1]) - max(a, b)
    reach[1] = max(entry[0], entry[1]) - min(a, b)
    reach[2] = min(leave[0], leave[1]) - max(a, b)
    reach[3] = max(leave[0], leave[1]) - min(a, b)
    if tops[piece] <= 0.0:
        reach[0], reach[3] = 1e3, -1e3


@register_jitable(**INLINED)
def turns_of_chain(pieces, reach, chain, spindle):
    """Turns by which a chain may have to be turned back to be in the cut, first and last."""
    early, late = 1e3, -1e3
    for piece in range(pieces.chain[chain], pieces.chain[chain + 1]):
        early, late = min(early, reach[piece, 0]), max(late, reach[piece, 3])
    first = math.ceil((spindle - late) / _TURN - 1e-12)
    return first, math.floor((spindle - early) / _TURN + 1e-12)


@register_jitable(**INLINED)
def _span(pieces, tops, reach, piece, spindle, back):
    """Part of a piece that is in the cut, as `engaged_span` gives it."""
    turned = spindle - _TURN * back
    if turned <= reach[piece, 0] or turned >= reach[piece, 3]:
        return 1.0, 0.0
    if reach[piece, 1] < turned < reach[piece, 2]:
        return 0.0, tops[piece]
    return engaged_span(pieces, piece, tops[piece], spindle, back)


@register_jitable(**INLINED)
def change_along(pieces, piece, elements):
    """Turn and bend of the edge, and turn of the vibration that it has left, along a piece, rad."""
    shift = pieces.delay[piece, 1] - pieces.delay[piece, 0]
    return (
        abs(pieces.angle[piece, 1] - pieces.angle[piece, 0])
        + abs(pieces.immersion[piece, 1] - pieces.immersion[piece, 0])
        + 2.0 * abs(shift) * elements
    )


@register_jitable(**INLINED)
def run_from(pieces, tops, reach, piece, end, spindle, back, elements):
    """Run of pieces in the cut that begins in a piece, or none.

    Parameters
    ----------
    pieces : EdgePieces
    tops : (P,) array of float
        Part of each piece below the depth of cut.
    reach : (P, 4) array of float
        See `reach_of_piece`.
    piece, end : int
        First piece, and that beyond the last of its chain.
    spindle : float
        Spindle angle, rad.
    back : int
        Turns taken off.
    elements : float
        Elements of the motion that pass as the tool turns by a radian.

    Returns
    -------
    last : int
        Last piece of the run, below the first where there is none.
    low, high : float
        Where it begins in the first and ends in the last piece.
    change : float
        By which the run turns, bends and shifts.
    """
    last = piece
    low, high = _span(pieces, tops, reach, piece, spindle, back)
    if low >= high:
        return piece - 1, 0.0, 0.0, 0.0
    change = change_along(pieces, piece, elements) * (high - low)
    while high >= _WHOLE and last + 1 < end:
        below, above = _span(pieces, tops, reach, last + 1, spindle, back)
        longer = change + change_along(pieces, last + 1, elements)
        if below > 0.0 or above <= 0.0 or longer > _LONGEST_RUN:
            break
        last, high, change = last + 1, above, longer
    return last, low, high, change


@register_jitable(**INLINED)
def _chip_at_place(pieces, piece, place, spindle):
    """Chip of a rigid tool at a place along a piece, m."""
    height = share_of_height(pieces, piece, place)
    turned = pieces.angle[piece, 1] - pieces.angle[piece, 0]
    sine = math.sin(spindle + pieces.angle[piece, 0] + height * turned)
    low, high = pieces.immersion[piece, 0], pieces.immersion[piece, 1]
    kappa = low + place * (high - low)
    return chip_at(pieces, piece, place, height, sine, math.sin(kappa), math.cos(kappa))


@register_jitable(**INLINED)
def points_along(pieces, piece, last, low, high, change, spindle):
    """Order of a quadrature along a run of pieces; see `run_from` for the parameters.

    Returns
    -------
    points : int
    ends : int
        Ends towards which the points are to crowd, because the chip vanishes there.
    """
    if change < 1e-9 and pieces.group[piece] >= 0:
        return 1, NO_END
    points = 2
    if change > _SHORT_RUN:
        points = min(MOST_POINTS, 2 + math.ceil(2.5 * change))
    if pieces.exponent == 0.0:
        return points, NO_END
    one = max(_chip_at_place(pieces, piece, low, spindle), 0.0)
    other = max(_chip_at_place(pieces, last, high, spindle), 0.0)
    root = math.sqrt(min(one, other) / max(one, other, 1e-300))
    # a singularity at the distance x from the middle of [-1, 1]: errors fall as (x + sqrt(x^2-1))
    # to the power -2 n (Trefethen 2008, SIAM Rev. 50, Theorem 4.5)
    rate = math.log((1.0 + root) / max(1.0 - root, 1e-12))
    if 2.0 * _MOST_POINTS_OF_CHIP * rate >= _CHIP_DIGITS:
        return max(points, math.ceil(0.5 * _CHIP_DIGITS / rate)), NO_END
    middle = _chip_at_place(pieces, (piece + last) // 2, 0.5 * (low + high), spindle)
    if max(one, other) < 0.5 * middle:
        return MOST_POINTS, BOTH_ENDS
    return min(MOST_POINTS, points + _FOR_CROWDING), LOW_END if one < other else HIGH_END


@register_jitable(**INLINED)
def crowd(place, weight, ends):
    """Place and weight on [0, 1], drawn towards the ends at which the chip vanishes."""
    if ends == NO_END:
        return place, weight
    if ends == BOTH_ENDS:
        weight *= 30.0 * (place * (1.0 - place)) ** 2
        return place * place * place * (10.0 - 15.0 * place + 6.0 * place * place), weight
    away = place if ends == LOW_END else 1.0 - place
    # a fourth power: what is left of a chip to any power vanishes smoothly
    weight *= 4.0 * away * away * away
    away *= away * away * away
    return away if ends == LOW_END else 1.0 - away, weight


@register_jitable(**INLINED)
def length_of_run(pieces, piece, last, low, high):
    """Length of edge in a run, m."""
    length = -low * pieces.length[piece] + high * pieces.length[last]
    for k in range(piece, last):
        length += pieces.length[k]
    return length


@register_jitable(**INLINED)
def place_in_run(pieces, piece, last, start, along):
    """Piece, and place along it, at a length (m) beyond the low end of a piece.

    `start` is the length of edge before that piece that is to be taken off.
    """
    rest = along - start
    while piece < last and rest > pieces.length[piece]:
        rest -= pieces.length[piece]
        start += pieces.length[piece]
        piece += 1
    return piece, rest / pieces.length[piece], start
