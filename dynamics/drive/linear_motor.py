"""Linear motors: a force along the axis, at one place or evenly shared by several."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dynamics.drive.parts import DrivenAxis, DriveParts, Motor
from dynamics.structure.bodies import finite
from dynamics.structure.linear_structure import StructureError


@dataclass(frozen=True, eq=False)
class LinearMotor:
    """Linear motor, or a pair of them on one controller.

    The force at the motor is the sum of all; its displacement the mean weighted by their shares,
    so that the work is the same. Motors with a controller each are a drive each. Attraction
    between primary and secondary, and the motors' mass, belong to the structure.

    Raises
    ------
    StructureError
        If there is no motor, or the shares are negative or not 1 in sum.
    """

    #: (3,) each: where a motor pushes, from the place where the axis is driven, m
    offsets: Sequence[ArrayLike] = ((0.0, 0.0, 0.0),)
    shares: Sequence[float] | None = None  # of the force, in sum 1; even by default

    def __post_init__(self) -> None:
        where = "linear motor"
        offsets = tuple(finite(where, "offset", one, (3,)) for one in self.offsets)
        if not offsets:
            raise StructureError(f"{where} has no place; give one offset at least")
        object.__setattr__(self, "offsets", offsets)
        given = np.full(len(offsets), 1.0 / len(offsets)) if self.shares is None else self.shares
        shares = finite(where, "shares", given, (len(offsets),))
        if np.any(shares < 0.0) or abs(np.sum(shares) - 1.0) > 1e-9:
            raise StructureError(f"{where}: shares are {list(shares)}; 0 or more, in sum 1")
        object.__setattr__(self, "shares", tuple(float(share) for share in shares))

    @property
    def transmission(self) -> float:
        """1: the motor travels as the axis does."""
        return 1.0

    def inertia_at_motor(self, moving_mass: float) -> float:
        """What the motor accelerates: the moving mass, kg."""
        return moving_mass

    def parts(self, axis: DrivenAxis) -> DriveParts:
        """The motor on an axis; nothing turns."""
        displacement = tuple(
            term.times(share)
            for offset, share in zip(self.offsets, self.shares, strict=True)
            for term in axis.travel(np.asarray(axis.at) + offset)
        )
        motor = Motor(f"{axis.name}: motor", displacement, self.transmission)
        return DriveParts((), (), (), (motor,))
