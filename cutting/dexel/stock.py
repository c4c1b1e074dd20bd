"""Workpiece of dexel lines: layout in memory, shaping, moving along with the tool, measurement.

A layer of the workpiece is a planar set of material, held as the material intervals on two
families of parallel lines: family 0 along x, family 1 along y (Van Hook 1986; with a second
family after Mueller et al. 2003). Interval ends are real numbers, so a smooth surface is known to
second order in the spacing of the lines.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rectangle = tuple[float, float, float, float]  # x0, x1, y0, y1 in m

#: most disjoint material intervals that a line can hold
CAPACITY = 6


class DexelStock(NamedTuple):
    """Layers of dexel lines, with the cuts that each tooth has made but not yet carried out.

    The second axis (first axis of `first` and `lines`) is the family: 0 for lines along x,
    numbered by y; 1 for lines along y, numbered by x. Cuts are delayed until the edge is `delay`
    past them, so that the material just behind an edge can still be read; they wait in a ring.
    The intervals of a line come first among its places, in any order; empty places hold 0, 0.
    Few arrays, as each costs time in every call of a compiled function.
    """

    spacing: float  # m, between lines
    window: float  # m, largest chip thickness that is read with full accuracy
    delay: float  # m, distance of the edge from a crossing at which its cut is carried out
    first: tuple[float, float]  # m, y (family 0) or x (family 1) of line 0
    lines: tuple[int, int]  # number of lines
    box: Rectangle  # m, around all material
    interval: NDArray[np.float64]  # m, lower and upper ends, (layers, 2, most lines, CAPACITY, 2)
    pending: NDArray[np.float64]  # line, m edge, m inner end of cuts, (layers, teeth, 2, ring, 3)
    queue: NDArray[np.int64]  # oldest waiting cut and their number, (layers, teeth, 2, 2)
    overflow: NDArray[np.int64]  # intervals dropped for want of room, (1,)


def checked_boxes(
    boxes: Sequence[Sequence[tuple[Rectangle, bool]]],
    layers: int,
    resolution: float,
    teeth: int,
    window: float,
) -> Rectangle:
    """Check the arguments of a stock and return the box around all added rectangles."""
    if len(boxes) != layers or layers < 1:
        raise ValueError(f"{len(boxes)} lists of rectangles given for {layers} layers")
    if teeth < 1:
        raise ValueError(f"the number of teeth is {teeth}, it must be at least 1")
    for name, value in (("resolution", resolution), ("window", window)):
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"the {name} is {value} m, it must be positive")
    for shapes in boxes:
        for (x0, x1, y0, y1), _ in shapes:
            if not (all(map(math.isfinite, (x0, x1, y0, y1))) and x0 < x1 and y0 < y1):
                raise ValueError(f"rectangle ({x0}, {x1}, {y0}, {y1}) m: x0 < x1, y0 < y1 wanted")
    added = np.array([shape for shapes in boxes for shape, adds in shapes if adds])
    if added.size == 0:
        raise ValueError("no rectangle adds material to the stock")
    lowest, highest = added.min(axis=0), added.max(axis=0)
    return float(lowest[0]), float(highest[1]), float(lowest[2]), float(highest[3])


def dexel_stock(
    boxes: Sequence[Sequence[tuple[Rectangle, bool]]],
    layers: int,
    resolution: float,
    teeth: int,
    window: float,
) -> DexelStock:
    """Build a workpiece from rectangles.

    Parameters
    ----------
    boxes : sequence over layers of sequences of ((x0, x1, y0, y1), adds)
        m; each rectangle adds (True) or removes (False) material, in this order. A border
        along a family of lines is rounded to the middle between two of them.
    layers : int
        Number of layers, the length of `boxes`.
    resolution : float
        Spacing of the lines, m.
    teeth : int
        Number of cutting edges per layer that will carve the stock.
    window : float
        Largest chip thickness expected, m. A thicker chip is still read, less accurately.

    Raises
    ------
    ValueError
        If a rectangle or a number makes no sense.
    """
    x0, x1, y0, y1 = checked_boxes(boxes, layers, resolution, teeth, window)
    # 1e-9: a length that is a multiple of the spacing but for rounding needs no further line
    by_y, by_x = (math.ceil((b - a) / resolution - 1e-9) for a, b in ((y0, y1), (x0, x1)))
    delay = window + 3.0 * resolution
    ring = math.ceil(delay / resolution) + 32
    stock = DexelStock(
        spacing=float(resolution),
        window=float(window),
        delay=float(delay),
        first=(y0 + 0.5 * resolution, x0 + 0.5 * resolution),
        lines=(by_y, by_x),
        box=(x0, x1, y0, y1),
        interval=np.zeros((layers, 2, max(by_y, by_x), CAPACITY, 2)),
        pending=np.zeros((layers, teeth, 2, ring, 3)),
        queue=np.zeros((layers, teeth, 2, 2), dtype=np.int64),
        overflow=np.zeros(1, dtype=np.int64),
    )
    for layer, shapes in enumerate(boxes):
        for (left, right, bottom, top), adds in shapes:
            spans = ((left, right), (bottom, top))
            for family in range(2):
                coordinate = line_coordinates(stock, family)
                low, high = spans[1 - family]
                covered = (coordinate >= low) & (coordinate < high)
                ends = (np.where(covered, spans[family][i], np.nan) for i in range(2))
                change = unite_spans if adds else subtract_spans
                change(stock, layer, family, *ends)
    return stock


def line_coordinates(stock: DexelStock, family: int) -> NDArray[np.float64]:
    """Transverse coordinate of the lines of a family, m: y of family 0, x of family 1."""
    return stock.first[family] + stock.spacing * np.arange(stock.lines[family])


def _intervals(
    stock: DexelStock, layer: int, family: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Interval ends of a family (lines, CAPACITY), NaN where there is none."""
    interval = stock.interval[layer, family, : stock.lines[family]]
    held = interval[..., 0] < interval[..., 1]
    return tuple(np.where(held, interval[..., i], np.nan) for i in range(2))


