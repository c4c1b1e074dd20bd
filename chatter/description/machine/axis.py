"""[axis.NAME]: what an axis moves, on what, and how it is driven and held."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from chatter.description.directions import Direction
from chatter.description.machine.control import ControlSection
from chatter.description.machine.drive import DriveSection
from chatter.description.machine.fields import Position
from chatter.description.quantities import either_quantity, quantities, quantity
from chatter.description.section import Section, raise_if_any
from dynamics.control.cascade import DriveController
from dynamics.drive.parts import DrivenAxis
from dynamics.machine.description import FeedDrive, MachineAxis
from dynamics.structure.bodies import GROUND

#: of positions at the end of a travel, m
_ROUNDING = 1e-9


class BrakeSection(Section):
    """What holds each motor while the brake is on."""

    stiffness: either_quantity("rotational_stiffness", "stiffness", above=0.0) = Field(
        description="N/m of a linear motor"
    )
    damping: either_quantity("rotational_damping", "damping", at_least=0.0) = 0.0


class AxisSection(Section):
    """Axis; without a drive it only says what travels."""

    direction: Direction = Field(
        description="of positive motion of moving against carrying", examples=[[0, 1, 0]]
    )
    moving: str | None = Field(None, description="part that is driven")
    carrying: str = Field(GROUND, description="part that carries the motor")
    at: Position | None = Field(None, description="where the drive acts, at position 0")
    carries: tuple[str, ...] | None = Field(
        None, description="all parts that travel with the axis; moving by default"
    )
    position: quantity("length", at_least=-200.0, at_most=200.0) = 0.0
    travel_limits: quantities(2, "length", at_least=-200.0, at_most=200.0) | None = Field(
        None,
        description="lowest and highest position that the axis may be at; not limited by default",
        examples=[["-200 mm", "200 mm"]],
    )
    scale_at: Position | None = Field(
        None, description="place of the direct measuring system; at by default"
    )
    drive: DriveSection | None = None
    brake: BrakeSection | None = None
    control: ControlSection | None = None

    @model_validator(mode="after")
    def _check_drive(self) -> AxisSection:
        problems = []
        kind = None if self.drive is None else self.drive.kind
        if self.moving is None and kind != "spindle":
            problems.append(("moving", "is missing; the part that the axis moves is required"))
        if self.at is None and kind is not None:
            problems.append(("at", "is missing; the position where the drive acts is required"))
        for key in ("brake", "control"):
            if kind is None and getattr(self, key) is not None:
                problems.append((key, "is given, but the axis has no drive"))
        if self.control is not None and self.control.motors == "each":
            problems += [
                (
                    f"drive.motors[{index}].preload",
                    f'{motor.preload:g} N m is given, but with control.motors = "each" the '
                    'controllers of the motors take it back; "together" keeps it',
                )
                for index, motor in enumerate(() if kind is None else self.drive.motors)
                if motor.preload
            ]
        shifted = self.carries or self.position or self.travel_limits
        if kind is not None and self.drive.is_rotary and shifted:
            text = f'drive.kind = "{kind}" turns; position, travel_limits and carries do not belong'
            problems.append(("", f"{text} to it"))
        raise_if_any([*problems, *self._problems_of_travel()])
        return self

    def _problems_of_travel(self) -> list[tuple[str, str]]:
        """Limits that are none, and a position beyond them."""
        if self.travel_limits is None:
            return []
        low, high = self.travel_limits
        if low >= high:
            text = f"{1e3 * low:g} mm is not below {1e3 * high:g} mm"
            return [("travel_limits", text)]
        text = self.beyond_travel(self.position)
        return [("position", text)] if text else []

    def beyond_travel(self, position: float) -> str:
        """Say that a position, m, lies beyond the travel of the axis; empty where it does not."""
        if self.travel_limits is None:
            return ""
        low, high = self.travel_limits
        if low - _ROUNDING <= position <= high + _ROUNDING:
            return ""
        return (
            f"{1e3 * position:.6g} mm is not within {1e3 * low:g} to {1e3 * high:g} mm, the travel "
            "of the axis (travel_limits)"
        )

    @property
    def travelling(self) -> tuple[str, ...]:
        """All parts that travel with the axis."""
        if self.drive is not None and self.drive.is_rotary:
            return ()
        return (self.moving,) if self.carries is None else self.carries

    @property
    def driven_part(self) -> str:
        """Part that is driven; a spindle that is only a rotor has none and names its housing."""
        return self.carrying if self.moving is None else self.moving

    def geometry(self, name: str, position: float, shift: NDArray[np.float64]) -> DrivenAxis:
        """Where the axis is driven.

        At a position, m, with the moving part shifted (3,), m, by all axes that carry it.
        """
        at = np.zeros(3) if self.at is None else np.asarray(self.at)
        return DrivenAxis(
            name, self.direction, self.driven_part, self.carrying, at + shift, position
        )

    def driven(self) -> tuple[FeedDrive, tuple[DriveController, ...]]:
        """Drive and controllers, the same at all positions.

        Raises StructureError or ControlError if numbers make no sense.
        """
        drive = self.drive.spec()
        return drive, self.controllers(drive)

    def axis(
        self,
        geometry: DrivenAxis,
        shift: NDArray[np.float64],
        driven: tuple[FeedDrive, tuple[DriveController, ...]],
    ) -> MachineAxis:
        """The axis with its drive and control."""
        return MachineAxis(
            geometry,
            *driven,
            None if self.scale_at is None else np.asarray(self.scale_at) + shift,
            *(() if self.brake is None else ((self.brake.stiffness, self.brake.damping),)),
        )

    def controllers(self, drive: FeedDrive) -> tuple[DriveController, ...]:
        """Controllers of a drive: none, one for all motors, or one each."""
        if self.control is None:
            return ()
        one = self.control.spec(drive.transmission)
        return (one,) * (max(len(self.drive.motors), 1) if self.control.motors == "each" else 1)
