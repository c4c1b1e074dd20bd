"""Rotor on an axis: the turning of a motor, a screw or a pinion as one freedom.

Its mass belongs to the body that carries it; here is only what turns.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.structure.bodies import refuse_ground, unit_vector
from dynamics.structure.linear_structure import StructureError


@dataclass(frozen=True, eq=False)
class Rotor:
    """Part with one freedom: its angle about an axis, rad, counted against ground.

    StructureError if the moment of inertia is not positive or the axis has no length.
    """

    name: str
    inertia: float  # moment of inertia about the axis, kg m^2
    axis: ArrayLike  # (3,), direction; made a unit vector

    def __post_init__(self) -> None:
        where = f'rotor "{self.name}"'
        refuse_ground(where, self.name)
        if not (np.isfinite(self.inertia) and self.inertia > 0.0):
            raise StructureError(
                f"{where}: moment of inertia is {self.inertia}; it must be positive, in kg m^2"
            )
        object.__setattr__(self, "axis", unit_vector(where, "axis", self.axis))

    @property
    def mass_matrix(self) -> NDArray[np.float64]:
        """(1, 1), kg m^2."""
        return np.array([[self.inertia]])

    @property
    def damping_matrix(self) -> NDArray[np.float64]:
        """(1, 1) of zero."""
        return np.zeros((1, 1))

    @property
    def stiffness_matrix(self) -> NDArray[np.float64]:
        """(1, 1) of zero."""
        return np.zeros((1, 1))

    @property
    def rigid_motions(self) -> NDArray[np.float64]:
        """(1, 1): its angle."""
        return np.ones((1, 1))

    def motion_at(self, position: ArrayLike) -> NDArray[np.float64]:  # noqa: ARG002
        """(6, 1): rotation about the axis, wherever the position."""
        return np.concatenate([np.zeros(3), self.axis])[:, None]
