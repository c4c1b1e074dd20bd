"""[tool]: geometry of the cutter."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from chatter.case.base import Section, raise_if_any
from chatter.case.quantities import (
    Length,
    PositiveLength,
    QuantityField,
    quantity,
    shown,
    whole_number,
)

_HELIX = QuantityField("angle", above=-0.5 * math.pi, below=0.5 * math.pi)
_PITCH = QuantityField("angle", above=0.0)
#: the pitch angles must make a turn to within this, rad
_TURN_TOLERANCE = math.radians(0.01)


def _angle_or_list(given: Any) -> float | tuple[float, ...]:
    if isinstance(given, (list, tuple)):
        return tuple(_HELIX.read(angle) for angle in given)
    return _HELIX.read(given)


def _list_of_angles(given: Any) -> tuple[float, ...]:
    if not isinstance(given, (list, tuple)):
        raise ValueError(
            f'{shown(given)} is no list; a list of angles is wanted, such as ["90 deg", ...]'
        )
    return tuple(_PITCH.read(angle) for angle in given)


HelixAngles = Annotated[
    float | tuple[float, ...],
    BeforeValidator(_angle_or_list),
    WithJsonSchema(
        {
            "anyOf": [
                *_HELIX.json_schema()["anyOf"],
                {"type": "array", "items": {"anyOf": _HELIX.json_schema()["anyOf"]}},
            ],
            "description": 'one angle, or one for each flute, such as "30 deg"',
        }
    ),
]
PitchAngles = Annotated[
    tuple[float, ...],
    BeforeValidator(_list_of_angles),
    WithJsonSchema(
        {
            "type": "array",
            "items": {"anyOf": _PITCH.json_schema()["anyOf"]},
            "description": "angle from each tooth to the next; they make a turn",
        }
    ),
]


class Runout(Section):
    """Offset of the tool axis from the spindle axis."""

    offset: Length = Field(description="radial offset")
    angle: quantity("angle") = Field(0.0, description="direction of the offset on the tool")


class Tool(Section):
    """Cutter geometry; lengths in m, angles in rad."""

    kind: Literal["end mill", "ball", "bull nose", "taper", "inserted"] = "end mill"
    teeth: whole_number(1, 200, "numbers of teeth")
    diameter: PositiveLength
    helix: HelixAngles = 0.0
    pitch: PitchAngles | None = None
    runout: Runout | None = None
    corner_radius: Length = 0.0
    edge_radius: Length = 0.0
    taper_angle: quantity("angle", at_least=0.0, below=0.5 * math.pi) = 0.0

    @model_validator(mode="after")
    def _check_geometry(self) -> Tool:
        problems = []
        if isinstance(self.helix, tuple) and len(self.helix) != self.teeth:
            problems.append(
                ("helix", f"{len(self.helix)} angles for {self.teeth} teeth; give one a flute")
            )
        if self.pitch is not None and len(self.pitch) != self.teeth:
            problems.append(
                ("pitch", f"{len(self.pitch)} angles for {self.teeth} teeth; give one a tooth")
            )
        elif self.pitch is not None and abs(sum(self.pitch) - 2.0 * math.pi) > _TURN_TOLERANCE:
            total = math.degrees(sum(self.pitch))
            problems.append(("pitch", f"the angles add up to {total:g} deg, not to 360 deg"))
        radius = 0.5 * self.diameter
        if self.corner_radius > radius * (1.0 + 1e-12):
            problems.append(
                (
                    "corner_radius",
                    f"{self.corner_radius * 1e3:g} mm is more than the radius of the tool, "
                    f"{radius * 1e3:g} mm",
                )
            )
        if self.edge_radius >= radius:
            problems.append(("edge_radius", "is not smaller than the radius of the tool"))
        raise_if_any(problems)
        return self
