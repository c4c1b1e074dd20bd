"""State of a linear structure in coordinates in which a step is cheap and exact.

The free motion splits into parts that do not know of one another: a pair of real coordinates for
each damped vibration, and one block for what is left - rigid-body motion, overdamped motion.
"""

from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure

#: part of the fastest rate below which a motion counts as not vibrating
_STILL = 1e-6
#: condition of the change of coordinates up to which it is used
_WORST_CONDITION = 1e3


class Blocks(NamedTuple):
    """z' = A z + B f with z = T xi; displacement D xi, velocity V xi of the structure's ports.

    The first `dense` coordinates have a full matrix, the others come in pairs.
    """

    dense: int
    rate: NDArray[np.float64]  # A in these coordinates, block diagonal, 1/s, (s, s)
    entry: NDArray[np.float64]  # of forces on ports, (s, ports)
    displacement: NDArray[np.float64]  # (ports, s)
    velocity: NDArray[np.float64]  # (ports, s)
    start: NDArray[np.float64]  # of a velocity of the structure's freedoms, (s, n)


def blocks(structure: LinearStructure, ports: NDArray[np.float64]) -> Blocks:
    """Split a structure into blocks.

    Ports (p, n) are rows along which forces act and motions are read. The modes of the undamped
    structure are the first change of coordinates; damping then couples them. Invariant subspaces
    come from an ordered real Schur form and eigenvectors (Golub and Van Loan 2013, Matrix
    Computations, section 7.6); where they are ill-conditioned - two motions that are almost one -
    everything is left as one block, which is as exact, only slower. StructureError if the matrices
    are not those of a structure.
    """
    modes = undamped_modes(structure)
    count = modes.frequency.size
    omega = 2.0 * np.pi * modes.frequency
    unit = np.where(omega > 0.0, omega, 1.0)
    damping = modes.shapes.T @ (structure.damping @ modes.shapes)
    # displacements times the frequency: all entries are then of the size of the frequencies
    rate = np.zeros((2 * count, 2 * count))
    rate[:count, count:] = np.diag(unit)
    rate[count:, :count] = np.diag(-(omega**2) / unit)
    rate[count:, count:] = -damping
    seen = np.asarray(ports) @ modes.shapes
    nothing = np.zeros_like(seen)
    basis, inverse, dense = _split(rate)
    return Blocks(
        dense,
        _cleaned(inverse @ rate @ basis, dense),
        inverse @ np.vstack([nothing.T, seen.T]),
        np.hstack([seen / unit, nothing]) @ basis,
        np.hstack([nothing, seen]) @ basis,
        inverse[:, count:] @ (modes.shapes.T @ structure.mass),
    )


def _split(rate: NDArray[np.float64]) -> tuple[NDArray, NDArray, int]:
    """Columns of invariant subspaces, their inverse, and the size of the first."""
    size = len(rate)
    whole = np.eye(size), np.eye(size), size
    if size == 0:
        return whole
    still = _STILL * np.max(np.abs(rate))
    values, vectors = np.linalg.eig(rate)
    turning = values.imag > still
    _, first, dense = scipy.linalg.schur(
        rate,
        output="real",
        sort=lambda re, im: abs(im) <= still,  # noqa: ARG005
    )
    if dense + 2 * np.sum(turning) != size:
        return whole
    chosen = vectors[:, turning]
    pairs = np.stack([chosen.real, chosen.imag], axis=2).reshape(size, -1)
    basis = np.hstack([first[:, :dense], pairs])
    if np.linalg.cond(basis) > _WORST_CONDITION:
        return whole
    return basis, np.linalg.inv(basis), dense


def _cleaned(rate: NDArray[np.float64], dense: int) -> NDArray[np.float64]:
    """The blocks alone, without the rounding between them."""
    kept = np.zeros_like(rate)
    kept[:dense, :dense] = rate[:dense, :dense]
    for start in range(dense, len(rate), 2):
        pair = slice(start, start + 2)
        kept[pair, pair] = rate[pair, pair]
    return kept
