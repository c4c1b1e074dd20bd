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

from chatter.kernels import KERNEL
from chatter.stability.spindle_turn import angle_at, time_at
from cutting.edge_pieces import (
    engaged_span,
    first_and_last_turn,
    part_below,
    share_of_height,
)

#: borders closer than this share of the period are the same
_SAME = 1e-10
#: element lengths closer than this share are the same
_SAME_LENGTH = 1e-9
#: levels and ratio of the elements towards a singular place
_LEVELS = 5
_RATIO = 0.16


class ElementLayout(NamedTuple):
    """M elements of a period, of which E lie in the cut; places and lengths in mean angle turned.

    Mean angle is time times the mean spindle speed.
    """

    start: NDArray[np.float64]  # rad (M,)
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
    singular: NDArray[np.int64]  # 1 where a chip vanishes and its slope is infinite (I + 1,)
    engaged: NDArray[np.int64]  # 1 in the cut (I,)
    turned: NDArray[np.float64]  # angle turned in the interval, rad (I,)
    period: float  # mean angle, rad


@njit(**KERNEL)
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


@njit(**KERNEL)
def _border_angles(cut, depth):
    """Borders in one period of the tool, ascending (rad), and 1 for each that is singular."""
    pieces, period = cut.pieces, cut.period_angle
    angles = np.empty(4 * pieces.bottom.shape[0] + 1)
    singular = np.zeros(angles.shape[0], dtype=np.int64)
    count = 0
    lowest = pieces.bottom.min()
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        for end in range(2):
            # the lowest place of an edge that cuts, and the top of the cut
            if (end == 0 and pieces.bottom[piece] > lowest) or (
                end == 1 and depth > pieces.bottom[piece] + pieces.thickness[piece] * (1.0 + 1e-12)
            ):
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
                if pieces.exponent != 0.0:
                    chip = pieces.feed[piece] * math.sin(at) - pieces.inset[piece]
                    if chip < 1e-3 * pieces.feed[piece]:
                        singular[count] = 1
                count += 1
    order = np.argsort(angles[:count])
    borders, flags = np.empty(count + 1), np.zeros(count + 1, dtype=np.int64)
    kept = 0
    for i in order:
        if kept > 0 and angles[i] - borders[kept - 1] <= _SAME * period:
            flags[kept - 1] = max(flags[kept - 1], singular[i])
            continue
        borders[kept], flags[kept] = angles[i], singular[i]
        kept += 1
    if kept > 1 and borders[0] + period - borders[kept - 1] <= _SAME * period:
        kept -= 1
        flags[0] = max(flags[0], flags[kept])
    if kept == 0:
        borders[0], kept = 0.0, 1
    return borders[:kept], flags[:kept]


@njit(**KERNEL)
def period_borders(cut, turn, depth):
    """Borders over the whole period at which a tip or a top of an edge enters or leaves.

    Parameters
    ----------
    cut : CutArrays
    turn : SpindleTurn
        In mean angle.
    depth : float
        Axial depth, m.

    Returns
    -------
    PeriodBorders
    """
    borders, flags = _border_angles(cut, depth)
    count = borders.shape[0]
    corners = 2 * turn.cycles if turn.triangle == 1 and turn.amplitude > 0.0 else 0
    places = np.empty(turn.patterns * count + corners + 1)
    marks = np.zeros(places.shape[0], dtype=np.int64)
    n = 0
    for pattern in range(turn.patterns):
        for i in range(count):
            places[n] = time_at(turn, borders[i] + pattern * cut.period_angle)
            marks[n] = flags[i]
            n += 1
    period = turn.patterns * cut.period_angle
    for i in range(corners):
        place = (0.25 + 0.5 * i) / turn.frequency
        place -= period * math.floor((place - places[0]) / period)
        near = np.abs(places[:n] - place).min()
        if near > _SAME * period and places[0] + period - place > _SAME * period:
            places[n] = place
            n += 1
    order = np.argsort(places[:n])
    out, out_marks = np.empty(n + 1), np.zeros(n + 1, dtype=np.int64)
    for k in range(n):
        out[k], out_marks[k] = places[order[k]], marks[order[k]]
    out[n], out_marks[n] = out[0] + period, out_marks[0]
    engaged, turned = np.empty(n, dtype=np.int64), np.empty(n)
    for k in range(n):
        turned[k] = angle_at(turn, out[k + 1]) - angle_at(turn, out[k])
        middle = angle_at(turn, 0.5 * (out[k] + out[k + 1]))
        engaged[k] = 1 if is_engaged(cut.pieces, depth, middle) else 0
    return PeriodBorders(out, out_marks, engaged, turned, period)


@njit(**KERNEL)
def element_counts(cut, borders, speed, depth):
    """Elements (I,) that each interval needs at a mean speed (rad/s)."""
    counts = np.empty(borders.engaged.shape[0], dtype=np.int64)
    waves = math.sqrt(1.0 + cut.stiffening * depth / cut.fastest**2)
    for i in range(counts.shape[0]):
        span = (borders.place[i + 1] - borders.place[i]) / speed
        need = max(span * waves / cut.longest, borders.turned[i] / cut.longest_angle)
        counts[i] = max(1, math.ceil(need - 1e-9)) if borders.engaged[i] == 1 else 1
    return counts


@njit(**KERNEL)
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
    place, marks, engaged = borders.place, borders.singular, borders.engaged
    intervals = counts.shape[0]
    total = 0
    for i in range(intervals):
        total += counts[i] + (2 * _LEVELS if engaged[i] == 1 else 0)
    start, length = np.empty(total), np.empty(total)
    number = np.full(total, -1, dtype=np.int64)
    m, cuts = 0, 0
    for i in range(intervals):
        step = (place[i + 1] - place[i]) / counts[i]
        for k in range(counts[i]):
            low, high = place[i] + k * step, place[i] + (k + 1) * step
            if engaged[i] == 1 and k == 0 and marks[i] == 1:
                at = low
                for level in range(_LEVELS, 0, -1):
                    start[m], number[m] = at, cuts
                    length[m] = low + step * _RATIO**level - at
                    at += length[m]
                    m, cuts = m + 1, cuts + 1
                low = at
            graded = engaged[i] == 1 and k == counts[i] - 1 and marks[i + 1] == 1
            end = high - step * _RATIO if graded else high
            start[m], length[m] = low, end - low
            if engaged[i] == 1:
                number[m] = cuts
                cuts += 1
            m += 1
            if graded:
                for level in range(1, _LEVELS + 1):
                    at = high - step * _RATIO ** (level + 1) if level < _LEVELS else high
                    start[m], number[m], length[m] = end, cuts, at - end
                    end = at
                    m, cuts = m + 1, cuts + 1
    return _with_shapes(start[:m], length[:m], number[:m], cuts, borders.period)


@njit(**KERNEL)
def _with_shapes(start, length, number, cuts, period):
    count = start.shape[0]
    shape = np.empty(count, dtype=np.int64)
    distinct = np.empty(count)
    of_cut = np.zeros(count, dtype=np.int64)
    shapes = 0
    cut_start, cut_length = np.empty(cuts), np.empty(cuts)
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
            cut_start[number[m]], cut_length[number[m]] = start[m], length[m]
    return ElementLayout(
        start, number, shape, distinct[:shapes], of_cut[:shapes], cut_start, cut_length, period
    )


@njit(**KERNEL)
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
