"""Workpiece of dexels or voxels that a case describes, and the cut through it.

A case without a stock is cut out of an endless one. What is held of it is a window about the
tool, which moves along between chunks of steps.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.compile.cutter import edge_law, flank_table
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.unit_system import units_of
from chatter.simulation.resolution import Resolution, outermost_radius
from chatter.simulation.spindle import ProgrammedSpindle, Spindle, ToolPath
from chatter.simulation.tool_course import ToolCourse
from cutting.chip.discrete_chip import DiscreteCut
from cutting.dexel.stock import (
    DexelStock,
    dexel_advanced,
    dexel_remaining_area,
    dexel_remove_path,
    dexel_stock,
    dexel_wall_profile,
)
from cutting.engagement.immersion import slice_engagement
from cutting.engagement.uncut_band import UncutBand
from cutting.tool.cutter import Cutter, EdgeSlices
from cutting.tool.edge_table import edge_table
from cutting.voxel.stock import (
    CELLS_A_WORD,
    VoxelStock,
    voxel_advanced,
    voxel_remaining_area,
    voxel_remove_path,
    voxel_stock,
    voxel_wall_profile,
)
from dynamics.modal.modes import Mode, inside_band

#: stock left behind the wall and ahead of the last place of the tool, in radii
_MARGIN = 0.15
#: dexels within the wave that the highest mode leaves and within the thickest chip, and the
#: coarsest spacing, m
_DEXELS_A_WAVE = 24
_COARSEST_DEXEL = 2.5e-5
_DEXELS_A_CHIP = 8
#: voxels within the thickest chip
_VOXELS_A_CHIP = 12
#: arc at which dexels get no finer, rad
_LEAST_ARC = 0.05
#: error of mean forces that are read from voxels, and its part that falls with the square of the
#: cells in the thickest chip
_VOXEL_ERROR, _VOXEL_ERROR_OF_CELLS = 0.01, 1.2
#: feeds per tooth in the radius of an edge below which chips are no longer thin against it: dexels
#: and true trochoids part by 1 % there and by half at two; share of the edge that is let pass
_FEEDS_A_RADIUS, _NARROW_SHARE = 3.0, 0.01
#: coarsest resolution that is taken, as a share of the diameter
_COARSEST_SHARE = 0.02
#: the stock may take this much memory, bytes
_MOST_MEMORY = 4e9
#: steps between two moves of a stock that follows the tool, and the way of the tool between them
#: in radii, at the most
STEPS_A_CHUNK = 20_000
_LONGEST_WAY = 2.0
#: an edge comes no farther from the undisplaced axis than this, in radii
_REACH = 1.25
#: turns that the tool carves at rest before the start of a run without a stock
REVOLUTIONS_BEFORE = 2

Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True)
class DiscreteChip:
    """A kind of discrete workpiece."""

    build: Callable[..., DexelStock | VoxelStock]  # of the module of the workpiece
    remove_path: Callable[..., None]  # of the module of the workpiece
    remaining_area: Callable[..., float]  # of the module of the workpiece
    wall_profile: Callable[..., NDArray[np.float64]]  # of the module of the workpiece
    #: spacing (m) for a case, where it gives none
    resolution: Callable[[Case, Cutter, tuple[Mode, ...]], float]
    #: bytes for a rectangle, a number of layers and a spacing
    memory: Callable[[Rectangle, int, float], float]
    advanced: Callable[..., DexelStock | VoxelStock]  # moves the workpiece along x
    cells_a_move: int  # lines or cells by whose multiples it moves


def _coarsest(case: Case, modes: tuple[Mode, ...]) -> float:
    """Fine enough for the shortest wave, and for the radius."""
    highest = max((mode.frequency for mode in inside_band(modes)), default=0.0)
    speed = 0.5 * case.tool.diameter * case.cut.spindle_speed
    wave = speed / highest if highest else math.inf
    return min(_COARSEST_DEXEL, 0.0025 * case.tool.diameter, wave / _DEXELS_A_WAVE)


def _dexel_spacing(case: Case, cutter: Cutter, modes: tuple[Mode, ...]) -> float:
    """Fine enough for the thickest chip as well, which decides where a short arc ends."""
    return min(_coarsest(case, modes), _thickest_chip(case, cutter) / _DEXELS_A_CHIP)


def _voxel_size(case: Case, _: Cutter, modes: tuple[Mode, ...]) -> float:
    """Fine enough for the chip of a wide cut as well; thinner ones cost too much memory."""
    return min(_coarsest(case, modes), case.cut.feed_per_tooth / _VOXELS_A_CHIP)


def _thickest_chip(case: Case, cutter: Cutter) -> float:
    """Thickest chip of a cut, m; that of a wide one where a stock may be anywhere."""
    if case.stock is not None or case.uncut_band.side == 0:
        return case.cut.feed_per_tooth
    # one that cuts beside its axis has its thickest chip where it is nearest to it
    radius = np.array([outermost_radius(case, cutter)])
    entry, leave = (float(angle[0]) for angle in slice_engagement(case.uncut_band, radius))
    inner = leave if case.uncut_band.side > 0 else math.pi - entry
    return case.cut.feed_per_tooth * math.sin(max(inner, _LEAST_ARC))


def reading_notes(case: Case, cutter: Cutter, cut: DiscreteCut) -> tuple[str, ...]:
    """How well forces are read from a stock; dexels keep to simulation.force_tolerance.

    The error of voxels was measured on rigid cuts over the cells in their thickest chip.
    """
    notes = _tip_notes(case, cut)
    if not isinstance(cut.stock, VoxelStock):
        return notes
    cells = _thickest_chip(case, cutter) / cut.stock.spacing
    error = _VOXEL_ERROR + _VOXEL_ERROR_OF_CELLS / cells**2
    return (
        *notes,
        f"voxel: the thickest chip is {cells:.2g} cells thick; mean forces are read to about "
        f"{100.0 * error:.2g} %",
    )


def _tip_notes(case: Case, cut: DiscreteCut) -> tuple[str, ...]:
    """Note of a tip so narrow that the feed is no small part of its radius."""
    narrow = _FEEDS_A_RADIUS * case.cut.feed_per_tooth
    inner = 0.0
    if case.stock is None and case.uncut_band.side != 0:
        inner = min(border.tangent_radius for border in case.uncut_band.borders)
    inner, outer = max(inner, float(cut.edges.radius.min())), float(cut.edges.radius.max())
    if not inner < narrow < outer:
        return ()
    share = (narrow**2 - inner**2) / (outer**2 - inner**2)
    if share < _NARROW_SHARE:
        return ()
    return (
        f"{case.simulation.chip}: {100.0 * share:.2g} % of the engaged edge, seen along the axis, "
        f"has a radius below {_FEEDS_A_RADIUS:g} feeds per tooth; the chip there is not thin "
        "against the radius, and its thickness is read to some per cent only",
    )


def _dexel_memory(box: Rectangle, layers: int, spacing: float) -> float:
    return 192.0 * layers * max(box[1] - box[0], box[3] - box[2]) / spacing


def _voxel_memory(box: Rectangle, layers: int, size: float) -> float:
    cells = (box[1] - box[0]) * (box[3] - box[2]) / size**2
    # packed, and a few layers at a time as bytes while the stock is shaped
    return layers * cells / 8.0 + 4.0 * cells


#: name in a case file -> workpiece
DISCRETE_CHIPS: dict[str, DiscreteChip] = {
    "dexel": DiscreteChip(
        dexel_stock,
        dexel_remove_path,
        dexel_remaining_area,
        dexel_wall_profile,
        _dexel_spacing,
        _dexel_memory,
        dexel_advanced,
        1,
    ),
    "voxel": DiscreteChip(
        voxel_stock,
        voxel_remove_path,
        voxel_remaining_area,
        voxel_wall_profile,
        _voxel_size,
        _voxel_memory,
        voxel_advanced,
        CELLS_A_WORD,
    ),
}


def discrete_cut(
    case: Case,
    cutter: Cutter,
    slices: EdgeSlices,
    modes: tuple[Mode, ...],
    resolution: Resolution,
    spindle: Spindle | ProgrammedSpindle,
    path: ToolPath | ToolCourse,
) -> DiscreteCut:
    """Cut through a workpiece as it is before the first step.

    InputError if the workpiece would need too much memory.
    """
    kind = DISCRETE_CHIPS[case.simulation.chip]
    size = case.simulation.resolution or kind.resolution(case, cutter, modes)
    ends = (0.0, 0.0)
    if case.stock is None:
        ends = _ends(case, cutter, slices, resolution, spindle, path, size)
    boxes = _boxes(case, slices, ends, size)
    _refuse_too_coarse(case, size)
    _refuse_too_large(case, kind, boxes, size)
    stock = kind.build(boxes, len(slices.height), size, cutter.teeth, _window(case, cutter))
    if case.stock is None:
        _cut_before(kind, stock, slices, case, path)
    return DiscreteCut(
        edges=edge_table(slices, resolution.steps_per_revolution),
        law=edge_law(case),
        flank=flank_table(case, slices.radius, 2.0 * math.pi / resolution.steps_per_revolution),
        stock=stock,
        depth=float(slices.thickness.sum()),
        removed=np.zeros(1),
    )


def _window(case: Case, cutter: Cutter) -> float:
    """Depth from the edge inwards within which material is looked for, m."""
    thickest = case.cut.feed_per_tooth * cutter.teeth * max(cutter.pitch) / (2.0 * math.pi)
    spread = np.ptp(cutter.radial_offsets) + np.ptp(cutter.axial_offsets)
    return 3.0 * thickest + float(spread) + 5e-5


def follows(case: Case, path: ToolPath | ToolCourse) -> bool:
    """Whether the stock moves along with the tool: in a straight cut along x without a stock."""
    if case.stock is not None or isinstance(path, ToolCourse):
        return False
    legs = np.diff(path.corners, axis=0)
    return bool(np.all(legs[:, 0] > 0.0) and np.all(legs[:, 1] == 0.0))


def steps_a_chunk(case: Case, slices: EdgeSlices, resolution: Resolution) -> int:
    """Steps that a stock which follows the tool is long enough for."""
    longest = _LONGEST_WAY * float(slices.radius.max())
    return max(1, min(STEPS_A_CHUNK, int(longest / _feed_a_step(case, resolution))))


def _feed_a_turn(case: Case) -> float:
    return case.cut.feed_per_tooth * case.tool.teeth


def _feed_a_step(case: Case, resolution: Resolution) -> float:
    return _feed_a_turn(case) / resolution.steps_per_revolution


def reach_of(case: Case, cutter: Cutter, slices: EdgeSlices, size: float) -> float:
    """Distance from the path of the tool axis beyond which nothing is cut or read, m."""
    return _REACH * float(slices.radius.max()) + _window(case, cutter) + 4.0 * size


def _ends(
    case: Case,
    cutter: Cutter,
    slices: EdgeSlices,
    resolution: Resolution,
    spindle: Spindle,
    path: ToolPath,
    size: float,
) -> tuple[float, float]:
    """Where the stock of a case without one begins and ends along x, m."""
    far = reach_of(case, cutter, slices, size)
    if not follows(case, path):
        x = _swept(resolution, spindle, path)[0]
        return float(x.min()) - 3.0 * float(slices.radius.max()), float(x.max()) + far
    travel = steps_a_chunk(case, slices, resolution) * _feed_a_step(case, resolution)
    start = float(path.corners[0, 0]) - REVOLUTIONS_BEFORE * _feed_a_turn(case)
    start -= _feed_a_step(case, resolution) + far
    # a stock that moves by whole steps lags behind by up to one
    step = DISCRETE_CHIPS[case.simulation.chip].cells_a_move
    return start, start + (math.ceil((2.0 * far + travel) / size) + step) * size


def _swept(resolution: Resolution, spindle: Spindle, path: ToolPath) -> NDArray[np.float64]:
    """Places (2, n) of the tool axis over the run, m, with all corners between."""
    end = resolution.revolutions * 2.0 * math.pi / spindle.speed
    legs = np.hypot(*np.diff(path.corners, axis=0).T)
    times = np.concatenate([[0.0], np.cumsum(legs) / path.feed, [end]])
    return path.position_at(np.sort(times[times <= end]))


def _boxes(
    case: Case, slices: EdgeSlices, ends: tuple[float, float], size: float
) -> list[list[tuple[Rectangle, bool]]]:
    """Rectangles of every layer: those of the case, else a stock of the radial depth of cut."""
    if case.stock is not None:
        layers = [
            [
                ((*box.x, *box.y), not box.remove)
                for box in case.stock.box
                if box.z[0] <= height < box.z[1]
            ]
            for height in slices.height
        ]
        if not any(adds for layer in layers for _, adds in layer):
            raise InputError(
                f"{case.name}: stock: no box lies at the height of the edge, 0 to "
                f"{units_of(case).length.text(case.cut.axial_depth, 'g')} above the tip at z = 0"
            )
        return layers
    return [
        [((*ends, *_across(case.uncut_band, radius, slices.radius.max(), size)), True)]
        for radius in slices.radius
    ]


def _across(band: UncutBand, radius: float, widest: float, size: float) -> tuple[float, float]:
    """Ends of the stock across the feed at a height where the edge has a radius, m.

    Whole cells, from the border that is within the reach of the tool.
    """
    far = (1.0 + _MARGIN) * widest
    low, high = max(band.lower.at(radius), -far), min(band.upper.at(radius), far)
    height = max(math.ceil((high - low) / size - 1e-9), 1) * size
    if high < far:
        return high - height, high
    return low, low + height


def _refuse_too_coarse(case: Case, size: float) -> None:
    coarsest = _COARSEST_SHARE * case.tool.diameter
    if size > coarsest:
        length = units_of(case).length
        raise InputError(
            f"{case.name}: simulation.resolution: {length.text(size, 'g')} is too coarse for a "
            f"tool of {length.text(case.tool.diameter, 'g')}; at most "
            f"{length.text(coarsest, '.3g')} are allowed"
        )


def _refuse_too_large(
    case: Case, kind: DiscreteChip, boxes: list[list[tuple[Rectangle, bool]]], size: float
) -> None:
    shapes = np.array([shape for layer in boxes for shape, adds in layer if adds])
    low, high = shapes.min(axis=0), shapes.max(axis=0)
    box = (low[0], high[1], low[2], high[3])
    needed = kind.memory(box, len(boxes), size)
    if needed > _MOST_MEMORY:
        raise InputError(
            f"{case.name}: simulation.resolution: {size * 1e6:.3g} um over a stock of "
            f"{(box[1] - box[0]) * 1e3:.3g} by {(box[3] - box[2]) * 1e3:.3g} mm in {len(boxes)} "
            f"layers needs {needed / 1e9:.3g} GB, at most {_MOST_MEMORY / 1e9:g} GB are allowed; "
            f"choose a coarser resolution{' or a smaller stock' if case.stock else ''}"
        )


def _cut_before(
    kind: DiscreteChip,
    stock: DexelStock | VoxelStock,
    slices: EdgeSlices,
    case: Case,
    path: ToolPath,
) -> None:
    """Take away what the tool has cut until the turns before the start."""
    heading = np.diff(path.corners[:2], axis=0)[0]
    heading = heading / np.hypot(*heading)
    end = path.corners[0] - REVOLUTIONS_BEFORE * _feed_a_turn(case) * heading
    start = end - (4.0 * slices.radius.max() + stock.window) * heading
    inner = slices.normal_offset.min(axis=0) / np.sin(slices.immersion)
    for layer, (radius, offset) in enumerate(zip(slices.radius, inner, strict=True)):
        kind.remove_path(stock, layer, *start, *end, radius + offset)
