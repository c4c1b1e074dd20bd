"""What a drive is made of, as the structure sees it: rotors, springs, and where motors act."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dynamics.structure.bodies import Connector, finite, unit_vector
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.rotor import Rotor
from dynamics.structure.spring_coupling import Coupling, Term


@dataclass(frozen=True, eq=False)
class DrivenAxis:
    """Place and direction of a feed drive.

    Raises
    ------
    StructureError
        If the direction has no length, or a number is not finite.
    """

    name: str
    #: (3,), of positive motion of `moving` against `carrying`; made a unit vector
    direction: ArrayLike
    moving: str  # part that is driven
    carrying: str  # part that carries the motor; may be "ground"
    at: ArrayLike  # (3,), where the drive pushes the moving part, m
    position: float = 0.0  # of the axis, m, from where the drive's own lengths count

    def __post_init__(self) -> None:
        where = f'axis "{self.name}"'
        object.__setattr__(self, "direction", unit_vector(where, "direction", self.direction))
        object.__setattr__(self, "at", finite(where, "at", self.at, (3,)))
        if not np.isfinite(self.position):
            raise StructureError(f"{where}: position is {self.position}; a finite length, in m")

    def travel(self, at: ArrayLike | None = None) -> tuple[Term, Term]:
        """Displacement of the moving against the carrying part along the axis, at a position."""
        position = self.at if at is None else at
        return (
            Term(self.moving, self.direction, position),
            Term(self.carrying, -self.direction, position),
        )

    def turning(self, part: str, factor: float = 1.0) -> Term:
        """Rotation of a part about the axis."""
        return Term(part, factor * np.concatenate([np.zeros(3), self.direction]), self.at)


class Motor(NamedTuple):
    """Motor of a drive: its torque acts along `angle`, which its encoder measures too.

    The angle is counted so that the axis travels forward with it. A linear motor has force and
    displacement instead, and transmission 1; a rotary axis has travel in rad.
    """

    name: str
    angle: tuple[Term, ...]  # of the rotor against its housing, rad
    transmission: float  # travel of the axis per angle, m/rad
    preload: float = 0.0  # torque that it gives besides its controller's, N m


class DriveParts(NamedTuple):
    """A drive in parts; `motors` are in the order of their controllers."""

    rotors: tuple[Rotor, ...]
    connectors: tuple[Connector, ...]
    couplings: tuple[Coupling, ...]
    motors: tuple[Motor, ...]


def require_not_negative(where: str, **values: float) -> None:
    """Refuse what is negative or not finite.

    StructureError: the message begins with `where` and names the key.
    """
    for what, value in values.items():
        if not (np.isfinite(value) and value >= 0.0):
            raise StructureError(f"{where}: {what} is {value}; it must be 0 or more")


def require_stiffness(where: str, **values: float) -> None:
    """Refuse a stiffness that is not above 0; infinite means rigid.

    StructureError: the message begins with `where` and names the key.
    """
    for what, value in values.items():
        if not value > 0.0:
            raise StructureError(
                f"{where}: {what} is {value}; it must be above 0 (infinite if rigid)"
            )


def require_not_zero(where: str, **values: float) -> None:
    """Refuse zero and what is not finite.

    StructureError: the message begins with `where` and names the key.
    """
    for what, value in values.items():
        if not np.isfinite(value) or value == 0.0:
            raise StructureError(f"{where}: {what} is {value}; it must be finite and not 0")
