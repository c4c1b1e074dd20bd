"""Drives of what turns: a spindle or rotary table, behind a coupling or belt or directly."""

from dataclasses import dataclass

import numpy as np

from dynamics.beam.element import positive
from dynamics.drive.belt import Belt, belt_stages
from dynamics.drive.gear_train import Housing, Spring, Stage, gear_train, reflected_inertia, turning
from dynamics.drive.parts import (
    DrivenAxis,
    DriveParts,
    Motor,
    require_not_negative,
    require_stiffness,
)
from dynamics.structure.rotor import Rotor
from dynamics.structure.spring_coupling import Term


@dataclass(frozen=True)
class DirectRotary:
    """Motor that turns the moving part about the direction of the axis.

    The moving part - a body, or a beam line of a spindle - is free to turn in its bearings.
    Travel is an angle here, rad.

    Raises
    ------
    StructureError
        If a number is out of its range.
    """

    #: kg m^2; 0 where the moving part has it (a built-in motor's rotor as a disc of the spindle)
    #: and the coupling is rigid
    motor_inertia: float = 0.0
    #: torsional, between motor (or driven pulley) and moving part, N m/rad; infinite if rigid
    coupling_stiffness: float = np.inf
    coupling_damping: float = 0.0  # N m s/rad
    belt: Belt | None = None  # between motor and moving part

    def __post_init__(self) -> None:
        where = "rotary drive"
        require_stiffness(where, coupling_stiffness=self.coupling_stiffness)
        require_not_negative(
            where, motor_inertia=self.motor_inertia, coupling_damping=self.coupling_damping
        )

    @property
    def transmission(self) -> float:
        """Angle of the axis per angle of the motor, rad/rad."""
        return 1.0 if self.belt is None else self.belt.ratio

    def inertia_at_motor(self, moving_inertia: float) -> float:
        """Moment of inertia at the motor with everything rigid, kg m^2.

        The moving inertia is of what the axis turns, kg m^2.
        """
        return reflected_inertia(self._stages("")) + moving_inertia * self.transmission**2

    def parts(self, axis: DrivenAxis) -> DriveParts:
        """Rotors, springs and motor on an axis.

        Raises StructureError if the motor has inertia and nothing that gives way ties it to the
        moving part.
        """
        housing = Housing(axis.carrying, axis.at, axis.direction)
        end = (turning(axis.moving, axis.at, axis.direction), housing.turning(-1.0))
        where = f'axis "{axis.name}": rotary drive'
        train = gear_train(where, self._stages(f"{axis.name}: "), end, housing)
        motor = Motor(f"{axis.name}: motor", train.motor_angle, self.transmission)
        return DriveParts(train.rotors, (), train.couplings, (motor,))

    def _stages(self, prefix: str) -> list[Stage]:
        coupling = Spring(f"{prefix}coupling", self.coupling_stiffness, self.coupling_damping)
        if self.belt is None:
            return [Stage(f"{prefix}motor", self.motor_inertia, 1.0, coupling)]
        return belt_stages(prefix, self.motor_inertia, self.belt, 1.0, coupling)


@dataclass(frozen=True)
class SpindleRotor:
    """Spindle that turns in its housing with nothing else to turn: one rotor and its motor.

    For a spindle whose bending is modelled apart, or not at all. The axis names the housing as
    the carrying part; its moving part is not asked.

    Raises
    ------
    StructureError
        If it is not above 0.
    """

    inertia: float  # of spindle, motor and tool about the axis, kg m^2

    def __post_init__(self) -> None:
        positive("spindle rotor", "inertia", self.inertia)

    @property
    def transmission(self) -> float:
        """1."""
        return 1.0

    def inertia_at_motor(self, further_inertia: float = 0.0) -> float:
        """Moment of inertia at the motor, kg m^2."""
        return self.inertia + further_inertia

    def parts(self, axis: DrivenAxis) -> DriveParts:
        """The rotor and its motor on an axis."""
        name = f"{axis.name}: motor"
        housing = Housing(axis.carrying, axis.at, axis.direction)
        along = np.concatenate([np.zeros(3), np.asarray(axis.direction)])
        motor = Motor(name, (Term(name, along), housing.turning(-1.0)), self.transmission)
        return DriveParts((Rotor(name, self.inertia, axis.direction),), (), (), (motor,))
