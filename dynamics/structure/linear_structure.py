"""Linear structure: mass, damping and stiffness over degrees of freedom, and named points on it.

Everything that describes a machine's mechanics ends here: rigid bodies and connectors, beams,
imported matrices, reduced models. What acts on it - a cut, a drive, friction - does so along a
port: a direction at a point, or between two points.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

Matrix: TypeAlias = "NDArray[np.float64] | scipy.sparse.csr_array"


class StructureError(ValueError):
    """A structure that makes no sense; the message names the part."""


@dataclass(frozen=True)
class LinearStructure:
    """M x'' + C x' + K x = sum of ports, with symmetric matrices (n, n), full or sparse."""

    mass: Matrix  # kg and rotational kin
    damping: Matrix  # N s/m and rotational kin
    stiffness: Matrix  # N/m and rotational kin
    # (6, n) by name: motion, three displacements (m) and three rotations (rad), per degree of
    # freedom; rows that a point does not have (rotations of a solid) are zero
    points: Mapping[str, NDArray[np.float64]]
    # (6, 6), m/N and kin, by names of two points: compliance between their ports that a reduction
    # left out; missing pairs have none
    residual: Mapping[tuple[str, str], NDArray[np.float64]] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Degrees of freedom."""
        return self.mass.shape[0]

    def port(self, point: str, direction: ArrayLike, against: str | None = None) -> NDArray:
        """Row (n,) of the motion of a point along a direction, against another point if named.

        The direction (3,) is of displacements, (6,) of displacements and rotations. StructureError
        if there is no such point.
        """
        along = np.zeros(6)
        given = np.asarray(direction, dtype=np.float64)
        along[: given.size] = given
        row = along @ self._point(point)
        return row if against is None else row - along @ self._point(against)

    def _point(self, name: str) -> NDArray[np.float64]:
        if name not in self.points:
            known = ", ".join(f'"{point}"' for point in self.points)
            raise StructureError(f'there is no point "{name}"; there are {known}')
        return self.points[name]

    def natural_frequencies(self, count: int | None = None) -> NDArray[np.float64]:
        """Undamped natural frequencies (count,), Hz, ascending; rigid-body motion has 0."""
        squared = scipy.linalg.eigh(
            dense(self.stiffness), dense(self.mass), eigvals_only=True, check_finite=True
        )
        frequency = np.sqrt(np.maximum(squared, 0.0)) / (2.0 * np.pi)
        return frequency[:count]

    def receptance(self, frequency: ArrayLike, ports: NDArray[np.float64]) -> NDArray:
        """Receptance (m, p, p) between ports at frequencies (m,), Hz, without residuals.

        Ports (p, n) are rows as from `port`.
        """
        rows = np.atleast_2d(ports)
        result = np.empty((np.size(frequency), len(rows), len(rows)), dtype=np.complex128)
        mass, damping, stiffness = (
            dense(part) for part in (self.mass, self.damping, self.stiffness)
        )
        for index, line in enumerate(np.atleast_1d(np.asarray(frequency, dtype=np.float64))):
            omega = 2.0 * np.pi * line
            dynamic = stiffness - omega**2 * mass + 1j * omega * damping
            result[index] = rows @ np.linalg.solve(dynamic, rows.T)
        return result


def dense(matrix: Matrix) -> NDArray[np.float64]:
    """Matrix as an array, whether it is sparse or not."""
    return np.asarray(matrix) if isinstance(matrix, np.ndarray) else matrix.toarray()
