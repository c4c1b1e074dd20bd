"""Search for the highest removal rate: a coarse grid over all that may be chosen, refinement."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from chatter.description.arrays import Array
from chatter.description.progress import Progress, no_progress
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.limits import Limits
from chatter.studies.optimisation.operating_point import OperatingPoint, model_with
from chatter.studies.optimisation.speed_depth_slice import (
    SpeedDepthSlice,
    evaluated_slice,
    removal_rates,
    slice_with,
    with_margins,
)
from chatter.studies.optimisation.stable_depths import stable_depths
from chatter.studies.optimisation.steady_cut import SteadyModel

#: points that are refined, further apart than this share in speed, or this part of the range of
#: radial depths
STARTS, _APART, _APART_IN_RADIAL_DEPTH = 5, 0.05, 0.4
#: refinements, each of a span smaller than the one before
LEVELS = 4
_SHRINK = 0.35
#: first span to either side: depth as a share, the others in steps of the coarse grid
_DEPTH_SPAN, _SPEED_STEPS, _STEPS = 0.5, 2.0, 1.0
#: points of a refinement
_SPEEDS, _DEPTHS, _RADIAL_DEPTHS = 7, 25, 3
#: steps at which stability is evaluated there, a share of the deepest one
_STABILITY_STEP = 0.03


def slices_at_radial_depth(
    model: MillingModel, limits: Limits, radial_depth: float, progress: Progress = no_progress
) -> list[SpeedDepthSlice]:
    """Slices of the coarse grid at one radial depth (m) and every feed.

    `progress` is called with (done, total) speeds of all feeds.
    """
    evaluation_speeds, feeds = limits.extended_speeds(), limits.feeds
    grid_slices: list[SpeedDepthSlice] = []
    for number, feed in enumerate(feeds):
        here = model_with(model, radial_depth, float(feed))
        if grid_slices and not _feed_matters(here):
            stable = grid_slices[0].stable
            grid_slices.append(slice_with(here, limits, limits.speeds, limits.depths, stable))
        else:
            report = _part(progress, number, feeds.size)
            grid_slices.append(
                evaluated_slice(
                    here, limits, limits.speeds, limits.depths, evaluation_speeds, report
                )
            )
    return grid_slices


def _part(progress: Progress, number: int, parts: int) -> Progress:
    """Progress of one of several equal parts."""
    return lambda done, total: progress(number * total + done, parts * total)


def _feed_matters(model: MillingModel) -> bool:
    """Whether stability may depend on the feed.

    Not if every tooth takes the whole of it, at a stiffness that is the same for any chip.
    """
    shallow = float(model.case.cut.axial_depth)
    return not (model.is_uniform and model.cut(shallow).segments.exponent == 0.0)


def best_of(grid_slice: SpeedDepthSlice) -> OperatingPoint | None:
    """Point of a slice with the highest removal rate; None where none keeps all limits."""
    points = _best_of_speeds(grid_slice)
    return max(points, key=lambda point: point.removal_rate, default=None)


def _best_of_speeds(grid_slice: SpeedDepthSlice) -> list[OperatingPoint]:
    rate = np.where(grid_slice.feasible, grid_slice.removal_rate, -1.0)
    rows = rate.argmax(axis=0)
    return [
        _operating_point(grid_slice, row, column)
        for column, row in enumerate(rows)
        if rate[row, column] > 0.0
    ]


def _operating_point(grid_slice: SpeedDepthSlice, row: int, column: int) -> OperatingPoint:
    return OperatingPoint(
        float(grid_slice.speeds[column]),
        float(grid_slice.depths[row]),
        grid_slice.case.width_of_cut,
        grid_slice.case.cut.feed_per_tooth,
        float(grid_slice.removal_rate[row, column]),
    )


def starts_of(grid_slices: Sequence[SpeedDepthSlice]) -> list[OperatingPoint]:
    """Best points of the coarse grid that lie apart in speed or radial depth, best first."""
    points = sorted(
        (point for grid_slice in grid_slices for point in _best_of_speeds(grid_slice)),
        key=lambda point: -point.removal_rate,
    )
    radial_depths = [grid_slice.case.width_of_cut for grid_slice in grid_slices]
    far = _APART_IN_RADIAL_DEPTH * (max(radial_depths) - min(radial_depths))
    chosen: list[OperatingPoint] = []
    for point in points:
        if len(chosen) < STARTS and not any(_near(point, one, far) for one in chosen):
            chosen.append(point)
    return chosen


def _near(point: OperatingPoint, other: OperatingPoint, far: float) -> bool:
    """Whether two operating points lie around the same peak, as far as the coarse grid shows."""
    in_speed = abs(math.log(point.spindle_speed / other.spindle_speed)) <= _APART
    return in_speed and abs(point.radial_depth - other.radial_depth) <= far


def refined(
    model: MillingModel, limits: Limits, start: OperatingPoint, level_done: Callable[[int], None]
) -> OperatingPoint:
    """Best point around a start, on grids that shrink towards it; reports how many are done."""
    best, span = start, 1.0
    for level in range(LEVELS):
        speeds, depths, radial_depths, feeds = _grid_around(best, limits, span)
        for radial_depth in radial_depths:
            for feed in feeds:
                here = model_with(model, float(radial_depth), float(feed))
                best = _better(here, limits, speeds, depths, best)
        level_done(level + 1)
        span *= _SHRINK
    return best


def _better(
    here: MillingModel, limits: Limits, speeds: Array, depths: Array, best: OperatingPoint
) -> OperatingPoint:
    """Best point of a grid at one radial depth and feed if it removes more than the best so far."""
    promising = _promising_depths(here, limits, speeds, depths, best.removal_rate)
    if promising.size == 0:
        return best
    # limits are found between the depths of a grid: fine steps need not be evaluated one by one
    steps = math.ceil(float(np.ptp(promising)) / (_STABILITY_STEP * float(promising[-1])))
    coarser = np.linspace(promising[0], promising[-1], min(promising.size, steps + 1))
    grid = with_margins(coarser, limits.depth_margin)
    stable = stable_depths(
        element_cut(here, float(grid[-1]), wavelengths=limits.wavelengths),
        limits.evaluation_speeds(speeds),
        grid,
    )
    found = best_of(slice_with(here, limits, speeds, promising, stable))
    return found if found is not None and found.removal_rate > best.removal_rate else best


def _promising_depths(
    here: MillingModel, limits: Limits, speeds: Array, depths: Array, rate: float
) -> Array:
    """Depths at which some speed removes more than a rate, m^3/s, with what the spindle has.

    Removal and the mean torque need no look at stability and motion, which cost by far the most.
    """
    more = removal_rates(here, speeds, depths) > rate
    torque = SteadyModel(here, float(speeds[0])).torques(depths)
    most = limits.most
    more &= (torque <= most.get("max_torque", math.inf))[:, None]
    more &= np.outer(torque, speeds) <= most.get("max_power", math.inf)
    rows = np.flatnonzero(more.any(axis=1))
    return depths[rows[0] : rows[-1] + 1] if rows.size else depths[:0]


def _grid_around(
    best: OperatingPoint, limits: Limits, span: float
) -> tuple[Array, Array, Array, Array]:
    ratio = limits.speed_step ** (_SPEED_STEPS * span)
    speeds = _within(best.spindle_speed * np.geomspace(1.0 / ratio, ratio, _SPEEDS), limits.speeds)
    share = _DEPTH_SPAN * span
    depths = _within(
        best.axial_depth * np.linspace(1.0 - share, 1.0 + share, _DEPTHS), limits.depths
    )
    radial_depths = _steps_around(best.radial_depth, limits.radial_depths, span)
    feeds = _steps_around(best.feed_per_tooth, limits.feeds, span)
    return speeds, depths, radial_depths, feeds


def _steps_around(middle: float, grid: Array, span: float) -> Array:
    if grid.size == 1:
        return grid
    step = _STEPS * span * float(grid[1] - grid[0])
    return _within(middle + np.linspace(-step, step, _RADIAL_DEPTHS), grid)


def _within(values: Array, grid: Array) -> Array:
    return np.unique(np.clip(values, grid[0], grid[-1]))
