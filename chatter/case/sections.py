"""The smaller sections: process damping, contact, friction, axis, simulation, lobes."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from chatter.case.base import Section, raise_if_any
from chatter.case.quantities import PositiveLength, quantity, whole_number

#: most points a side of a diagram, and in all
MOST_POINTS_A_SIDE = 20_000
MOST_POINTS = 20_000_000


class ProcessDamping(Section):
    """Viscous process damping: coefficient C in N/m, friction mu."""

    coefficient: quantity("line_force", at_least=0.0)
    friction: quantity("number", at_least=0.0) = 0.0


class Contact(Section):
    """Contact of tool and workpiece while in cut."""

    stiffness: quantity("stiffness", at_least=0.0)
    damping: quantity("damping", at_least=0.0) = 0.0


class Friction(Section):
    """Friction of a guide or drive; forces in N, velocities in m/s."""

    law: Literal["lugre", "coulomb", "coulomb-stribeck", "tanh"] = "coulomb"
    coulomb: quantity("force", at_least=0.0) | None = None
    static: quantity("force", at_least=0.0) | None = None
    viscous: quantity("damping", at_least=0.0) | None = None
    stribeck_velocity: quantity("velocity", above=0.0) | None = None
    sigma0: quantity("stiffness", at_least=0.0) | None = None
    sigma1: quantity("damping", at_least=0.0) | None = None


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
    """Spindle speeds of the diagram, rad/s."""

    from_: quantity("angular_speed", above=0.0) = Field(alias="from")
    to: quantity("angular_speed", above=0.0)
    count: Count = 400

    @model_validator(mode="after")
    def _check_order(self) -> SpeedRange:
        problem = ("", "the range is empty: from is not less than to")
        raise_if_any([problem] if self.from_ >= self.to else [])
        return self


class DepthRange(Section):
    """Axial depths of the diagram, m."""

    to: PositiveLength
    count: Count = 100


class Lobes(Section):
    """The stability diagram."""

    speeds: SpeedRange | None = None
    depths: DepthRange | None = None
    method: str | None = Field(None, description="semi-discretization or zero-order")
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
