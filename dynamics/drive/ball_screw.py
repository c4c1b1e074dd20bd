"""Ball screw: motor, coupling or belt, turning screw, nut on the moving part.

The screw stands as a rotor whose bearings, shaft and nut act in a row, with the active length of
the shaft from the position of the axis. `dynamics.drive.screw_on_beam` has the screw as a beam.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.beam.element import positive
from dynamics.drive.belt import Belt, belt_stages
from dynamics.drive.gear_train import (
    RIGID,
    Housing,
    Spring,
    Stage,
    gear_train,
    reflected_inertia,
    series_stiffness,
    turning,
)
from dynamics.drive.parts import (
    DrivenAxis,
    DriveParts,
    Motor,
    require_not_negative,
    require_not_zero,
    require_stiffness,
)
from dynamics.drive.screw_shaft import AxialSupport, ScrewShaft
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.spring_coupling import Term


@dataclass(frozen=True)
class BallScrew:
    """Ball screw whose bearings and motor sit in the carrying part, its nut in the moving one.

    The force passes from the nut's place into the carrying part where the bearings are, if there
    is a shaft, else at the nut's place. What each bearing carries goes by its stiffness; the
    shaft does not stiffen the carrying part between two of them.

    Raises
    ------
    StructureError
        If a number is out of its range.
    """

    #: travel per turn, m; positive for a right-hand thread, negative for a left-hand one. It
    #: decides which way the screw turns, so which way the reaction of its torque acts; the motor's
    #: angle counts positive forward with either
    lead: float
    motor_inertia: float  # kg m^2
    screw_inertia: float  # kg m^2; a coupling's is divided between the two
    nut_stiffness: float  # axial, with the nut's housing, N/m
    #: axial, of the fixed bearing at the drive's end with its housing, N/m; infinite if rigid
    bearing_stiffness: float = np.inf
    #: the same at the other end of a shaft that is fixed there too
    far_bearing_stiffness: float = np.inf
    shaft: ScrewShaft | None = None  # without one the stiffness does not depend on position
    #: torsional, between motor (or driven pulley) and screw, N m/rad; infinite if rigid
    coupling_stiffness: float = np.inf
    belt: Belt | None = None  # between motor and screw
    axial_damping: float = 0.0  # of bearings, shaft and nut together, N s/m
    torsional_damping: float = 0.0  # of coupling and shaft together, N m s/rad
    backlash: float = 0.0  # of the nut, from flank to flank, m of travel

    def __post_init__(self) -> None:
        where = "ball screw"
        require_not_zero(where, lead=self.lead)
        positive(where, "motor_inertia", self.motor_inertia)
        require_stiffness(
            where,
            nut_stiffness=self.nut_stiffness,
            bearing_stiffness=self.bearing_stiffness,
            far_bearing_stiffness=self.far_bearing_stiffness,
            coupling_stiffness=self.coupling_stiffness,
        )
        require_not_negative(
            where,
            screw_inertia=self.screw_inertia,
            axial_damping=self.axial_damping,
            torsional_damping=self.torsional_damping,
            backlash=self.backlash,
        )
        held_twice = self.shaft is not None and self.shaft.support == "fixed-fixed"
        if np.isfinite(self.far_bearing_stiffness) and not held_twice:
            raise StructureError(
                f"{where}: far_bearing_stiffness is given, but no shaft with support "
                '"fixed-fixed" that the bearing would hold'
            )

    @property
    def travel(self) -> float:
        """Travel per angle of the screw, |lead|/(2 pi), m/rad."""
        return abs(self.lead) / (2.0 * np.pi)

    @property
    def transmission(self) -> float:
        """Travel per angle of the motor, m/rad."""
        return self.travel * (1.0 if self.belt is None else self.belt.ratio)

    def axial_stiffness(self, axis: DrivenAxis) -> float:
        """Stiffness of bearings, shaft and nut in a row where the nut is, N/m.

        Raises StructureError if the nut would lie off the shaft, or everything is rigid.
        """
        where = _who(axis)
        held = sum(one.stiffness for one in self._supports(axis))
        stiffness = series_stiffness([held, self.nut_stiffness])
        if np.isinf(stiffness):
            raise StructureError(
                f"{where}: bearings, shaft and nut are all rigid; give nut_stiffness"
            )
        return stiffness

    def torsional_stiffness(self, axis: DrivenAxis) -> float:
        """Stiffness of coupling and shaft in a row, N m/rad; infinite if rigid."""
        springs = [self.coupling_stiffness]
        if self.shaft is not None:
            springs.append(self.shaft.torsional_stiffness(_who(axis), axis.position))
        return series_stiffness(springs)

    def inertia_at_motor(self, moving_mass: float) -> float:
        """Moment of inertia at the motor, kg m^2: J + m h_p^2 with everything rigid."""
        turning_parts = reflected_inertia(self._stages("", RIGID, RIGID))
        return turning_parts + moving_mass * self.transmission**2

    def parts(self, axis: DrivenAxis) -> DriveParts:
        """Rotors, springs and motor on an axis.

        Raises StructureError if the nut would lie off the shaft, or no spring ties the motor to the
        axis.
        """
        stiffness, twist = self.axial_stiffness(axis), self.torsional_stiffness(axis)
        torsion = Spring(
            f"{axis.name}: screw torsion",
            twist / self.travel**2,
            self.torsional_damping / self.travel**2,
        )
        nut = Spring(f"{axis.name}: nut", stiffness, self.axial_damping, self.backlash)
        supports = self._supports(axis)
        turns = turning_direction(axis, self.lead)
        housing = Housing(axis.carrying, _place(axis, supports[0].station), turns)
        end = (
            Term(axis.moving, axis.direction, axis.at),
            *(
                Term(axis.carrying, -share * axis.direction, _place(axis, one.station))
                for one, share in zip(supports, _shares(supports), strict=True)
            ),
            turning(axis.moving, axis.at, turns, self.travel),
            housing.turning(-self.travel),
        )
        stages = self._stages(f"{axis.name}: ", torsion, nut)
        train = gear_train(_who(axis), stages, end, housing)
        motor = Motor(f"{axis.name}: motor", train.motor_angle, self.transmission)
        return DriveParts(train.rotors, (), train.couplings, (motor,))

    def _supports(self, axis: DrivenAxis) -> tuple[AxialSupport, ...]:
        if self.shaft is None:
            return (AxialSupport(0.0, self.bearing_stiffness),)
        bearings = (self.bearing_stiffness, self.far_bearing_stiffness)
        return self.shaft.supports(_who(axis), axis.position, bearings)

    def _stages(self, prefix: str, torsion: Spring, nut: Spring) -> list[Stage]:
        screw = Stage(f"{prefix}screw", self.screw_inertia, self.travel, nut)
        if self.belt is None:
            return [Stage(f"{prefix}motor", self.motor_inertia, self.travel, torsion), screw]
        driven = belt_stages(prefix, self.motor_inertia, self.belt, self.travel, torsion)
        return [*driven, screw]


def turning_direction(axis: DrivenAxis, lead: float) -> NDArray[np.float64]:
    """Direction (3,) that a screw turns about to push its nut forward.

    A nut held from turning runs back along a right-hand screw that turns about the direction.
    """
    return -np.sign(lead) * np.asarray(axis.direction)


def _who(axis: DrivenAxis) -> str:
    return f'axis "{axis.name}": ball screw'


def _place(axis: DrivenAxis, station: float) -> NDArray[np.float64]:
    return np.asarray(axis.at) + station * np.asarray(axis.direction)


def _shares(supports: tuple[AxialSupport, ...]) -> NDArray[np.float64]:
    stiffness = np.array([one.stiffness for one in supports])
    weights = np.isinf(stiffness) if np.any(np.isinf(stiffness)) else stiffness
    return weights / np.sum(weights)
