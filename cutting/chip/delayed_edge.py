"""Force on a slice of an edge whose chip is the delayed motion of the tool, whole or in part.

Within a slice, lag, normal and the angles of entry and exit vary linearly: `t` runs from -1 at its
lower end to 1. Each part is integrated by two Gauss points.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from numba.extending import register_jitable

from cutting.compiled import INLINED
from cutting.force.laws import edge_force
from cutting.tool.cutter import GAUSS_POINT
from cutting.tool.edge_table import direction, force_on_tool, tilted_normal

#: half a span, as a share of the distance between its Gauss points
_HALF_SPAN = 0.5 / GAUSS_POINT


class Span(NamedTuple):
    """What an integral goes over, by t: a slice, or the time in which its middle moves on."""

    position: float  # at t = 0, bins
    half_lag: float  # by which t = 1 trails it, bins
    along: float  # 1 along the slice, 0 in time


@register_jitable(**INLINED)
def _offset_at(cut, tooth, segment, k, t):
    """Offset of an edge behind a pass at a t of its slice, m; linear between the Gauss points."""
    upper, lower = (
        cut.radial_offset[tooth, segment, k, 0],
        cut.radial_offset[tooth, segment, k, 1],
    )
    return 0.5 * (upper + lower) + _HALF_SPAN * t * (upper - lower)


@register_jitable(**INLINED)
def chip_at(cut, tooth, segment, at, t):
    """Chip thickness of an edge, m, at a t of its slice; negative in the air.

    `at` holds the immersion (sine, cosine), radius and angle (sine, cosine) there.
    """
    since = cut.since
    across, along, ck = at[0] * at[3], at[0] * at[4], at[1]
    thinnest = math.inf
    for k in range(since.shape[0]):
        chip = since[k, 0] * across + since[k, 1] * along - since[k, 2] * ck
        chip -= _offset_at(cut, tooth, segment, k, t)
        if chip < thinnest:
            thinnest = chip
    return thinnest


@register_jitable(**INLINED)
def _add_edge_force(law, tooth, at, chip, length, total):
    """Add the force and torque of a length of edge to a total (x, y, z, torque, length)."""
    sk, ck, radius, sine, cosine = at
    ft, fr, fa = edge_force(law, tooth, chip)
    fx, fy, fz = force_on_tool(sk, ck, sine, cosine, ft, fr, fa)
    return (
        total[0] + length * fx,
        total[1] + length * fy,
        total[2] + length * fz,
        total[3] + length * ft * radius,
        total[4] + length,
    )


@register_jitable(**INLINED)
def _at_ends(first, last):
    """Chip at the ends of a span whose Gauss points are known, as if it varied linearly."""
    middle, rise = 0.5 * (first + last), _HALF_SPAN * (last - first)
    return middle - rise, middle + rise


@register_jitable(**INLINED)
def _at_gauss_point(cut, tooth, segment, side, rotation):
    """Immersion (sine, cosine), radius and angle (sine, cosine) of a Gauss point of a slice."""
    sine, cosine = direction(cut.edges, tooth, segment, side + 1, rotation)
    gauss = cut.edges.gauss
    return gauss[segment, side, 0], gauss[segment, side, 1], gauss[segment, side, 2], sine, cosine


@register_jitable(**INLINED)
def whole_slice(cut, tooth, segment, rotation):
    """Force of a slice that is wholly inside the arc; second value: none of it in the air."""
    total = (0.0, 0.0, 0.0, 0.0, 0.0)
    half = 0.5 * cut.edges.edge_length[segment]
    one = _at_gauss_point(cut, tooth, segment, 0, rotation)
    other = _at_gauss_point(cut, tooth, segment, 1, rotation)
    x1, y1, z1 = one[0] * one[3], one[0] * one[4], one[1]
    x2, y2, z2 = other[0] * other[3], other[0] * other[4], other[1]
    chip1 = chip2 = at_low = at_high = best = math.inf
    # a loop without branches: most of all the time goes here
    for k in range(cut.since.shape[0]):
        x, y, z = cut.since[k, 0], cut.since[k, 1], cut.since[k, 2]
        first = x * x1 + y * y1 - z * z1 - cut.radial_offset[tooth, segment, k, 0]
        last = x * x2 + y * y2 - z * z2 - cut.radial_offset[tooth, segment, k, 1]
        low, high = _at_ends(first, last)
        chip1, chip2 = min(chip1, first), min(chip2, last)
        at_low, at_high = min(at_low, low), min(at_high, high)
        best = min(best, max(low, high))
    if best <= 0.0:
        return total, True
    if at_low > 0.0 and at_high > 0.0:
        total = _add_edge_force(cut.law, tooth, one, chip1, half, total)
        total = _add_edge_force(cut.law, tooth, other, chip2, half, total)
        return total, True
    return total, False


@register_jitable(**INLINED)
def _at(cut, segment, span, t):
    """Immersion (sine, cosine), radius and angle (sine, cosine) of the edge at a t of a span."""
    edges = cut.edges
    angle = (span.position - t * span.half_lag) * (2.0 * math.pi / edges.bins)
    t = t * span.along
    sk, ck = tilted_normal(
        edges.sine_immersion[segment], edges.cosine_immersion[segment], t * edges.half_tilt[segment]
    )
    radius = edges.radius[segment] + t * edges.half_rise[segment]
    return sk, ck, radius, math.sin(angle), math.cos(angle)


@register_jitable(**INLINED)
def _clear_of_air(cut, tooth, segment, span, low, high):
    """Part low..high of a span in which the chip is positive against every earlier pass.

    Against each of them it varies nearly linearly; the thinnest of all has kinks, often where it
    vanishes.
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    t1, t2 = middle - GAUSS_POINT * half, middle + GAUSS_POINT * half
    one, other = _at(cut, segment, span, t1), _at(cut, segment, span, t2)
    x1, y1, z1 = one[0] * one[3], one[0] * one[4], one[1]
    x2, y2, z2 = other[0] * other[3], other[0] * other[4], other[1]
    begin, end = low, high
    for k in range(cut.since.shape[0]):
        x, y, z = cut.since[k, 0], cut.since[k, 1], cut.since[k, 2]
        at_low, at_high = _at_ends(
            x * x1 + y * y1 - z * z1 - _offset_at(cut, tooth, segment, k, t1 * span.along),
            x * x2 + y * y2 - z * z2 - _offset_at(cut, tooth, segment, k, t2 * span.along),
        )
        if at_low <= 0.0 and at_high <= 0.0:
            return low, low
        if at_low > 0.0 and at_high > 0.0:
            continue
        root = low + at_low / (at_low - at_high) * (high - low)
        if at_high > 0.0:
            begin = max(begin, root)
        else:
            end = min(end, root)
    if end < begin:
        return low, low
    return begin, end