def _store(
    stock: DexelStock, layer: int, family: int, start: NDArray[np.float64], end: NDArray[np.float64]
) -> None:
    """Keep the longest intervals of each line; those of no length are none."""
    length = end - start
    length = np.where(length > 1e-6 * stock.spacing, length, 0.0)
    dropped = np.count_nonzero(length, axis=1) - CAPACITY
    stock.overflow[0] += np.maximum(dropped, 0).sum()
    longest = np.argsort(-length, axis=1, kind="stable")[:, :CAPACITY]
    held = np.take_along_axis(length, longest, axis=1) > 0.0
    interval = stock.interval[layer, family, : stock.lines[family]]
    for i, ends in enumerate((start, end)):
        interval[..., i] = np.where(held, np.take_along_axis(ends, longest, axis=1), 0.0)


def subtract_spans(
    stock: DexelStock, layer: int, family: int, low: NDArray[np.float64], high: NDArray[np.float64]
) -> None:
    """Remove low..high from each line of a family.

    Ends (lines,), m, along the lines; NaN for nothing. The stock is changed.
    """
    start, end = _intervals(stock, layer, family)
    low = np.where(np.isnan(low), np.inf, low)[:, None]
    high = np.where(np.isnan(high), np.inf, high)[:, None]
    starts = np.concatenate([start, np.maximum(start, high)], axis=1)
    ends = np.concatenate([np.minimum(end, low), end], axis=1)
    _store(stock, layer, family, starts, ends)


def unite_spans(
    stock: DexelStock, layer: int, family: int, low: NDArray[np.float64], high: NDArray[np.float64]
) -> None:
    """Add low..high to each line of a family, merged with the intervals it meets.

    Ends (lines,), m, along the lines; NaN for nothing. The stock is changed.
    """
    start, end = _intervals(stock, layer, family)
    met = (start <= high[:, None]) & (end >= low[:, None])
    low = np.minimum(low, np.where(met, start, np.inf).min(axis=1))
    high = np.maximum(high, np.where(met, end, -np.inf).max(axis=1))
    start, end = (np.where(met, np.nan, part) for part in (start, end))
    starts = np.concatenate([start, low[:, None]], axis=1)
    ends = np.concatenate([end, high[:, None]], axis=1)
    _store(stock, layer, family, starts, ends)


