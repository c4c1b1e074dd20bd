"""Walls that are left standing in a carved workpiece, and what went wrong in carving it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from chatter.simulation.reconstruction import WallProfiles
from chatter.simulation.stock import DISCRETE_CHIPS
from cutting.dexel import dexel_flush
from cutting.dexel_stock import DexelStock
from cutting.discrete_chip import DiscreteCut

if TYPE_CHECKING:
    from chatter.simulation.result import SimulationResult

_SIDES = {"up": ("+y",), "down": ("-y",), "slot": ("+y", "-y")}
_SIGN = {"+y": 1, "-y": -1}
_MOST_POINTS = 4000
_LEAST_POINTS = 16


def carved_walls(result: SimulationResult) -> list[WallProfiles]:
    """Walls behind the tool over the settled part of a straight run.

    Parameters
    ----------
    result : SimulationResult
        With a dexel or voxel chip.

    Returns
    -------
    list of WallProfiles
        Empty where the tool has not come far enough for a finished wall.
    """
    cut: DiscreteCut = result.setup.groups[0]
    if isinstance(cut.stock, DexelStock):
        dexel_flush(cut.stock)
    place = result.setup.path.place_at(result.time[[result.settled.start, -1]])
    slices = result.setup.slices
    swing = float(np.ptp(result.displacement[result.settled, 1]))
    a_turn = result.case.cut.feed_per_tooth * result.case.tool.teeth
    unfinished = math.sqrt(2.0 * float(slices.radius.max()) * swing) + a_turn
    low, high = float(place[0, 0]), float(place[0, 1]) - unfinished
    spacing = cut.stock.spacing if isinstance(cut.stock, DexelStock) else cut.stock.cell
    count = min(_MOST_POINTS, int((high - low) / spacing))
    if count < _LEAST_POINTS:
        return []
    x = np.linspace(low, high, count)
    walls = (_wall(result, cut, side, x) for side in _SIDES[result.case.cut.mode])
    return [wall for wall in walls if wall is not None]


def _wall(
    result: SimulationResult, cut: DiscreteCut, side: str, x: np.ndarray
) -> WallProfiles | None:
    profile = DISCRETE_CHIPS[result.case.simulation.chip].wall_profile
    slices, sign = result.setup.slices, _SIGN[side]
    straight = np.flatnonzero(slices.immersion >= result.setup.cutter.edge_angle - 1e-9)
    levels = straight if straight.size else np.arange(slices.height.size)
    y = np.array([profile(cut.stock, level, x, sign) for level in levels])
    deviation = (sign * y - slices.radius[levels, None]) * np.sin(slices.immersion[levels, None])
    if not np.all(np.isfinite(deviation)):
        return None
    return WallProfiles(side, x, slices.height[levels], deviation, slices.edge_length[levels])


def carving_notes(cut: DiscreteCut) -> list[str]:
    """What the user should know of a carved workpiece."""
    if isinstance(cut.stock, DexelStock):
        dropped = int(cut.stock.overflow[0])
        return [f"dexel: {dropped} slivers of material were dropped"] if dropped else []
    deep = int(cut.stock.deep[0])
    if not deep:
        return []
    return [f"voxel: {deep} times an edge met more material than the {_window_text(cut)} looked at"]


def _window_text(cut: DiscreteCut) -> str:
    return f"{cut.stock.window * 1e3:.3g} mm"
