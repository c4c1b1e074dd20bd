"""Fourier coefficients of the couplings of a cut over a period of the tool."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, ComplexArray
from chatter.engine.presets import DRIVER, INNER_KERNEL
from cutting.edge_segments.coupling import arc_at, coupling_at, delay_at, part_below, radius_at
from cutting.process_damping.linear_flank import inverse_radius

#: delays vary by no more than this along a part of a segment, and differ by more to be two, rad
_SAME_DELAY, _ONE_DELAY = 4e-3, 1e-9
_MOST_PARTS = 48
#: phase of the highest order along a part up to which two Gauss points do, and three, rad
_SHORT_PART, _LONG_PART = 0.5, 1.5


class Harmonics(NamedTuple):
    """Fourier coefficients of the couplings at one depth, orders -K .. K."""

    delay: Array  # rad (g,)
    stiffness: ComplexArray  # N/m (g, 2K + 1, r, r)
    dashpot: ComplexArray  # N s/m times the spindle speed (2K + 1, r, r)
    stiffening: float  # stiffness without delay over the dashpot, 1/rad


@njit(**INNER_KERNEL)
def _parts(segments, segment, top, highest):
    """Parts of a segment along the edge, each of one delay, that the highest order resolves."""
    varies = abs(segments.delay[segment, 1] - segments.delay[segment, 0])
    turned = abs(segments.angle[segment, 1] - segments.angle[segment, 0])
    return min(1 + int(varies / _SAME_DELAY) + int(turned * top * highest / 6.0), _MOST_PARTS)


@njit(**INNER_KERNEL)
def _points_along(segments, segment, top, parts, highest):
    """Gauss points along a part: two or three do where it is short for the highest order."""
    turned = abs(segments.angle[segment, 1] - segments.angle[segment, 0])
    widened = max(
        abs(segments.entry[segment, 1] - segments.entry[segment, 0]),
        abs(segments.exit[segment, 1] - segments.exit[segment, 0]),
    )
    phase = highest * (turned + widened) * top / parts
    if segments.exponent != 0.0 or phase > _LONG_PART:
        return 6
    return 2 if phase < _SHORT_PART else 3


@njit(**INNER_KERNEL)
def _distinct_delays(segments, depth, highest):
    """Delays of all parts down to a depth, each once, ascending, rad."""
    count = 0
    for segment in range(segments.bottom.shape[0]):
        count += _parts(segments, segment, 1.0, highest)
    delays = np.empty(count)
    count = 0
    for segment in range(segments.bottom.shape[0]):
        top = part_below(segments, segment, depth)
        if top <= 0.0:
            continue
        parts = _parts(segments, segment, top, highest)
        for share in range(parts):
            delays[count] = delay_at(segments, segment, top * (share + 0.5) / parts)
            count += 1
    delays = np.sort(delays[:count])
    used = min(1, count)
    for i in range(1, count):
        if delays[i] - delays[used - 1] > _ONE_DELAY:
            delays[used] = delays[i]
            used += 1
    return delays[:used].copy()


@njit(**INNER_KERNEL)
def _add_by_quadrature(cut, segment, position, length, speed_factor, orders, stiffness, dashpot):
    """Add the coefficients of a position along a segment that stands for a length of edge, m."""
    segments = cut.segments
    rank = cut.shape.shape[1]
    base = 2.0 * math.pi / cut.period_angle
    part, part_dashpot = np.empty((rank, rank)), np.empty((rank, rank))
    entry, leave, at = arc_at(segments, segment, position)
    spans = 2 + int((leave - entry) * orders * base / 4.0)
    for span in range(spans):
        for q in range(12):
            share = (span + cut.edge_position[12, q]) / spans
            # crowded towards the ends: a chip may vanish there, the slope of the law is infinite
            x = share * share * share * (10.0 - 15.0 * share + 6.0 * share * share)
            spindle = entry + x * (leave - entry) - at
            weight = 30.0 * (share * (1.0 - share)) ** 2 * (leave - entry)
            weight *= cut.edge_weight[12, q] / spans * length / (2.0 * math.pi)
            coupling_at(
                segments,
                segment,
                position,
                spindle,
                weight,
                speed_factor,
                cut.basis,
                part,
                part_dashpot,
            )
            turn = np.exp(-1j * base * spindle)
            wave = np.exp(1j * base * spindle * orders)
            for k in range(2 * orders + 1):
                for i in range(rank):
                    for j in range(rank):
                        stiffness[k, i, j] += wave * part[i, j]
                        if speed_factor > 0.0:
                            dashpot[k, i, j] += wave * part_dashpot[i, j]
                wave *= turn


@njit(**INNER_KERNEL)
def _add_exactly(cut, segment, position, length, speed_factor, orders, stiffness, dashpot):
    """Do the same where the force is linear in the chip.

    The coupling is then a trigonometric polynomial of the second degree in the immersion angle:
    five samples of it give its terms, and the integral of each against a wave is known.
    """
    segments = cut.segments
    rank = cut.shape.shape[1]
    base = 2.0 * math.pi / cut.period_angle
    part, part_dashpot = np.empty((rank, rank)), np.empty((rank, rank))
    terms = np.zeros((2, 5, rank, rank), dtype=np.complex128)
    entry, leave, at = arc_at(segments, segment, position)
    for sample in range(5):
        phi = 0.4 * math.pi * sample
        coupling_at(
            segments, segment, position, phi - at, length / (2.0 * math.pi), speed_factor,
            cut.basis, part, part_dashpot,
        )  # fmt: skip
        for n in range(5):
            wave = np.exp(-1j * (n - 2) * phi) / 5.0
            terms[0, n] += wave * part
            if speed_factor > 0.0:
                terms[1, n] += wave * part_dashpot
    middle, half = 0.5 * (entry + leave), 0.5 * (leave - entry)
    for k in range(2 * orders + 1):
        order = (k - orders) * base
        for n in range(5):
            rest = n - 2 - order
            size = 2.0 * half if abs(rest) < 1e-9 else 2.0 * math.sin(rest * half) / rest
            wave = size * np.exp(1j * (rest * middle + order * at))
            for i in range(rank):
                for j in range(rank):
                    stiffness[k, i, j] += wave * terms[0, n, i, j]
                    if speed_factor > 0.0:
                        dashpot[k, i, j] += wave * terms[1, n, i, j]


@njit(**DRIVER)
def harmonics_at(cut, depth, orders):
    """Fourier coefficients of the couplings at a depth (m) over a period, orders -K .. K."""
    segments = cut.segments
    rank = cut.shape.shape[1]
    highest = orders * 2.0 * math.pi / cut.period_angle
    delays = _distinct_delays(segments, depth, highest)
    stiffness = np.zeros((delays.size, 2 * orders + 1, rank, rank), dtype=np.complex128)
    dashpot = np.zeros((2 * orders + 1, rank, rank), dtype=np.complex128)
    speed_factor = inverse_radius(segments.flank, radius_at(segments, depth))
    exactly = segments.exponent == 0.0 and segments.flank.path.shape[0] == 0
    for segment in range(segments.bottom.shape[0]):
        top = part_below(segments, segment, depth)
        if top <= 0.0:
            continue
        parts = _parts(segments, segment, top, highest)
        points = _points_along(segments, segment, top, parts, highest)
        for share in range(parts):
            delay = delay_at(segments, segment, top * (share + 0.5) / parts)
            own = max(0, np.searchsorted(delays, delay, side="right") - 1)
            for along in range(points):
                position = top * (share + cut.edge_position[points, along]) / parts
                length = segments.length[segment] * top / parts * cut.edge_weight[points, along]
                if exactly:
                    _add_exactly(
                        cut,
                        segment,
                        position,
                        length,
                        speed_factor,
                        orders,
                        stiffness[own],
                        dashpot,
                    )
                    continue
                _add_by_quadrature(
                    cut, segment, position, length, speed_factor, orders, stiffness[own], dashpot
                )
    return Harmonics(delays, stiffness, dashpot, segments.flank.stiffening)
