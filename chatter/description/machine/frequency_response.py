"""[frf.NAME]: a frequency response of the machine, linearised and by a test in time."""

from __future__ import annotations

import re
from typing import Annotated, Literal, NamedTuple

from pydantic import BeforeValidator, Field, model_validator

from chatter.description.quantities import either_quantity, ends_of_range, quantity, whole_number
from chatter.description.section import Section, raise_if_any
from dynamics.machine.description import Condition

#: tests in time; "linearised" makes none
FrfKind = Literal[
    "linearised", "hammer", "chirp", "multisine", "torque impulse", "torque multisine"
]
TORQUE_KINDS = ("torque impulse", "torque multisine")

_PLACE = re.compile(r"(?:(motor):(\w[\w-]*)|(\w[\w-]*)(?:/(\w[\w-]*))?:(r?[xyz]))", re.ASCII)


class TestedPoint(NamedTuple):
    """What a text such as "tool/table:y" or "motor:Y" names."""

    motor: str | None
    point: str | None
    against: str | None
    direction: str | None


def parse_tested_point(text: str) -> TestedPoint:
    """Read a place of a test.

    Raises
    ------
    ValueError
        If the text is none.
    """
    match = _PLACE.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        raise ValueError(
            f'{text!r} is given; a point and a direction are required, such as "table:y", '
            '"tool/table:y" (against another point) or "motor:Y" (torque of an axis)'
        )
    _, motor, point, against, direction = match.groups()
    return TestedPoint(motor, point, against, direction)


def _checked_point(text: str) -> str:
    parse_tested_point(text)
    return text


TestedPointText = Annotated[str, BeforeValidator(_checked_point)]


class StateSection(Section):
    """State of the machine in a test."""

    condition: dict[str, Condition] = Field(
        default_factory=dict, description="what holds an axis: control, brake, free"
    )
    position: dict[str, quantity("length")] = Field(
        default_factory=dict, description="of axes, where not as in [axis.NAME]"
    )
    friction: bool = Field(True, description="false: without any")
    in_cut: bool = Field(False, description="with the couplings of [contact]")


class FrfSection(StateSection):
    """What is excited and read, how, and in which state."""

    excite: TestedPointText = Field(description='such as "table:y", "tool/table:y", "motor:Y"')
    read: TestedPointText | None = Field(None, description="the same as excited by default")
    by: FrfKind = "hammer"
    level: either_quantity("force", "torque", above=0.0) = Field(
        100.0, description="peak of the force or torque"
    )
    band: ends_of_range("frequency", above=0.0)
    lines: whole_number(10, 1_000_000, "numbers of lines") = Field(
        2000, description="of the linearised response"
    )
    period: quantity("time", above=0.0) = Field(
        1.0,
        description="of a periodic excitation, or from blow to blow; where it is not stated, twice "
        "it and so on, up to 16 s, for blows that have not died away",
    )
    averages: whole_number(1, 10_000, "numbers of averages") = 3
    settling: quantity("time", at_least=0.0) = Field(0.5, description="before the excitation")
    seed: whole_number(0, 2**31, "seeds") = 1
    spindle_speed: quantity("angular_speed", above=0.0) | None = Field(
        None, description="of the tool, for impulses at an angle"
    )
    at_angle: quantity("angle") | None = Field(
        None, description="of the spindle at which torque impulses are released"
    )
    moving: dict[str, quantity("velocity")] = Field(
        default_factory=dict, description="axes that move during the test"
    )
    amplitude: either_quantity("length", "angle", above=0.0) | None = Field(
        None, description="of the motion at frictions at rest, for their describing functions"
    )
    kind: Literal["receptance", "mobility", "accelerance"] = "receptance"

    @model_validator(mode="after")
    def _check(self) -> FrfSection:
        problems = []
        by_motor = parse_tested_point(self.excite).motor is not None
        if by_motor != (self.by in TORQUE_KINDS) and self.by != "linearised":
            text = f'{self.excite!r} does not suit by = "{self.by}"; '
            text += "a motor is excited by torque impulse or torque multisine, a point by a force"
            problems.append(("excite", text))
        if self.read is None and by_motor:
            problems.append(("read", "is missing; where a motor excites, say what is read"))
        if (
            self.read is not None
            and parse_tested_point(self.read).motor is not None
            and not by_motor
        ):
            problems.append(("read", "motors are read only where a motor excites"))
        if (self.at_angle is None) != (self.spindle_speed is None):
            missing = "at_angle" if self.at_angle is None else "spindle_speed"
            problems.append((missing, "is missing; impulses at an angle need angle and speed"))
        if self.at_angle is not None and self.by != "torque impulse":
            problems.append(("at_angle", 'belongs to by = "torque impulse"'))
        if self.band[0] >= self.band[1]:
            problems.append(("band", f"{self.band[0]:g} Hz is not below {self.band[1]:g} Hz"))
        raise_if_any(problems)
        return self
