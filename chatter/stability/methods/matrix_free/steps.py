"""Steps of the matrix-free method over a period.

Steps end where a tip or a top of an edge enters or leaves, and where a triangular variation of the
speed has its corners, so that all is smooth inside them. Where a size effect makes the slope of the
force law infinite, at a vanishing chip, the force f is like t^(p-1) in the time t from the border,
and the integral of f dt is taken over s, with t = h s^k: f dt/ds is like s^(k p - 1), smooth for
the right k (a graded mesh: Brunner 2004, Collocation Methods for Volterra Integral and Related
Functional Differential Equations, chapter 6; here the force is graded along with the mesh). So it
is where an edge, on a cone or a corner, enters or leaves nearly all at once: what is engaged then
is like the root of the time.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array
from chatter.engine.presets import INNER_KERNEL
from chatter.stability.methods.matrix_free.modal_response import POSITIONS
from chatter.stability.spindle_rotation import angle_at, time_at
from cutting.edge_segments.coupling import chip_vanishes, part_below
from cutting.edge_segments.segment_ends import (
    TURNING,
    border_at,
    is_border,
    lowest_height,
    sort_with_marks,
)

#: borders closer than this share of the period are the same
_SAME = 1e-10
#: steps that one is graded into towards a vanishing chip, and towards a root of the time
_GRADED, _GRADED_ROOT = 6, 3
#: an edge enters nearly all at once where it does so in a share of the time that it takes elsewhere
_FLAT = 0.5
#: power for a root: f dt/ds is like s^2
_POWER_OF_ROOT = 2.0
#: the slope of a size effect is infinite, or nearly, where the chip is below this share of the feed
_THIN = 0.1
#: sides of a border on which a chip vanishes, and on which engagement is a root of the time
_BEFORE, _AFTER, _ROOT_BEFORE, _ROOT_AFTER = 1, 2, 4, 8
#: borders closer than this share of a step are as good as one
_NEAR = 0.3
#: a step turns the spindle by no more than this over the steps per wavelength, rad
_ANGLE_PER_WAVELENGTH = 3.0


class Steps(NamedTuple):
    """N steps; at the share x of one the time is anchor + span s^power, s = low + x (high - low).

    A plain step has power 1 and goes from 0 to 1.
    """

    node: Array  # starts and middles of the steps and the end, s (2 N + 1,)
    anchor: Array  # s (N,)
    span: Array  # s, below zero before a border (N,)
    power: Array  # (N,)
    low: Array  # (N,)
    high: Array  # (N,)


@njit(**INNER_KERNEL)
def _rise(segments, segment, side):
    """Angle by which the edge enters (side 0) or leaves later at the high end of a segment, rad."""
    arc = segments.entry[segment] if side == 0 else segments.exit[segment]
    return arc[1] - arc[0] - (segments.angle[segment, 1] - segments.angle[segment, 0])


@njit(**INNER_KERNEL)
def _follows(segments, segment):
    """Whether a segment goes on where that before it in the table ends."""
    apart = abs(segments.angle[segment - 1, 1] - segments.angle[segment, 0])
    apart += abs(segments.entry[segment - 1, 1] - segments.entry[segment, 0])
    apart += abs(segments.exit[segment - 1, 1] - segments.exit[segment, 0])
    return apart < _SAME and segments.bottom[segment] > segments.bottom[segment - 1]


@njit(**INNER_KERNEL)
def _sides_of_root(segments, segment, side, end):
    """Side of a border on which the edge enters or leaves nearly all at once, if any.

    There the angle of entry or exit has, along the edge, its least or largest value near by.
    """
    first, last = segment, segment
    while first > 0 and _follows(segments, first):
        first -= 1
    while last + 1 < segments.bottom.shape[0] and _follows(segments, last + 1):
        last += 1
    total, length = 0.0, 0.0
    for other in range(first, last + 1):
        total += abs(_rise(segments, other, side))
        length += segments.length[other]
    rise = _rise(segments, segment, side)
    if abs(rise) * length >= _FLAT * total * segments.length[segment]:
        return 0
    return _ROOT_AFTER if (rise > 0.0) == (end == 0) else _ROOT_BEFORE


@njit(**INNER_KERNEL)
def _border_angles(cut, depth):
    """Borders in one period of the tool (rad), unsorted, and the sides with a thin chip of each."""
    segments, period = cut.segments, cut.period_angle
    angles = np.empty(4 * segments.bottom.shape[0] + 1)
    sides = np.zeros(angles.shape[0], dtype=np.int64)
    count = 0
    lowest, sized = lowest_height(segments), segments.exponent != 0.0
    for segment in range(segments.bottom.shape[0]):
        top = part_below(segments, segment, depth)
        if top <= 0.0:
            continue
        for end in range(2):
            if not is_border(segments, segment, end, depth, lowest):
                continue
            position = top if end == 1 else 0.0
            for side in range(2):
                immersed, angles[count] = border_at(segments, segment, position, side, period)
                sides[count] = _sides_of_root(segments, segment, side, end)
                if sized and chip_vanishes(segments, segment, position, immersed, _THIN):
                    # a position that enters is in the cut after it, one that leaves before; where
                    # the edge is flat, what is left of it next to it counts too
                    turned_round = segments.turning[segment, end] >= TURNING
                    after = side == 0 or turned_round or sides[count] == _ROOT_AFTER
                    before = side == 1 or turned_round or sides[count] == _ROOT_BEFORE
                    sides[count] = _AFTER * after + _BEFORE * before
                count += 1
    if count == 0:
        count, angles[0] = 1, 0.0
    return angles[:count], sides[:count]


@njit(**INNER_KERNEL)
def _border_times(cut, rotation, depth):
    """Border times over the whole period, ascending (s), and their flags."""
    angles, sides = _border_angles(cut, depth)
    per_tool = angles.shape[0]
    corners = 2 * rotation.cycles if rotation.triangle == 1 and rotation.amplitude > 0.0 else 0
    times = np.empty(rotation.patterns * per_tool + corners)
    flags = np.zeros(times.shape[0], dtype=np.int64)
    period = rotation.patterns * cut.period_angle / rotation.speed
    for i in range(times.shape[0]):
        if i < rotation.patterns * per_tool:
            pattern, k = i // per_tool, i % per_tool
            times[i] = time_at(rotation, angles[k] + pattern * cut.period_angle)
            flags[i] = sides[k]
        else:
            times[i] = (0.25 + 0.5 * (i - rotation.patterns * per_tool)) / rotation.frequency
        times[i] -= period * math.floor(times[i] / period)
    sort_with_marks(times, flags)
    out, marks = np.empty(times.shape[0] + 1), np.zeros(times.shape[0] + 1, dtype=np.int64)
    kept = 0
    for i in range(times.shape[0]):
        again = kept > 0 and times[i] - out[kept - 1] <= _SAME * period
        wrapped = kept > 0 and out[0] + period - times[i] <= _SAME * period
        if again or wrapped:
            same = kept - 1 if again else 0
            marks[same] |= flags[i]
            continue
        out[kept], marks[kept] = times[i], flags[i]
        kept += 1
    out[kept], marks[kept] = out[0] + period, marks[0]
    return out[: kept + 1], marks[: kept + 1]


@njit(**INNER_KERNEL)
def _empty_steps(count):
    """Room for steps."""
    return Steps(
        np.empty(2 * count + 1), np.empty(count), np.empty(count), np.empty(count),
        np.empty(count), np.empty(count),
    )  # fmt: skip


@njit(**INNER_KERNEL)
def step_time(steps, step, share):
    """Time at a share of a step, s."""
    s = steps.low[step] + share * (steps.high[step] - steps.low[step])
    if steps.power[step] != 1.0:
        s **= steps.power[step]
    return steps.anchor[step] + steps.span[step] * s


@njit(**INNER_KERNEL)
def _add_steps(steps, count, anchor, span, power, number):
    """Divide the time between a border and that beyond its span; returns the number of steps."""
    for i in range(number):
        k = count + i
        steps.anchor[k], steps.span[k], steps.power[k] = anchor, span, power
        if power == 1.0:
            steps.anchor[k], steps.span[k] = anchor + span * i / number, span / number
            steps.low[k], steps.high[k] = 0.0, 1.0
        elif span > 0.0:
            steps.low[k], steps.high[k] = i / number, (i + 1) / number
        else:
            steps.low[k], steps.high[k] = (number - i) / number, (number - i - 1) / number
    return count + number


@njit(**INNER_KERNEL)
def _grading(segments, sides, thin, root):
    """Power of the time and number of the steps beside a border; none for plain steps."""
    if sides & thin != 0:
        p = 1.0 + segments.exponent
        # k p whole: 4 for a law that is nearly linear, less where k would be large
        return math.ceil(4.0 * p) / p, _GRADED
    if sides & root != 0:
        return _POWER_OF_ROOT, _GRADED_ROOT
    return 1.0, 0


@njit(**INNER_KERNEL)
def _plain_steps(cut, rotation, depth, borders, steps_per_wavelength):
    """Steps (I,) that each interval between borders needs, not rounded."""
    arrays = cut.arrays
    stiffened = cut.fastest**2 + arrays.stiffening * depth
    longest = 2.0 * math.pi / (steps_per_wavelength * math.sqrt(stiffened))
    need = np.empty(borders.shape[0] - 1)
    for i in range(need.shape[0]):
        turned = angle_at(rotation, borders[i + 1]) - angle_at(rotation, borders[i])
        need[i] = (borders[i + 1] - borders[i]) / longest
        need[i] = max(need[i], turned * steps_per_wavelength / _ANGLE_PER_WAVELENGTH)
    return need


@njit(**INNER_KERNEL)
def _pass_on(sides, need):
    """Let a border next to a singular one be singular, too, on the side away from it.

    On the scale of a step both are at the same position: as where an edge begins to leave within
    its length, and a moment later its top leaves.
    """
    last = need.shape[0]
    for _ in range(2):
        for i in range(last):
            if need[i] < _NEAR:
                sides[i + 1] |= sides[i] & (_AFTER | _ROOT_AFTER)
        for i in range(last - 1, -1, -1):
            if need[i] < _NEAR:
                sides[i] |= sides[i + 1] & (_BEFORE | _ROOT_BEFORE)
        # the end of a period is its beginning
        sides[0] |= sides[last]
        sides[last] = sides[0]


@njit(**INNER_KERNEL)
def period_steps(cut, rotation, depth, steps_per_wavelength, refinement):
    """Cut a period into `Steps`.

    The axial depth is in m; `steps_per_wavelength` are steps in a period of the fastest vibration,
    and every step that this gives is divided by `refinement`.
    """
    borders, sides = _border_times(cut.arrays, rotation, depth)
    need = _plain_steps(cut, rotation, depth, borders, steps_per_wavelength)
    _pass_on(sides, need)
    counts = np.maximum(1, np.ceil(need - 1e-9).astype(np.int64))
    steps = _empty_steps(refinement * (np.sum(counts) + 2 * _GRADED * counts.shape[0]))
    count = 0
    for i in range(counts.shape[0]):
        low, high = borders[i], borders[i + 1]
        power, graded = _grading(cut.arrays.segments, sides[i], _AFTER, _ROOT_AFTER)
        power_before, graded_before = _grading(
            cut.arrays.segments, sides[i + 1], _BEFORE, _ROOT_BEFORE
        )
        plain = counts[i] - min(1, graded) - min(1, graded_before)
        if plain < 0:
            plain, counts[i] = 0, 2
        step = (high - low) / counts[i]
        if graded > 0:
            count = _add_steps(steps, count, low, step, power, graded * refinement)
            low += step
        if plain > 0:
            count = _add_steps(steps, count, low, plain * step, 1.0, plain * refinement)
        if graded_before > 0:
            count = _add_steps(steps, count, high, -step, power_before, graded_before * refinement)
    return _with_nodes(steps, count, borders[-1])


@njit(**INNER_KERNEL)
def _with_nodes(steps, count, end):
    """The steps that are there, with their starts and middles."""
    node = np.empty(2 * count + 1)
    for k in range(count):
        node[2 * k], node[2 * k + 1] = step_time(steps, k, 0.0), step_time(steps, k, POSITIONS[2])
    node[2 * count] = end
    return Steps(
        node, steps.anchor[:count], steps.span[:count], steps.power[:count],
        steps.low[:count], steps.high[:count],
    )  # fmt: skip
