"""State space of a machine's structure between ports."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.structure.linear_structure import LinearStructure, dense

Array = NDArray[np.float64]


class StateSpace(NamedTuple):
    """x' = A x + B u, y = C x + D u; states are coordinates of the structure, then their rates."""

    a: Array  # (2 n, 2 n), 1/s and kin
    b: Array  # (2 n, p)
    c: Array  # (q, 2 n)
    d: Array  # (q, p)

    def response(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Frequency response (m, q, p) at frequencies (m,), Hz."""
        lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
        unit = np.eye(len(self.a))
        return np.array(
            [
                self.c @ np.linalg.solve(2j * np.pi * line * unit - self.a, self.b) + self.d
                for line in lines
            ]
        )


def state_space(structure: LinearStructure, excited: Array, read: Array) -> StateSpace:
    """First-order form of M q'' + C q' + K q = E^T u, y = R q.

    Rows of what is excited (p, n) and of what is read (q, n), as from `LinearStructure.port`.
    Compliance that a reduction left out stays left out: D is zero.
    """
    mass, damping, stiffness = (
        dense(part) for part in (structure.mass, structure.damping, structure.stiffness)
    )
    size = structure.size
    right = np.hstack([-stiffness, -damping, np.atleast_2d(excited).T])
    below = np.linalg.solve(mass, right)
    a = np.zeros((2 * size, 2 * size))
    a[:size, size:] = np.eye(size)
    a[size:] = below[:, : 2 * size]
    b = np.vstack([np.zeros((size, len(excited))), below[:, 2 * size :]])
    c = np.hstack([np.atleast_2d(read), np.zeros((len(read), size))])
    return StateSpace(a, b, c, np.zeros((len(read), len(excited))))
