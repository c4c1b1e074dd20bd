"""[friction.NAME]: a friction law along a motion."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from chatter.description.machine.fields import Place, arguments, fields_of, key_problems
from chatter.description.quantities import either_quantity, quantity, whole_number
from chatter.description.section import Section, raise_if_any
from dynamics.friction.laws import LAWS, FrictionLaw

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
    at: Place | None = Field(None, description="place on the axis; where it is driven by default")

    @model_validator(mode="after")
    def _check_target(self) -> FrictionTarget:
        given = [key for key in _TARGETS if getattr(self, key) is not None]
        problems = []
        if len(given) != 1:
            problems.append(("", f"one of {', '.join(_TARGETS)} is wanted; {len(given)} are given"))
        if (self.direction is None) == ("connector" in given):
            text = "is missing; a connector has x, y, z, rx, ry and rz"
            problems.append(("direction", text if given else "belongs to connector"))
        if self.at is not None and "axis" not in given:
            problems.append(("at", "belongs to axis"))
        raise_if_any(problems)
        return self


def _force(**bounds: float) -> object:
    return either_quantity("force", "torque", **bounds)


def _viscous(**bounds: float) -> object:
    return either_quantity("damping", "rotational_damping", **bounds)


_slow_decay = either_quantity("inverse_velocity", "inverse_angular_speed", at_least=0.0)


class FrictionSection(Section):
    """Friction law; about an axis its quantities are those of a rotation."""

    law: Literal["LuGre", "tanh hysteresis", "Coulomb-Stribeck", "smooth Coulomb"]
    on: FrictionTarget
    coulomb: _force(at_least=0.0) | None = None
    static: _force(at_least=0.0) | None = None
    viscous: _viscous(at_least=0.0) | None = None
    stribeck_velocity: either_quantity("velocity", "angular_speed", above=0.0) | None = None
    stribeck_shape: quantity("number", above=0.0) | None = None
    smoothing_velocity: either_quantity("velocity", "angular_speed", above=0.0) | None = None
    stiffness: either_quantity("stiffness", "rotational_stiffness", above=0.0) | None = Field(
        None, description="of the bristles"
    )
    bristle_damping: _viscous(at_least=0.0) | None = None
    logarithmic: _force(at_least=0.0) | None = None
    logarithmic_velocity: either_quantity("velocity", "angular_speed", above=0.0) | None = None
    slow_viscous: _viscous(at_least=0.0) | None = None
    slow_decay: (
        either_quantity("inverse_velocity", "inverse_angular_speed", at_least=0.0) | None
    ) = None
    inclination: either_quantity("inverse_length", "inverse_angle", above=0.0) | None = Field(
        None, description="a_h of the presliding hysteresis"
    )

    @model_validator(mode="after")
    def _check_law(self) -> FrictionSection:
        raise_if_any(key_problems(self, "law", fields_of(LAWS[self.law]), ("on",)))
        return self

    def spec(self) -> FrictionLaw:
        """The law.

        Raises
        ------
        ValueError
            If a number is out of its range.
        """
        return LAWS[self.law](**arguments(self, LAWS[self.law]))