def dexel_remove_path(
    stock: DexelStock, layer: int, x0: float, y0: float, x1: float, y1: float, radius: float
) -> None:
    """Remove what a disc clears as its centre moves straight from (x0, y0) to (x1, y1).

    All in m.
    """
    for family, (a, b) in enumerate((((x0, y0), (x1, y1)), ((y0, x0), (y1, x1)))):
        coordinate = line_coordinates(stock, family)
        low, high = _capsule_chord(coordinate, a, b, radius)
        subtract_spans(stock, layer, family, low, high)


def _capsule_chord(
    coordinate: NDArray[np.float64], a: tuple[float, float], b: tuple[float, float], radius: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends of the chord of a capsule on lines at the transverse coordinate `coordinate`.

    The capsule is convex: its chord is the hull of those of the two discs and of the band.
    """
    low, high = np.full_like(coordinate, np.inf), np.full_like(coordinate, -np.inf)
    for centre in (a, b):
        square = radius**2 - (coordinate - centre[1]) ** 2
        half = np.sqrt(np.maximum(square, 0.0))
        low = np.where(square > 0.0, np.minimum(low, centre[0] - half), low)
        high = np.where(square > 0.0, np.maximum(high, centre[0] + half), high)
    along, across = b[0] - a[0], b[1] - a[1]
    length = math.hypot(along, across)
    if length > 0.0 and across != 0.0:
        for side in (-radius, radius):
            # point of the band's edge on the line, as a fraction of the path
            fraction = (coordinate - a[1] - side * along / length) / across
            point = a[0] + fraction * along - side * across / length
            on = (fraction >= 0.0) & (fraction <= 1.0)
            low = np.where(on, np.minimum(low, point), low)
            high = np.where(on, np.maximum(high, point), high)
    missed = low > high
    return np.where(missed, np.nan, low), np.where(missed, np.nan, high)


def dexel_remaining_area(stock: DexelStock, layer: int) -> float:
    """Area of material in a layer, m^2, the mean of what the two families of lines say.

    Cuts still waiting are not taken off: call `dexel_flush` before.
    """
    lengths = (
        np.nansum(end - start) for start, end in (_intervals(stock, layer, f) for f in (0, 1))
    )
    return 0.5 * stock.spacing * float(sum(lengths))


def dexel_wall_profile(
    stock: DexelStock, layer: int, x: ArrayLike, side: int, reference: float = 0.0
) -> NDArray[np.float64]:
    """Surface that bounds the material nearest to y = reference on one side of it.

    Parameters
    ----------
    stock : DexelStock
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
        y, m, linear between lines; NaN where a neighbouring line has no material on that side.
    """
    start, end = _intervals(stock, layer, 1)
    start, end = (start, end) if side > 0 else (-end, -start)
    level = side * reference
    near = np.where(end > level, np.maximum(start, level), np.inf).min(axis=1)
    near = np.where(np.isinf(near), np.nan, near)
    x = np.asarray(x, dtype=np.float64)
    coordinate = line_coordinates(stock, 1)
    margin = 0.5 * stock.spacing * (1.0 + 1e-9)
    inside = (x >= coordinate[0] - margin) & (x <= coordinate[-1] + margin)
    return side * np.where(inside, np.interp(x, coordinate, near), np.nan)


#: a distance that lacks this share of a line is whole but for rounding
_ROUNDING = 1e-6


def dexel_advanced(stock: DexelStock, distance: float) -> DexelStock:
    """Move the workpiece along +x by the most whole lines that are not above a distance.

    What falls off behind is dropped, with the cuts that wait there; ahead comes fresh material
    over the full height of the box. The arrays are changed in place: the stock given is no longer
    of use.

    The stock has material up to the far border of its box, and a whole number of lines along it;
    distance in m.
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
