"""Mean of the directional matrix over a turn, for every delay: what zeroth order keeps of a cut."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER
from cutting.edge_segments.coupling import coupling_at, part_below, share_of_height

#: delays that differ by less than this are taken together, rad
_SAME_DELAY = 2e-3
_LEVELS = 8


@njit(**DRIVER)
def mean_couplings(cut, depth):
    """Mean coupling over a turn of the spindle for every delay.

    Parameters
    ----------
    cut : CutArrays
    depth : float
        Axial depth, m.

    Returns
    -------
    delays : (g,) array of float
        rad.
    means : (g, r, r) array of float
        N/m; the force on the tool is -sum_g mean_g (u(t) - u(t - delay_g)).
    """
    pieces = cut.pieces
    rank = cut.shape.shape[1]
    count = 64 * pieces.bottom.shape[0] + 1
    delays, means = np.zeros(count), np.zeros((count, rank, rank))
    part, unused = np.empty((rank, rank)), np.empty((rank, rank))
    used = 0
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        varies = abs(pieces.delay[piece, 1] - pieces.delay[piece, 0])
        shares = min(64, 1 + int(varies / _SAME_DELAY))
        for share in range(shares):
            place = top * (share + 0.5) / shares
            height = share_of_height(pieces, piece, place)
            delay = pieces.delay[piece, 0] + height * (
                pieces.delay[piece, 1] - pieces.delay[piece, 0]
            )
            own = -1
            for g in range(used):
                if abs(delays[g] - delay) < 1e-9:
                    own = g
            if own < 0:
                own = used
                delays[own] = delay
                used += 1
            entry = pieces.entry[piece, 0] + place * (
                pieces.entry[piece, 1] - pieces.entry[piece, 0]
            )
            leave = pieces.exit[piece, 0] + place * (pieces.exit[piece, 1] - pieces.exit[piece, 0])
            turned = pieces.angle[piece, 1] - pieces.angle[piece, 0]
            at = pieces.angle[piece, 0] + height * turned
            weight = pieces.length[piece] * top / shares
            for q in range(16):
                x, w = cut.edge_place[16, q], cut.edge_weight[16, q]
                # dense towards both ends, where a size effect may be singular
                w *= 6.0 * x * (1.0 - x)
                x = x * x * (3.0 - 2.0 * x)
                spindle = entry + x * (leave - entry) - at
                share_of_turn = w * (leave - entry) / (2.0 * math.pi)
                coupling_at(
                    pieces, piece, place, spindle, weight * share_of_turn, 0.0, cut.basis,
                    part, unused,
                )  # fmt: skip
                for i in range(rank):
                    for j in range(rank):
                        means[own, i, j] += part[i, j]
    return delays[:used], means[:used]
