"""Where the cut asks for borders of elements within a period of the tool.

Elements end where a tip or a top of an edge enters or leaves, so that all is smooth inside them.
Where a size effect makes the slope of the force law infinite, at a vanishing chip, they shrink
towards that place.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL
from cutting.edge_segments.coupling import (
    chip_vanishes,
    engaged_span,
    first_and_last_turn,
    part_below,
    share_of_height,
)

#: borders closer than this share of the period are the same
SAME_BORDER = 1e-10
#: places of an interval that are looked at to tell whether an edge is in the cut
_LOOKS = (0.5, 0.02, 0.98)
#: levels of elements towards a singular place, and their ratio
_LEVELS = 5
LEVEL_RATIO = 0.16
#: the coupling of an upright edge itself is infinite there: the last element, raised to the
#: exponent of the law, is as short as the ratio raised to this; beyond the most, rounding eats it
_UPRIGHT_LEVELS, _MOST_LEVELS = 5.0, 18
#: an edge that trails by this much from tip to top smears what is singular over an element, rad
_SMEARED = 0.9


class PeriodBorders(NamedTuple):
    """I intervals of a period of the tool between the borders that the cut sets."""

    angle: NDArray[np.float64]  # of the spindle, rad (I + 1,)
    levels: NDArray[np.int64]  # of ever smaller elements, where a chip vanishes (I + 1,)
    engaged: NDArray[np.int64]  # 1 in the cut (I,)


@njit(**LEAF_KERNEL)
def is_engaged(pieces, depth, spindle):
    """Tell whether any edge is in the cut at a spindle angle."""
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        first, last = first_and_last_turn(pieces, piece, top, spindle)
        for turn in range(first, last + 1):
            low, high = engaged_span(pieces, piece, top, spindle, turn)
            if low < high or (low == high and low <= top):
                return True
    return False


@njit(**LEAF_KERNEL)
def _sort(places, marks):
    """Sort places in ascending order, and their marks with them; nearly sorted ones are quick."""
    for i in range(1, places.shape[0]):
        place, mark = places[i], marks[i]
        j = i
        while j > 0 and places[j - 1] > place:
            places[j], marks[j] = places[j - 1], marks[j - 1]
            j -= 1
        places[j], marks[j] = place, mark


@njit(**LEAF_KERNEL)
def _levels_at(pieces, piece, place, immersion, depth):
    """Levels of smaller elements towards a border; none where the slope of the law is finite."""
    if pieces.exponent == 0.0 or not chip_vanishes(pieces, piece, place, immersion):
        return 0
    lag = abs(pieces.angle[piece, 1] - pieces.angle[piece, 0]) * depth / pieces.thickness[piece]
    smeared = math.log(max(lag / _SMEARED, 1e-12)) / math.log(LEVEL_RATIO)
    most = _LEVELS
    if lag == 0.0:
        upright = math.ceil(_UPRIGHT_LEVELS / (1.0 + pieces.exponent))
        most = min(_MOST_LEVELS, max(_LEVELS, upright))
    return min(most, max(1, 1 + math.ceil(smeared)))


@njit(**LEAF_KERNEL)
def _border_angles(pieces, period, depth, angles, levels):
    """Fill in borders in one period of the tool, in no order (rad), and their levels.

    Returns their number.
    """
    count = 0
    lowest = np.inf
    for piece in range(pieces.bottom.shape[0]):
        lowest = min(lowest, pieces.bottom[piece])
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        for end in range(2):
            # the lowest place that cuts, the top of the cut, and where an edge meets the stock
            if end == 0:
                wanted = pieces.bottom[piece] <= lowest
            else:
                above = depth - pieces.bottom[piece]
                wanted = above <= pieces.thickness[piece] * (1.0 + 1e-12)
            if not (wanted or pieces.turning[piece, end] == 1):
                continue
            s = top if end == 1 else 0.0
            height = share_of_height(pieces, piece, s)
            turned = pieces.angle[piece, 1] - pieces.angle[piece, 0]
            place = pieces.angle[piece, 0] + height * turned
            for side in range(2):
                arc = pieces.entry if side == 0 else pieces.exit
                at = arc[piece, 0] + s * (arc[piece, 1] - arc[piece, 0])
                angle = at - place
                angles[count] = angle - period * math.floor(angle / period)
                levels[count] = _levels_at(pieces, piece, s, at, depth)
                count += 1
    return count


@njit(**LEAF_KERNEL)
def _distinct(angles, levels, count, period):
    """Sort borders, take equal ones together and return how many are left, one at the least."""
    _sort(angles[:count], levels[:count])
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
def period_borders(pieces, period, depth):
    """Spindle angles at which a tip or a top of an edge enters or leaves.

    Parameters
    ----------
    pieces : EdgePieces
    period : float
        Angle after which the tool looks the same again, rad.
    depth : float
        Axial depth, m.

    Returns
    -------
    PeriodBorders
    """
    room = 4 * pieces.bottom.shape[0] + 2
    angles, levels = np.empty(room), np.empty(room, dtype=np.int64)
    count = _border_angles(pieces, period, depth, angles, levels)
    count = _distinct(angles, levels, count, period)
    angles[count], levels[count] = angles[0] + period, levels[0]
    engaged = np.zeros(count, dtype=np.int64)
    for k in range(count):
        for share in _LOOKS:
            angle = angles[k] + share * (angles[k + 1] - angles[k])
            if engaged[k] == 0 and is_engaged(pieces, depth, angle):
                engaged[k] = 1
    return PeriodBorders(angles[: count + 1], levels[: count + 1], engaged)


@njit(**INNER_KERNEL)
def empty_borders():
    """Borders before there are any."""
    whole = np.empty(0, dtype=np.int64)
    return PeriodBorders(np.empty(0), whole, whole)
