"""[optimum] and [pitch_design]: what a search may change, and what it must keep within."""

from typing import ClassVar, Literal

from pydantic import Field

from chatter.description.bare_numbers import LEAST_POWER
from chatter.description.quantities import PositiveLength, quantity, whole_number
from chatter.description.section import Section
from chatter.description.sections.cut import LARGEST_FEED
from chatter.description.sections.process import Range, SpeedBand

_MOST_VALUES = 200
Values = whole_number(2, _MOST_VALUES, "counts")


class AxialDepths(Range):
    """Axial depths that may be chosen."""

    EXAMPLE: ClassVar[str] = "1..5 mm:60"
    from_: PositiveLength | None = Field(None, alias="from")
    count: Values = Field(60, description="depths of the coarse grid")


class RadialDepths(Range):
    """Radial depths that may be chosen."""

    EXAMPLE: ClassVar[str] = "1..8 mm:8"
    count: Values = Field(8, description="radial depths of the coarse grid")


class Feeds(Range):
    """Feeds per tooth that may be chosen."""

    EXAMPLE: ClassVar[str] = "0.05..0.2 mm:4"
    from_: quantity("length", above=0.0, at_most=LARGEST_FEED) = Field(alias="from")
    to: quantity("length", above=0.0, at_most=LARGEST_FEED)
    count: Values = Field(4, description="feeds of the coarse grid")


Margin = quantity("number", at_least=0.0, at_most=0.5)
#: what is more than 10 mm is no limit of a tool but one in another unit
Deflection = quantity("length", above=0.0, at_most=10e-3)


class Optimum(Section):
    """What the search for the highest removal rate may choose, and its limits."""

    speeds: SpeedBand | None = Field(None, description="by default those of the lobe diagram")
    depths: AxialDepths | None = Field(None, description="by default those of the lobe diagram")
    radial_depths: RadialDepths | None = Field(None, description="by default that of the cut alone")
    feeds: Feeds | None = Field(None, description="by default that of the cut alone")
    max_power: quantity("power", at_least=LEAST_POWER) | None = Field(
        None, description="of the spindle, mean over a revolution"
    )
    max_torque: quantity("torque", above=0.0) | None = Field(
        None, description="of the spindle, mean over a revolution"
    )
    max_deflection: Deflection | None = Field(
        None, description="of the tool point against the work, largest within a revolution"
    )
    max_surface_error: Deflection | None = Field(
        None, description="location of the wall, largest over its height, either way"
    )
    min_tool_life: quantity("time", above=0.0) | None = Field(
        None, description="cutting time that the edge must last, by [tool_life]"
    )
    confidence: quantity("number", at_least=0.5, below=1.0) = Field(
        0.95, description="probability of stability, where values of the case are uncertain"
    )
    depth_margin: Margin | None = Field(
        None, description="share of the critical depth kept free; 0.15 by default"
    )
    speed_margin: Margin | None = Field(
        None, description="share by which the speed may be off; 0.015 by default"
    )


class PitchDesign(Section):
    """Search for pitch angles over a range of speeds."""

    speeds: SpeedBand | None = Field(None, description="by default those of the lobe diagram")
    count: Values = Field(20, description="speeds at which the limit is computed")
    depths: AxialDepths | None = Field(None, description="to which the limit is looked for")
    max_pitch_ratio: quantity("number", above=1.0, at_most=2.0) = Field(
        1.25, description="of a tooth, in units of the mean; no pitch is smaller than 2 less this"
    )
    goal: Literal["lowest limit", "removal rate"] = Field(
        "lowest limit",
        description="the lowest limit over all speeds, or the highest removal rate within the "
        "margins of depth and speed",
    )
