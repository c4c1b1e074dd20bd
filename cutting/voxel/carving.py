"""Carving of a voxel workpiece by moving cutting edges, and the chip thickness they meet.

The tool axis is at C, an edge at E = C + r (sin phi, cos phi), phi clockwise from +y. In a step
the rake line from C to E sweeps a quadrilateral, of which the outer part, `VoxelStock.window`
deep, is looked at. A cell belongs to it by its centre, with half-open rules, so that steps that
share a rake line neither share a cell nor leave one. The chip thickness is that of the ring
sector of the same area: it is a mean over the step, or over the last `VoxelStock.smooth` of edge
movement where steps are shorter.
"""

import math

import numpy as np
from numba.extending import register_jitable

from cutting.compiled import UNCOUNTED

_ALL = np.uint64(0xFFFFFFFFFFFFFFFF)
_PAIRS = np.uint64(0x5555555555555555)
_NIBBLES = np.uint64(0x3333333333333333)
_OCTETS = np.uint64(0x0F0F0F0F0F0F0F0F)
_SHIFTS = tuple(np.uint64(n) for n in (1, 2, 4, 8, 16, 32))
_LOW = np.uint64(0x7F)


@register_jitable(**UNCOUNTED)
def _bits(word):
    """Return the number of set bits of a word (Warren 2012, section 5-1, without multiplying)."""
    word = word - ((word >> _SHIFTS[0]) & _PAIRS)
    word = (word & _NIBBLES) + ((word >> _SHIFTS[1]) & _NIBBLES)
    word = (word + (word >> _SHIFTS[2])) & _OCTETS
    word = word + (word >> _SHIFTS[3])
    word = word + (word >> _SHIFTS[4])
    word = word + (word >> _SHIFTS[5])
    return int(word & _LOW)


@register_jitable(**UNCOUNTED)
def _span(stock, layer, row, left, right, keep):
    """Return the number of material cells of a row in columns left <= i < right.

    The cells stay where they are for keep = all ones and are cleared for keep = 0.
    """
    left, right = max(left, 0), min(right, stock.columns)
    if left >= right:
        return 0
    number = 0
    for w in range(left >> 6, ((right - 1) >> 6) + 1):
        word = stock.words[layer, row, w]
        if word == 0:
            continue
        mask = _ALL
        if left > w * 64:
            mask = mask & (_ALL << np.uint64(left - w * 64))
        if right < w * 64 + 64:
            mask = mask & (_ALL >> np.uint64(w * 64 + 64 - right))
        hit = word & mask
        if hit != 0:
            number += _bits(hit)
            stock.words[layer, row, w] = word & (keep | ~mask)
    return number


@register_jitable(**UNCOUNTED)
def _crossing(y, ax, ay, bx, by):
    """X at which the line a b reaches y, the same to the last bit in both directions."""
    if ay > by:
        ax, ay, bx, by = bx, by, ax, ay
    return ax + (y - ay) / (by - ay) * (bx - ax)


@register_jitable(**UNCOUNTED)
def _quadrilateral(stock, layer, ax, ay, bx, by, px, py, qx, qy, keep):
    """Return the numbers of material cells and of all cells in the convex quadrilateral a b p q.

    See `_span` for `keep`. Cells off the stock count among all.
    """
    cell = stock.spacing
    bottom = (min(ay, by, py, qy) - stock.y_min) / cell - 0.5
    top = (max(ay, by, py, qy) - stock.y_min) / cell - 0.5
    number, every = 0, 0
    for row in range(math.ceil(bottom), math.ceil(top) + 1):
        y = stock.y_min + (row + 0.5) * cell
        left, right = math.inf, -math.inf
        if (ay <= y) != (by <= y):
            x = _crossing(y, ax, ay, bx, by)
            left, right = min(left, x), max(right, x)
        if (by <= y) != (py <= y):
            x = _crossing(y, bx, by, px, py)
            left, right = min(left, x), max(right, x)
        if (py <= y) != (qy <= y):
            x = _crossing(y, px, py, qx, qy)
            left, right = min(left, x), max(right, x)
        if (qy <= y) != (ay <= y):
            x = _crossing(y, qx, qy, ax, ay)
            left, right = min(left, x), max(right, x)
        if left < right:
            first = math.ceil((left - stock.x_min) / cell - 0.5)
            after = math.ceil((right - stock.x_min) / cell - 0.5)
            every += after - first
            if 0 <= row < stock.rows:
                number += _span(stock, layer, row, first, after, keep)
    return number, every


@register_jitable(**UNCOUNTED)
def _inner_end(stock, cx, cy, ex, ey):
    """Return the point of a rake line at the inner limit of what is looked at."""
    share = min(stock.window / math.hypot(ex - cx, ey - cy), 1.0)
    return ex - share * (ex - cx), ey - share * (ey - cy)


