"""Where the cut asks for borders of elements within a period of the tool.

Elements end where a tip or a top of an edge enters or leaves, so that all is smooth inside them.
Where a size effect makes the slope of the force law infinite, at a vanishing chip, they shrink
towards that position.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL
from cutting.edge_segments.coupling import (
    chip_vanishes,
    engaged_span,
    first_and_last_revolution,
    part_below,
)
from cutting.edge_segments.segment_ends import (
    WITHIN_WAVES,
    border_at,
    is_border,
    lowest_height,
    sort_with_marks,
)

#: borders closer than this share of the period are the same
SAME_BORDER = 1e-10
#: positions of an interval that are evaluated to return whether an edge is in the cut
_SAMPLES = (0.5, 0.02, 0.98)
#: levels of elements towards a singular position, and their ratio
_LEVELS = 5
LEVEL_RATIO = 0.16
#: the coupling of a straight cylindrical edge itself is infinite there: the last element, raised to
#: the exponent of the law, is as short as the ratio raised to this; beyond the most, rounding eats
#: it
_STRAIGHT_LEVELS, _MOST_LEVELS = 5.0, 18
#: an edge that trails by this much from tip to top smears what is singular over an element, rad
_SMEARED = 0.9


class PeriodBorders(NamedTuple):
    """I intervals of a period of the tool between the borders that the cut sets."""

    angle: Array  # of the spindle, rad (I + 1,)
    levels: IntegerArray  # of ever smaller elements, where a chip vanishes (I + 1,)
    engaged: IntegerArray  # 1 in the cut (I,)


@njit(**LEAF_KERNEL)
def is_engaged(segments, depth, spindle):
    """Whether any edge is in the cut at a spindle angle."""
    for segment in range(segments.bottom.shape[0]):
        top = part_below(segments, segment, depth)
        if top <= 0.0:
            continue
        first, last = first_and_last_revolution(segments, segment, top, spindle)
        for turn in range(first, last + 1):
            low, high = engaged_span(segments, segment, top, spindle, turn)
            if low < high or (low == high and low <= top):
                return True
    return False


@njit(**LEAF_KERNEL)
def _levels_at(segments, segment, position, immersion, depth):
    """Levels of smaller elements towards a border; none where the slope of the law is finite."""
    if segments.exponent == 0.0 or not chip_vanishes(segments, segment, position, immersion):
        return 0
    lag = (
        abs(segments.angle[segment, 1] - segments.angle[segment, 0])
        * depth
        / segments.thickness[segment]
    )
    smeared = math.log(max(lag / _SMEARED, 1e-12)) / math.log(LEVEL_RATIO)
    most = _LEVELS
    if lag == 0.0:
        straight = math.ceil(_STRAIGHT_LEVELS / (1.0 + segments.exponent))
        most = min(_MOST_LEVELS, max(_LEVELS, straight))
    return min(most, max(1, 1 + math.ceil(smeared)))


@njit(**LEAF_KERNEL)
def _border_angles(segments, period, depth, angles, levels):
    """Fill in borders in one period of the tool, in no order (rad), and their levels.

    Returns their number.
    """
    count, lowest = 0, lowest_height(segments)
    for segment in range(segments.bottom.shape[0]):
        top = part_below(segments, segment, depth)
        if top <= 0.0:
            continue
        for end in range(2):
            if not is_border(segments, segment, end, depth, lowest):
                continue
            position = top if end == 1 else 0.0
            # of so many each changes little, and is no worse for the size effect
            inner = segments.turning[segment, end] == WITHIN_WAVES
            for side in range(2):
                at, angles[count] = border_at(segments, segment, position, side, period)
                levels[count] = 0
                if not (inner and position == end):
                    levels[count] = _levels_at(segments, segment, position, at, depth)
                count += 1
    return count


@njit(**LEAF_KERNEL)
def _distinct(angles, levels, count, period):
    """Sort borders, take equal ones together and return how many are left, one at the least."""
    sort_with_marks(angles[:count], levels[:count])
    kept = 0
    for i in range(count):
        if kept > 0 and angles[i] - angles[kept - 1] <= SAME_BORDER * period:
            levels[kept - 1] = max(levels[kept - 1], levels[i])
            continue
        angles[kept], levels[kept] = angles[i], levels[i]
        kept += 1
    if kept > 1 and angles[0] + period - angles[kept - 1] <= SAME_BORDER * period:
        kept -= 1
        levels[0] = max(levels[0], levels[kept])
    if kept == 0:
        angles[0], levels[0], kept = 0.0, 0, 1
    return kept


@njit(**INNER_KERNEL)
def period_borders(segments, period, depth):
    """Spindle angles at which a tip or a top of an edge enters or leaves.

    `period` is the angle after which the tool repeats itself, rad; `depth` the axial depth, m.
    """
    room = 4 * segments.bottom.shape[0] + 2
    angles, levels = np.empty(room), np.empty(room, dtype=np.int64)
    count = _border_angles(segments, period, depth, angles, levels)
    count = _distinct(angles, levels, count, period)
    angles[count], levels[count] = angles[0] + period, levels[0]
    engaged = np.zeros(count, dtype=np.int64)
    for k in range(count):
        for share in _SAMPLES:
            angle = angles[k] + share * (angles[k + 1] - angles[k])
            if engaged[k] == 0 and is_engaged(segments, depth, angle):
                engaged[k] = 1
    return PeriodBorders(angles[: count + 1], levels[: count + 1], engaged)


@njit(**INNER_KERNEL)
def empty_borders():
    """Borders before there are any."""
    whole = np.empty(0, dtype=np.int64)
    return PeriodBorders(np.empty(0), whole, whole)


@njit(**LEAF_KERNEL)
def same_borders(one, other):
    """Whether borders and the intervals between them are the same."""
    if one.angle.shape[0] != other.angle.shape[0]:
        return False
    same = True
    for i in range(one.angle.shape[0]):
        same = same and one.angle[i] == other.angle[i] and one.levels[i] == other.levels[i]
    for i in range(one.engaged.shape[0]):
        same = same and one.engaged[i] == other.engaged[i]
    return same
