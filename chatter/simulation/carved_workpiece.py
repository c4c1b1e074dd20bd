"""What is left of a carved workpiece: its walls, what went wrong, and another cut through it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.simulation.reconstruction import WallProfiles
from chatter.simulation.setup import Setup, set_up_in_stock, with_start_cleared
from chatter.simulation.workpiece import DISCRETE_CHIPS
from cutting.chip.discrete_chip import DiscreteCut
from cutting.dexel.carving import dexel_flush
from cutting.dexel.stock import DexelStock, dexel_wall_profile, line_coordinates
from cutting.tool.cutter import EdgeSlices
from cutting.voxel.stock import VoxelStock

if TYPE_CHECKING:
    from chatter.simulation.result import SimulationResult

#: walls that a cut leaves standing
_SIGN = {"+y": 1, "-y": -1}
_MOST_POINTS = 4000
_LEAST_POINTS = 16


@dataclass(frozen=True, eq=False)
class WallPiece:
    """Walls of a part of the stock that has fallen off behind the tool."""

    x: NDArray[np.float64]  # (n,), of the lines, m
    y: dict[str, NDArray[np.float64]]  # side -> (layers, n) array of float, m


class FollowingStock:
    """Stock of a cut that follows the tool, and the walls that it has left behind.

    Walls are kept of dexels alone; voxels are too coarse for that. `reach` is the distance behind
    the tool axis that is still needed, m; the stock of the cut moves.
    """

    def __init__(self, case: Case, cut: DiscreteCut, reach: float) -> None:
        self.cut = cut
        self.left_behind: list[WallPiece] = []
        self._kind = DISCRETE_CHIPS[case.simulation.chip]
        self._sides = case.uncut_band.walls(0.5 * case.tool.diameter)
        self._reach = reach

    def follow(self, x: float) -> DiscreteCut:
        """Move the stock up to the place of the tool axis, m, and return the cut through it."""
        stock = self.cut.stock
        rear = stock.box[0] if isinstance(stock, DexelStock) else stock.x_min
        a_move = stock.spacing * self._kind.cells_a_move
        moves = math.floor((x - self._reach - rear) / a_move + 1e-6)
        if moves > 0:
            if isinstance(stock, DexelStock):
                self._keep_walls(stock, moves)
            self.cut = self.cut._replace(stock=self._kind.advanced(stock, moves * a_move))
        return self.cut

    def _keep_walls(self, stock: DexelStock, lines: int) -> None:
        position = line_coordinates(stock, 1)[:lines]
        layers = range(stock.interval.shape[0])
        walls = {
            side: np.array([dexel_wall_profile(stock, k, position, _SIGN[side]) for k in layers])
            for side in self._sides
        }
        self.left_behind.append(WallPiece(position, walls))


def after_run(setup: Setup, stock: FollowingStock) -> Setup:
    """Setup of a run whose stock has followed the tool, with the stock as it is now."""
    return replace(
        setup, groups=(stock.cut, *setup.groups[1:]), left_behind=tuple(stock.left_behind)
    )


def carved_walls(result: SimulationResult) -> list[WallProfiles]:
    """Walls behind the tool over the settled part of a straight run.

    Of a run with a dexel or voxel chip. Empty where the tool has not come far enough for a finished
    wall, and where voxels have fallen off behind the tool.
    """
    cut: DiscreteCut = result.setup.groups[0]
    if isinstance(cut.stock, DexelStock):
        dexel_flush(cut.stock)
    position = result.setup.path.position_at(result.time[[result.settled.start, -1]])
    slices = result.setup.slices
    swing = float(np.ptp(result.displacement[result.settled, 1]))
    a_turn = result.case.cut.feed_per_tooth * result.case.tool.teeth
    unfinished = math.sqrt(2.0 * float(slices.radius.max()) * swing) + a_turn
    low, high = float(position[0, 0]), float(position[0, 1]) - unfinished
    spacing = cut.stock.spacing
    count = min(_MOST_POINTS, int((high - low) / spacing))
    if count < _LEAST_POINTS:
        return []
    x = np.linspace(low, high, count)
    walls = (
        _wall(result, cut, side, x)
        for side in result.case.uncut_band.walls(result.setup.cutter.radius)
    )
    return [wall for wall in walls if wall is not None]


def _wall(
    result: SimulationResult, cut: DiscreteCut, side: str, x: np.ndarray
) -> WallProfiles | None:
    slices, sign = result.setup.slices, _SIGN[side]
    straight = np.flatnonzero(slices.immersion >= result.setup.cutter.edge_angle - 1e-9)
    levels = straight if straight.size else np.arange(slices.height.size)
    y = np.array([_profile(result, cut, side, level, x) for level in levels])
    deviation = (sign * y - slices.radius[levels, None]) * np.sin(slices.immersion[levels, None])
    if not np.all(np.isfinite(deviation)):
        return None
    return WallProfiles(side, x, slices.height[levels], deviation, slices.edge_length[levels])


def _profile(
    result: SimulationResult, cut: DiscreteCut, side: str, level: int, x: np.ndarray
) -> np.ndarray:
    """Wall at a level, m, with what has fallen off behind."""
    of_stock = DISCRETE_CHIPS[result.case.simulation.chip].wall_profile
    setup = result.setup
    pieces = setup.left_behind
    if not pieces:
        return of_stock(cut.stock, level, x, _SIGN[side])
    held = line_coordinates(cut.stock, 1)
    position = np.concatenate([*(piece.x for piece in pieces), held])
    last = of_stock(cut.stock, level, held, _SIGN[side])
    y = np.concatenate([*(piece.y[side][level] for piece in pieces), last])
    return np.interp(x, position, y, left=np.nan, right=np.nan)


def carving_notes(cut: DiscreteCut) -> list[str]:
    """What the user should know of a carved workpiece."""
    if isinstance(cut.stock, DexelStock):
        dropped = int(cut.stock.overflow[0])
        return [f"dexel: {dropped} slivers of material were dropped"] if dropped else []
    deep = int(cut.stock.deep[0])
    if not deep:
        return []
    return [f"voxel: {deep} times an edge met more material than its window of {_window_text(cut)}"]


def _window_text(cut: DiscreteCut) -> str:
    return f"{cut.stock.window * 1e3:.3g} mm"


def set_up_on(case: Case, before: SimulationResult) -> Setup:
    """Compile a case that cuts what a run has left of its workpiece.

    InputError if there is no such workpiece, or the case does not fit it.
    """
    carved = before.setup.groups[0]
    _refuse_other_workpiece(case, before.case, carved)
    size = carved.stock.spacing
    stock = before.case.stock.model_dump(mode="json", exclude_unset=True)
    setup = set_up_in_stock(case.patch({"stock": stock, "simulation.resolution": size}))
    _refuse_other_layers(case, setup.slices, before.setup.slices)
    cut = _carved_before(setup.groups[0], carved.stock)
    return with_start_cleared(replace(setup, groups=(cut, *setup.groups[1:])))


def _refuse_other_workpiece(case: Case, before: Case, carved: object) -> None:
    """Refuse to go on with a workpiece that is not there as a whole, or not of the case."""
    if not isinstance(carved, DiscreteCut) or before.stock is None:
        raise InputError(
            f"{case.name}: the run before ({before.name}) has left no workpiece; it needs [stock] "
            'and simulation.chip = "dexel" or "voxel"'
        )
    chip = case.simulation.chip if case.simulation else "delay"
    if chip != before.simulation.chip:
        raise InputError(
            f'{case.name}: simulation.chip is "{chip}", but the workpiece of the run before is of '
            f'kind "{before.simulation.chip}"; both must be the same'
        )
    if case.stock is not None and case.stock != before.stock:
        raise InputError(
            f"{case.name}: stock differs from that of the run before, which has left the workpiece;"
            " leave [stock] out"
        )
    size = carved.stock.spacing
    given = case.simulation.resolution
    if given is not None and not math.isclose(given, size, rel_tol=1e-9):
        raise InputError(
            f"{case.name}: simulation.resolution is {given * 1e6:.6g} um, but the workpiece of the "
            f"run before has {size * 1e6:.6g} um; leave it out"
        )


def _refuse_other_layers(case: Case, slices: EdgeSlices, before: EdgeSlices) -> None:
    """Refuse a cut whose layers do not lie where those of the workpiece do."""
    same = slices.height.shape == before.height.shape and np.allclose(
        [slices.height, slices.thickness], [before.height, before.thickness], rtol=1e-9, atol=0.0
    )
    if not same:
        raise InputError(
            f"{case.name}: the {len(slices.height)} layers of this cut are not at the heights of "
            f"the {len(before.height)} layers of the workpiece; cut.axial_depth, "
            "simulation.slices and the corner of the tool must be the same"
        )


def _carved_before(cut: DiscreteCut, stock: DexelStock | VoxelStock) -> DiscreteCut:
    """Cut through what has been left of a stock; that itself is not changed."""
    if isinstance(stock, VoxelStock):
        # the smaller parts belong to the teeth of the cut
        own = {name: getattr(cut.stock, name) for name in ("window", "recent", "newest", "deep")}
        return cut._replace(stock=stock._replace(words=stock.words.copy(), **own))
    copied = stock._replace(
        interval=stock.interval.copy(), queue=stock.queue.copy(), overflow=stock.overflow.copy()
    )
    dexel_flush(copied)
    own = {
        name: getattr(cut.stock, name)
        for name in ("window", "delay", "pending", "queue", "overflow")
    }
    return cut._replace(stock=copied._replace(**own))
