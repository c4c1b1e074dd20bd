"""Wall and floor that a simulated motion leaves behind, reconstructed from passes of the edges."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.compile.inclined_axis import inclined_engagement, is_inclined
from cutting.engagement.immersion import slice_engagement
from cutting.engagement.uncut_band import UncutBand
from cutting.surface.envelope import (
    ToolMotion,
    WallPasses,
    floor_height,
    wall_reach,
    width_of_influence,
)
from cutting.tool.cutter import Cutter, EdgeSlices, corner_height, edge_slices

if TYPE_CHECKING:
    from chatter.simulation.result import SimulationResult

Array = NDArray[np.float64]

_TURN = 2.0 * math.pi
#: direction in which an edge points at the wall, by the side of the wall
_WALL_ANGLE = {"+y": 0.0, "-y": math.pi}
#: turns, points along the feed, points a tooth and heights that are evaluated
_MOST_TURNS = 60.0
_MOST_POINTS = 4000
_POINTS_A_TOOTH = 24
_LEAST_POINTS_A_TOOTH = 12
_MOST_HEIGHTS = 40
_LEAST_HEIGHTS = 6
#: points of an arc to either side, at the most
_POINTS_OF_ARC = 400
#: points of all arcs of a wall
_MOST_LOOKS = 6_000_000
#: margin at both ends of the motion for edges on their way past the wall, rad
_MARGIN = 0.65
_ROUNDING = 1e-9
_WALL_OF_INCLINED = "wall: not evaluated with an inclined tool axis; the floor is"


@dataclass(frozen=True, eq=False)
class WallProfiles:
    """Wall over the feed and the height."""

    side: str  # ``"+y"`` or ``"-y"``
    x: Array  # (n,), along the feed, evenly spaced, m
    height: Array  # (L,), above the tip of the tool, m
    #: (L, n), along its normal from the nominal place, m; positive where too much was removed
    deviation: Array
    weight: Array  # (L,), share of each height in means over the wall


@dataclass(frozen=True, eq=False)
class FloorProfile:
    """Floor along the feed."""

    x: Array  # (n,), evenly spaced, m
    height: Array  # (n,), over the nominal floor, m
    #: a sharp corner: its feed marks depend on a minor cutting edge, which no case states
    sharp: bool = False


def surface_profiles(
    result: SimulationResult,
) -> tuple[list[WallProfiles], FloorProfile | None, list[str]]:
    """Reconstruct wall and floor of a straight cut from the motion of its tool.

    Walls (none where the run is too short), floor, and what is missing and why.
    """
    case = result.case
    if case.stock is not None or (case.simulation and case.simulation.has_own_path):
        return [], None, ["surface: evaluated for the straight cut of [cut] alone"]
    record = _record(result)
    if record is None:
        return [], None, ["surface: the run is too short for it to be evaluated"]
    if is_inclined(case):
        floor, reason = _floor_of_inclined(result, record)
        return [], floor, [_WALL_OF_INCLINED, *([reason] if floor is None else [])]
    sides = case.uncut_band.walls(result.setup.cutter.radius)
    found = [_wall(result, record, side) for side in sides]
    walls = [wall for wall in found if wall is not None]
    notes = []
    if not sides:
        notes = ["wall: none is left, the tool overhangs the work on both sides"]
    elif not walls:
        notes = ["wall: the run is too short for it to be evaluated"]
    floor, reason = _floor(result, record)
    return walls, floor, notes + ([reason] if floor is None else [])


@dataclass(frozen=True, eq=False)
class _Record:
    """Motion over the turns that are evaluated, and with as many turns before them."""

    evaluated: ToolMotion
    longer: ToolMotion


def _record(result: SimulationResult) -> _Record | None:
    teeth = result.case.tool.teeth
    turns = min(_MOST_TURNS, _MOST_POINTS / (_LEAST_POINTS_A_TOOTH * teeth))
    angle, settled = result.spindle_angle, result.settled
    last = angle[settled.stop - 1]
    start = max(settled.start, int(np.searchsorted(angle, last - turns * _TURN)))
    if settled.stop - start < 8 or last - angle[start] < 0.5 * _TURN:
        return None
    before = int(np.searchsorted(angle, 2.0 * angle[start] - last))
    position = result.displacement.copy()
    position[:, :2] += result.setup.path.position_at(result.time).T
    evaluated, longer = slice(start, settled.stop), slice(before, None)
    return _Record(
        ToolMotion(angle[evaluated], position[evaluated]),
        ToolMotion(angle[longer], position[longer]),
    )


def _surface_slices(cutter: Cutter, depth: float) -> EdgeSlices:
    """Slices of the edge for the surface: their middles are the heights that are evaluated."""
    top = min(depth, corner_height(cutter))
    straight = round(_MOST_HEIGHTS * (depth - top) / depth)
    corner = max(_MOST_HEIGHTS - straight, 2) if top > 0.0 else 0
    # at least two of either, but none of a straight part that only rounding makes
    straight = max(straight, 2) if depth - top > _ROUNDING * depth else 0
    return edge_slices(cutter, depth if straight else top, (corner, straight))


def _levels(result: SimulationResult, slices: EdgeSlices) -> NDArray:
    """Slices that make the wall: the straight edge, or the corner where nothing else cuts."""
    entry, leave = slice_engagement(result.case.uncut_band, slices.radius)
    cutting = entry < leave
    straight = cutting & (slices.immersion >= result.setup.cutter.edge_angle - 1e-9)
    return np.flatnonzero(straight if straight.any() else cutting)


def _wall(result: SimulationResult, record: _Record, side: str) -> WallProfiles | None:
    slices = _surface_slices(result.setup.cutter, result.case.cut.axial_depth)
    levels = _levels(result, slices)
    if levels.size == 0:
        return None
    looked_at = levels[[0, levels.size // 2, -1]]
    few = [_wall_passes(record.evaluated, slices, level, side) for level in looked_at]
    if any(one.angle.size < 2 for one in few):
        return None
    width = max(width_of_influence(record.evaluated, one) for one in few)
    spacing = max(_spacing(result, record.evaluated), width / _POINTS_OF_ARC)
    points = 2 * few[0].angle.size * (2.0 * width / spacing + 1.0)
    count = int(np.clip(_MOST_LOOKS / points, _LEAST_HEIGHTS, _MOST_HEIGHTS))
    levels = levels[:: math.ceil(levels.size / count)]
    passes = [_wall_passes(record.longer, slices, level, side) for level in levels]
    x = _grid(record, passes, width, spacing)
    if x is None:
        return None
    reach = np.array([wall_reach(record.longer, one, x, width) for one in passes])
    normal = np.sin(slices.immersion[levels])
    deviation = (reach - slices.radius[levels, None]) * normal[:, None]
    if not np.all(np.isfinite(deviation)):
        return None
    return WallProfiles(side, x, slices.height[levels], deviation, slices.edge_length[levels])


def _spacing(result: SimulationResult, motion: ToolMotion) -> float:
    """Distance between points along the feed, m."""
    travel = float(np.ptp(motion.position[:, 0]))
    return max(result.case.cut.feed_per_tooth / _POINTS_A_TOOTH, travel / _MOST_POINTS)


def _wall_passes(motion: ToolMotion, slices: EdgeSlices, level: int, side: str) -> WallPasses:
    angle, edge = motion.passes(slices.angle[:, level], _WALL_ANGLE[side], _MARGIN)
    immersion = slices.immersion[level]
    radius = slices.radius[level] + slices.normal_offset[:, level] / math.sin(immersion)
    return WallPasses(
        angle=angle,
        radius=radius[edge],
        radius_per_lift=-1.0 / math.tan(immersion) if immersion < 0.5 * math.pi else 0.0,
        side=1.0 if side == "+y" else -1.0,
    )


def _grid(record: _Record, passes: list[WallPasses], width: float, spacing: float) -> Array | None:
    """Points along the feed that every edge which matters has passed."""
    middles = [one.reach_at_pass(record.longer)[0] for one in passes]
    low = max(middle[0] for middle in middles) + width
    low = max(low, float(record.evaluated.position[0, 0]))
    high = min(middle[-1] for middle in middles) - width
    count = math.floor((high - low) / spacing) if high > low else 0
    return low + spacing * np.arange(count) if count >= _POINTS_A_TOOTH else None


def _floor(result: SimulationResult, record: _Record) -> tuple[FloorProfile | None, str]:
    """Floor along a line in the middle of the cut, or why there is none."""
    cutter, slices, case = result.setup.cutter, result.setup.slices, result.case
    tip_radius = cutter.radius - cutter.corner_radius
    direction = _crossing(tip_radius, case.uncut_band.middle(cutter.radius), case.uncut_band)
    if direction is None:
        return None, "floor: the tip of the tool is not within the width of the cut"
    angle, edge = record.longer.passes(slices.angle[:, 0], direction, _MARGIN)
    steep = math.sin(direction)
    position = record.longer.at(angle)
    at = position[:, 0] + (tip_radius + cutter.radial_offsets[edge]) * steep
    lowest = position[:, 2] - cutter.axial_offsets[edge]
    if cutter.corner_radius == 0.0 and not lowest.any():
        return None, "floor: a sharp corner that does not move along z leaves no marks"
    feed_per_revolution = case.cut.feed_per_tooth * cutter.teeth
    spacing = _spacing(result, record.evaluated)
    # what later revolutions will still cut is excluded at the end
    start = max(
        at.min() + feed_per_revolution, record.evaluated.position[0, 0] + tip_radius * steep
    )
    count = math.floor((at.max() - feed_per_revolution - start) / spacing)
    if count < _POINTS_A_TOOTH:
        return None, "floor: the run is too short for it to be evaluated"
    x = start + spacing * np.arange(count)
    profile = floor_height(x, at, lowest, cutter.corner_radius / steep**2, feed_per_revolution)
    if not np.all(np.isfinite(profile)):
        return None, "floor: the tool moves too far for its corners to meet"
    return FloorProfile(x, profile, sharp=cutter.corner_radius == 0.0), ""


def _floor_of_inclined(
    result: SimulationResult, record: _Record
) -> tuple[FloorProfile | None, str]:
    """Floor along the line of the lowest points of an inclined tool, or why there is none.

    Its edges pass that point with the normal of the floor, on an arc along the feed whose curvature
    is that of the corner and of the circle about the axis by their directions (Euler).
    """
    cutter, case = result.setup.cutter, result.case
    corner = cutter.corner_radius
    if corner == 0.0:
        return None, "floor: the feed marks of a sharp corner on an inclined tool are not evaluated"
    engaged = inclined_engagement(case, cutter)
    direction, immersion = engaged.floor_point
    height, sine = corner * (1.0 - math.cos(immersion)), math.sin(immersion)
    lag = np.tan(np.asarray(cutter.helix)) / cutter.radius * height
    angle, edge = record.longer.passes(cutter.tooth_angles - lag, direction, _MARGIN)
    position = record.longer.at(angle)
    reach = cutter.radial_offsets * sine + cutter.axial_offsets * math.cos(immersion)
    lowest = position[:, 2] - reach[edge]
    about_axis = engaged.frame @ [math.cos(direction), -math.sin(direction), 0.0]
    share = float(about_axis[0]) ** 2
    circle = cutter.radius - corner + corner * sine
    curvature = (1.0 - share) / corner + (share * sine / circle if circle > 0.0 else share / corner)
    return _floor_along(result, record, position[:, 0], lowest, 1.0 / curvature)


def _floor_along(
    result: SimulationResult, record: _Record, at: Array, lowest: Array, radius: float
) -> tuple[FloorProfile | None, str]:
    """Floor of arcs of a radius whose lowest points are given along the feed, m."""
    feed_per_revolution = result.case.cut.feed_per_tooth * result.setup.cutter.teeth
    spacing = _spacing(result, record.evaluated)
    # what later revolutions will still cut is excluded at the end
    start = max(at.min() + feed_per_revolution, record.evaluated.position[0, 0])
    count = math.floor((at.max() - feed_per_revolution - start) / spacing)
    if count < _POINTS_A_TOOTH:
        return None, "floor: the run is too short for it to be evaluated"
    x = start + spacing * np.arange(count)
    profile = floor_height(x, at, lowest, radius, feed_per_revolution)
    if not np.all(np.isfinite(profile)):
        return None, "floor: the tool moves too far for its corners to meet"
    return FloorProfile(x, profile), ""


def _crossing(tip_radius: float, middle: float, band: UncutBand) -> float | None:
    """Angle at which the deepest points of the edges cross the middle of the cut, rad.

    A ball has one such point, on its axis.
    """
    if tip_radius <= 0.0:
        return 0.5 * math.pi if band.side == 0 else None
    return math.acos(middle / tip_radius) if abs(middle) < tip_radius else None
