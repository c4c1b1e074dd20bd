"""Where the elements of a period begin and end.

Between the borders that the cut sets in every period of the tool, elements rotate the spindle by
the same angle. So the motion of an earlier tooth, seen from a position in an element, lies in one
element also where the speed varies. Where a triangular variation of the speed has its corners,
elements are cut in two. Where no tooth cuts, the free motion is one element.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.methods.collocation.element_borders import LEVEL_RATIO, SAME_BORDER
from chatter.stability.spindle_rotation import speed_at, swing_range, time_near

#: an element turns the spindle by no more than this, rad
_LONGEST_ANGLE = 0.9
#: element lengths closer than this share are the same
_SAME_LENGTH = 1e-9
#: of more intervals than these, or where the speed varies, elements are counted in steps of the
#: speed, in powers of two
_FEW_INTERVALS = 12
_STEP_OF_MANY = 0.25
#: by which a depth may shorten the waves: far above any limit, so that it needs no finer elements
_MOST_STIFFENED = 10.0
#: vibrations in a period of the tool that such a depth may make elements for
_MOST_VIBRATIONS = 1000.0
#: over so small an angle the speed is even, and a difference of times would be rounded, rad
_EVEN = 1e-6


class ElementLayout(NamedTuple):
    """M elements of a period, of which E lie in the cut; starts and lengths in mean angle.

    Mean angle is time times the mean spindle speed.
    """

    cut: IntegerArray  # number among the elements in the cut, -1 for free motion (M,)
    shape: IntegerArray  # number of the length (M,)
    length: Array  # distinct lengths, rad (S,)
    length_cuts: IntegerArray  # 1 where an element in the cut has the length (S,)
    cut_start: Array  # start of the elements in the cut, rad (E,)
    cut_length: Array  # rad (E,)
    cut_angle: Array  # of the spindle where the span of each starts, rad (E,)
    span: IntegerArray  # of those in the cut among the spans, -1 for a part of one (E,)
    span_start: Array  # of the Q spans in the cut that a period of the tool has, rad (Q,)
    span_length: Array  # rad that the spindle turns (Q,)
    period: float  # rad


class _Spans(NamedTuple):
    """Elements by the angle that the spindle turns (M,)."""

    start: Array  # rad
    length: Array  # rad
    engaged: IntegerArray


@njit(**LEAF_KERNEL)
def speed_step(speed, step):
    """Speed, at most the given one, out of steps of a power of two; rad/s."""
    return 2.0 ** (step * math.floor(math.log2(speed) / step))


@njit(**LEAF_KERNEL)
def _longest_span(rotation, angle):
    """Mean angle that the spindle needs for an angle at the most, wherever it begins."""
    if rotation.amplitude == 0.0:
        return angle
    # at the slowest speed, or as far as the spindle lags at one end and leads at the other
    slowest = angle / (1.0 - rotation.amplitude)
    return min(slowest, angle + rotation.amplitude / rotation.frequency * swing_range(rotation))


@njit(**LEAF_KERNEL)
def _wavelengths(arrays, speed, depth):
    """Waves at a depth, over those with no cut."""
    stiffened = math.sqrt(1.0 + arrays.stiffening * depth / arrays.fastest**2)
    vibrations = arrays.fastest * arrays.period_angle / (2.0 * math.pi * speed)
    return min(stiffened, _MOST_STIFFENED, max(1.0, _MOST_VIBRATIONS / vibrations))


@njit(**INNER_KERNEL)
def element_counts(cut, borders, rotation, speed, depth):
    """Elements (I,) that each interval needs at a mean speed (rad/s), in every tool period."""
    arrays = cut.arrays
    counts = np.empty(borders.engaged.shape[0], dtype=np.int64)
    if counts.shape[0] > _FEW_INTERVALS or rotation.amplitude > 0.0:
        # one of so many would change its number at every speed, and nothing could be shared
        speed = speed_step(speed, _STEP_OF_MANY)
    wavelengths = _wavelengths(arrays, speed, depth)
    for i in range(counts.shape[0]):
        counts[i] = 1
        if borders.engaged[i] == 1:
            start, end = borders.angle[i], borders.angle[i + 1]
            span = _longest_span(rotation, end - start) / speed
            need = max(span * wavelengths / cut.longest, (end - start) / _LONGEST_ANGLE)
            counts[i] = max(1, math.ceil(need - 1e-9))
    return counts


@njit(**LEAF_KERNEL)
def _put_span(spans, m, start, length, engaged):
    """Set element m; returns the number of the next."""
    spans.start[m], spans.length[m], spans.engaged[m] = start, length, engaged
    return m + 1


@njit(**SINGLE_KERNEL)
def _tool_period_spans(borders, counts):
    """Elements of one period of the tool."""
    angle, levels, engaged = borders.angle, borders.levels, borders.engaged
    room = 0
    for i in range(counts.shape[0]):
        room += counts[i] + levels[i] + levels[i + 1]
    spans = _Spans(np.empty(room), np.empty(room), np.empty(room, dtype=np.int64))
    m = 0
    for i in range(counts.shape[0]):
        step = (angle[i + 1] - angle[i]) / counts[i]
        for k in range(counts[i]):
            low, high = angle[i] + k * step, angle[i] + (k + 1) * step
            rising = levels[i] if engaged[i] == 1 and k == 0 else 0
            falling = levels[i + 1] if engaged[i] == 1 and k == counts[i] - 1 else 0
            for level in range(rising, 0, -1):
                inner = step * LEVEL_RATIO ** (level + 1) if level < rising else 0.0
                m = _put_span(spans, m, low + inner, step * LEVEL_RATIO**level - inner, 1)
            cut_off = (LEVEL_RATIO if rising > 0 else 0.0) + (LEVEL_RATIO if falling > 0 else 0.0)
            start = low + step * LEVEL_RATIO if rising > 0 else low
            m = _put_span(spans, m, start, step * (1.0 - cut_off), engaged[i])
            for level in range(1, falling + 1):
                outer = step * LEVEL_RATIO**level
                inner = step * LEVEL_RATIO ** (level + 1) if level < falling else 0.0
                m = _put_span(spans, m, high - outer, outer - inner, 1)
    return _Spans(spans.start[:m], spans.length[:m], spans.engaged[:m])


@njit(**LEAF_KERNEL)
def _until_corner(rotation, start, length):
    """Mean angle to the first corner of a triangular variation within a length, or the length."""
    if rotation.triangle == 0 or rotation.amplitude == 0.0:
        return length
    half = 0.5 / rotation.frequency
    ahead = half * (math.ceil(start / half - 0.5) + 0.5) - start
    if ahead <= SAME_BORDER:
        ahead += half
    return ahead if length - ahead > SAME_BORDER else length


@njit(**LEAF_KERNEL)
def _lasting(rotation, start, angle, length):
    """Mean angle from one on, at a spindle angle, that the spindle needs for some more."""
    if rotation.amplitude == 0.0:
        return length
    even = length / speed_at(rotation, start)
    if length < _EVEN:
        return even
    return time_near(rotation, angle + length, start + even) - start


@njit(**INNER_KERNEL)
def _engaged_only(spans):
    """Spans in the cut, and the number of each among them, -1 for none (M,)."""
    number = np.full(spans.start.shape[0], -1, dtype=np.int64)
    count = 0
    for i in range(number.shape[0]):
        if spans.engaged[i] == 1:
            number[i] = count
            count += 1
    start, length = np.empty(count), np.empty(count)
    for i in range(number.shape[0]):
        if number[i] >= 0:
            start[number[i]], length[number[i]] = spans.start[i], spans.length[i]
    return start, length, number


@njit(**INNER_KERNEL)
def element_layout(borders, counts, rotation, tool_period):
    """Cut a period into elements, `counts` (I,) in each interval of the `PeriodBorders`.

    `rotation` is in mean angle; `tool_period` is the angle after which the tool repeats itself,
    rad.
    """
    spans = _tool_period_spans(borders, counts)
    span_start, span_length, number_of_span = _engaged_only(spans)
    # every half of a cycle has a corner
    room = rotation.patterns * spans.start.shape[0] + 2 * rotation.cycles * rotation.triangle
    start, length, turned = np.empty(room), np.empty(room), np.empty(room)
    number, whole = np.full(room, -1, dtype=np.int64), np.full(room, -1, dtype=np.int64)
    m, cuts, begin = 0, 0, 0.0
    for pattern in range(rotation.patterns):
        for i in range(spans.start.shape[0]):
            angle = pattern * tool_period + spans.start[i]
            # it begins where the last one ended, but for rounding
            begin = time_near(rotation, angle, begin)
            left = _lasting(rotation, begin, angle, spans.length[i])
            complete = True
            while left > 0.0:
                part = _until_corner(rotation, begin, left)
                complete = complete and part == left
                start[m], length[m], turned[m] = begin, part, angle
                if spans.engaged[i] == 1:
                    number[m] = cuts
                    whole[m] = number_of_span[i] if complete else -1
                    cuts += 1
                begin, left, m = begin + part, left - part, m + 1
    shape = np.empty(m, dtype=np.int64)
    cut_start, cut_length, cut_angle = np.empty(cuts), np.empty(cuts), np.empty(cuts)
    span = np.empty(cuts, dtype=np.int64)
    for i in range(m):
        if number[i] >= 0:
            cut_start[number[i]], cut_length[number[i]] = start[i], length[i]
            cut_angle[number[i]], span[number[i]] = turned[i], whole[i]
    distinct, of_cut = _shapes(length, number, m, rotation.amplitude == 0.0, shape)
    period = rotation.patterns * tool_period
    return ElementLayout(
        number[:m], shape, distinct, of_cut, cut_start, cut_length, cut_angle, span,
        span_start, span_length, period,
    )  # fmt: skip


@njit(**SINGLE_KERNEL)
def _shapes(length, number, count, even, shape):
    """Set shape (count,) to the number of each length; returns them and which lie in the cut.

    Where the speed is not even, every element has a length of its own: what is alike by chance
    would make structures differ.
    """
    distinct, of_cut = np.empty(count), np.zeros(count, dtype=np.int64)
    shapes = 0
    for m in range(count):
        found = -1
        for s in range(shapes if even else 0):
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
    """Element in the cut that holds a mean angle, counted over the periods, and the position in it.

    Between two elements in the cut, by rounding, the end of the nearer one.
    """
    cuts = layout.cut_start.shape[0]
    first = layout.cut_start[0]
    rotation = math.floor((angle - first) / layout.period + SAME_BORDER)
    local = angle - rotation * layout.period
    low, high = 0, cuts
    while high - low > 1:
        middle = (low + high) // 2
        if layout.cut_start[middle] <= local + SAME_BORDER * layout.period:
            low = middle
        else:
            high = middle
    position = (local - layout.cut_start[low]) / layout.cut_length[low]
    if position > 1.0:
        beyond = local - layout.cut_start[low] - layout.cut_length[low]
        following = (layout.cut_start[low + 1] if low + 1 < cuts else first + layout.period) - local
        if following < beyond:
            if low + 1 < cuts:
                return low + 1 + rotation * cuts, 0.0
            return (rotation + 1) * cuts, 0.0
    return low + rotation * cuts, min(1.0, max(0.0, position))
