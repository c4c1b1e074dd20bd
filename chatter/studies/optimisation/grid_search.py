"""Search for the highest removal rate: a coarse net over all that may be chosen, refinement."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress, no_progress
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.limits import Limits
from chatter.studies.optimisation.operating_point import Place, model_at
from chatter.studies.optimisation.speed_depth_slice import (
    Sheet,
    removal_rates,
    sheet_of,
    sheet_with,
    with_margins,
)
from chatter.studies.optimisation.stable_depths import StableDepths, stable_depths
from chatter.studies.optimisation.steady_cut import SteadyModel

Array = NDArray[np.float64]

#: places that are refined, further apart than this share in speed, or this part of all widths
STARTS, _APART, _APART_IN_WIDTH = 5, 0.05, 0.4
#: refinements, each of a span smaller than the one before
LEVELS = 4
_SHRINK = 0.35
#: first span to either side: depth as a share, speed, width and feed in steps of the coarse net
_DEPTH_SPAN, _SPEED_STEPS, _STEPS = 0.5, 2.0, 1.0
#: points of a refinement
_SPEEDS, _DEPTHS, _WIDTHS = 7, 25, 3
#: steps at which stability is looked at there, a share of the deepest depth
_STABILITY_STEP = 0.03


def sheets_of_width(
    model: MillingModel, limits: Limits, width: float, progress: Progress = no_progress
) -> list[Sheet]:
    """Sheets of the coarse net at one width and every feed.

    Parameters
    ----------
    model : MillingModel
    limits : Limits
    width : float
        m.
    progress : callable, optional
        Called with (done, total) speeds of all feeds.
    """
    looked_at, feeds = limits.looked_at_beyond(), limits.feeds
    sheets: list[Sheet] = []
    for number, feed in enumerate(feeds):
        here = model_at(model, width, float(feed))
        if sheets and not _feed_matters(here):
            sheets.append(_same_stability(here, limits, sheets[0].stable))
        else:
            told = _part(progress, number, feeds.size)
            sheets.append(sheet_of(here, limits, limits.speeds, limits.depths, looked_at, told))
    return sheets


def _same_stability(model: MillingModel, limits: Limits, stable: StableDepths) -> Sheet:
    return sheet_with(model, limits, limits.speeds, limits.depths, stable)


def _part(progress: Progress, number: int, parts: int) -> Progress:
    """Progress of one of several equal parts."""
    return lambda done, total: progress(number * total + done, parts * total)


def _feed_matters(model: MillingModel) -> bool:
    """Whether stability may depend on the feed.

    Not if every tooth takes the whole of it, at a stiffness that is the same for any chip.
    """
    shallow = float(model.case.cut.axial_depth)
    return not (model.is_uniform and model.cut(shallow).segments.exponent == 0.0)


def best_of(sheet: Sheet) -> Place | None:
    """Place of a sheet with the highest removal rate; None where none keeps all limits."""
    places = _best_of_speeds(sheet)
    return max(places, key=lambda place: place.removal_rate, default=None)


def _best_of_speeds(sheet: Sheet) -> list[Place]:
    rate = np.where(sheet.feasible, sheet.removal_rate, -1.0)
    rows = rate.argmax(axis=0)
    return [
        _place(sheet, row, column) for column, row in enumerate(rows) if rate[row, column] > 0.0
    ]


def _place(sheet: Sheet, row: int, column: int) -> Place:
    return Place(
        float(sheet.speeds[column]),
        float(sheet.depths[row]),
        sheet.case.width_of_cut,
        sheet.case.cut.feed_per_tooth,
        float(sheet.removal_rate[row, column]),
    )


def starts_of(sheets: Sequence[Sheet]) -> list[Place]:
    """Best places of the coarse net that lie apart in speed or width, best first."""
    places = sorted(
        (place for sheet in sheets for place in _best_of_speeds(sheet)),
        key=lambda place: -place.removal_rate,
    )
    widths = [sheet.case.width_of_cut for sheet in sheets]
    far = _APART_IN_WIDTH * (max(widths) - min(widths))
    chosen: list[Place] = []
    for place in places:
        if len(chosen) < STARTS and not any(_near(place, one, far) for one in chosen):
            chosen.append(place)
    return chosen


def _near(place: Place, other: Place, far: float) -> bool:
    """Whether two places lie around the same peak, as far as the coarse net tells."""
    in_speed = abs(math.log(place.spindle_speed / other.spindle_speed)) <= _APART
    return in_speed and abs(place.radial_depth - other.radial_depth) <= far


def refined(
    model: MillingModel, limits: Limits, start: Place, level_done: Callable[[int], None]
) -> Place:
    """Best place around a start, on nets that shrink towards it; tells how many are done."""
    best, span = start, 1.0
    for level in range(LEVELS):
        speeds, depths, widths, feeds = _net_around(best, limits, span)
        for width in widths:
            for feed in feeds:
                here = model_at(model, float(width), float(feed))
                best = _better(here, limits, speeds, depths, best)
        level_done(level + 1)
        span *= _SHRINK
    return best


def _better(here: MillingModel, limits: Limits, speeds: Array, depths: Array, best: Place) -> Place:
    """Best place of a net at one width and feed if it removes more than the best so far."""
    worth = _worth_a_look(here, limits, speeds, depths, best.removal_rate)
    if worth.size == 0:
        return best
    # limits are found between the depths of a net: fine steps need not be looked at one by one
    coarser = np.linspace(worth[0], worth[-1], min(worth.size, _steps_in(worth) + 1))
    net = with_margins(coarser, limits.depth_margin)
    stable = stable_depths(
        element_cut(here, float(net[-1]), wavelengths=limits.waves), limits.looked_at(speeds), net
    )
    found = best_of(sheet_with(here, limits, speeds, worth, stable))
    return found if found is not None and found.removal_rate > best.removal_rate else best


def _steps_in(depths: Array) -> int:
    return math.ceil(float(np.ptp(depths)) / (_STABILITY_STEP * float(depths[-1])))


def _worth_a_look(
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


def _net_around(best: Place, limits: Limits, span: float) -> tuple[Array, Array, Array, Array]:
    ratio = limits.speed_step ** (_SPEED_STEPS * span)
    speeds = _within(best.spindle_speed * np.geomspace(1.0 / ratio, ratio, _SPEEDS), limits.speeds)
    share = _DEPTH_SPAN * span
    depths = _within(
        best.axial_depth * np.linspace(1.0 - share, 1.0 + share, _DEPTHS), limits.depths
    )
    widths = _steps_around(best.radial_depth, limits.widths, span)
    feeds = _steps_around(best.feed_per_tooth, limits.feeds, span)
    return speeds, depths, widths, feeds


def _steps_around(middle: float, net: Array, span: float) -> Array:
    if net.size == 1:
        return net
    step = _STEPS * span * float(net[1] - net[0])
    return _within(middle + np.linspace(-step, step, _WIDTHS), net)


def _within(values: Array, net: Array) -> Array:
    return np.unique(np.clip(values, net[0], net[-1]))
