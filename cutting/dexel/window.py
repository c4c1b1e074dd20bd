"""Dexel workpiece as a window that moves along with the tool."""

from __future__ import annotations

import math

import numpy as np

from cutting.dexel.stock import DexelStock, line_coordinates, subtract_spans, unite_spans

#: a distance that lacks this share of a line is whole but for rounding
_ROUNDING = 1e-6


def dexel_advanced(stock: DexelStock, distance: float) -> DexelStock:
    """Move the workpiece along +x by the most whole lines that are not above a distance.

    What falls off behind is dropped, with the cuts that wait there; ahead comes fresh material
    over the full height of the box. The arrays are changed in place: the stock given is no longer
    of use.

    Parameters
    ----------
    stock : DexelStock
        With material up to the far border of its box, and a whole number of lines along it.
    distance : float
        m.

    Returns
    -------
    DexelStock
        On the same arrays.
    """
    moved = math.floor(distance / stock.spacing + _ROUNDING)
    if moved <= 0:
        return stock
    x0, x1, y0, y1 = stock.box
    shift = moved * stock.spacing
    advanced = stock._replace(
        first=(stock.first[0], stock.first[1] + shift), box=(x0 + shift, x1 + shift, y0, y1)
    )
    _move_lines_across(advanced, moved, x1)
    _lengthen_lines_along(advanced, x1)
    _renumber_waiting_cuts(advanced, moved)
    return advanced


def _move_lines_across(stock: DexelStock, moved: int, border: float) -> None:
    """Move the lines along y; those beyond the old far border are fresh."""
    lines = stock.lines[1]
    kept = max(lines - moved, 0)
    fresh = line_coordinates(stock, 1) >= border
    fresh[kept:] = True
    for interval in stock.interval[:, 1, :lines]:
        interval[:kept] = interval[lines - kept :]
        interval[fresh] = 0.0
        interval[fresh, 0] = stock.box[2:]


def _lengthen_lines_along(stock: DexelStock, border: float) -> None:
    """Cut the lines along x off behind, and lengthen them ahead."""
    count = stock.lines[0]
    behind = np.full(count, -np.inf), np.full(count, stock.box[0])
    ahead = np.full(count, max(border, stock.box[0])), np.full(count, stock.box[1])
    for layer in range(stock.interval.shape[0]):
        subtract_spans(stock, layer, 0, *behind)
        unite_spans(stock, layer, 0, *ahead)


def _renumber_waiting_cuts(stock: DexelStock, moved: int) -> None:
    """Let the waiting cuts of lines along y follow their lines, and drop those that fell off."""
    stock.pending[:, :, 1, :, 0] -= moved
    ring = stock.pending.shape[3]
    for layer, tooth in np.argwhere(stock.queue[:, :, 1, 1] > 0):
        oldest, waiting = stock.queue[layer, tooth, 1]
        cuts = stock.pending[layer, tooth, 1]
        entries = (oldest + np.arange(waiting)) % ring
        kept = cuts[entries, 0] >= 0.0
        if not kept.all():
            remaining = cuts[entries[kept]]
            cuts[entries[: len(remaining)]] = remaining
            stock.queue[layer, tooth, 1, 1] = len(remaining)
