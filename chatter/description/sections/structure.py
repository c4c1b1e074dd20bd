"""[structure]: modes at the tool point, measured FRFs, or a virtual machine."""

from __future__ import annotations

import math
import re
from bisect import bisect
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, field_validator, model_validator

from chatter.description.directions import UnitVector
from chatter.description.file_name import FileName
from chatter.description.formatting import formatted
from chatter.description.quantities import quantity, quantity_list, whole_number
from chatter.description.section import Section, raise_if_any

#: vibration, m, at which resting frictions are linearised: what a cut that is hardly stable has
DEFAULT_FRICTION_AMPLITUDE = 5e-6
_INERTIA = ("mass", "stiffness")
_DIRECTION = re.compile("[xyz]{1,2}")


#: entries of a table over the spindle speed
_FEWEST_SPEEDS, _MOST_SPEEDS = 2, 1000


class SpeedDependence(Section):
    """A mode at several spindle speeds: linear between them, held at the ends beyond."""

    speeds: quantity_list("angular_speed", _FEWEST_SPEEDS, _MOST_SPEEDS, at_least=0.0) = Field(
        description="spindle speeds, ascending"
    )
    frequency: quantity_list("frequency", _FEWEST_SPEEDS, _MOST_SPEEDS, above=0.0) | None = None
    damping: quantity_list("number", _FEWEST_SPEEDS, _MOST_SPEEDS, above=0.0, below=1.0) | None = (
        None
    )
    mass: quantity_list("mass", _FEWEST_SPEEDS, _MOST_SPEEDS, above=0.0) | None = None
    stiffness: quantity_list("stiffness", _FEWEST_SPEEDS, _MOST_SPEEDS, above=0.0) | None = None

    @model_validator(mode="after")
    def _check_table(self) -> SpeedDependence:
        count = len(self.speeds)
        columns = {key: getattr(self, key) for key in ("frequency", "damping", *_INERTIA)}
        given = {key: column for key, column in columns.items() if column is not None}
        problems = [
            (key, f"has {len(column)} values for {count} speeds; one for each is required")
            for key, column in given.items()
            if len(column) != count
        ]
        if any(high <= low for low, high in pairwise(self.speeds)):
            problems.append(("speeds", "must ascend, each above the one before"))
        if self.mass is not None and self.stiffness is not None:
            problems.append(("", "give mass or stiffness, not both"))
        if not given:
            problems.append(("", "says nothing; give frequency, damping, mass or stiffness"))
        raise_if_any(problems)
        return self

    def at(self, key: str, spindle_speed: float) -> float | None:
        """Value of a quantity at a spindle speed, rad/s; None where the table lacks it."""
        column = getattr(self, key)
        if column is None:
            return None
        index = bisect(self.speeds, spindle_speed)
        if index in (0, len(column)):
            return column[min(index, len(column) - 1)]
        low, high = self.speeds[index - 1], self.speeds[index]
        share = (spindle_speed - low) / (high - low)
        return column[index - 1] + share * (column[index] - column[index - 1])


