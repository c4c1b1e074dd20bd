"""Operating point of a cut: speed, depths and feed, written into a case or a compiled model."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from chatter.description.case import Case
from chatter.description.units import from_rpm, rpm
from chatter.stability.model import MillingModel

#: speeds are whole revolutions a minute above this, lengths whole micrometres
_WHOLE_RPM_ABOVE = 1000.0


class Place(NamedTuple):
    """A cut that may be chosen, SI."""

    spindle_speed: float
    axial_depth: float
    radial_depth: float
    feed_per_tooth: float
    removal_rate: float


def rounded(place: Place) -> Place:
    """Place in numbers that a programmer would write, no depth, width or feed larger."""
    digits = 0 if rpm(place.spindle_speed) > _WHOLE_RPM_ABOVE else 2
    speed = from_rpm(round(rpm(place.spindle_speed), digits))
    depth, width = (math.floor(value * 1e6 + 1e-6) * 1e-6 for value in place[1:3])
    return Place(
        speed,
        depth if depth > 1e-4 else place.axial_depth,
        width if width > 1e-4 else place.radial_depth,
        place.feed_per_tooth,
        place.removal_rate,
    )


def at_width_and_feed(case: Case, width: float, feed: float) -> Case:
    """Case with another radial depth and feed per tooth, m."""
    values = {"cut.feed_per_tooth": feed}
    if case.cut.mode != "slot":
        values["cut.radial_depth"] = width
    return case.patch({path: value for path, value in values.items() if value != case.get(path)})


def model_at(model: MillingModel, width: float, feed: float) -> MillingModel:
    """Model at another radial depth and feed per tooth, m; its structure is not looked at again."""
    return replace(model, case=at_width_and_feed(model.case, width, feed))


def case_at(case: Case, place: Place) -> Case:
    """Case with a cut written in."""
    return at_width_and_feed(case, place.radial_depth, place.feed_per_tooth).patch(
        {"cut.spindle_speed": place.spindle_speed, "cut.axial_depth": place.axial_depth}
    )
