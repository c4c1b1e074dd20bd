"""Carving of a dexel workpiece by moving cutting edges, and the chip thickness they meet.

The tool axis is at C, an edge at E = C + r (sin phi, cos phi), phi clockwise from +y; the edge
moves from E0 to E1 in a step. Every line that it crosses loses the material between the crossing
and the tool axis. The chip thickness is read on lines that the tooth has not yet cut: a cut waits
until the edge is `DexelStock.delay` past it. For that, `dexel_carve` must be called at every step
of a tooth, in air as well, and `dexel_flush` at the end.
"""

# ruff: noqa: ARG001 - workpieces share one signature, the reading here is pointwise

import math

from numba.extending import register_jitable

from cutting.compiled import UNCOUNTED
from cutting.dexel.stock import CAPACITY

#: pieces shorter than this fraction of the spacing are rounding, not material
_SPECK = 1e-6


@register_jitable(**UNCOUNTED)
def _drop_smallest(ends, low, high):
    """Put low..high in place of the smallest interval of a full line if that is smaller.

    The length of the interval dropped is returned.
    """
    smallest, at = high - low, -1
    for k in range(CAPACITY):
        if ends[k, 1] - ends[k, 0] < smallest:
            smallest, at = ends[k, 1] - ends[k, 0], k
    if at >= 0:
        ends[at, 0], ends[at, 1] = low, high
    return smallest


@register_jitable(**UNCOUNTED)
def _interval_count(ends):
    """Return the number of intervals on a line; empty places come last."""
    number = 0
    while number < CAPACITY and ends[number, 0] < ends[number, 1]:
        number += 1
    return number


@register_jitable(**UNCOUNTED)
def _remove_interval(ends, low, high, speck, overflow):
    """Remove low..high from a line with the given interval ends; the length removed, m."""
    removed = 0.0
    number = _interval_count(ends)
    k = 0
    while k < number:
        a, b = ends[k, 0], ends[k, 1]
        if b <= low or a >= high:
            k += 1
            continue
        keeps_lower, keeps_upper = low - a > speck, b - high > speck
        if keeps_lower and keeps_upper:
            removed += high - low
            ends[k, 1] = low
            if number < CAPACITY:
                ends[number, 0], ends[number, 1] = high, b
            else:
                overflow[0] += 1
                removed += _drop_smallest(ends, high, b)
            break  # no other interval can overlap low..high
        if keeps_lower:
            removed += b - low
            ends[k, 1] = low
            k += 1
        elif keeps_upper:
            removed += high - a
            ends[k, 0] = high
            k += 1
        else:
            removed += b - a
            number -= 1
            ends[k, 0], ends[k, 1] = ends[number, 0], ends[number, 1]
            ends[number, 0], ends[number, 1] = 0.0, 0.0
    return removed


@register_jitable(**UNCOUNTED)
def _material(interval, layer, family, line, a, b):
    """Length of material on a line between two coordinates, m."""
    low, high = min(a, b), max(a, b)
    length = 0.0
    for k in range(CAPACITY):
        start = interval[layer, family, line, k, 0]
        end = interval[layer, family, line, k, 1]
        if start >= end:
            break
        length += max(min(high, end) - max(low, start), 0.0)
    return length


@register_jitable(**UNCOUNTED)
def _cut_oldest(stock, layer, tooth, family):
    """Carry out the oldest waiting cut; the length of material removed, m."""
    at = stock.queue[layer, tooth, family, 0]
    stock.queue[layer, tooth, family, 0] = (at + 1) % stock.pending.shape[3]
    stock.queue[layer, tooth, family, 1] -= 1
    cut = stock.pending[layer, tooth, family, at]
    low, high = min(cut[1], cut[2]), max(cut[1], cut[2])
    ends = stock.interval[layer, family, int(cut[0])]
    return _remove_interval(ends, low, high, _SPECK * stock.spacing, stock.overflow)


