"""Engaged intervals along a group that are in the cut at once, and quadrature along them.

Leaves for compiled code.
"""

import math

from numba.extending import register_jitable

from cutting.compiled import INLINED
from cutting.edge_segments.coupling import chip_at, engaged_span, share_of_height

_REVOLUTION = 2.0 * math.pi
#: Gauss points that a table of quadratures goes up to
MOST_POINTS = 16
#: an interval turns, bends and shifts by no more than this, rad
_LONGEST_INTERVAL = 3.5
#: below this two points do
_SHORT_INTERVAL = 0.15
#: an engaged interval is in the cut up to the end of a segment within this share of it
_WHOLE = 1.0 - 1e-12
#: digits (as a power of e) to which a power of the chip is integrated
_CHIP_DIGITS = 15.0
#: more points than this are spent better on crowding them towards an end
_MOST_POINTS_OF_CHIP = 6
#: points by which an interval takes more where they are graded
_FOR_CROWDING = 6
#: ends of an interval at which the chip vanishes
NO_END, LOW_END, HIGH_END, BOTH_ENDS = 0, 1, 2, 3


@register_jitable(**INLINED)
def reach_of_segment(segments, tops, segment, reach):
    """Set reach (4,) to the spindle angles, rad, between which a segment is in the cut.

    Outside the first and the last nothing of it is, between the second and the third all of it.
    """
    a, b = segments.angle[segment, 0], segments.angle[segment, 1]
    entry, leave = segments.entry[segment], segments.exit[segment]
    reach[0] = min(entry[0], entry[1]) - max(a, b)
    reach[1] = max(entry[0], entry[1]) - min(a, b)
    reach[2] = min(leave[0], leave[1]) - max(a, b)
    reach[3] = max(leave[0], leave[1]) - min(a, b)
    if tops[segment] <= 0.0:
        reach[0], reach[3] = 1e3, -1e3


@register_jitable(**INLINED)
def bounds_of_groups(segments, reach, bounds):
    """Set bounds (G, 2) to the spindle angles, rad, between which something of a group is cut."""
    for group in range(bounds.shape[0]):
        early, late = 1e3, -1e3
        for segment in range(segments.first_of_group[group], segments.first_of_group[group + 1]):
            early, late = min(early, reach[segment, 0]), max(late, reach[segment, 3])
        bounds[group, 0], bounds[group, 1] = early, late


@register_jitable(**INLINED)
def revolutions_of_group(bounds, group, spindle):
    """Revolutions by which a group may have to be turned back to be in the cut, first and last."""
    first = math.ceil((spindle - bounds[group, 1]) / _REVOLUTION - 1e-12)
    return first, math.floor((spindle - bounds[group, 0]) / _REVOLUTION + 1e-12)


@register_jitable(**INLINED)
def _span(segments, tops, reach, segment, spindle, back):
    """Part of a segment that is in the cut, as `engaged_span` gives it."""
    turned = spindle - _REVOLUTION * back
    if turned <= reach[segment, 0] or turned >= reach[segment, 3]:
        return 1.0, 0.0
    if reach[segment, 1] < turned < reach[segment, 2]:
        return 0.0, tops[segment]
    return engaged_span(segments, segment, tops[segment], spindle, back)


@register_jitable(**INLINED)
def change_along(segments, segment, elements):
    """Rotation and bend of the edge, and phase of the wave that it has left, along a segment."""
    shift = segments.delay[segment, 1] - segments.delay[segment, 0]
    return (
        abs(segments.angle[segment, 1] - segments.angle[segment, 0])
        + abs(segments.immersion[segment, 1] - segments.immersion[segment, 0])
        + 2.0 * abs(shift) * elements
    )


