"""Where the elements of a period begin and end.

Elements end where a tip or a top of an edge enters or leaves, so that all is smooth inside them,
and where a triangular variation of the speed has its corners. Where no tooth cuts, the free motion
is one element. Where a size effect makes the slope of the force law infinite, at a vanishing chip,
elements shrink towards that place.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.spindle_turn import angle_at, time_at
from cutting.edge_coupling import (
    chip_vanishes,
    engaged_span,
    first_and_last_turn,
    part_below,
    share_of_height,
)

#: borders closer than this share of the period are the same
_SAME = 1e-10
#: element lengths closer than this share are the same
_SAME_LENGTH = 1e-9
#: places of an interval that are looked at to tell whether an edge is in the cut
_LOOKS = (0.5, 0.02, 0.98)
#: of more intervals than these the elements are counted in steps of the speed, in powers of two
_FEW_INTERVALS = 12
_STEP_OF_MANY = 0.25
#: levels and ratio of the elements towards a singular place
_LEVELS = 5
_RATIO = 0.16
#: the coupling of an upright edge itself is infinite there: the last element, raised to the
#: exponent of the law, is as short as the ratio raised to this; beyond the most, rounding eats it
_UPRIGHT_LEVELS, _MOST_LEVELS = 5.0, 18
#: an edge that trails by this much from tip to top smears what is singular over an element, rad
_SMEARED = 0.9


class ElementLayout(NamedTuple):
    """M elements of a period, of which E lie in the cut; places and lengths in mean angle turned.

    Mean angle is time times the mean spindle speed.
    """

    cut: NDArray[np.int64]  # number among the elements in the cut, -1 for free motion (M,)
    shape: NDArray[np.int64]  # number of the length (M,)
    length: NDArray[np.float64]  # distinct lengths, rad (S,)
    length_cuts: NDArray[np.int64]  # 1 where an element in the cut has the length (S,)
    cut_start: NDArray[np.float64]  # start of the elements in the cut, rad (E,)
    cut_length: NDArray[np.float64]  # rad (E,)
    period: float  # rad


class PeriodBorders(NamedTuple):
    """I intervals of a period between the borders of elements that the cut itself sets."""

    place: NDArray[np.float64]  # mean angle, rad (I + 1,)
    levels: NDArray[np.int64]  # of ever smaller elements, where a chip vanishes (I + 1,)
    engaged: NDArray[np.int64]  # 1 in the cut (I,)
    turned: NDArray[np.float64]  # angle turned in the interval, rad (I,)
    period: float  # mean angle, rad


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
    smeared = math.log(max(lag / _SMEARED, 1e-12)) / math.log(_RATIO)
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
        if kept > 0 and angles[i] - angles[kept - 1] <= _SAME * period:
            levels[kept - 1] = max(levels[kept - 1], levels[i])
            continue
        angles[kept], levels[kept] = angles[i], levels[i]
        kept += 1
    if kept > 1 and angles[0] + period - angles[kept - 1] <= _SAME * period:
        kept -= 1
        levels[0] = max(levels[0], levels[kept])
    if kept == 0:
        angles[0], levels[0], kept = 0.0, 0, 1
    return kept


@njit(**LEAF_KERNEL)
def _add_corners(turn, places, marks, n, period):
    """Add the corners of a triangular variation of the speed; returns the number of borders."""
    first, borders = places[0], n
    for i in range(2 * turn.cycles):
        place = (0.25 + 0.5 * i) / turn.frequency
        place -= period * math.floor((place - first) / period)
        near = first + period - place
        for k in range(borders):
            near = min(near, abs(places[k] - place))
        if near > _SAME * period:
            places[n], marks[n] = place, 0
            n += 1
    return n


@njit(**INNER_KERNEL)
def period_borders(pieces, tool_period, turn, depth):
    """Borders over the whole period at which a tip or a top of an edge enters or leaves.

    Parameters
    ----------
    pieces : EdgePieces
    tool_period : float
        Angle after which the tool looks the same again, rad.
    turn : SpindleTurn
        In mean angle.
    depth : float
        Axial depth, m.

    Returns
    -------
    PeriodBorders
    """
    room = 4 * pieces.bottom.shape[0] + 1
    angles, levels = np.empty(room), np.empty(room, dtype=np.int64)
    count = _border_angles(pieces, tool_period, depth, angles, levels)
    count = _distinct(angles, levels, count, tool_period)
    triangular = turn.triangle == 1 and turn.amplitude > 0.0
    n = turn.patterns * count
    room = n + 1 + (2 * turn.cycles if triangular else 0)
    places, marks = np.empty(room), np.empty(room, dtype=np.int64)
    for pattern in range(turn.patterns):
        for i in range(count):
            places[pattern * count + i] = time_at(turn, angles[i] + pattern * tool_period)
            marks[pattern * count + i] = levels[i]
    period = turn.patterns * tool_period
    if triangular:
        n = _add_corners(turn, places, marks, n, period)
    _sort(places[:n], marks[:n])
    places[n], marks[n] = places[0] + period, marks[0]
    engaged, turned = np.empty(n, dtype=np.int64), np.empty(n)
    for k in range(n):
        turned[k] = angle_at(turn, places[k + 1]) - angle_at(turn, places[k])
        engaged[k] = 0
        for share in _LOOKS:
            angle = angle_at(turn, places[k] + share * (places[k + 1] - places[k]))
            if engaged[k] == 0 and is_engaged(pieces, depth, angle):
                engaged[k] = 1
    return PeriodBorders(places[: n + 1], marks[: n + 1], engaged, turned, period)


@njit(**LEAF_KERNEL)
def speed_step(speed, step):
    """Speed, at most the given one, out of steps of a power of two; rad/s."""
    return 2.0 ** (step * math.floor(math.log2(speed) / step))


@njit(**INNER_KERNEL)
def empty_borders():
    """Borders before there are any."""
    whole = np.empty(0, dtype=np.int64)
    return PeriodBorders(np.empty(0), whole, whole, np.empty(0), 0.0)


@njit(**INNER_KERNEL)
def element_counts(resolution, borders, speed, depth):
    """Elements (I,) that each interval needs at a mean speed (rad/s)."""
    counts = np.empty(borders.engaged.shape[0], dtype=np.int64)
    if counts.shape[0] > _FEW_INTERVALS:
        # one of so many would change its number at every speed, and no plan could be shared
        speed = speed_step(speed, _STEP_OF_MANY)
    waves = math.sqrt(1.0 + resolution.stiffening * depth / resolution.fastest**2)
    for i in range(counts.shape[0]):
        span = (borders.place[i + 1] - borders.place[i]) / speed
        need = max(span * waves / resolution.longest, borders.turned[i] / resolution.longest_angle)
        counts[i] = max(1, math.ceil(need - 1e-9)) if borders.engaged[i] == 1 else 1
    return counts


@njit(**INNER_KERNEL)
def element_layout(borders, counts):
    """Cut a period into elements.

    Parameters
    ----------
    borders : PeriodBorders
    counts : (I,) array of int
        Elements of each interval.

    Returns
    -------
    ElementLayout
    """
    place, levels, engaged = borders.place, borders.levels, borders.engaged
    intervals = counts.shape[0]
    total = 0
    for i in range(intervals):
        total += counts[i] + (levels[i] + levels[i + 1] if engaged[i] == 1 else 0)
    start, length = np.empty(total), np.empty(total)
    number = np.full(total, -1, dtype=np.int64)
    m, cuts = 0, 0
    for i in range(intervals):
        step = (place[i + 1] - place[i]) / counts[i]
        for k in range(counts[i]):
            low, high = place[i] + k * step, place[i] + (k + 1) * step
            if engaged[i] == 1 and k == 0 and levels[i] > 0:
                at = low
                for level in range(levels[i], 0, -1):
                    start[m], number[m] = at, cuts
                    length[m] = low + step * _RATIO**level - at
                    at += length[m]
                    m, cuts = m + 1, cuts + 1
                low = at
            graded = engaged[i] == 1 and k == counts[i] - 1 and levels[i + 1] > 0
            end = high - step * _RATIO if graded else high
            start[m], length[m] = low, end - low
            if engaged[i] == 1:
                number[m] = cuts
                cuts += 1
            m += 1
            if graded:
                for level in range(1, levels[i + 1] + 1):
                    at = high
                    if level < levels[i + 1]:
                        at -= step * _RATIO ** (level + 1)
                    start[m], number[m], length[m] = end, cuts, at - end
                    end = at
                    m, cuts = m + 1, cuts + 1
    shape, cut_start, cut_length = np.empty(m, dtype=np.int64), np.empty(cuts), np.empty(cuts)
    for i in range(m):
        if number[i] >= 0:
            cut_start[number[i]], cut_length[number[i]] = start[i], length[i]
    distinct, of_cut = _shapes(length, number, m, shape)
    return ElementLayout(number[:m], shape, distinct, of_cut, cut_start, cut_length, borders.period)


@njit(**SINGLE_KERNEL)
def _shapes(length, number, count, shape):
    """Set shape (count,) to the number of each length; returns them and which lie in the cut."""
    distinct, of_cut = np.empty(count), np.zeros(count, dtype=np.int64)
    shapes = 0
    for m in range(count):
        found = -1
        for s in range(shapes):
            if abs(distinct[s] - length[m]) <= _SAME_LENGTH * length[m]:
                found = s
                break
        if found < 0:
            found = shapes
            distinct[shapes] = length[m]
            shapes += 1
        shape[m] = found
        if number[m] >= 0:
            of_cut[found] = 1
    return distinct[:shapes], of_cut[:shapes]


@njit(**LEAF_KERNEL)
def element_before(layout, angle):
    """Element in the cut that holds a mean angle, counted on over the periods, and the place in it.

    Between two elements in the cut, by rounding, the end of the nearer one.
    """
    cuts = layout.cut_start.shape[0]
    first = layout.cut_start[0]
    turn = math.floor((angle - first) / layout.period + _SAME)
    local = angle - turn * layout.period
    low, high = 0, cuts
    while high - low > 1:
        middle = (low + high) // 2
        if layout.cut_start[middle] <= local + _SAME * layout.period:
            low = middle
        else:
            high = middle
    place = (local - layout.cut_start[low]) / layout.cut_length[low]
    if place > 1.0:
        beyond = local - layout.cut_start[low] - layout.cut_length[low]
        following = (layout.cut_start[low + 1] if low + 1 < cuts else first + layout.period) - local
        if following < beyond:
            if low + 1 < cuts:
                return low + 1 + turn * cuts, 0.0
            return (turn + 1) * cuts, 0.0
    return low + turn * cuts, min(1.0, max(0.0, place))
