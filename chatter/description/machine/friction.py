"""[friction.NAME]: a friction law along a motion."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from chatter.description.machine.fields import Position
from chatter.description.quantities import either_quantity, quantity, whole_number
from chatter.description.section import Section, raise_if_any
from chatter.description.sections.friction import friction_section

_TARGETS = ("axis", "motor", "connector", "mode")


class FrictionTarget(Section):
    """Motion that the friction resists: of one of four."""

    axis: str | None = Field(None, description="travel of an axis")
    motor: str | None = Field(None, description="each motor of an axis, against its housing")
    connector: str | None = Field(
        None, description='connector, or "beam.bearing", along or about its direction'
    )
    mode: whole_number(1, 100_000, "numbers of modes") | None = Field(
        None, description="undamped mode, counted from 1, in its mass-normalised coordinate"
    )
    direction: Literal["x", "y", "z", "rx", "ry", "rz"] | None = Field(
        None, description="of the connector's own"
    )
    at: Position | None = Field(
        None, description="place on the axis; where it is driven by default"
    )

    @model_validator(mode="after")
    def _check_target(self) -> FrictionTarget:
        given = [key for key in _TARGETS if getattr(self, key) is not None]
        problems = []
        if len(given) != 1:
            problems.append(
                ("", f"one of {', '.join(_TARGETS)} is required; {len(given)} are given")
            )
        if (self.direction is None) == ("connector" in given):
            text = "is missing; a connector has x, y, z, rx, ry and rz"
            problems.append(("direction", text if given else "belongs to connector"))
        if self.at is not None and "axis" not in given:
            problems.append(("at", "belongs to axis"))
        raise_if_any(problems)
        return self


#: dimension along a travel -> the same about an axis
_ROTATIONAL = {
    "force": "torque",
    "stiffness": "rotational_stiffness",
    "damping": "rotational_damping",
    "velocity": "angular_speed",
    "inverse_length": "inverse_angle",
    "inverse_velocity": "inverse_angular_speed",
}


def _along_or_about(dimension: str, **bounds: float) -> Any:
    if dimension not in _ROTATIONAL:
        return quantity(dimension, **bounds)
    return either_quantity(dimension, _ROTATIONAL[dimension], **bounds)


_Keys: Any = friction_section(None, _along_or_about)


class FrictionSection(_Keys):
    """Friction law; about an axis its quantities are those of a rotation."""

    on: FrictionTarget
