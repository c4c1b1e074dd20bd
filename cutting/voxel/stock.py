"""Workpiece of voxels: layout in memory, shaping, moving along with the tool, measurement.

A layer of the workpiece is a bitmap, 64 cells along x to a word; a cell is material or air by its
centre.
"""

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
    ``(x_min + (64 w + i + 1/2) spacing, y_min + (j + 1/2) spacing)``. `recent` holds, for
    the last steps of a tooth, the material cells and all cells swept, the movement of the edge
    (m) and its rotation (rad).
    """

    spacing: float  # m, side of a cell
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

    Parameters and errors as of `cutting.dexel.stock.dexel_stock`; `resolution` is the side of a
    cell, m. Material deeper under the edge than `window` is removed but not counted in the
    thickness; `VoxelStock.deep` counts the steps that met it.
    """
    x0, x1, y0, y1 = checked_boxes(boxes, layers, resolution, teeth, window)
    # 1e-9: a length that is a multiple of the cell but for rounding needs no further cell
    columns, rows = (math.ceil((b - a) / resolution - 1e-9) for a, b in ((x0, x1), (y0, y1)))
    stock = VoxelStock(
        spacing=float(resolution),
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
    return stock.x_min + stock.spacing * (np.arange(stock.columns) + 0.5)


def _row_centres(stock: VoxelStock) -> NDArray[np.float64]:
    return stock.y_min + stock.spacing * (np.arange(stock.rows) + 0.5)


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
    """Remove what a disc clears on a straight way, as `cutting.dexel.stock.dexel_remove_path`."""
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
    return float(_BITS_OF_BYTE[octets].sum()) * stock.spacing**2


def voxel_wall_profile(
    stock: VoxelStock, layer: int, x: ArrayLike, side: int, reference: float = 0.0
) -> NDArray[np.float64]:
    """Surface that bounds the material on one side, as `cutting.dexel.stock.dexel_wall_profile`.

    It is the side of the cell in the column that holds x.
    """
    x = np.asarray(x, dtype=np.float64)
    column = np.floor((x - stock.x_min) / stock.spacing).astype(np.int64)
    inside = (column >= 0) & (column < stock.columns)
    y = _row_centres(stock)
    beyond = side * (y - reference) > 0.0
    material = _cells(stock.words[layer], stock.columns)[:, np.where(inside, column, 0)]
    distance = np.where(material & beyond[:, None], side * y[:, None], np.inf).min(axis=0)
    found = inside & np.isfinite(distance)
    return side * np.where(found, distance - 0.5 * stock.spacing, np.nan)


#: cells of a word, which move together
CELLS_A_WORD = 64
#: a distance that lacks this share of a cell is whole but for rounding
_ROUNDING = 1e-6


def voxel_advanced(stock: VoxelStock, distance: float) -> VoxelStock:
    """Move the workpiece along +x by the most whole words that are not above a distance.

    Otherwise as `cutting.dexel.stock.dexel_advanced`.
    """
    moved = math.floor((distance / stock.spacing + _ROUNDING) / CELLS_A_WORD)
    if moved <= 0:
        return stock
    width = stock.words.shape[2]
    kept = max(width - moved, 0)
    fresh = packed(np.arange(stock.columns) >= stock.columns - moved * CELLS_A_WORD)
    for words in stock.words:
        words[:, :kept] = words[:, width - kept :]
        words[:, kept:] = 0
        words |= fresh
    return stock._replace(x_min=stock.x_min + moved * CELLS_A_WORD * stock.spacing)
