"""What of an edge piece stands in the cut, and what it couples: leaves for compiled code.

See `edge_pieces` for the pieces themselves.
"""

from __future__ import annotations

import math

from numba.extending import register_jitable

from cutting.compiled import INLINED

_TURN = 2.0 * math.pi
#: Newton steps to the place at which an edge on a corner crosses the border of its arc
_PLACE_STEPS = 6
#: of the reference chip: as far as rounding lets a chip vanish. The slope of a size effect is
#: infinite there, its integral is not: what lies below is lost to the power of the exponent
_LEAST_CHIP = 1e-16
#: of the feed: a chip below this has vanished
_VANISHED = 1e-3


@register_jitable(**INLINED)
def part_below(pieces, piece, depth):
    """Part of a piece, from its low end and along its length, that lies below a depth (m)."""
    share = (depth - pieces.bottom[piece]) / pieces.thickness[piece]
    if share >= 1.0:
        return 1.0
    corner = pieces.corner[piece]
    if corner == 0.0 or share <= 0.0:
        return share
    low, high = pieces.immersion[piece, 0], pieces.immersion[piece, 1]
    return (math.acos(1.0 - depth / corner) - low) / (high - low)


@register_jitable(**INLINED)
def radius_at(pieces, height):
    """Radius of the edge at a height above the tip, m."""
    radius, corner, angle = pieces.outline[0], pieces.outline[1], pieces.outline[2]
    top = corner * (1.0 - math.cos(angle))
    if height < top:
        return radius - corner + corner * math.sin(math.acos(1.0 - height / corner))
    return radius - corner * (1.0 - math.sin(angle)) + (height - top) / math.tan(angle)


@register_jitable(**INLINED)
def share_of_height(pieces, piece, place):
    """Height of a place along a piece above its low end, as a share of the piece's."""
    corner = pieces.corner[piece]
    if corner == 0.0:
        return place
    low, high = pieces.immersion[piece, 0], pieces.immersion[piece, 1]
    height = corner * (1.0 - math.cos(low + place * (high - low)))
    return (height - pieces.bottom[piece]) / pieces.thickness[piece]


@register_jitable(**INLINED)
def _place_on_corner(pieces, piece, place, value, lag, rate):
    """Place where value + lag h + rate s = 0, h the share of the height, which bends along s."""
    low, high = pieces.immersion[piece, 0], pieces.immersion[piece, 1]
    steepness = pieces.corner[piece] * (high - low) / pieces.thickness[piece]
    for _ in range(_PLACE_STEPS):
        slope = lag * steepness * math.sin(low + place * (high - low)) + rate
        if slope == 0.0:
            break
        step = (value + lag * share_of_height(pieces, piece, place) + rate * place) / slope
        place = min(1.0, max(0.0, place - step))
        if abs(step) < 1e-12:
            break
    return place


@register_jitable(**INLINED)
def engaged_span(pieces, piece, top, spindle, turn):
    """Part of a piece that is in the cut at a spindle angle.

    Parameters
    ----------
    pieces : EdgePieces
    piece : int
    top : float
        Part of the piece, from its low end, that lies below the depth of cut.
    spindle : float
        Spindle angle, rad.
    turn : int
        Turns that are taken off the place of the edge.

    Returns
    -------
    (float, float)
        As parts of the piece; the first above the second where nothing is in the cut.
    """
    start = spindle + pieces.angle[piece, 0] - _TURN * turn
    turned = pieces.angle[piece, 1] - pieces.angle[piece, 0]
    low, high = 0.0, top
    entry, leave = pieces.entry[piece, 0], pieces.exit[piece, 0]
    for side in range(2):
        # value + rate s >= 0 inside
        if side == 0:
            value, rate = start - entry, turned - (pieces.entry[piece, 1] - entry)
        else:
            value, rate = leave - start, (pieces.exit[piece, 1] - leave) - turned
        if rate == 0.0:
            if value <= 0.0:
                return 1.0, 0.0
            continue
        place = -value / rate
        if pieces.corner[piece] > 0.0 and 0.0 < place < 1.0:
            lag = turned if side == 0 else -turned
            place = _place_on_corner(pieces, piece, place, value, lag, rate - lag)
        if rate > 0.0:
            low = max(low, place)
        else:
            high = min(high, place)
    return low, high


@register_jitable(**INLINED)
def first_and_last_turn(pieces, piece, top, spindle):
    """Turns by which a piece may have to be turned back to lie in its arc."""
    a = spindle + pieces.angle[piece, 0]
    b = a + top * (pieces.angle[piece, 1] - pieces.angle[piece, 0])
    entry = min(pieces.entry[piece, 0], pieces.entry[piece, 1])
    leave = max(pieces.exit[piece, 0], pieces.exit[piece, 1])
    first = math.ceil((min(a, b) - leave) / _TURN - 1e-12)
    last = math.floor((max(a, b) - entry) / _TURN + 1e-12)
    return first, last


