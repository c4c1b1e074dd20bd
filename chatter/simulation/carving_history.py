"""When each cell of a carved workpiece was cut away, from the path of the tool."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from chatter.simulation.result import SimulationResult

#: places of the tool that are looked at; between them it moves less than a cell mostly
_MOST_PLACES = 400


def removal_times(
    result: SimulationResult,
    material: NDArray[np.bool_],
    corners: tuple[tuple[float, float], tuple[float, float]],
    layer: int,
) -> NDArray[np.float64]:
    """Time at which the tool first reached each cell that is not there at the end.

    The tool is taken as the disc of its radius on its path without its vibration, so that a time is
    right to about a revolution.

    Parameters
    ----------
    result : SimulationResult
        Of a run that carves a workpiece.
    material : (rows, columns) array of bool
        What is left at the end, rows along y.
    corners : pair of (x, y)
        Lower and upper corner of the grid, m.
    layer : int
        Of the slices of the tool.

    Returns
    -------
    (rows, columns) array of float
        s; inf where material is left, -inf where the tool never came.
    """
    (x0, y0), (x1, y1) = corners
    rows, columns = material.shape
    x = x0 + (np.arange(columns) + 0.5) * (x1 - x0) / columns
    y = y0 + (np.arange(rows) + 0.5) * (y1 - y0) / rows
    radius = float(result.setup.slices.radius[layer])
    found = np.full(material.shape, -np.inf)
    stride = max(1, len(result.time) // _MOST_PLACES)
    times = result.time[::stride][::-1]
    for time, place in zip(times, result.setup.path.position_at(times).T, strict=True):
        near = (y[:, None] - place[1]) ** 2 + (x[None, :] - place[0]) ** 2 <= radius**2
        found[near] = time
    return np.where(material, np.inf, found)
