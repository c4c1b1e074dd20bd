"""The smaller sections: process damping, contact, friction, axis, simulation, lobes."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field, model_validator

from chatter.case.base import Section, raise_if_any
from chatter.case.quantities import PositiveLength, quantity, whole_number

#: most points a side of a diagram, and in all
MOST_POINTS_A_SIDE = 20_000
MOST_POINTS = 20_000_000


class ProcessDamping(Section):
    """Process damping in its viscous form: F_r += C (b/V) r_dot, F_t += mu times the same."""

    coefficient: quantity("line_force", at_least=0.0) = Field(description="C")
    friction: quantity("number", at_least=0.0) = Field(0.0, description="mu")


class Contact(Section):
    """Contact of tool and workpiece while in cut."""

    stiffness: quantity("stiffness", at_least=0.0)
    damping: quantity("damping", at_least=0.0) = 0.0


#: law of friction -> its keys
FRICTION_LAWS: dict[str, tuple[str, ...]] = {
    "coulomb": ("coulomb", "viscous"),
    "coulomb-stribeck": ("coulomb", "static", "stribeck_velocity", "viscous"),
    "tanh": ("coulomb", "viscous", "presliding_stiffness"),
    "lugre": ("coulomb", "static", "stribeck_velocity", "sigma0", "sigma1", "sigma2"),
}


class Friction(Section):
    """Friction of a guide or drive."""

    law: Literal["coulomb", "coulomb-stribeck", "tanh", "lugre"] = "coulomb"
    coulomb: quantity("force", at_least=0.0) | None = None
    static: quantity("force", at_least=0.0) | None = None
    viscous: quantity("damping", at_least=0.0) | None = None
    stribeck_velocity: quantity("velocity", above=0.0) | None = None
    presliding_stiffness: quantity("stiffness", above=0.0) | None = None
    sigma0: quantity("stiffness", at_least=0.0) | None = Field(
        None, description="stiffness of the bristles"
    )
    sigma1: quantity("damping", at_least=0.0) | None = Field(
        None, description="damping of the bristles"
    )
    sigma2: quantity("damping", at_least=0.0) | None = Field(
        None, description="viscous part of the LuGre law"
    )

    @model_validator(mode="after")
    def _check_law(self) -> Friction:
        known = ("law", *FRICTION_LAWS[self.law])
        raise_if_any(
            [
                (key, f'does not belong to law = "{self.law}"')
                for key in type(self).model_fields
                if key not in known and getattr(self, key) is not None
            ]
        )
        return self


class Axis(Section):
    """A feed axis as a moving mass with friction."""

    moving_mass: quantity("mass", above=0.0)
    viscous_friction: quantity("damping", at_least=0.0) = 0.0
    coulomb_friction: quantity("force", at_least=0.0) = 0.0
    static_friction: quantity("force", at_least=0.0) | None = None
    stribeck_velocity: quantity("velocity", above=0.0) | None = None
    presliding_stiffness: quantity("stiffness", above=0.0) | None = None
    presliding_damping: quantity("damping", at_least=0.0) | None = None


class Simulation(Section):
    """Time-domain simulation."""

    chip: Literal["delay", "dexel", "voxel"] = "delay"
    duration: quantity("time", above=0.0) | None = None
    revolutions: quantity("number", above=0.0) | None = None
    resolution: PositiveLength | None = None

    @model_validator(mode="after")
    def _check_length(self) -> Simulation:
        both = self.duration is not None and self.revolutions is not None
        raise_if_any([("", "give duration or revolutions, not both")] if both else [])
        return self


Count = whole_number(2, MOST_POINTS_A_SIDE, "counts")


class SpeedRange(Section):
    """Spindle speeds of the diagram."""

    from_: quantity("angular_speed", above=0.0) = Field(alias="from")
    to: quantity("angular_speed", above=0.0)
    count: Count = 400

    @model_validator(mode="after")
    def _check_order(self) -> SpeedRange:
        first, last = (value * 30.0 / math.pi for value in (self.from_, self.to))
        text = f"the range is empty: from ({first:g} rpm) is not less than to ({last:g} rpm)"
        raise_if_any([("", text)] if self.from_ >= self.to else [])
        return self


class DepthRange(Section):
    """Axial depths of the diagram."""

    to: PositiveLength
    count: Count = 100


class Lobes(Section):
    """The stability diagram."""

    speeds: SpeedRange | None = None
    depths: DepthRange | None = None
    method: Literal["semi-discretization", "zero-order"] | None = None
    steps: whole_number(4, 20_000, "steps a tooth period") | None = Field(
        None, description="fixes the steps a tooth period; by default they are chosen"
    )

    @model_validator(mode="after")
    def _check_size(self) -> Lobes:
        points = (self.speeds.count if self.speeds else 400) * (
            self.depths.count if self.depths else 100
        )
        text = f"{points} points in all; at most {MOST_POINTS} are allowed"
        raise_if_any([("", text)] if points > MOST_POINTS else [])
        return self
