"""Search for the highest removal rate: a coarse net over all that may be chosen, refinement."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.best_cut.limits import Limits
from chatter.best_cut.sheet import Sheet, model_at, sheet_of
from chatter.model import MillingModel

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

_RPM = 30.0 / math.pi
#: speeds are whole revolutions a minute above this, lengths whole micrometres
_WHOLE_RPM_ABOVE = 1000.0


class Place(NamedTuple):
    """A cut that may be chosen, SI."""

    spindle_speed: float
    axial_depth: float
    radial_depth: float
    feed_per_tooth: float
    removal_rate: float


def coarse_sheets(
    model: MillingModel, limits: Limits, sheet_done: Callable[[], None]
) -> list[Sheet]:
    """Sheets at every width and feed of the coarse net, width by width."""
    looked_at = limits.looked_at_beyond()
    sheets = []
    for width in limits.widths:
        for feed in limits.feeds:
            here = model_at(model, float(width), float(feed))
            sheets.append(sheet_of(here, limits, limits.speeds, limits.depths, looked_at))
            sheet_done()
    return sheets


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
    model: MillingModel, limits: Limits, start: Place, sheet_done: Callable[[], None]
) -> Place:
    """Best place around a start, on nets that shrink towards it."""
    best, span = start, 1.0
    for _ in range(LEVELS):
        found = []
        speeds, depths, widths, feeds = _net_around(best, limits, span)
        for width in widths:
            for feed in feeds:
                here = model_at(model, float(width), float(feed))
                looked_at = limits.looked_at(speeds)
                found.append(best_of(sheet_of(here, limits, speeds, depths, looked_at)))
        sheet_done()
        known = [place for place in found if place is not None]
        best = max([best, *known], key=lambda place: place.removal_rate)
        span *= _SHRINK
    return best


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


def rounded(place: Place) -> Place:
    """Place in numbers that a programmer would write, no depth, width or feed larger."""
    digits = 0 if place.spindle_speed * _RPM > _WHOLE_RPM_ABOVE else 2
    speed = round(place.spindle_speed * _RPM, digits) / _RPM
    depth, width = (math.floor(value * 1e6 + 1e-6) * 1e-6 for value in place[1:3])
    return Place(
        speed,
        depth if depth > 1e-4 else place.axial_depth,
        width if width > 1e-4 else place.radial_depth,
        place.feed_per_tooth,
        place.removal_rate,
    )
