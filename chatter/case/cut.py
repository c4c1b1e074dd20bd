"""[cut]: speed, feed and engagement."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from chatter.case.base import Section, raise_if_any
from chatter.case.quantities import PositiveLength, quantity


class Cut(Section):
    """The operation: spindle speed in rad/s, lengths in m."""

    mode: Literal["up", "down", "slot"]
    spindle_speed: quantity("angular_speed", above=0.0)
    feed_per_tooth: PositiveLength
    axial_depth: PositiveLength
    radial_depth: PositiveLength | None = Field(
        None, description="width of cut; a slot is as wide as the tool"
    )

    @model_validator(mode="after")
    def _check_width(self) -> Cut:
        missing = self.radial_depth is None and self.mode != "slot"
        raise_if_any(
            [("radial_depth", f'is missing; mode = "{self.mode}" needs it')] if missing else []
        )
        return self