@register_jitable(**INLINED)
def _part_of_span(cut, tooth, segment, span, low, high):
    """Force of the part low..high of a span that is as long as the slice."""
    total = (0.0, 0.0, 0.0, 0.0, 0.0)
    if high <= low:
        return total
    clear_low, clear_high = _clear_of_air(cut, tooth, segment, span, low, high)
    if clear_high <= clear_low:
        return total
    middle, half = 0.5 * (clear_low + clear_high), 0.5 * (clear_high - clear_low)
    # two Gauss points share the part; the span is 2 long
    length = 0.5 * half * cut.edges.edge_length[segment]
    for side in range(2):
        t = middle + (2.0 * side - 1.0) * GAUSS_POINT * half
        at = _at(cut, segment, span, t)
        chip = chip_at(cut, tooth, segment, at, t * span.along)
        if chip > 0.0:
            total = _add_edge_force(cut.law, tooth, at, chip, length, total)
    return total


@register_jitable(**INLINED)
def _slice_at(cut, tooth, segment, position):
    """Span of a slice whose middle is at a position, bins."""
    return Span(position, cut.edges.half_lag[tooth, segment], 1.0)


@register_jitable(**INLINED)
def _inside_arc(cut, tooth, segment, position, heading):
    """Part of a slice, from one t to another, that is between entry and exit."""
    lag = cut.edges.half_lag[tooth, segment]
    low, high = -1.0, 1.0
    entry, leave = cut.entry[segment] - heading, cut.exit[segment] - heading
    beyond, falls = position - entry, lag + cut.entry_rise[segment]
    before, rises = leave - position, lag + cut.exit_rise[segment]
    # beyond - t falls and before + t rises are not below zero
    if (falls == 0.0 and beyond < 0.0) or (rises == 0.0 and before < 0.0):
        return low, low
    if falls > 0.0:
        high = min(high, beyond / falls)
    elif falls < 0.0:
        low = max(low, beyond / falls)
    if rises > 0.0:
        low = max(low, -before / rises)
    elif rises < 0.0:
        high = min(high, -before / rises)
    return low, high


@register_jitable(**INLINED)
def part_of_slice(cut, tooth, segment, position, heading):
    """Force of the part of a slice that is in the cut, whose feed has a heading, bins."""
    low, high = _inside_arc(cut, tooth, segment, position, heading)
    return _part_of_span(cut, tooth, segment, _slice_at(cut, tooth, segment, position), low, high)


@register_jitable(**INLINED)
def straight_mean(cut, tooth, segment, position, rotation, heading):
    """Force of a straight edge over the turn of a step, so that a jump keeps its impulse."""
    half = 0.5 * rotation.advance
    low = max((cut.entry[segment] - heading - position) / half, -1.0)
    high = min((cut.exit[segment] - heading - position) / half, 1.0)
    return _part_of_span(cut, tooth, segment, Span(position, -half, 0.0), low, high)


@register_jitable(**INLINED)
def at_jump(cut, tooth, segment, position):
    """Force of a whole straight edge at a position, bins, where it enters or leaves."""
    return _part_of_span(cut, tooth, segment, _slice_at(cut, tooth, segment, position), -1.0, 1.0)
