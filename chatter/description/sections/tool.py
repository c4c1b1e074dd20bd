"""[tool]: geometry of the cutter."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Field,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from chatter.description.quantities import (
    Length,
    PositiveLength,
    QuantityField,
    list_reader,
    list_type,
    quantity,
    whole_number,
)
from chatter.description.section import Section, raise_if_any

_HELIX = QuantityField("angle", above=-0.5 * math.pi, below=0.5 * math.pi)
_PITCH = QuantityField("angle", above=0.0)
_ERROR = QuantityField("length", above=-0.1, below=0.1)
#: the pitch angles must make a turn to within this, rad
#: of a worn flank, m; the usual end of life is 0.3 mm (ISO 8688-2)
_LONGEST_LAND = 10e-3
_TURN_TOLERANCE = math.radians(0.01)


def _angle_or_list(given: Any) -> float | tuple[float, ...]:
    if isinstance(given, (list, tuple)):
        return tuple(_HELIX.read(angle) for angle in given)
    return _HELIX.read(given)


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
    _HELIX,
]
PitchAngles = list_type(
    tuple[float, ...],
    list_reader(_PITCH, 'is not a list; a list of angles is required, such as ["90 deg", ...]'),
    _PITCH,
    "angle from each tooth to the next; they make a revolution",
)
ToothErrors = list_type(
    tuple[float, ...],
    list_reader(
        _ERROR, 'is not a list; one length for each tooth is required, such as ["5 um", ...]'
    ),
    _ERROR,
    "deviation of each tooth, positive outwards",
)


class SerrationSection(Section):
    """Sinusoidal wave of the edge along the axis, shifted by 1/teeth of a wave each tooth."""

    depth: PositiveLength = Field(description="crest to valley")
    wavelength: PositiveLength


class Runout(Section):
    """Offset of the tool axis from the spindle axis."""

    offset: Length = Field(description="radial offset")
    angle: quantity("angle") = Field(0.0, description="direction of the offset on the tool")


class Tool(Section):
    """Cutter geometry; lengths in m, angles in rad."""

    kind: Literal["end mill", "ball", "bull nose", "taper", "inserted"] = "end mill"
    teeth: whole_number(1, 200, "numbers of teeth") = Field(examples=[4])
    diameter: PositiveLength
    helix: HelixAngles = 0.0
    pitch: PitchAngles | None = None
    runout: Runout | None = None
    corner_radius: Length = 0.0
    edge_radius: Length = 0.0
    taper_angle: quantity("angle", at_least=0.0, below=0.5 * math.pi) = Field(
        0.0, description="of the envelope against the axis"
    )
    cutting_edge_angle: quantity("angle", above=0.0, at_most=0.5 * math.pi) = Field(
        0.5 * math.pi, description="of an insert against the plane of the feed; 90 deg for a wall"
    )
    radial_error: ToothErrors | None = None
    axial_error: ToothErrors | None = None
    serration: SerrationSection | None = None
    clearance_angle: quantity("angle", above=0.0, below=0.5 * math.pi) | None = Field(
        None, description="of the flank; ploughing needs it"
    )
    flank_wear: quantity("length", at_least=0.0, at_most=_LONGEST_LAND) = Field(
        0.0, description="length of the worn land"
    )
    flute_length: PositiveLength | None = Field(
        None, description="of the cutting edges along the axis; no cut is deeper"
    )
    stick_out: PositiveLength | None = Field(
        None, description="of the tool from its holder; no cut is deeper"
    )
    shank_diameter: PositiveLength | None = Field(
        None, description="above the flutes; the diameter by default"
    )
    maximum_depth: PositiveLength | None = Field(
        None, description="axial depth that its maker allows; no cut is deeper"
    )

    @property
    def depth_that_tool_allows(self) -> float:
        """Axial depth that no cut exceeds, m; inf where the tool says nothing."""
        return min((depth for depth, _ in self._depths()), default=math.inf)

    @property
    def limiting_length(self) -> str:
        """Key of the shortest of the lengths that limit the depth; empty where there is none."""
        return min(self._depths(), default=(0.0, ""))[1]

    def _depths(self) -> list[tuple[float, str]]:
        keys = ("flute_length", "stick_out", "maximum_depth")
        return [(length, key) for key in keys if (length := getattr(self, key)) is not None]

    @field_validator("helix", "pitch", "radial_error", "axial_error")
    @classmethod
    def _check_count(cls, given: Any, info: ValidationInfo) -> Any:
        teeth = info.data.get("teeth")
        if isinstance(given, tuple) and teeth is not None and len(given) != teeth:
            what = "lengths" if info.field_name.endswith("error") else "angles"
            raise ValueError(f"{len(given)} {what} for {teeth} teeth; give one for each tooth")
        return given

    @field_validator("pitch")
    @classmethod
    def _check_turn(cls, given: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if given is not None and abs(sum(given) - 2.0 * math.pi) > _TURN_TOLERANCE:
            total = math.degrees(sum(given))
            raise ValueError(f"the angles add up to {total:g} deg, not to 360 deg")
        return given

    @field_validator("corner_radius", "edge_radius")
    @classmethod
    def _check_radius(cls, given: float, info: ValidationInfo) -> float:
        diameter = info.data.get("diameter")
        if diameter is not None and given > 0.5 * diameter * (1.0 + 1e-9):
            raise ValueError(
                f"{given * 1e3:g} mm is more than the radius of the tool, {diameter * 500.0:g} mm"
            )
        return given

    @model_validator(mode="after")
    def _check_kind(self) -> Tool:
        problems = []
        if self.cutting_edge_angle < 0.5 * math.pi and self.kind != "inserted":
            text = f'belongs to kind = "inserted", not to "{self.kind}"'
            problems.append(("cutting_edge_angle", text))
        if self.cutting_edge_angle < 0.5 * math.pi and self.taper_angle:
            problems.append(("taper_angle", "is another name for 90 deg - cutting_edge_angle"))
        is_ball = abs(self.corner_radius - 0.5 * self.diameter) <= 1e-9 * self.diameter
        if self.kind == "ball" and self.corner_radius and not is_ball:
            text = f'is {self.corner_radius * 1e3:g} mm, but kind = "ball" has half the diameter'
            problems.append(("corner_radius", text))
        if self.kind == "bull nose" and not self.corner_radius:
            problems.append(("corner_radius", 'is missing; kind = "bull nose" needs it'))
        raise_if_any(problems)
        return self