@register_jitable(**UNCOUNTED)
def _out_of_reach(stock, cx, cy, ex, ey):
    """Whether a rake line cannot meet the stock: edge and axis beyond the same side of its box."""
    margin = stock.window
    x_max = stock.x_min + stock.columns * stock.spacing
    y_max = stock.y_min + stock.rows * stock.spacing
    return (
        max(ex, cx) < stock.x_min - margin
        or min(ex, cx) > x_max + margin
        or max(ey, cy) < stock.y_min - margin
        or min(ey, cy) > y_max + margin
    )


@register_jitable(**UNCOUNTED)
def _movement(cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1):
    """Return the movement of the edge across the mean rake line (m) and its rotation (rad)."""
    ax, ay, bx, by = ex0 - cx0, ey0 - cy0, ex1 - cx1, ey1 - cy1
    rotation = math.atan2(abs(ax * by - ay * bx), ax * bx + ay * by)
    mx, my = ax + bx, ay + by
    across = abs((ex1 - ex0) * my - (ey1 - ey0) * mx) / math.hypot(mx, my)
    return across, rotation


@register_jitable(**UNCOUNTED)
def _reaches_deeper(stock, layer, cx, cy, ix, iy):
    """Whether material lies inward of the inner end of a rake line.

    Looked for in a square of three cells about the line, as the last step may just have cleared
    what is on it.
    """
    length = math.hypot(ix - cx, iy - cy)
    if length < stock.spacing:
        return False
    ux, uy = 1.5 * stock.spacing * (ix - cx) / length, 1.5 * stock.spacing * (iy - cy) / length
    ax, ay, bx, by = ix - uy, iy + ux, ix + uy, iy - ux
    px, py, qx, qy = bx - 2.0 * ux, by - 2.0 * uy, ax - 2.0 * ux, ay - 2.0 * uy
    number, _ = _quadrilateral(stock, layer, ax, ay, bx, by, px, py, qx, qy, _ALL)
    return number > 0


@register_jitable(**UNCOUNTED)
def voxel_chip_thickness(stock, layer, tooth, cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1):
    """Chip thickness in a step, along the radius; to be read before `voxel_carve`.

    The share of material among the cells swept, times the area swept, is that of a ring sector
    h thick, whose outer side moves by s while it turns by a: ``h s - h^2 a/2``. The share is
    less noisy than the number of cells, as steps gain and lose whole rows of both together.

    Tool axis and edge at the start of the step and at its end, m; the step is short against the
    radius. In m, 0 where the edge meets no material.
    """
    if _out_of_reach(stock, cx1, cy1, ex1, ey1):
        return 0.0
    ix0, iy0 = _inner_end(stock, cx0, cy0, ex0, ey0)
    ix1, iy1 = _inner_end(stock, cx1, cy1, ex1, ey1)
    number, every = _quadrilateral(stock, layer, ix0, iy0, ex0, ey0, ex1, ey1, ix1, iy1, _ALL)
    movement, rotation = _movement(cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1)
    material, swept = float(number), float(every)
    remembered = stock.recent.shape[2]
    k = stock.newest[layer, tooth]
    for _ in range(remembered):
        if movement >= stock.smooth or stock.recent[layer, tooth, k, 2] <= 0.0:
            break
        material += stock.recent[layer, tooth, k, 0]
        swept += stock.recent[layer, tooth, k, 1]
        movement += stock.recent[layer, tooth, k, 2]
        rotation += stock.recent[layer, tooth, k, 3]
        k = (k - 1) % remembered
    if material <= 0.0 or movement <= 0.0:
        return 0.0
    depth = min(stock.window, math.hypot(ex1 - cx1, ey1 - cy1))
    area = material / swept * depth * (movement - 0.5 * depth * rotation)
    root = math.sqrt(max(movement * movement - 2.0 * rotation * area, 0.0))
    return min(2.0 * area / (movement + root), depth)


@register_jitable(**UNCOUNTED)
def voxel_carve(stock, layer, tooth, cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1):
    """Remove what the rake line of a tooth sweeps in a step; the area removed, m^2.

    Parameters as of `voxel_chip_thickness`; the stock is changed.
    """
    zero = _ALL ^ _ALL
    number, every, beyond = 0, 0, 0
    if not _out_of_reach(stock, cx1, cy1, ex1, ey1):
        ix0, iy0 = _inner_end(stock, cx0, cy0, ex0, ey0)
        ix1, iy1 = _inner_end(stock, cx1, cy1, ex1, ey1)
        number, every = _quadrilateral(stock, layer, ix0, iy0, ex0, ey0, ex1, ey1, ix1, iy1, zero)
        if _reaches_deeper(stock, layer, cx1, cy1, ix1, iy1):
            stock.deep[0] += 1
            beyond, _ = _quadrilateral(stock, layer, cx0, cy0, ix0, iy0, ix1, iy1, cx1, cy1, zero)
    k = (stock.newest[layer, tooth] + 1) % stock.recent.shape[2]
    stock.newest[layer, tooth] = k
    movement, rotation = _movement(cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1)
    stock.recent[layer, tooth, k, 0] = number
    stock.recent[layer, tooth, k, 1] = every
    stock.recent[layer, tooth, k, 2] = movement
    stock.recent[layer, tooth, k, 3] = rotation
    return (number + beyond) * stock.spacing * stock.spacing