@register_jitable(**UNCOUNTED)
def _cut_what_lies_behind(stock, layer, tooth, family, along, across, radius):
    """Carry out the waiting cuts farther than the delay from an edge; length removed, m."""
    # an edge near the axis never gets farther from its cuts than its diameter
    delay = min(stock.delay, radius)
    removed = 0.0
    while stock.queue[layer, tooth, family, 1] > 0:
        at = stock.queue[layer, tooth, family, 0]
        coordinate = (
            stock.first[family] + stock.pending[layer, tooth, family, at, 0] * stock.spacing
        )
        a = along - stock.pending[layer, tooth, family, at, 1]
        b = across - coordinate
        if a * a + b * b < delay * delay:
            break
        removed += _cut_oldest(stock, layer, tooth, family)
    return removed


@register_jitable(**UNCOUNTED)
def _carve_family(stock, layer, tooth, family, ca0, ct0, ea0, et0, ca1, ct1, ea1, et1):
    """Cut the lines of a family; a is the coordinate along the lines, t across them."""
    removed = 0.0
    ra0, rt0, ra1, rt1 = ea0 - ca0, et0 - ct0, ea1 - ca1, et1 - ct1
    radius = math.sqrt(ra1 * ra1 + rt1 * rt1)
    if stock.queue[layer, tooth, family, 1] > 0:
        removed += _cut_what_lies_behind(stock, layer, tooth, family, ea1, et1, radius)
    first, spacing = stock.first[family], stock.spacing
    k0 = math.floor((et0 - first) / spacing)
    k1 = math.floor((et1 - first) / spacing)
    if k0 == k1:
        return removed
    lowest = max(min(k0, k1) + 1, 0)
    highest = min(max(k0, k1), stock.lines[family] - 1)
    number = highest - lowest + 1
    ring = stock.pending.shape[3]
    for i in range(number):
        line = lowest + i if k1 > k0 else highest - i
        coordinate = first + line * spacing
        # crossing on the arc between E0 and E1: the chord's, then one Newton step
        u = (coordinate - et0) / (et1 - et0)
        ra, rt = ra0 + u * (ra1 - ra0), rt0 + u * (rt1 - rt0)
        bulge = radius / math.sqrt(ra * ra + rt * rt)
        u += (coordinate - (ct0 + u * (ct1 - ct0) + bulge * rt)) / (et1 - et0)
        u = min(max(u, 0.0), 1.0)
        ra, rt = ra0 + u * (ra1 - ra0), rt0 + u * (rt1 - rt0)
        centre = ca0 + u * (ca1 - ca0)
        depth = ra * radius / math.sqrt(ra * ra + rt * rt)
        # the axis moves on before the edge comes down on its other side: overlap the two cuts
        overlap = min(0.5 * abs(depth), stock.window)
        inner = centre - math.copysign(overlap, depth)
        edge = centre + depth
        if _material(stock.interval, layer, family, line, inner, edge) <= 0.0:
            continue
        if stock.queue[layer, tooth, family, 1] == ring:
            removed += _cut_oldest(stock, layer, tooth, family)
        waiting = stock.queue[layer, tooth, family, 1]
        at = (stock.queue[layer, tooth, family, 0] + waiting) % ring
        stock.pending[layer, tooth, family, at, 0] = line
        stock.pending[layer, tooth, family, at, 1] = edge
        stock.pending[layer, tooth, family, at, 2] = inner
        stock.queue[layer, tooth, family, 1] = waiting + 1
    return removed


@register_jitable(**UNCOUNTED)
def _out_of_reach(box, cx, cy, ex0, ey0, ex1, ey1):
    """Whether axis and edge are beyond the same side of the box around the stock."""
    return (
        max(cx, ex0, ex1) < box[0]
        or min(cx, ex0, ex1) > box[1]
        or max(cy, ey0, ey1) < box[2]
        or min(cy, ey0, ey1) > box[3]
    )


@register_jitable(**UNCOUNTED)
def dexel_carve(stock, layer, tooth, cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1):
    """Remove what the rake line of a tooth sweeps in a step.

    Tool axis and edge at the start of the step and at its end, m; the step is short against the
    radius. The stock is changed; the area removed, m^2, is late by the time that the edge takes for
    `stock.delay`.
    """
    waiting = stock.queue[layer, tooth, 0, 1] + stock.queue[layer, tooth, 1, 1]
    if waiting == 0 and _out_of_reach(stock.box, cx1, cy1, ex0, ey0, ex1, ey1):
        return 0.0
    removed = _carve_family(stock, layer, tooth, 0, cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1)
    removed += _carve_family(stock, layer, tooth, 1, cy0, cx0, ey0, ex0, cy1, cx1, ey1, ex1)
    return 0.5 * stock.spacing * removed


