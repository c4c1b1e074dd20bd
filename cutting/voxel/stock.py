"""Workpiece of voxels: its layout in memory, its shaping before the cut, its measurement.

A layer of the workpiece is a bitmap, 64 cells along x to a word; a cell is material or air by its
centre.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutting.dexel.stock import Rectangle, checked_boxes

#: the thickness is averaged over at least this many cells of edge movement
_AVERAGED_CELLS = 4.0

#: steps whose removal is remembered for that
_REMEMBERED_STEPS = 64

_BITS_OF_BYTE = np.unpackbits(np.arange(256, dtype=np.uint8)[:, None], axis=1).sum(1)


class VoxelStock(NamedTuple):
    """Layers of bitmaps, with the recent removals of each tooth.

    Bit i of word w in row j is the cell whose centre is at
    ``(x_min + (64 w + i + 1/2) cell, y_min + (j + 1/2) cell)``. `recent` holds, for
    the last steps of a tooth, the material cells and all cells swept, the movement of the edge
    (m) and its rotation (rad).
    """

    cell: float  # m, side of a cell
    window: float  # m, depth from the edge inward that is looked at in every step
    smooth: float  # m, edge movement over which the thickness is averaged, if the step is shorter
    x_min: float  # m
    y_min: float  # m
    columns: int
    rows: int
    words: NDArray[np.uint64]  # (layers, rows, ceil(columns / 64))
    recent: NDArray[np.float64]  # of each step of a tooth, (layers, teeth, K, 4)
    newest: NDArray[np.int64]  # index of the last step in `recent`, (layers, teeth)
    deep: NDArray[np.int64]  # steps that found material beyond the window, (1,)


def voxel_stock(
    boxes: Sequence[Sequence[tuple[Rectangle, bool]]],
    layers: int,
    resolution: float,
    teeth: int,
    window: float,
) -> VoxelStock:
    """Build a workpiece from rectangles.

    Parameters
    ----------
    boxes : sequence over layers of sequences of ((x0, x1, y0, y1), adds)
        m; each rectangle adds (True) or removes (False) material, in this order.
    layers : int
        Number of layers, the length of `boxes`.
    resolution : float
        Side of a cell, m.
    teeth : int
        Number of cutting edges per layer that will carve the stock.
    window : float
        Largest chip thickness expected, m. Material deeper under the edge than this is removed
        but not counted in the thickness; `VoxelStock.deep` counts the steps that met it.

    Returns
    -------
    VoxelStock

    Raises
    ------
    ValueError
        If a rectangle or a number makes no sense.
    """
    x0, x1, y0, y1 = checked_boxes(boxes, layers, resolution, teeth, window)
    # 1e-9: a length that is a multiple of the cell but for rounding needs no further cell
    columns, rows = (math.ceil((b - a) / resolution - 1e-9) for a, b in ((x0, x1), (y0, y1)))
    stock = VoxelStock(
        cell=float(resolution),
        window=float(window),
        smooth=_AVERAGED_CELLS * resolution,
        x_min=float(x0),
        y_min=float(y0),
        columns=columns,
        rows=rows,
        words=np.zeros((layers, rows, (columns + 63) // 64), dtype=np.uint64),
        recent=np.zeros((layers, teeth, _REMEMBERED_STEPS, 4)),
        newest=np.zeros((layers, teeth), dtype=np.int64),
        deep=np.zeros(1, dtype=np.int64),
    )
    x, y = _column_centres(stock), _row_centres(stock)
    for layer, shapes in enumerate(boxes):
        for (left, right, bottom, top), adds in shapes:
            columns_in = packed((x >= left) & (x < right))
            rows_in = (y >= bottom) & (y < top)
            if adds:
                stock.words[layer, rows_in] |= columns_in
            else:
                stock.words[layer, rows_in] &= ~columns_in
    return stock


def _column_centres(stock: VoxelStock) -> NDArray[np.float64]:
    return stock.x_min + stock.cell * (np.arange(stock.columns) + 0.5)


def _row_centres(stock: VoxelStock) -> NDArray[np.float64]:
    return stock.y_min + stock.cell * (np.arange(stock.rows) + 0.5)


def packed(cells: NDArray[np.bool_]) -> NDArray[np.uint64]:
    """Pack truth values along the last axis into words of 64, the last one filled up with False."""
    octets = np.packbits(cells, axis=-1, bitorder="little")
    lacking = -octets.shape[-1] % 8
    octets = np.pad(octets, [(0, 0)] * (octets.ndim - 1) + [(0, lacking)])
    return np.ascontiguousarray(octets).view("<u8").astype(np.uint64)


def _cells(words: NDArray[np.uint64], columns: int) -> NDArray[np.bool_]:
    """Unpack words along the last axis."""
    octets = np.ascontiguousarray(words.astype("<u8")).view(np.uint8)
    return np.unpackbits(octets, axis=-1, count=columns, bitorder="little").astype(bool)


def voxel_remove_path(
    stock: VoxelStock, layer: int, x0: float, y0: float, x1: float, y1: float, radius: float
) -> None:
    """Remove what a disc clears as its centre moves straight from (x0, y0) to (x1, y1).

    Parameters
    ----------
    stock : VoxelStock
    layer : int
    x0, y0, x1, y1 : float
        Ends of the path of the centre, m.
    radius : float
        Of the disc, m.
    """
    x, y = _column_centres(stock), _row_centres(stock)
    reached = np.flatnonzero((y > min(y0, y1) - radius) & (y < max(y0, y1) + radius))
    along, across = x1 - x0, y1 - y0
    square = along**2 + across**2
    u, v = x[None, :] - x0, y[reached, None] - y0
    fraction = np.clip((u * along + v * across) / square, 0.0, 1.0) if square > 0.0 else 0.0
    cleared = (u - fraction * along) ** 2 + (v - fraction * across) ** 2 < radius**2
    stock.words[layer, reached] &= ~packed(cleared)


def voxel_remaining_area(stock: VoxelStock, layer: int) -> float:
    """Area of material in a layer, m^2."""
    octets = np.ascontiguousarray(stock.words[layer]).view(np.uint8)
    return float(_BITS_OF_BYTE[octets].sum()) * stock.cell**2


def voxel_wall_profile(
    stock: VoxelStock, layer: int, x: ArrayLike, side: int, reference: float = 0.0
) -> NDArray[np.float64]:
    """Surface that bounds the material nearest to y = reference on one side of it.

    Parameters
    ----------
    stock : VoxelStock
    layer : int
    x : (n,) array of float
        m.
    side : int
        +1 for the lower end of the material above the reference, -1 for the upper end of the
        material below it.
    reference : float
        m.

    Returns
    -------
    (n,) array of float
        y, m, of the side of the cell in the column that holds x; NaN where there is none.
    """
    x = np.asarray(x, dtype=np.float64)
    column = np.floor((x - stock.x_min) / stock.cell).astype(np.int64)
    inside = (column >= 0) & (column < stock.columns)
    y = _row_centres(stock)
    beyond = side * (y - reference) > 0.0
    material = _cells(stock.words[layer], stock.columns)[:, np.where(inside, column, 0)]
    distance = np.where(material & beyond[:, None], side * y[:, None], np.inf).min(axis=0)
    found = inside & np.isfinite(distance)
    return side * np.where(found, distance - 0.5 * stock.cell, np.nan)
