"""[cut]: speed, feed and engagement."""

from typing import Literal

from pydantic import Field, ValidationInfo, field_validator

from chatter.description.quantities import PositiveLength, quantity
from chatter.description.section import Section
from chatter.description.units import rpm

#: no tooth takes a thicker chip, so that a number meant in mm is not taken for one in m
LARGEST_FEED = 0.02

#: no edge and no table moves faster, so that m/min is not taken for m/s
FASTEST_CUT, FASTEST_FEED = 200.0, 5.0


class SpeedVariation(Section):
    """Spindle speed that is made to vary around its mean."""

    amplitude: quantity("number", above=0.0, at_most=0.5) = Field(
        description="share of the mean speed"
    )
    frequency: quantity("frequency", above=0.0)
    shape: Literal["sine", "triangle"] = "sine"


class Cut(Section):
    """The operation: speed, feed and engagement."""

    mode: Literal["up", "down", "slot"]
    spindle_speed: quantity("angular_speed", above=0.0)
    feed_per_tooth: quantity("length", above=0.0, at_most=LARGEST_FEED)
    cutting_speed: quantity("velocity", above=0.0, at_most=FASTEST_CUT) | None = Field(
        None, description="at the diameter of the tool, in place of spindle_speed"
    )
    feed_rate: quantity("velocity", above=0.0, at_most=FASTEST_FEED) | None = Field(
        None, description="of the tool, in place of feed_per_tooth"
    )
    axial_depth: PositiveLength
    radial_depth: PositiveLength | None = Field(
        None, validate_default=True, description="width of cut; a slot is as wide as the tool"
    )

    speed_variation: SpeedVariation | None = None
    cut_time: quantity("time", at_least=0.0) = Field(
        0.0, description="that the tool has cut before, for [wear]"
    )

    @field_validator("radial_depth")
    @classmethod
    def _check_width(cls, given: float | None, info: ValidationInfo) -> float | None:
        mode = info.data.get("mode")
        if given is None and mode in ("up", "down"):
            raise ValueError(
                f'is missing; mode = "{mode}" needs a length, such as radial_depth = "4 mm"'
            )
        return given

    @property
    def spindle_speed_rpm(self) -> float:
        """Spindle speed in revolutions a minute, for output."""
        return rpm(self.spindle_speed)