@register_jitable(**UNCOUNTED)
def dexel_flush(stock):
    """Carry out all waiting cuts; the area removed from all layers, m^2."""
    removed = 0.0
    layers, teeth, families, _ = stock.queue.shape
    for layer in range(layers):
        for tooth in range(teeth):
            for family in range(families):
                while stock.queue[layer, tooth, family, 1] > 0:
                    removed += _cut_oldest(stock, layer, tooth, family)
    return 0.5 * stock.spacing * removed


@register_jitable(**UNCOUNTED)
def _thickness_on_family(stock, layer, family, ca, ct, ea, et):
    """Chip thickness at an edge from lines more along than across its radius.

    On each line the material between the circle of the edge and the axis ends in an inner point.
    The points are taken in polar coordinates about the axis, and the thickness is interpolated
    between the two whose directions enclose that of the edge.
    """
    first, spacing = stock.first[family], stock.spacing
    ra, rt = ea - ca, et - ct
    radius = math.sqrt(ra * ra + rt * rt)
    na, nt = ra / radius, rt / radius
    inward = -1 if nt > 0.0 else 1
    sense = math.copysign(1.0, na) * inward
    below = math.floor((et - first) / spacing)
    line = below if inward > 0 else below + 1
    reach = int(0.75 * stock.window / spacing) + 3
    air = 0.0  # length of the radius in air before the material
    length0, offset0, thickness0 = 0.0, 0.0, 0.0
    for i in range(reach):
        coordinate = first + line * spacing
        pt = coordinate - ct
        on_circle = math.copysign(math.sqrt(max(radius * radius - pt * pt, 0.0)), ra)
        length = 0.0
        if 0 <= line < stock.lines[family]:
            length = _material(stock.interval, layer, family, line, ca, ca + on_circle)
        pa = on_circle - math.copysign(length, ra)
        offset = sense * (pt * na - pa * nt) / max(pa * na + pt * nt, spacing)
        thickness = radius - math.sqrt(pa * pa + pt * pt) if length > 0.0 else 0.0
        if i > 0:
            # along the radius, where the stock ends if it does so between the two lines
            end = max((coordinate - et) * inward - 0.5 * spacing, 0.0) / max(abs(nt), 1e-12)
            begins = length0 == 0.0 and length * abs(nt) > spacing
            ends = length == 0.0 and length0 * abs(nt) > spacing
            if begins:
                air = end
            if offset >= 0.0 and begins:
                return max(thickness - air, 0.0)
            if offset >= 0.0 and ends:
                return max(min(thickness0, end) - air, 0.0)
            if offset >= 0.0 and offset0 >= 0.0 and (length > 0.0 or end > stock.window):
                return 0.0
            if offset >= 0.0 and thickness + thickness0 > 0.0:
                share = -offset0 / (offset - offset0)
                return max(thickness0 + share * (thickness - thickness0) - air, 0.0)
        length0, offset0, thickness0 = length, offset, thickness
        line += inward
    return max(thickness0 - air, 0.0)


@register_jitable(**UNCOUNTED)
def dexel_chip_thickness(stock, layer, tooth, cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1):
    """Chip thickness at the end of a step, along the radius; to be read before `dexel_carve`.

    Tool axis and edge at the start of the step, not used, as the reading is pointwise, but one
    signature serves all workpieces, and at its end, m. In m, 0 where the edge meets no material.
    """
    far = stock.window
    if ex1 < stock.box[0] - far or ex1 > stock.box[1] + far:
        return 0.0
    if ey1 < stock.box[2] - far or ey1 > stock.box[3] + far:
        return 0.0
    if abs(ex1 - cx1) >= abs(ey1 - cy1):
        return _thickness_on_family(stock, layer, 0, cx1, cy1, ex1, ey1)
    return _thickness_on_family(stock, layer, 1, cy1, cx1, ey1, ex1)
