"""[axis.NAME.drive]: ball screw, rack and pinion, linear motor, spindle."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from chatter.description.directions import Direction
from chatter.description.machine.beam import MaterialSection
from chatter.description.machine.fields import Position, Positions, arguments, fields_of, pair
from chatter.description.quantities import quantity
from chatter.description.section import Section, raise_if_any
from chatter.description.wording import key_problems
from dynamics.drive.ball_screw import BallScrew
from dynamics.drive.belt import Belt
from dynamics.drive.linear_motor import LinearMotor
from dynamics.drive.rack_and_pinion import RackAndPinion, RackMotor
from dynamics.drive.rotary import DirectRotary, SpindleRotor
from dynamics.drive.screw_on_beam import ScrewOnBeam
from dynamics.drive.screw_shaft import ScrewShaft

#: kind -> specification
KINDS: dict[str, type] = {
    "ball screw": BallScrew,
    "screw on beam": ScrewOnBeam,
    "rack and pinion": RackAndPinion,
    "linear motor": LinearMotor,
    "rotary": DirectRotary,
    "spindle": SpindleRotor,
}
#: kinds whose travel is an angle
ROTARY = ("rotary", "spindle")
#: kinds whose motor has force and displacement
LINEAR = ("linear motor",)


class BeltSection(Section):
    """Toothed belt between motor and screw: by the pulleys' pitch radii."""

    driver_radius: quantity("length", above=0.0)
    driven_radius: quantity("length", above=0.0)
    stiffness: quantity("stiffness", above=0.0) = Field(description="of both strands")
    damping: quantity("damping", at_least=0.0) = 0.0
    driver_inertia: quantity("moment_of_inertia", at_least=0.0) = 0.0
    driven_inertia: quantity("moment_of_inertia", at_least=0.0) = 0.0


class ShaftSection(Section):
    """Shaft of a ball screw between its bearings."""

    diameter: quantity("length", above=0.0) = Field(description="core or equivalent diameter")
    length: quantity("length", above=0.0)
    nut_at: quantity("length") = Field(
        description="nut at position 0, from the fixed bearing along the axis"
    )
    support: Literal["fixed-free", "fixed-supported", "fixed-fixed"] = "fixed-free"
    material: MaterialSection | None = Field(None, description="steel by default")

    def spec(self) -> ScrewShaft:
        """The shaft."""
        further = {} if self.material is None else {"material": self.material.spec()}
        return ScrewShaft(**arguments(self, ScrewShaft), **further)


class RackMotorSection(Section):
    """Motor of a rack and pinion, with gearbox and pinion."""

    inertia: quantity("moment_of_inertia", above=0.0)
    towards_pinion: Direction = Field(
        description="from the rack to the pinion's axis", examples=[[0, 0, 1]]
    )
    offset: Position = Field((0.0, 0.0, 0.0), description="from where the axis is driven")
    preload: quantity("torque") = 0.0


class DriveSection(Section):
    """Drive of an axis; the kind says which keys it has. A stiffness left out is rigid."""

    kind: Literal[
        "ball screw", "screw on beam", "rack and pinion", "linear motor", "rotary", "spindle"
    ]
    lead: quantity("length") | None = Field(
        None, description="travel per revolution; negative for a left-hand thread"
    )
    motor_inertia: quantity("moment_of_inertia", at_least=0.0) | None = None
    screw_inertia: quantity("moment_of_inertia", at_least=0.0) | None = None
    nut_stiffness: quantity("stiffness", above=0.0) | None = None
    bearing_stiffness: quantity("stiffness", above=0.0) | None = Field(
        None, description="axial, of the fixed bearing"
    )
    far_bearing_stiffness: quantity("stiffness", above=0.0) | None = None
    shaft: ShaftSection | None = None
    coupling_stiffness: quantity("rotational_stiffness", above=0.0) | None = None
    belt: BeltSection | None = None
    beam: str | None = Field(None, description="beam that is the screw")
    radial: pair("stiffness", at_least=0.0) | None = None
    axial: quantity("stiffness", above=0.0) | None = None
    tilt: pair("rotational_stiffness", at_least=0.0) | None = None
    nut_at: quantity("length") | None = Field(
        None, description="nut at position 0, from the driven end along the axis"
    )
    first_radial: Direction | None = None
    axial_damping: quantity("damping", at_least=0.0) | None = None
    torsional_damping: quantity("rotational_damping", at_least=0.0) | None = None
    radial_damping: pair("damping", at_least=0.0) | None = None
    tilt_damping: pair("rotational_damping", at_least=0.0) | None = None
    pinion_radius: quantity("length", above=0.0) | None = None
    gear_ratio: quantity("number", above=0.0) | None = Field(
        None, description="revolutions of the motor per one of the pinion"
    )
    motors: tuple[RackMotorSection, ...] = ()
    mesh_stiffness: quantity("stiffness", above=0.0) | None = None
    gearbox_stiffness: quantity("rotational_stiffness", above=0.0) | None = None
    pinion_inertia: quantity("moment_of_inertia", at_least=0.0) | None = None
    gearbox_inertia: quantity("moment_of_inertia", at_least=0.0) | None = None
    mesh_damping: quantity("damping", at_least=0.0) | None = None
    gearbox_damping: quantity("rotational_damping", at_least=0.0) | None = None
    coupling_damping: quantity("rotational_damping", at_least=0.0) | None = None
    motors_on: Literal["moving", "carrying"] | None = None
    backlash: quantity("length", at_least=0.0) | None = Field(
        None, description="of nut or pinion, from flank to flank, along the axis"
    )
    offsets: Positions | None = Field(None, description="of each linear motor, from at of the axis")
    shares: tuple[quantity("number", at_least=0.0), ...] | None = None
    inertia: quantity("moment_of_inertia", above=0.0) | None = Field(
        None, description="of spindle, motor and tool"
    )

    @model_validator(mode="after")
    def _check_kind(self) -> DriveSection:
        raise_if_any(key_problems(self, "kind", fields_of(KINDS[self.kind])))
        return self

    @property
    def is_rotary(self) -> bool:
        """Whether travel of the axis is an angle."""
        return self.kind in ROTARY

    @property
    def motor_is_linear(self) -> bool:
        """Whether its motor has force and displacement."""
        return self.kind in LINEAR

    def spec(self) -> Any:
        """The drive.

        Raises StructureError if its numbers make no sense.
        """
        make = KINDS[self.kind]
        values = arguments(self, make, but=("motors",))
        if self.belt is not None:
            values["belt"] = Belt(**arguments(self.belt, Belt))
        if self.shaft is not None:
            values["shaft"] = self.shaft.spec()
        if self.motors:
            values["motors"] = [RackMotor(**arguments(one, RackMotor)) for one in self.motors]
        return make(**values)
