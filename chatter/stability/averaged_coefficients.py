"""Directional coefficients averaged over a revolution, for every delay: what zeroth order keeps."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array
from chatter.engine.presets import DRIVER
from cutting.edge_segments.coupling import arc_at, coupling_at, delay_at, part_below

#: delays vary by no more than this along a part of a segment, rad; the most parts
_DELAY_STEP, _MOST_PARTS = 2e-3, 64
#: Gauss points over an arc, and along a part
_POINTS, _ALONG = 16, 8


class AveragedCoefficients(NamedTuple):
    """Averaged directional coefficients: the force on the tool is -sum_g mean_g (u - u delayed)."""

    delay: Array  # rad (g,)
    mean: Array  # N/m, or N/m^2 per axial depth (g, r, r)


@njit(**DRIVER)
def _dense_at_ends(cut, count, q):
    """Gauss point of 0..1 and its weight, dense towards both ends.

    There a size effect may be singular, and the arc of an edge that just touches grows as a root.
    """
    x, w = cut.edge_position[count, q], cut.edge_weight[count, q]
    return x * x * (3.0 - 2.0 * x), 6.0 * w * x * (1.0 - x)


@njit(**DRIVER)
def _add_over_arc(cut, segment, position, weight, part, unused, mean):
    """Add the coupling of a point of a segment, averaged over a revolution, times a weight."""
    entry, leave, at = arc_at(cut.segments, segment, position)
    for q in range(_POINTS):
        x, w = _dense_at_ends(cut, _POINTS, q)
        spindle = entry + x * (leave - entry) - at
        of_revolution = weight * w * (leave - entry) / (2.0 * math.pi)
        coupling_at(
            cut.segments, segment, position, spindle, of_revolution, 0.0, cut.basis, part, unused
        )
        for i in range(mean.shape[0]):
            for j in range(mean.shape[1]):
                mean[i, j] += part[i, j]


@njit(**DRIVER)
def averaged_coefficients(cut, depth):
    """Average the couplings of a cut over a revolution, apart for every delay; means in N/m.

    `depth` is the axial depth, m.
    """
    segments = cut.segments
    rank = cut.shape.shape[1]
    count = _MOST_PARTS * segments.bottom.shape[0] + 1
    delays, means = np.zeros(count), np.zeros((count, rank, rank))
    part, unused = np.empty((rank, rank)), np.empty((rank, rank))
    used = 0
    for segment in range(segments.bottom.shape[0]):
        top = part_below(segments, segment, depth)
        if top <= 0.0:
            continue
        varies = abs(segments.delay[segment, 1] - segments.delay[segment, 0])
        parts = min(_MOST_PARTS, 1 + int(varies / _DELAY_STEP))
        for share in range(parts):
            position = top * (share + 0.5) / parts
            delay = delay_at(segments, segment, position)
            own = -1
            for g in range(used):
                if abs(delays[g] - delay) < 1e-9:
                    own = g
            if own < 0:
                own = used
                delays[own] = delay
                used += 1
            for along in range(_ALONG):
                x, w = _dense_at_ends(cut, _ALONG, along)
                position = top * (share + x) / parts
                weight = w * segments.length[segment] * top / parts
                _add_over_arc(cut, segment, position, weight, part, unused, means[own])
    return AveragedCoefficients(delays[:used], means[:used])
