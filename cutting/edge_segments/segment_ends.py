"""Ends of segments at which the engagement of an edge changes: leaves for compiled code."""

import math

from numba.extending import register_jitable

from cutting.compiled import INLINED
from cutting.edge_segments.coupling import arc_at

#: marks of the ends at which the engagement of an edge turns round: alone, and as one of many, a
#: few to every wave of a serrated edge, none of which changes the force by much
TURNING, WITHIN_WAVES = 1, 2


@register_jitable(**INLINED)
def lowest_height(segments):
    """Height of the lowest segment above the tip, m."""
    lowest = math.inf
    for segment in range(segments.bottom.shape[0]):
        lowest = min(lowest, segments.bottom[segment])
    return lowest


@register_jitable(**INLINED)
def is_border(segments, segment, end, depth, lowest):
    """Whether engagement changes at the low (0) or high (1) end of a segment.

    At the lowest position that cuts, at the top of the cut, and where an edge meets the stock;
    elsewhere the segments of an edge continue one another.
    """
    if segments.turning[segment, end] >= TURNING:
        return True
    if end == 0:
        return segments.bottom[segment] <= lowest
    high = depth + segments.lift
    return high - segments.bottom[segment] <= segments.thickness[segment] * (1.0 + 1e-12)


@register_jitable(**INLINED)
def border_at(segments, segment, position, side, period):
    """Immersion angle of entry (side 0) or exit at a position, and the spindle angle there, rad.

    The spindle angle lies in the first period (rad) of the tool.
    """
    entry, leave, lag = arc_at(segments, segment, position)
    immersion = entry if side == 0 else leave
    angle = immersion - lag
    return immersion, angle - period * math.floor(angle / period)


@register_jitable(**INLINED)
def sort_with_marks(values, marks):
    """Sort values in ascending order, and their marks with them, by insertion: there are few."""
    for i in range(1, values.shape[0]):
        value, mark, j = values[i], marks[i], i
        while j > 0 and values[j - 1] > value:
            values[j], marks[j] = values[j - 1], marks[j - 1]
            j -= 1
        values[j], marks[j] = value, mark
