"""Ball screw whose shaft is a line of beam elements of the machine."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.drive.ball_screw import turning_direction
from dynamics.drive.belt import Belt, belt_stages
from dynamics.drive.gear_train import (
    RIGID,
    Housing,
    Spring,
    Stage,
    gear_train,
    reflected_inertia,
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
from dynamics.structure.bodies import Connector, finite, radial_direction
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.spring_coupling import Coupling, Term


@dataclass(frozen=True, eq=False)
class ScrewOnBeam:
    """Nut on a beam that is the screw, and the motor at the beam's end.

    Between nut and screw is the stiffness of
    `dynamics.structure.spring_coupling.screw_nut_matrix`: springs in the radial
    directions and against tilt, and one along the screw that its turning stretches too.
    The beam brings the screw's bearings, inertia and compliance.

    Raises
    ------
    StructureError
        If a number is out of its range.
    """

    beam: str  # name of the `dynamics.beam.shaft.BeamLine`; it lies along the axis
    #: travel per turn, m; positive for a right-hand thread, negative for a left-hand one
    lead: float
    radial: tuple[float, float]  # k_X, k_Y between nut and screw, N/m
    axial: float  # k_Z, N/m
    tilt: tuple[float, float]  # k_psi, k_theta about the same two radial directions, N m/rad
    #: place of the nut at position 0 of the axis from the beam's driven end along the direction of
    #: the axis, m; negative if that end lies ahead of the nut
    nut_at: float
    #: kg m^2; 0 where the beam has it as a disc and the coupling is rigid
    motor_inertia: float = 0.0
    #: torsional, between motor (or driven pulley) and the beam's end, N m/rad
    coupling_stiffness: float = np.inf
    belt: Belt | None = None
    #: (3,), first radial direction, made perpendicular to the axis
    first_radial: ArrayLike | None = None
    axial_damping: float = 0.0  # of the nut, N s/m
    torsional_damping: float = 0.0  # of the coupling, N m s/rad
    radial_damping: tuple[float, float] = (0.0, 0.0)  # of the nut, N s/m
    tilt_damping: tuple[float, float] = (0.0, 0.0)  # of the nut, N m s/rad
    backlash: float = 0.0  # of the nut along the thread, from flank to flank, m of travel

    def __post_init__(self) -> None:
        where = f'screw on beam "{self.beam}"'
        require_not_zero(where, lead=self.lead)
        require_stiffness(where, coupling_stiffness=self.coupling_stiffness)
        if not (np.isfinite(self.axial) and self.axial > 0.0):
            raise StructureError(f"{where}: axial is {self.axial}; it must be above 0, in N/m")
        require_not_negative(
            where,
            motor_inertia=self.motor_inertia,
            axial_damping=self.axial_damping,
            torsional_damping=self.torsional_damping,
            backlash=self.backlash,
        )
        for what in ("radial", "tilt", "radial_damping", "tilt_damping"):
            for value in finite(where, what, getattr(self, what), (2,)):
                require_not_negative(where, **{what: value})
        if not np.isfinite(self.nut_at):
            raise StructureError(f"{where}: nut_at is {self.nut_at}; a finite length, in m")

    @property
    def travel(self) -> float:
        """Travel per angle of the screw, |lead|/(2 pi), m/rad."""
        return abs(self.lead) / (2.0 * np.pi)

    @property
    def transmission(self) -> float:
        """Travel per angle of the motor, m/rad."""
        return self.travel * (1.0 if self.belt is None else self.belt.ratio)

    def inertia_at_motor(self, moving_mass: float, screw_inertia: float = 0.0) -> float:
        """Moment of inertia at the motor with everything rigid, kg m^2.

        The moving mass is in kg; the inertia of beam and discs about their axis in kg m^2.
        """
        stages = [*self._stages("", np.inf), Stage("", screw_inertia, self.travel, RIGID)]
        return reflected_inertia(stages) + moving_mass * self.transmission**2

    def parts(self, axis: DrivenAxis) -> DriveParts:
        """Rotors, springs of nut and coupling, and the motor on an axis.

        Raises StructureError if the motor has inertia and a rigid coupling, or the reverse.
        """
        where = f'axis "{axis.name}": screw on beam "{self.beam}"'
        turns = turning_direction(axis, self.lead)
        end = np.asarray(axis.at) - (self.nut_at + axis.position) * np.asarray(axis.direction)
        housing = Housing(axis.carrying, end, turns)
        angle = (turning(self.beam, end, turns, self.travel), housing.turning(-self.travel))
        stages = self._stages(f"{axis.name}: ", self.coupling_stiffness)
        train = gear_train(where, stages, angle, housing)
        motor = Motor(f"{axis.name}: motor", train.motor_angle, self.transmission)
        couplings = (*train.couplings, self._thread(axis, turns))
        return DriveParts(train.rotors, (self._nut(where, axis),), couplings, (motor,))

    def _stages(self, prefix: str, coupling_stiffness: float) -> list[Stage]:
        coupling = Spring(
            f"{prefix}coupling",
            coupling_stiffness / self.travel**2,
            self.torsional_damping / self.travel**2,
        )
        if self.belt is None:
            return [Stage(f"{prefix}motor", self.motor_inertia, self.travel, coupling)]
        return belt_stages(prefix, self.motor_inertia, self.belt, self.travel, coupling)

    def _nut(self, where: str, axis: DrivenAxis) -> Connector:
        def along_screw_last(radial: tuple[float, float], tilt: tuple[float, float]) -> tuple:
            return (*radial, 0.0, *tilt, 0.0)

        return Connector(
            name=f"{axis.name}: nut",
            first=axis.moving,
            second=self.beam,
            at=axis.at,
            stiffness=along_screw_last(self.radial, self.tilt),
            damping=along_screw_last(self.radial_damping, self.tilt_damping),
            axes=self._axes(where, axis),
        )

    def _thread(self, axis: DrivenAxis, turns: NDArray) -> Coupling:
        terms = (
            Term(axis.moving, axis.direction, axis.at),
            Term(self.beam, -np.asarray(axis.direction), axis.at),
            turning(axis.moving, axis.at, turns, self.travel),
            turning(self.beam, axis.at, turns, -self.travel),
        )
        return Coupling(
            f"{axis.name}: thread", terms, self.axial, self.axial_damping, self.backlash
        )

    def _axes(self, where: str, axis: DrivenAxis) -> NDArray[np.float64]:
        """(3, 3): rows are the two radial directions and the axis."""
        along = np.asarray(axis.direction)
        first = radial_direction(where, along, self.first_radial)
        return np.array([first, np.cross(along, first), along])
