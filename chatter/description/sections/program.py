"""[simulation.program]: an NC program, or recorded set points, that the tool follows in a cut."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from chatter.description.file_name import FileName
from chatter.description.quantities import QuantityField, list_reader, list_type, quantity
from chatter.description.section import Section, raise_if_any

_COORDINATE = QuantityField("length", above=-100.0, below=100.0)
_WANTED = 'is not a point; x, y and perhaps z are required: ["0 mm", "5 mm"]'
_SpacePoint = list_type(
    tuple[float, ...], list_reader(_COORDINATE, _WANTED, 2, 3), _COORDINATE, fewest=2, most=3
)
#: keys of a program alone
_OF_PROGRAMS = ("start", "velocity", "acceleration", "jerk", "tolerance")


class Program(Section):
    """Path, feed and spindle speed of a cut, by an NC program or by recorded set points."""

    kind: Literal["nc program", "recorded"] = "nc program"
    file: FileName = Field(
        description="NC program, or a record with time, X, Y and perhaps Z", examples=["part.nc"]
    )
    start: _SpacePoint = Field(
        (0.0, 0.0), description="where the tool stands before the program, in its coordinates"
    )
    velocity: quantity("velocity", above=0.0) = Field(
        0.5, description="of rapid traverse, and the largest of all"
    )
    acceleration: quantity("acceleration", above=0.0) = Field(5.0, description="along the path")
    jerk: quantity("jerk", above=0.0) = Field(200.0, description="along the path")
    tolerance: quantity("length", above=0.0) | None = Field(
        None, description="by which corners may be rounded; exact by default, with a stop"
    )

    @model_validator(mode="after")
    def _check(self) -> Program:
        given = self.model_fields_set & set(_OF_PROGRAMS)
        if self.kind == "recorded" and given:
            text = 'is of an NC program; kind = "recorded" has its times in the file'
            raise_if_any([(key, text) for key in _OF_PROGRAMS if key in given])
        return self