@register_jitable(**INLINED)
def chip_at(pieces, piece, place, height, sine, sine_of_edge, cosine_of_edge):
    """Chip of a rigid tool, m, below zero where the edge misses.

    Parameters
    ----------
    pieces : EdgePieces
    piece : int
    place, height : float
        Share of the length and of the height of the piece.
    sine : float
        Of the immersion angle.
    sine_of_edge, cosine_of_edge : float
        Of the axial immersion angle.
    """
    # flutes of different helix leave each other more or less of the feed from height to height
    first, last = pieces.delay[piece, 0], pieces.delay[piece, 1]
    rise = pieces.feed * (first + height * (last - first))
    vanishing = pieces.vanishing[piece]
    if vanishing > 0:
        # what bends along the piece is taken for straight, and the chip must end with the arc
        begin, end = pieces.entry[piece, 0], pieces.entry[piece, 1]
        if vanishing == 2:
            begin, end = pieces.exit[piece, 0], pieces.exit[piece, 1]
        border = begin + place * (end - begin)
        return sine_of_edge * rise * (sine - math.sin(border))
    low, high = pieces.inset[piece, 0], pieces.inset[piece, 1]
    radial = rise * sine - (low + height * (high - low))
    return sine_of_edge * radial - cosine_of_edge * pieces.axial_inset[piece]


@register_jitable(**INLINED)
def chip_vanishes(pieces, piece, place, immersion, share=_VANISHED):
    """Tell whether a place along a piece has hardly a chip left at an immersion angle.

    Hardly a chip is less than this share of the feed.
    """
    low, high = pieces.immersion[piece, 0], pieces.immersion[piece, 1]
    kappa = low + place * (high - low)
    # at the very tip of a corner the chip is nothing at any angle
    sk = max(math.sin(kappa), 1e-9)
    height = share_of_height(pieces, piece, place)
    chip = chip_at(pieces, piece, place, height, math.sin(immersion), sk, math.cos(kappa))
    return chip < share * sk * pieces.feed * pieces.delay[piece, 0]


@register_jitable(**INLINED)
def coupling_at(pieces, piece, place, spindle, weight, speed_factor, basis, stiffness, dashpot):
    """Add the coupling of a point of the edge to displacement and velocity.

    Parameters
    ----------
    pieces : EdgePieces
    piece : int
    place : float
        Of the point, as a part of the piece.
    spindle : float
        rad.
    weight : float
        Length of edge that the point stands for, m.
    speed_factor : float
        One over the cutting speed, s/m; 0 leaves the dashpot alone.
    basis : (3, r) array of float
        Directions of motion.
    stiffness, dashpot : (r, r) array of float
        N/m and N s/m: the force on the tool is -stiffness u - dashpot u'. Overwritten.
    """
    turned = pieces.angle[piece, 1] - pieces.angle[piece, 0]
    height = share_of_height(pieces, piece, place)
    phi = spindle + pieces.angle[piece, 0] + height * turned
    kappa = pieces.immersion[piece, 0]
    bend = pieces.immersion[piece, 1] - kappa
    s, c = math.sin(phi), math.cos(phi)
    sk, ck = 1.0, 0.0
    if bend != 0.0 or abs(kappa - 0.5 * math.pi) > 1e-12:
        sk, ck = math.sin(kappa + place * bend), math.cos(kappa + place * bend)
    size = weight
    if pieces.exponent != 0.0:
        chip = chip_at(pieces, piece, place, height, s, sk, ck)
        chip = max(chip, _LEAST_CHIP * pieces.reference)
        size *= math.exp(pieces.exponent * math.log(chip / pieces.reference))
    kt, kr, ka = pieces.cutting[piece, 0], pieces.cutting[piece, 1], pieces.cutting[piece, 2]
    for coupling in range(2):
        if coupling == 1:
            if speed_factor == 0.0:
                break
            size = weight * speed_factor
            kt, kr, ka = pieces.damping[0], pieces.damping[1], 0.0
        plane = ka * ck - kr * sk
        fx, fy, fz = plane * s - kt * c, plane * c + kt * s, kr * ck + ka * sk
        out = stiffness if coupling == 0 else dashpot
        for j in range(basis.shape[1]):
            chip_change = sk * (s * basis[0, j] + c * basis[1, j]) - ck * basis[2, j]
            for i in range(basis.shape[1]):
                push = fx * basis[0, i] + fy * basis[1, i] + fz * basis[2, i]
                out[i, j] = -size * push * chip_change
