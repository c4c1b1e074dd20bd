"""Springs and dampers along a combination of motions: nuts, belts, pinions, gears.

A connector has a place where two parts meet; a transmission ties motions of different kinds at
different places, such as the rotation of a screw and the travel of its nut.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.structure.bodies import finite
from dynamics.structure.linear_structure import StructureError


@dataclass(frozen=True, eq=False)
class Term:
    """Motion of a part at a place, weighted."""

    part: str  # name of a body, beam or rotor, or "ground", which does not move
    #: (6,) or (3,) array of float, weights of displacements along and rotations about x, y, z
    direction: ArrayLike
    at: ArrayLike = (0.0, 0.0, 0.0)  # (3,), place, m; of no matter for a rotor

    def __post_init__(self) -> None:
        where = f'term on "{self.part}"'
        weights = np.zeros(6)
        given = np.atleast_1d(np.asarray(self.direction, dtype=np.float64))
        if given.shape not in ((3,), (6,)):
            raise StructureError(f"{where}: direction must be 3 or 6 numbers")
        weights[: given.size] = given
        object.__setattr__(self, "direction", finite(where, "direction", weights, (6,)))
        object.__setattr__(self, "at", finite(where, "at", self.at, (3,)))

    def times(self, factor: float) -> Term:
        """Same motion with weights times a factor."""
        return Term(self.part, factor * np.asarray(self.direction), self.at)


def reversed_terms(terms: Sequence[Term]) -> tuple[Term, ...]:
    """Terms of the opposite motion."""
    return tuple(term.times(-1.0) for term in terms)


@dataclass(frozen=True, eq=False)
class Coupling:
    """Spring and damper along the sum of its terms.

    StructureError if a number is negative or not finite, or there are no terms.
    """

    name: str
    terms: Sequence[Term]
    stiffness: float  # N/m (N m/rad where the sum is an angle)
    damping: float = 0.0  # N s/m and kin
    backlash: float = 0.0  # gap in which neither acts, from flank to flank, m or rad

    def __post_init__(self) -> None:
        where = f'coupling "{self.name}"'
        object.__setattr__(self, "terms", tuple(self.terms))
        if not self.terms:
            raise StructureError(f"{where} ties nothing: it has no terms")
        for what in ("stiffness", "damping", "backlash"):
            value = getattr(self, what)
            if not (np.isfinite(value) and value >= 0.0):
                raise StructureError(f"{where}: {what} is {value:g}; it must be 0 or more")


def screw_nut_matrix(
    radial: tuple[float, float], axial: float, tilt: tuple[float, float], lead: float
) -> NDArray[np.float64]:
    """Stiffness (6, 6) between screw and nut, screw axis along z.

    k_X, k_Y and k_Z, N/m, k_psi, k_theta, N m/rad, and the lead, travel per turn, m; h_p = lead/(2
    pi). Eq. 2 of the test machine's model, after Oertli and Berkemer: the axial spring is stretched
    by the travel less h_p times the rotation, so that it takes part in torsion too.
    """
    matrix = np.diag([*radial, axial, *tilt, 0.0]).astype(np.float64)
    h_p = lead / (2.0 * np.pi)
    matrix[2, 5] = matrix[5, 2] = -h_p * axial
    matrix[5, 5] = h_p**2 * axial
    return matrix
