"""Rack and pinion: one or several motors, each with gearbox and pinion, on one axis."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from dynamics.beam.element import positive
from dynamics.drive.gear_train import (
    GearTrain,
    Housing,
    Spring,
    Stage,
    gear_train,
    reflected_inertia,
)
from dynamics.drive.parts import (
    DrivenAxis,
    DriveParts,
    Motor,
    require_not_negative,
    require_stiffness,
)
from dynamics.structure.bodies import finite, unit_vector
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.spring_coupling import Term


@dataclass(frozen=True, eq=False)
class RackMotor:
    """One motor of a rack-and-pinion drive, with gearbox and pinion.

    Raises
    ------
    StructureError
        If a number is out of its range.
    """

    inertia: float  # moment of inertia of the motor, kg m^2
    #: (3,), direction from the rack to the pinion's axis, perpendicular to the axis of motion; made
    #: a unit vector
    towards_pinion: ArrayLike
    #: (3,), where they mesh, from the place where the axis is driven, m
    offset: ArrayLike = (0.0, 0.0, 0.0)
    preload: float = 0.0  # torque held against the other motors, N m, positive if it pushes forward

    def __post_init__(self) -> None:
        where = "motor of rack and pinion"
        positive(where, "inertia", self.inertia)
        normal = unit_vector(where, "towards_pinion", self.towards_pinion)
        object.__setattr__(self, "towards_pinion", normal)
        object.__setattr__(self, "offset", finite(where, "offset", self.offset, (3,)))
        if not np.isfinite(self.preload):
            raise StructureError(f"{where}: preload is {self.preload}; a finite torque, in N m")


@dataclass(frozen=True, eq=False)
class RackAndPinion:
    """Pinions on one rack or several, each with its gearbox and motor about the same axis.

    Springs in a row: coupling between motor and gearbox (K1), gearbox about its output shaft
    (K2), mesh of pinion and rack. The motors' housings take the reaction of their torques.

    Raises
    ------
    StructureError
        If a number is out of its range, there is no motor, or the preloads do not cancel.
    """

    pinion_radius: float  # pitch radius, m
    gear_ratio: float  # turns of the motor per turn of the pinion, the same way round
    motors: Sequence[RackMotor]
    mesh_stiffness: float = np.inf  # N/m along the rack; infinite if rigid
    gearbox_stiffness: float = np.inf  # N m/rad about the output shaft; infinite if rigid
    coupling_stiffness: float = np.inf  # N m/rad between motor and gearbox; infinite if rigid
    pinion_inertia: float = 0.0  # with the gearbox's output shaft, kg m^2; 0 if negligible
    gearbox_inertia: float = 0.0  # at the gearbox's input, kg m^2
    mesh_damping: float = 0.0  # N s/m
    gearbox_damping: float = 0.0  # N m s/rad
    coupling_damping: float = 0.0  # N m s/rad
    #: of each gearbox and pinion together, from flank to flank, m along the rack
    backlash: float = 0.0
    #: {"moving", "carrying"}, part that the motors ride on; the rack is on the other one
    motors_on: Literal["moving", "carrying"] = "moving"

    def __post_init__(self) -> None:
        where = "rack and pinion"
        positive(where, "pinion_radius", self.pinion_radius)
        positive(where, "gear_ratio", self.gear_ratio)
        stiffness = ("mesh_stiffness", "gearbox_stiffness", "coupling_stiffness")
        require_stiffness(where, **{what: getattr(self, what) for what in stiffness})
        others = (
            "pinion_inertia",
            "gearbox_inertia",
            "mesh_damping",
            "gearbox_damping",
            "coupling_damping",
            "backlash",
        )
        require_not_negative(where, **{what: getattr(self, what) for what in others})
        if self.motors_on not in ("moving", "carrying"):
            raise StructureError(
                f'{where}: motors_on is "{self.motors_on}"; "moving" or "carrying"'
            )
        object.__setattr__(self, "motors", tuple(self.motors))
        if not self.motors:
            raise StructureError(f"{where} has no motors")
        preloads = np.array([motor.preload for motor in self.motors])
        if abs(np.sum(preloads)) > 1e-9 * np.max(np.abs(preloads)):
            raise StructureError(
                f"{where}: the motors' preloads add up to {np.sum(preloads):g} N m; they must "
                "cancel, or they drive the axis"
            )

    @property
    def transmission(self) -> float:
        """Travel per angle of each motor, m/rad."""
        return self.pinion_radius / self.gear_ratio

    def inertia_at_motor(self, moving_mass: float) -> float:
        """Moment of inertia at one motor, kg m^2, with an even share of the moving mass.

        The mean of the motors, where their inertias differ.
        """
        stages = [self._stages("", "", motor) for motor in self.motors]
        turning_parts = np.mean([reflected_inertia(one) for one in stages])
        return float(turning_parts) + moving_mass / len(self.motors) * self.transmission**2

    def parts(self, axis: DrivenAxis) -> DriveParts:
        """Rotors, springs and motors on an axis.

        Raises StructureError if a pinion does not lie beside the rack, or nothing gives way.
        """
        names = [f" {number}" for number in range(1, len(self.motors) + 1)]
        if len(self.motors) == 1:
            names = [""]
        trains = [
            self._train(axis, name, one) for name, one in zip(names, self.motors, strict=True)
        ]
        motors = [
            Motor(f"{axis.name}: motor{name}", train.motor_angle, self.transmission, one.preload)
            for name, train, one in zip(names, trains, self.motors, strict=True)
        ]
        return DriveParts(
            tuple(rotor for train in trains for rotor in train.rotors),
            (),
            tuple(coupling for train in trains for coupling in train.couplings),
            tuple(motors),
        )

    def _train(self, axis: DrivenAxis, name: str, motor: RackMotor) -> GearTrain:
        where = f'axis "{axis.name}": rack and pinion{name and ", motor" + name}'
        direction, normal = np.asarray(axis.direction), np.asarray(motor.towards_pinion)
        if abs(normal @ direction) > 1e-6:
            raise StructureError(f"{where}: towards_pinion is not perpendicular to the direction")
        rides = self.motors_on == "moving"
        # A rack in the moving part slides under its pinion, which stays where it is at 0.
        meshes = np.asarray(axis.at) + motor.offset - (0.0 if rides else axis.position) * direction
        centre = meshes + self.pinion_radius * normal
        forward = 1.0 if rides else -1.0
        carrier, rack = (axis.moving, axis.carrying) if rides else (axis.carrying, axis.moving)
        housing = Housing(carrier, centre, forward * np.cross(normal, direction))
        end = (
            Term(carrier, forward * direction, centre),
            Term(rack, -forward * direction, meshes),
            housing.turning(-self.pinion_radius),
        )
        return gear_train(where, self._stages(f"{axis.name}: ", name, motor), end, housing)

    def _stages(self, prefix: str, name: str, motor: RackMotor) -> list[Stage]:
        at_motor, radius = self.transmission, self.pinion_radius
        coupling = Spring(
            f"{prefix}coupling{name}",
            self.coupling_stiffness / at_motor**2,
            self.coupling_damping / at_motor**2,
        )
        gearbox = Spring(
            f"{prefix}gearbox{name}",
            self.gearbox_stiffness / radius**2,
            self.gearbox_damping / radius**2,
        )
        mesh = Spring(f"{prefix}mesh{name}", self.mesh_stiffness, self.mesh_damping, self.backlash)
        return [
            Stage(f"{prefix}motor{name}", motor.inertia, at_motor, coupling),
            Stage(f"{prefix}gearbox{name}", self.gearbox_inertia, at_motor, gearbox),
            Stage(f"{prefix}pinion{name}", self.pinion_inertia, radius, mesh),
        ]
