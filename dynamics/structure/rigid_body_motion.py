"""Rigid-body motions of parts that nothing holds."""

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.structure.linear_structure import StructureError

DIRECTIONS = ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z")
# Of rows scaled to unit length; a true constraint is far above it.
RANK_TOLERANCE = 1e-9
# Of pivots, over the largest: above it a constraint is a true one without a further look.
SURE = 1e-6
# Part of a free motion, scaled to the machine's size, that is worth naming.
NAMED = 0.05


def free_motions(
    restrained: NDArray[np.float64], turning: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Motions of parts that strain no spring.

    Whatever strains no part is a rigid motion of every part, so the rank of the springs on those
    decides: a question of geometry, and not of stiffness.

    Stretch (springs, n) of each spring per rigid motion of each part, displacements (m) and
    rotations (rad), and which of them turn (n,). Motions (n, free), rotations times the longest
    lever; each has a 1 where the others have 0.
    """
    rows = _scaled(restrained, turning)
    if not len(rows):
        return np.eye(len(turning))
    # the triangle of the rows has their null space, and is no taller than wide
    triangle = np.linalg.qr(rows, mode="r")
    free = scipy.linalg.null_space(triangle, rcond=RANK_TOLERANCE)
    if not free.shape[1]:
        return free
    pivots = scipy.linalg.qr(free.T, mode="r", pivoting=True)[1][: free.shape[1]]
    return free @ np.linalg.inv(free[pivots])


def _scaled(restrained: NDArray[np.float64], turning: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Rows of unit length, rotations times the longest lever; those of zeros are left out."""
    lever = np.max(np.abs(restrained[:, turning]), initial=0.0)
    rows = restrained / np.where(turning, lever if lever > 0.0 else 1.0, 1.0)
    norms = np.sqrt(np.einsum("sn,sn->s", rows, rows))
    return rows[norms > 0.0] / norms[norms > 0.0, None]


def _surely_held(restrained: NDArray[np.float64], turning: NDArray[np.bool_]) -> int:
    """Number of motions that springs hold, where no motion is held by next to nothing.

    Fewer than there are otherwise: singular values tell then.
    """
    rows = _scaled(restrained, turning)
    if not len(rows):
        return 0
    pivots = np.abs(np.diag(scipy.linalg.qr(rows, mode="r", pivoting=True)[0]))
    return int(np.sum(pivots > SURE * pivots[0]))


def refuse_free_motion(
    restrained: NDArray[np.float64], turning: NDArray[np.bool_], labels: Sequence[str], allowed: int
) -> None:
    """Refuse more free motions than allowed.

    Arguments as for `free_motions`, and names of the rigid motions (n,). The StructureError names
    parts and directions.
    """
    if len(turning) - _surely_held(restrained, turning) <= allowed:
        return
    free = free_motions(restrained, turning)
    if free.shape[1] <= allowed:
        return
    motions = [
        " with ".join(labels[row] for row in np.flatnonzero(np.abs(motion) > NAMED))
        for motion in free.T
    ]
    raise StructureError(
        f"rigid-body motions that no connector holds: {free.shape[1]}, allowed: {allowed}; "
        "free are " + "; ".join(motions)
    )
