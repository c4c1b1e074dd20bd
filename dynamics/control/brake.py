"""Motor held by its brake: the cascade is off and a stiff connection to the housing acts.

The rigid brake is the limit of great stiffness; slipping is not modelled.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import ArrayLike, NDArray

from dynamics.compiled import INLINED
from dynamics.control.sampling import require_not_negative, require_positive


@dataclass(frozen=True)
class MotorBrake:
    """Spring and dashpot between rotor and housing.

    Parameters
    ----------
    stiffness : float
        N m/rad.
    damping : float
        N m s/rad.

    Raises
    ------
    ControlError
        If the stiffness is not above 0 or the damping negative.
    """

    stiffness: float
    damping: float = 0.0

    def __post_init__(self):
        require_positive("motor brake", "stiffness", self.stiffness)
        require_not_negative("motor brake", "damping", self.damping)

    def response(self, frequencies: ArrayLike) -> NDArray[np.complex128]:
        """Return the torque per motor angle, N m/rad; frequencies in Hz."""
        w = 2.0 * np.pi * np.asarray(frequencies, dtype=np.float64)
        return -(self.stiffness + 1j * w * self.damping)


class BrakeTable(NamedTuple):
    """k brakes; `angle` is where they engaged."""

    stiffness: NDArray[np.float64]  # N m/rad, (k,)
    damping: NDArray[np.float64]  # N m s/rad, (k,)
    angle: NDArray[np.float64]  # rad, (k,)


def brake_table(brakes: Sequence[MotorBrake]) -> BrakeTable:
    """Return the columns of brakes engaged at angle 0."""
    return BrakeTable(
        np.array([brake.stiffness for brake in brakes], dtype=np.float64),
        np.array([brake.damping for brake in brakes], dtype=np.float64),
        np.zeros(len(brakes)),
    )


@register_jitable(**INLINED)
def engage_brake(table, k, x_motor):
    """Engage a brake at an angle of the motor, rad."""
    table.angle[k] = x_motor


@register_jitable(**INLINED)
def brake_torque(table, k, x_motor, v_motor):
    """Torque on the motor, N m, at its angle, rad, and velocity, rad/s."""
    return -table.stiffness[k] * (x_motor - table.angle[k]) - table.damping[k] * v_motor