@register_jitable(**INLINED)
def engaged_interval_from(segments, tops, reach, segment, end, spindle, back, elements):
    """Engaged interval in the cut that begins in a segment, or none.

    From the first segment to `end`, that beyond the last of its group. `tops` (P,) are the parts of
    segments below the depth of cut, `reach` (P, 4) that of `reach_of_segment`; at a spindle angle,
    rad, so many revolutions taken off; `elements` of the motion pass as the tool turns by a radian.
    Last segment of the interval, below the first where there is none, where it begins in the first
    and ends in the last segment, and by which it turns, bends and shifts.
    """
    last = segment
    low, high = _span(segments, tops, reach, segment, spindle, back)
    if low >= high:
        return segment - 1, 0.0, 0.0, 0.0
    change = change_along(segments, segment, elements) * (high - low)
    while high >= _WHOLE and last + 1 < end:
        below, above = _span(segments, tops, reach, last + 1, spindle, back)
        longer = change + change_along(segments, last + 1, elements)
        if below > 0.0 or above <= 0.0 or longer > _LONGEST_INTERVAL:
            break
        last, high, change = last + 1, above, longer
    return last, low, high, change


@register_jitable(**INLINED)
def _chip_at_position(segments, segment, position, spindle):
    """Chip of a rigid tool at a position along a segment, m."""
    height = share_of_height(segments, segment, position)
    turned = segments.angle[segment, 1] - segments.angle[segment, 0]
    sine = math.sin(spindle + segments.angle[segment, 0] + height * turned)
    low, high = segments.immersion[segment, 0], segments.immersion[segment, 1]
    kappa = low + position * (high - low)
    return chip_at(segments, segment, position, height, sine, math.sin(kappa), math.cos(kappa))


@register_jitable(**INLINED)
def points_along(segments, segment, last, low, high, change, spindle):
    """Order of a quadrature along an engaged interval; parameters of `engaged_interval_from`.

    Points, and the ends towards which they are graded, because the chip vanishes there.
    """
    if change < 1e-9 and segments.delay_index[segment] >= 0:
        return 1, NO_END
    points = 2
    if change > _SHORT_INTERVAL:
        points = min(MOST_POINTS, 2 + math.ceil(2.5 * change))
    if segments.exponent == 0.0:
        return points, NO_END
    one = max(_chip_at_position(segments, segment, low, spindle), 0.0)
    other = max(_chip_at_position(segments, last, high, spindle), 0.0)
    root = math.sqrt(min(one, other) / max(one, other, 1e-300))
    # a singularity at the distance x from the middle of [-1, 1]: errors fall as (x + sqrt(x^2-1))
    # to the power -2 n (Trefethen 2008, SIAM Rev. 50, Theorem 4.5)
    rate = math.log((1.0 + root) / max(1.0 - root, 1e-12))
    if 2.0 * _MOST_POINTS_OF_CHIP * rate >= _CHIP_DIGITS:
        return max(points, math.ceil(0.5 * _CHIP_DIGITS / rate)), NO_END
    middle = _chip_at_position(segments, (segment + last) // 2, 0.5 * (low + high), spindle)
    if max(one, other) < 0.5 * middle:
        return MOST_POINTS, BOTH_ENDS
    return min(MOST_POINTS, points + _FOR_CROWDING), LOW_END if one < other else HIGH_END


@register_jitable(**INLINED)
def graded(position, weight, ends):
    """Place and weight on [0, 1], graded towards the ends at which the chip vanishes."""
    if ends == NO_END:
        return position, weight
    if ends == BOTH_ENDS:
        weight *= 30.0 * (position * (1.0 - position)) ** 2
        return position * position * position * (
            10.0 - 15.0 * position + 6.0 * position * position
        ), weight
    away = position if ends == LOW_END else 1.0 - position
    # a fourth power: what is left of a chip to any power vanishes smoothly
    weight *= 4.0 * away * away * away
    away *= away * away * away
    return away if ends == LOW_END else 1.0 - away, weight


@register_jitable(**INLINED)
def length_of_interval(segments, segment, last, low, high):
    """Length of edge in an interval, m."""
    length = -low * segments.length[segment] + high * segments.length[last]
    for k in range(segment, last):
        length += segments.length[k]
    return length


@register_jitable(**INLINED)
def position_in_interval(segments, segment, last, start, along):
    """Segment, and position along it, at a length (m) beyond the low end of a segment.

    `start` is the length of edge before that segment that is to be taken off.
    """
    rest = along - start
    while segment < last and rest > segments.length[segment]:
        rest -= segments.length[segment]
        start += segments.length[segment]
        segment += 1
    return segment, rest / segments.length[segment], start
