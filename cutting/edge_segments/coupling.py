"""What of an edge segment stands in the cut, and what it couples: leaves for compiled code.

See `edge_segments` for the segments themselves.
"""

import math

from numba.extending import register_jitable

from cutting.compiled import INLINED
from cutting.process_damping.linear_flank import pressed_over_radius

_REVOLUTION = 2.0 * math.pi
#: Newton steps to the position at which an edge on a corner crosses the border of its arc
_NEWTON_STEPS = 6
#: of the reference chip: as far as rounding lets a chip vanish. The slope of a size effect is
#: infinite there, its integral is not: what lies below is lost to the power of the exponent
_LEAST_CHIP = 1e-16
#: of the feed: a chip below this has vanished
_VANISHED = 1e-3


@register_jitable(**INLINED)
def part_below(segments, segment, depth):
    """Part of a segment, from its low end and along its length, that lies below a depth (m)."""
    depth = depth + segments.lift
    share = (depth - segments.bottom[segment]) / segments.thickness[segment]
    if share >= 1.0:
        return 1.0
    corner = segments.corner[segment]
    if corner == 0.0 or share <= 0.0:
        return share
    low, high = segments.immersion[segment, 0], segments.immersion[segment, 1]
    return (math.acos(1.0 - depth / corner) - low) / (high - low)


@register_jitable(**INLINED)
def radius_at(segments, depth):
    """Radius of the edge where it is engaged at a depth of cut, m."""
    height = depth + segments.lift
    radius, corner, angle = segments.outline[0], segments.outline[1], segments.outline[2]
    top = corner * (1.0 - math.cos(angle))
    if height < top:
        return radius - corner + corner * math.sin(math.acos(1.0 - height / corner))
    return radius - corner * (1.0 - math.sin(angle)) + (height - top) / math.tan(angle)


@register_jitable(**INLINED)
def share_of_height(segments, segment, position):
    """Height of a position along a segment above its low end, as a share of the segment's."""
    corner = segments.corner[segment]
    if corner == 0.0:
        return position
    low, high = segments.immersion[segment, 0], segments.immersion[segment, 1]
    height = corner * (1.0 - math.cos(low + position * (high - low)))
    return (height - segments.bottom[segment]) / segments.thickness[segment]


@register_jitable(**INLINED)
def arc_at(segments, segment, position):
    """Entry and exit at a position along a segment, and its angle on the tool, rad."""
    entry, leave = segments.entry[segment, 0], segments.exit[segment, 0]
    entry += position * (segments.entry[segment, 1] - entry)
    leave += position * (segments.exit[segment, 1] - leave)
    turned = segments.angle[segment, 1] - segments.angle[segment, 0]
    height = share_of_height(segments, segment, position)
    return entry, leave, segments.angle[segment, 0] + height * turned


@register_jitable(**INLINED)
def delay_at(segments, segment, position):
    """Angle since the pass that left the surface at a position along a segment, rad."""
    first, last = segments.delay[segment, 0], segments.delay[segment, 1]
    return first + share_of_height(segments, segment, position) * (last - first)


@register_jitable(**INLINED)
def _position_on_corner(segments, segment, position, value, lag, rate):
    """Place where value + lag h + rate s = 0, h the share of the height, which bends along s."""
    low, high = segments.immersion[segment, 0], segments.immersion[segment, 1]
    steepness = segments.corner[segment] * (high - low) / segments.thickness[segment]
    for _ in range(_NEWTON_STEPS):
        slope = lag * steepness * math.sin(low + position * (high - low)) + rate
        if slope == 0.0:
            break
        step = (
            value + lag * share_of_height(segments, segment, position) + rate * position
        ) / slope
        position = min(1.0, max(0.0, position - step))
        if abs(step) < 1e-12:
            break
    return position


@register_jitable(**INLINED)
def engaged_span(segments, segment, top, spindle, revolution):
    """Part of a segment that is in the cut at a spindle angle.

    `top` is the part of the segment, from its low end, that lies below the depth of cut; so many
    revolutions are taken off the place of the edge at the spindle angle, rad. As parts of the
    segment; the first above the second where nothing is in the cut.
    """
    start = spindle + segments.angle[segment, 0] - _REVOLUTION * revolution
    turned = segments.angle[segment, 1] - segments.angle[segment, 0]
    low, high = 0.0, top
    entry, leave = segments.entry[segment, 0], segments.exit[segment, 0]
    for side in range(2):
        # value + rate s >= 0 inside
        if side == 0:
            value, rate = start - entry, turned - (segments.entry[segment, 1] - entry)
        else:
            value, rate = leave - start, (segments.exit[segment, 1] - leave) - turned
        if rate == 0.0:
            if value <= 0.0:
                return 1.0, 0.0
            continue
        position = -value / rate
        if segments.corner[segment] > 0.0 and 0.0 < position < 1.0:
            lag = turned if side == 0 else -turned
            position = _position_on_corner(segments, segment, position, value, lag, rate - lag)
        if rate > 0.0:
            low = max(low, position)
        else:
            high = min(high, position)
    return low, high


