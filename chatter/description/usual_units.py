"""Units that people read quantities of a case in."""

from __future__ import annotations

import math
from typing import NamedTuple

from pydantic import BaseModel

from chatter.description.path import field_at, parse_path
from chatter.description.units import DIMENSIONS, rpm


class UsualUnit(NamedTuple):
    """A unit and the number of it in one of SI."""

    name: str
    factor: float

    def text(self, value: float, form: str = ".4g") -> str:
        """Value, SI, in the unit, and its name."""
        return f"{value * self.factor:{form}} {self.name}"


_USUAL = {
    "length": UsualUnit("mm", 1e3),
    "angular_speed": UsualUnit("rpm", rpm(1.0)),
    "angle": UsualUnit("deg", 180.0 / math.pi),
    "line_force": UsualUnit("N/mm", 1e-3),
    "pressure": UsualUnit("MPa", 1e-6),
    "stiffness": UsualUnit("N/um", 1e-6),
}


def usual_unit(kind: type[BaseModel], path: str) -> UsualUnit:
    """Unit of the quantity at a path of a case or machine; without a name for a plain number."""
    field = field_at(kind, parse_path(path))
    if field is None:
        return UsualUnit("", 1.0)
    return of_dimension(field.dimension)


def of_dimension(dimension: str) -> UsualUnit:
    """Unit that people read a dimension in, a key of `DIMENSIONS`."""
    return _USUAL.get(dimension, UsualUnit(DIMENSIONS[dimension].unit, 1.0))
