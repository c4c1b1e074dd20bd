"""Voxel workpiece as a window that moves along with the tool."""

from __future__ import annotations

import math

import numpy as np

from cutting.voxel.stock import VoxelStock, packed

#: cells of a word, which move together
CELLS_A_WORD = 64
#: a distance that lacks this share of a cell is whole but for rounding
_ROUNDING = 1e-6


def voxel_advanced(stock: VoxelStock, distance: float) -> VoxelStock:
    """Move the workpiece along +x by the most whole words that are not above a distance.

    What falls off behind is dropped; ahead comes fresh material over the full height of the box.
    The arrays are changed in place: the stock given is no longer of use.

    Parameters
    ----------
    stock : VoxelStock
        With material up to its far border.
    distance : float
        m.

    Returns
    -------
    VoxelStock
        On the same arrays.
    """
    moved = math.floor((distance / stock.cell + _ROUNDING) / CELLS_A_WORD)
    if moved <= 0:
        return stock
    width = stock.words.shape[2]
    kept = max(width - moved, 0)
    fresh = packed(np.arange(stock.columns) >= stock.columns - moved * CELLS_A_WORD)
    for words in stock.words:
        words[:, :kept] = words[:, width - kept :]
        words[:, kept:] = 0
        words |= fresh
    return stock._replace(x_min=stock.x_min + moved * CELLS_A_WORD * stock.cell)