class ModeSection(Section):
    """One real mode at the tool point."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["mass"]}, {"required": ["stiffness"]}]}
    )

    frequency: quantity("frequency", above=0.0)
    damping: quantity("number", above=0.0, below=1.0) = Field(description="damping ratio")
    mass: quantity("mass", above=0.0) | None = None
    stiffness: quantity("stiffness", above=0.0) | None = None
    frequency_slope: quantity("inverse_angular_speed") = Field(
        0.0, description="relative change of the frequency with the spindle speed"
    )
    speed_dependence: SpeedDependence | None = Field(
        None, description="what the mode is at several spindle speeds"
    )
    direction: UnitVector = Field(
        description="unit vector: x feed, y normal, z tool axis", examples=[[1, 0, 0]]
    )
    side: Literal["tool", "workpiece"] = "tool"
    friction: str | None = Field(
        None, description="name of the [friction.NAME] that rubs on this mode"
    )

    @model_validator(mode="after")
    def _check_inertia(self) -> ModeSection:
        given = (self.mass is not None) + (self.stiffness is not None)
        text = {0: "either mass or stiffness is needed", 2: "give mass or stiffness, not both"}
        problems = [("", text[given])] if given != 1 else []
        table = self.speed_dependence
        if self.frequency_slope and table is not None and table.frequency is not None:
            problems.append(
                ("frequency_slope", "and speed_dependence.frequency both say how it changes")
            )
        raise_if_any(problems)
        return self

    @property
    def depends_on_speed(self) -> bool:
        """True where the mode is another one at another spindle speed."""
        return bool(self.frequency_slope) or self.speed_dependence is not None

    def frequency_at(self, spindle_speed: float) -> float:
        """Natural frequency, Hz, at a spindle speed, rad/s; not above 0 where the slope ends."""
        table = self.speed_dependence
        if table is not None and table.frequency is not None:
            return table.at("frequency", spindle_speed)
        return self.frequency * (1.0 + self.frequency_slope * spindle_speed)

    def damping_at(self, spindle_speed: float) -> float:
        """Damping ratio at a spindle speed, rad/s."""
        table = self.speed_dependence
        listed = None if table is None else table.at("damping", spindle_speed)
        return self.damping if listed is None else listed

    def mass_at(self, spindle_speed: float) -> float:
        """Modal mass, kg, at a spindle speed, rad/s: of the table, else as at rest.

        A stiffness of the table goes with the frequency at that speed.
        """
        table = self.speed_dependence
        if table is not None and table.mass is not None:
            return table.at("mass", spindle_speed)
        if table is not None and table.stiffness is not None:
            omega = 2.0 * math.pi * self.frequency_at(spindle_speed)
            return table.at("stiffness", spindle_speed) / omega**2
        return self.modal_mass

    @property
    def modal_mass(self) -> float:
        """Modal mass, kg, as given or from the stiffness."""
        if self.mass is not None:
            return self.mass
        return self.stiffness / (2.0 * math.pi * self.frequency) ** 2


class MeasuredFrf(Section):
    """A file of measured FRFs at the tool point."""

    file: FileName = Field(examples=["tap.uff"])
    direction: str | None = Field(
        None,
        description='"x", or response and force as in "xy"; where the file does not say',
        json_schema_extra={"pattern": f"^{_DIRECTION.pattern}$"},
    )
    side: Literal["tool", "workpiece"] = "tool"
    node: str | None = Field(
        None,
        description="node of the tool point, where there are several",
        json_schema_extra={"type": ["string", "integer"]},
    )
    spindle_speed: quantity("angular_speed", at_least=0.0) | None = Field(
        None, description="at which it was measured; it holds at all of them by default"
    )

    @field_validator("direction")
    @classmethod
    def _check_direction(cls, given: str | None) -> str | None:
        if given is not None and not _DIRECTION.fullmatch(given):
            raise ValueError(
                f'"{given}" is not a direction; "x", "y", "z" or two of them are required'
            )
        return given

    @field_validator("node", mode="before")
    @classmethod
    def _as_text(cls, given: Any) -> Any:
        return str(given) if isinstance(given, int) and not isinstance(given, bool) else given


def _as_tables(given: Any) -> Any:
    """One name, a list of names or of tables: all become tables."""
    entries = given if isinstance(given, (list, tuple)) else [given]
    for entry in entries:
        if not isinstance(entry, (str, dict)):
            raise ValueError(
                f"{formatted(entry)} is not a measured FRF; "
                "a file name is required, or a table with file"
            )
    return [{"file": entry} if isinstance(entry, str) else entry for entry in entries]


def _also_file_names(schema: dict) -> None:
    """Let the schema accept what `_as_tables` accepts."""
    table = schema.pop("items")
    name = {"type": "string", "examples": ["tap.uff"]}
    del schema["type"]
    schema["anyOf"] = [name, {"type": "array", "items": {"anyOf": [name, table]}}, table]


#: keys that say how a machine cuts
OF_MACHINE = (
    "feed",
    "tool_axis",
    "spindle",
    "condition",
    "position",
    "friction",
    "friction_amplitude",
    "settling",
    "travel_positions",
)


class StructureSection(Section):
    """Where the dynamics at the tool point come from: exactly one of three."""

    mode: tuple[ModeSection, ...] = Field((), description="real modes at the tool point")
    frf: Annotated[tuple[MeasuredFrf, ...], BeforeValidator(_as_tables)] = Field(
        (),
        description="measured FRFs: a file, a list of files or of tables",
        json_schema_extra=_also_file_names,
    )
    machine: FileName | None = Field(None, description="file of a virtual machine")
    feed: UnitVector | None = Field(
        None,
        description="direction of the machine in which the tool is fed against the workpiece; x "
        "by default",
    )
    tool_axis: UnitVector | None = Field(
        None, description="direction of the machine from the tip into the spindle; z by default"
    )
    spindle: str | None = Field(
        None, description="axis of the machine that turns the tool; its only spindle by default"
    )
    condition: dict[str, Literal["control", "brake", "free"]] | None = Field(
        None, description="what holds an axis of the machine"
    )
    position: dict[str, quantity("length")] | None = Field(
        None, description="of axes of the machine"
    )
    friction: bool | None = Field(None, description="false: the machine without any")
    friction_amplitude: quantity("length", at_least=0.0) | None = Field(
        None,
        description="of the vibration along axes whose friction rests: stability takes their "
        "describing functions at it, 5 um by default; 0 um: their stiffness at rest",
    )
    settling: quantity("time", at_least=0.0) | None = Field(
        None, description="time that the machine runs in the air before the cut; 1 s by default"
    )
    travel_positions: whole_number(1, 101, "numbers of positions") | None = Field(
        None,
        description="along the travel of each axis of the machine, at which its structure is "
        "assembled, to change between them; as many as its natural frequencies need by default; "
        "1: it stays as at the start",
    )

    @property
    def amplitude_at_frictions(self) -> float:
        """Amplitude along axes whose friction rests, m, as stated or by default."""
        stated = self.friction_amplitude
        return DEFAULT_FRICTION_AMPLITUDE if stated is None else stated

    @model_validator(mode="after")
    def _check_source(self) -> StructureSection:
        named = [key for key in ("mode", "frf", "machine") if getattr(self, key)]
        problems = []
        if self.machine is None:
            problems += [
                (key, "belongs to a machine; structure.machine is not given")
                for key in OF_MACHINE
                if getattr(self, key) is not None
            ]
        if self.friction is False and self.friction_amplitude is not None:
            problems.append(("friction_amplitude", "is given, but friction = false leaves none"))
        if len(named) > 1:
            listed = " and ".join(named)
            problems.append(("", f"{listed} are both given; the structure comes from one of them"))
        if not named:
            problems.append(("", "is empty; give [[structure.mode]], structure.frf or machine"))
        raise_if_any(problems)
        return self
