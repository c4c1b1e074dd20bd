"""Operating point of a cut: speed, depths and feed, written into a case or a compiled model."""

import math
from dataclasses import replace
from typing import NamedTuple

from chatter.description.case import Case
from chatter.description.unit_system import INCH, units_of
from chatter.description.units import from_rpm, rpm
from chatter.description.usual_units import UsualUnit
from chatter.stability.model import MillingModel

#: speeds are whole revolutions a minute above this, lengths whole micrometres
_WHOLE_RPM_ABOVE = 1000.0
#: step of a depth in inches, m, a tenth of a thou; and in metric units
_TENTH, _MICROMETRE = 2.54e-6, 1e-6
#: relative difference of a feed that is none: of what the text of a case rounds
_SAME_FEED = 1e-9


class OperatingPoint(NamedTuple):
    """A cut that may be chosen, SI."""

    spindle_speed: float
    axial_depth: float
    radial_depth: float
    feed_per_tooth: float
    removal_rate: float


def step_of_depths(case: Case) -> float:
    """Step, m, of depths that people of a case write."""
    return _TENTH if units_of(case) is INCH else _MICROMETRE


def rounded(point: OperatingPoint, step: float) -> OperatingPoint:
    """Point in numbers that a programmer would write: whole steps, m, and no depth larger."""
    digits = 0 if rpm(point.spindle_speed) > _WHOLE_RPM_ABOVE else 2
    speed = from_rpm(round(rpm(point.spindle_speed), digits))
    depth, radial_depth = (math.floor(value / step + 1e-6) * step for value in point[1:3])
    return OperatingPoint(
        speed,
        depth if depth > 1e-4 else point.axial_depth,
        radial_depth if radial_depth > 1e-4 else point.radial_depth,
        point.feed_per_tooth,
        point.removal_rate,
    )


def case_with(case: Case, radial_depth: float, feed: float) -> Case:
    """Case with another radial depth and feed per tooth, m."""
    case = with_feed_per_tooth(case, feed)
    if case.cut.radial_depth is None or radial_depth == case.cut.radial_depth:
        return case
    return case.patch({"cut.radial_depth": radial_depth})


def with_feed_per_tooth(case: Case, feed: float) -> Case:
    """Case with a feed per tooth, m, whatever rate of the feed it states at another speed."""
    if math.isclose(feed, case.cut.feed_per_tooth, rel_tol=_SAME_FEED):
        return case
    stated = _as_stated(case, "feed_per_tooth", feed, units_of(case).length)
    return case.patch({"cut.feed_per_tooth": stated})


def model_with(model: MillingModel, radial_depth: float, feed: float) -> MillingModel:
    """Model at another radial depth and feed per tooth, m; its structure is not evaluated again."""
    return replace(model, case=case_with(model.case, radial_depth, feed))


def case_at(case: Case, point: OperatingPoint) -> Case:
    """Case with a cut written in.

    The feed per tooth comes last: a case that states the rate of the feed has another at each
    speed.
    """
    speed = _as_stated(case, "spindle_speed", point.spindle_speed, UsualUnit("rpm", rpm(1.0)))
    at = case.patch({"cut.spindle_speed": speed, "cut.axial_depth": point.axial_depth})
    return case_with(at, point.radial_depth, point.feed_per_tooth)


def _as_stated(case: Case, key: str, value: float, unit: UsualUnit) -> float | str:
    """Value for the unit that the key of [cut] has in a case; with its own where it has none."""
    stated = case.stated.get("cut", {})
    return value if key in stated else f"{value * unit.factor:.10g} {unit.name}"
