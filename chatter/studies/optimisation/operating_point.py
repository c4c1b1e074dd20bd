"""Operating point of a cut: speed, depths and feed, written into a case or a compiled model."""

import math
from dataclasses import replace
from typing import NamedTuple

from chatter.description.case import Case
from chatter.description.units import from_rpm, rpm
from chatter.stability.model import MillingModel

#: speeds are whole revolutions a minute above this, lengths whole micrometres
_WHOLE_RPM_ABOVE = 1000.0


class OperatingPoint(NamedTuple):
    """A cut that may be chosen, SI."""

    spindle_speed: float
    axial_depth: float
    radial_depth: float
    feed_per_tooth: float
    removal_rate: float


def rounded(point: OperatingPoint) -> OperatingPoint:
    """Point in numbers that a programmer would write, no depth or feed larger."""
    digits = 0 if rpm(point.spindle_speed) > _WHOLE_RPM_ABOVE else 2
    speed = from_rpm(round(rpm(point.spindle_speed), digits))
    depth, radial_depth = (math.floor(value * 1e6 + 1e-6) * 1e-6 for value in point[1:3])
    return OperatingPoint(
        speed,
        depth if depth > 1e-4 else point.axial_depth,
        radial_depth if radial_depth > 1e-4 else point.radial_depth,
        point.feed_per_tooth,
        point.removal_rate,
    )


def case_with(case: Case, radial_depth: float, feed: float) -> Case:
    """Case with another radial depth and feed per tooth, m."""
    values = {"cut.feed_per_tooth": feed}
    if case.cut.radial_depth is not None:
        values["cut.radial_depth"] = radial_depth
    return case.patch({path: value for path, value in values.items() if value != case.get(path)})


def model_with(model: MillingModel, radial_depth: float, feed: float) -> MillingModel:
    """Model at another radial depth and feed per tooth, m; its structure is not evaluated again."""
    return replace(model, case=case_with(model.case, radial_depth, feed))


def case_at(case: Case, point: OperatingPoint) -> Case:
    """Case with a cut written in."""
    return case_with(case, point.radial_depth, point.feed_per_tooth).patch(
        {"cut.spindle_speed": point.spindle_speed, "cut.axial_depth": point.axial_depth}
    )
