"""[cut]: speed, feed and engagement."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field, model_validator

from chatter.description.quantities import PositiveLength, quantity
from chatter.description.section import Section, raise_if_any
from chatter.description.units import rpm

#: no tooth takes a thicker chip, so that a number meant in mm is not taken for one in m
LARGEST_FEED = 0.02

#: no edge and no table moves faster, so that m/min is not taken for m/s
FASTEST_CUT, FASTEST_FEED = 200.0, 5.0

#: ways to state the engagement, each by its keys
ENGAGEMENTS = (
    ("radial_depth",),
    ("stepover",),
    ("workpiece_width", "tool_offset"),
    ("entry_angle", "exit_angle"),
)
ENGAGEMENTS_OF_MODE = {
    "up": ENGAGEMENTS[:2],
    "down": ENGAGEMENTS[:2],
    "slot": ENGAGEMENTS[:1],
    "face": ENGAGEMENTS[2:],
}
_BESIDE = 'mode = "{}" needs a length, such as radial_depth = "4 mm", or a stepover'
_NEEDED = {
    "up": _BESIDE.format("up"),
    "down": _BESIDE.format("down"),
    "slot": "a slot is as wide as the tool",
    "face": 'mode = "face" needs workpiece_width and may have tool_offset, or it needs entry_angle '
    "and exit_angle",
}


class SpeedVariation(Section):
    """Spindle speed that is made to vary around its mean."""

    amplitude: quantity("number", above=0.0, at_most=0.5) = Field(
        description="share of the mean speed"
    )
    frequency: quantity("frequency", above=0.0)
    shape: Literal["sine", "triangle"] = "sine"


class Cut(Section):
    """The operation: speed, feed and engagement."""

    mode: Literal["up", "down", "slot", "face"]
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
        None,
        description="from the wall at the full radius, or in % of the diameter; a slot is as wide "
        "as the tool",
    )
    stepover: PositiveLength | None = Field(
        None,
        description="from the pass before, which left what is cut, in place of radial_depth; also "
        "in % of the diameter",
    )
    workpiece_width: PositiveLength | None = Field(
        None, description="across the feed, of a workpiece that the tool may overhang"
    )
    tool_offset: quantity("length") | None = Field(
        None, description="of the tool axis from the middle of the workpiece, towards +y"
    )
    entry_angle: quantity("angle", at_least=0.0, below=math.pi) | None = Field(
        None, description="of a tooth at the full radius, clockwise from +y, where feed is along +x"
    )
    exit_angle: quantity("angle", above=0.0, at_most=math.pi) | None = None
    lead: quantity("angle", above=-0.5 * math.pi, below=0.5 * math.pi) = Field(
        0.0, description="of the tool axis from the normal of the surface, towards the feed"
    )
    tilt: quantity("angle", above=-0.5 * math.pi, below=0.5 * math.pi) = Field(
        0.0, description="of the tool axis from the normal of the surface, towards +y"
    )
    speed_variation: SpeedVariation | None = None
    cut_time: quantity("time", at_least=0.0) = Field(
        0.0, description="that the tool has cut before, for [wear]"
    )

    @model_validator(mode="before")
    @classmethod
    def _read_mode(cls, data: Any) -> Any:
        """Take a cut stated by the place of the workpiece or by angles for a face-milling one."""
        if not isinstance(data, Mapping) or data.get("mode") is not None:
            return data
        stated = any(data.get(key) is not None for keys in ENGAGEMENTS[2:] for key in keys)
        return {**data, "mode": "face"} if stated else data

    @model_validator(mode="after")
    def _check_engagement(self) -> Cut:
        raise_if_any(self._mode_problems() + self._angle_problems())
        return self

    def _mode_problems(self) -> list[tuple[str, str]]:
        stated = [
            keys for keys in ENGAGEMENTS if any(getattr(self, key) is not None for key in keys)
        ]
        if len(stated) > 1:
            first, second = (
                next(k for k in keys if getattr(self, k) is not None) for keys in stated[:2]
            )
            return [(second, f"cut.{first} is given as well; the engagement is stated in one way")]
        allowed = ENGAGEMENTS_OF_MODE[self.mode]
        if stated and stated[0] not in allowed:
            key = next(key for key in stated[0] if getattr(self, key) is not None)
            return [(key, f'does not belong to mode = "{self.mode}"; {_NEEDED[self.mode]}')]
        if not stated and self.mode != "slot":
            return [(allowed[0][0], f"is missing; {_NEEDED[self.mode]}")]
        if stated and self.tool_offset is not None and self.workpiece_width is None:
            return [("workpiece_width", "is missing; tool_offset counts from its middle")]
        return []

    def _angle_problems(self) -> list[tuple[str, str]]:
        entry, leave = self.entry_angle, self.exit_angle
        if (entry is None) != (leave is None):
            missing, other = ("entry_angle", "exit_angle")[:: 1 if entry is None else -1]
            return [(missing, f"is missing; {other} needs it")]
        if entry is not None and not entry < leave:
            text = (
                f"{math.degrees(leave):g} deg is not above entry_angle, {math.degrees(entry):g} deg"
            )
            return [("exit_angle", text)]
        return []

    @property
    def spindle_speed_rpm(self) -> float:
        """Spindle speed in revolutions a minute, for output."""
        return rpm(self.spindle_speed)
