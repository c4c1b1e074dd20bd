"""Plan view of a carved workpiece."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import ListedColormap

from chatter.plots.style import BLUE, GREY, finish
from cutting.dexel.stock import CAPACITY, DexelStock, line_coordinates
from cutting.voxel.stock import VoxelStock

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from chatter.simulation.result import SimulationResult

Corner = tuple[float, float]
Plan = tuple[Corner, Corner, np.ndarray]

_MATERIAL = ListedColormap(["white", "#C9D6DF"])
#: cells of the picture along its longer side
_CELLS = 700


def draw_workpiece(axes: Axes, result: SimulationResult, layer: int) -> None:
    """Draw a layer of a carved dexel or voxel workpiece, and the path of the tool."""
    stock = result.setup.groups[0].stock
    low, high, material = plan_view(stock, layer)
    unit, factor = result.units.length
    axes.imshow(
        material,
        cmap=_MATERIAL,
        origin="lower",
        extent=(low[0] * factor, high[0] * factor, low[1] * factor, high[1] * factor),
        interpolation="nearest",
        vmin=0,
        vmax=1,
    )
    x, y = result.setup.path.position_at(result.time) * factor
    axes.plot(x, y, color=BLUE, linewidth=1.0, label="tool axis")
    turn = np.linspace(0.0, 2.0 * np.pi, 100)
    radius = result.setup.slices.radius[layer] * factor
    axes.plot(
        x[-1] + radius * np.sin(turn), y[-1] + radius * np.cos(turn), color=GREY, linewidth=0.8
    )
    axes.legend(frameon=False, fontsize=8, loc="upper left")
    axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
    finish(axes)
    axes.grid(visible=False)


def plan_view(stock: DexelStock | VoxelStock, layer: int) -> Plan:
    """Lower and upper corner (x, y) in m, and a picture (rows along y) of the material."""
    if isinstance(stock, DexelStock):
        return _of_dexels(stock, layer)
    return _of_voxels(stock, layer)


def _of_dexels(stock: DexelStock, layer: int) -> Plan:
    x = line_coordinates(stock, 1)
    x = x[:: -(-len(x) // _CELLS)]
    lines = np.round((x - stock.first[1]) / stock.spacing).astype(int)
    y = np.linspace(stock.box[2], stock.box[3], min(_CELLS, stock.lines[0]))
    ends = stock.interval[layer, 1, lines]
    material = np.zeros((y.size, x.size), dtype=bool)
    for k in range(CAPACITY):
        material |= (y[:, None] >= ends[:, k, 0]) & (y[:, None] < ends[:, k, 1])
    return (stock.box[0], stock.box[2]), (stock.box[1], stock.box[3]), material


def _of_voxels(stock: VoxelStock, layer: int) -> Plan:
    octets = np.ascontiguousarray(stock.words[layer]).view(np.uint8)
    cells = np.unpackbits(octets, axis=1, bitorder="little")[:, : stock.columns].astype(bool)
    step = -(-max(cells.shape) // _CELLS)
    low = (stock.x_min, stock.y_min)
    high = (low[0] + stock.columns * stock.spacing, low[1] + stock.rows * stock.spacing)
    return low, high, cells[::step, ::step]