@register_jitable(**INLINED)
def first_and_last_revolution(segments, segment, top, spindle):
    """Revolutions by which a segment may have to be turned back to lie in its arc."""
    a = spindle + segments.angle[segment, 0]
    b = a + top * (segments.angle[segment, 1] - segments.angle[segment, 0])
    entry = min(segments.entry[segment, 0], segments.entry[segment, 1])
    leave = max(segments.exit[segment, 0], segments.exit[segment, 1])
    first = math.ceil((min(a, b) - leave) / _REVOLUTION - 1e-12)
    last = math.floor((max(a, b) - entry) / _REVOLUTION + 1e-12)
    return first, last


@register_jitable(**INLINED)
def chip_at(segments, segment, position, height, sine, sine_of_edge, cosine_of_edge):
    """Chip of a rigid tool, m, below zero where the edge misses.

    At a share of the length and of the height of a segment, by the sine of the immersion angle and
    sine and cosine of the axial immersion angle.
    """
    # flutes of different helix leave each other more or less of the feed from height to height
    first, last = segments.delay[segment, 0], segments.delay[segment, 1]
    turned = first + height * (last - first)
    rise = segments.feed * turned
    vanishing = segments.vanishing[segment]
    if vanishing > 0:
        # what bends along the segment is taken for straight, and the chip must end with the arc
        begin, end = segments.entry[segment, 0], segments.entry[segment, 1]
        if vanishing == 2:
            begin, end = segments.exit[segment, 0], segments.exit[segment, 1]
        border = begin + position * (end - begin)
        return sine_of_edge * rise * (sine - math.sin(border))
    low, high = segments.radial_offset[segment, 0], segments.radial_offset[segment, 1]
    radial = rise * sine - (low + height * (high - low))
    along_axis = segments.axial_offset[segment] + segments.axial_feed * turned
    return sine_of_edge * radial - cosine_of_edge * along_axis


@register_jitable(**INLINED)
def chip_vanishes(segments, segment, position, immersion, share=_VANISHED):
    """Whether a position along a segment has hardly a chip left at an immersion angle.

    Hardly a chip is less than this share of the feed.
    """
    low, high = segments.immersion[segment, 0], segments.immersion[segment, 1]
    kappa = low + position * (high - low)
    # at the very tip of a corner the chip is nothing at any angle
    sk = max(math.sin(kappa), 1e-9)
    height = share_of_height(segments, segment, position)
    chip = chip_at(segments, segment, position, height, math.sin(immersion), sk, math.cos(kappa))
    return chip < share * sk * segments.feed * segments.delay[segment, 0]


@register_jitable(**INLINED)
def coupling_at(
    segments, segment, position, spindle, weight, speed_factor, basis, stiffness, dashpot
):
    """Add the coupling of a point of the edge to displacement and velocity.

    The point is at a part of the segment and stands for a length of edge, its weight, m, at a
    spindle angle, rad; the speed factor is `inverse_radius` over the spindle speed, s/m, 0 to leave
    the dashpot alone. With the directions of motion (3, r), stiffness and dashpot (r, r), N/m and
    N s/m, which are overwritten, make the force on the tool -stiffness u - dashpot u'.
    """
    turned = segments.angle[segment, 1] - segments.angle[segment, 0]
    height = share_of_height(segments, segment, position)
    phi = spindle + segments.angle[segment, 0] + height * turned
    kappa = segments.immersion[segment, 0]
    bend = segments.immersion[segment, 1] - kappa
    s, c = math.sin(phi), math.cos(phi)
    sk, ck = 1.0, 0.0
    if bend != 0.0 or abs(kappa - 0.5 * math.pi) > 1e-12:
        sk, ck = math.sin(kappa + position * bend), math.cos(kappa + position * bend)
    size = weight
    kt, kr, ka = (
        segments.cutting[segment, 0],
        segments.cutting[segment, 1],
        segments.cutting[segment, 2],
    )
    if segments.exponent != 0.0:
        chip = chip_at(segments, segment, position, height, s, sk, ck)
        chip = max(chip, _LEAST_CHIP * segments.reference)
        logarithm = math.log(chip / segments.reference)
        size *= math.exp(segments.exponent * logarithm)
        if segments.directional:
            kt *= math.exp(segments.above_exponent[0] * logarithm)
            kr *= math.exp(segments.above_exponent[1] * logarithm)
            ka *= math.exp(segments.above_exponent[2] * logarithm)
    for coupling in range(2):
        if coupling == 1:
            if speed_factor == 0.0:
                break
            flank = segments.flank
            size = weight * speed_factor
            if flank.pressed.shape[0] > 0:
                low, high = segments.radius[segment, 0], segments.radius[segment, 1]
                size *= pressed_over_radius(
                    flank, low + height * (high - low), spindle, s, c, sk, ck
                )
            kt, kr, ka = flank.tangential, flank.radial, 0.0
        plane = ka * ck - kr * sk
        fx, fy, fz = plane * s - kt * c, plane * c + kt * s, kr * ck + ka * sk
        out = stiffness if coupling == 0 else dashpot
        for j in range(basis.shape[1]):
            chip_change = sk * (s * basis[0, j] + c * basis[1, j]) - ck * basis[2, j]
            for i in range(basis.shape[1]):
                push = fx * basis[0, i] + fy * basis[1, i] + fz * basis[2, i]
                out[i, j] = -size * push * chip_change
