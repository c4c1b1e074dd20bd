"""Super-elements with exact boundary points, and structures joined at points.

Fixed-interface modes and constraint modes (Craig and Bampton, AIAA Journal 6, 1968); joining by
elimination of the dependent freedoms, or by springs and dampers between points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.receptance.coupling import joint_matrix
from dynamics.reduction.modal_truncation import ROUNDING, symmetric_factors, undamped_modes
from dynamics.structure.linear_structure import LinearStructure, Matrix, StructureError, dense
from dynamics.structure.rigid_body_motion import DIRECTIONS

# Of rows scaled to unit length: below it, a row follows from the others.
DEPENDENT = 1e-9
MOVES_FREELY = "super-element: part of it moves freely while its boundary is held"


@dataclass(frozen=True, eq=False)
class RigidJoint:
    """Two points, each (part, point), that move as one in every direction they have."""

    first: tuple[str, str]
    second: tuple[str, str]


@dataclass(frozen=True, eq=False)
class ElasticJoint:
    """Springs and dampers between two points.

    Parameters
    ----------
    first, second : (str, str)
        Part and point.
    stiffness, damping : (6, 6) array of float, or (6,) for the diagonal
        N/m, N m/rad; N s/m, N m s/rad; symmetric, not negative.

    Raises
    ------
    StructureError
        If a matrix is not.
    """

    first: tuple[str, str]
    second: tuple[str, str]
    stiffness: ArrayLike
    damping: ArrayLike = field(default_factory=lambda: np.zeros(6))

    def __post_init__(self) -> None:
        where = f"joint {_title(self.first)} - {_title(self.second)}"
        for what in ("stiffness", "damping"):
            matrix = joint_matrix(where, what, getattr(self, what))
            if matrix.shape != (6, 6):
                raise StructureError(f"{where}: {what} must be 6 or 6 x 6 numbers")
            object.__setattr__(self, what, matrix)


def super_element(
    structure: LinearStructure,
    boundary: Sequence[str],
    highest: float = np.inf,
    count: int | None = None,
    freedoms: Sequence[int] = (),
) -> LinearStructure:
    """Reduce a structure to the motion of its boundary and fixed-interface modes.

    The static answer to motion of and loads on the boundary is exact; natural frequencies are
    from above (Rayleigh and Ritz).

    Parameters
    ----------
    structure : LinearStructure
    boundary : sequence of str
        Points kept exactly, in the directions they have (rows that are not zero).
    highest, count
        Fixed-interface modes kept: up to a frequency in Hz, at most so many (0 for none: Guyan's
        reduction).
    freedoms : sequence of int
        Freedoms of the structure, from 0, kept exactly too.

    Returns
    -------
    LinearStructure
        Dense. Coordinates: boundary points' directions in order, freedoms, modal coordinates.
        Other points move by the reduced shapes.

    Raises
    ------
    StructureError
        If the boundary is empty or its motions depend on one another, a boundary point has a
        residual compliance, or the structure moves freely with its boundary held.
    """
    rows = _boundary_rows(structure, boundary, freedoms)
    for pair in structure.residual:
        if set(pair) & set(boundary):
            raise StructureError(
                f'super-element: point "{pair[0]}" has a residual compliance, which freedoms '
                "cannot carry; reduce the full structure"
            )
    given, free = _solved_for(rows)
    held, inner_size = len(rows), free.shape[1]
    if held + inner_size != structure.size:
        raise StructureError("super-element: motions of the boundary depend on one another")
    basis = scipy.sparse.hstack([given, free], format="csr")
    mass, damping, stiffness = (
        _congruent(part, basis) for part in (structure.mass, structure.damping, structure.stiffness)
    )
    inside = slice(held, None)
    constraint = _static_shapes(stiffness[inside, inside], stiffness[inside, :held])
    shapes = np.zeros((inner_size, 0))
    if count != 0 and inner_size:
        held_structure = LinearStructure(
            mass[inside, inside], damping[inside, inside], stiffness[inside, inside], points={}
        )
        modes = undamped_modes(held_structure, highest, count)
        if np.any(modes.frequency == 0.0):
            raise StructureError(MOVES_FREELY)
        shapes = modes.shapes
    reduced = basis @ np.block(
        [[np.eye(held), np.zeros((held, shapes.shape[1]))], [constraint, shapes]]
    )
    compact = _congruent(structure.stiffness, reduced)
    # what cancels in a rigid-body motion is zero, not rounding of either sign
    compact[abs(compact) <= ROUNDING * _congruent(abs(structure.stiffness), abs(reduced))] = 0.0
    return LinearStructure(
        _congruent(structure.mass, reduced),
        _congruent(structure.damping, reduced),
        compact,
        {name: motion @ reduced for name, motion in structure.points.items()},
        structure.residual,
    )


def joined(
    parts: Mapping[str, LinearStructure], joints: Sequence[RigidJoint | ElasticJoint]
) -> LinearStructure:
    """Join structures or super-elements at points.

    Parameters
    ----------
    parts : mapping of str to LinearStructure
    joints : sequence of RigidJoint or ElasticJoint
        Both points of one may be of the same part. Directions are the machine's.

    Returns
    -------
    LinearStructure
        Points named "part.point". Sparse if all parts are.

    Raises
    ------
    StructureError
        If a part or point is unknown, or a joint asks for a direction that only one point has.
    """
    points = _joined_points(parts)
    mass, damping, stiffness = (
        _block_diagonal([getattr(part, what) for part in parts.values()])
        for what in ("mass", "damping", "stiffness")
    )
    rigid = []
    for joint in joints:
        relative = _relative(joint, points)
        if isinstance(joint, RigidJoint):
            rigid.append(relative)
        else:
            stiffness = stiffness + relative.T @ joint.stiffness @ relative
            damping = damping + relative.T @ joint.damping @ relative
    residual = {
        (f"{name}.{one}", f"{name}.{other}"): left
        for name, part in parts.items()
        for (one, other), left in part.residual.items()
    }
    if rigid:
        basis = _solved_for(np.vstack(rigid))[1]
        mass, damping, stiffness = (_congruent(part, basis) for part in (mass, damping, stiffness))
        points = {name: motion @ basis for name, motion in points.items()}
    return LinearStructure(mass, damping, stiffness, points, residual)


def _title(end: tuple[str, str]) -> str:
    return f'"{end[0]}.{end[1]}"'


def _boundary_rows(
    structure: LinearStructure, boundary: Sequence[str], freedoms: Sequence[int]
) -> NDArray[np.float64]:
    for name in boundary:
        structure.port(name, np.zeros(3))
    for freedom in freedoms:
        if not 0 <= freedom < structure.size:
            raise StructureError(f"super-element: no freedom {freedom}; 0 to {structure.size - 1}")
    motions = [structure.points[name] for name in boundary]
    single = np.zeros((len(freedoms), structure.size))
    single[np.arange(len(freedoms)), list(freedoms)] = 1.0
    rows = np.vstack([*motions, single])
    rows = rows[np.any(rows != 0.0, axis=1)]
    if not len(rows):
        raise StructureError("super-element: the boundary is empty")
    return rows


def _joined_points(parts: Mapping[str, LinearStructure]) -> dict[str, NDArray[np.float64]]:
    if not parts:
        raise StructureError("nothing to join: there are no parts")
    size = sum(part.size for part in parts.values())
    points, start = {}, 0
    for name, part in parts.items():
        for point, motion in part.points.items():
            points[f"{name}.{point}"] = np.zeros((6, size))
            points[f"{name}.{point}"][:, start : start + part.size] = motion
        start += part.size
    return points


def _relative(
    joint: RigidJoint | ElasticJoint, points: Mapping[str, NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Motion (6, n) of the first point against the second."""
    ends = [".".join(end) for end in (joint.first, joint.second)]
    where = f'joint "{ends[0]}" - "{ends[1]}"'
    for end in ends:
        if end not in points:
            known = ", ".join(f'"{point}"' for point in points)
            raise StructureError(f'{where}: there is no point "{end}"; there are {known}')
    there = [np.any(points[end] != 0.0, axis=1) for end in ends]
    asked = np.ones(6, dtype=bool)
    if isinstance(joint, ElasticJoint):
        asked = np.any(joint.stiffness != 0.0, axis=1) | np.any(joint.damping != 0.0, axis=1)
    lacking = np.flatnonzero(asked & (there[0] != there[1]))
    if lacking.size:
        end = ends[0] if there[1][lacking[0]] else ends[1]
        raise StructureError(
            f'{where}: point "{end}" has no {DIRECTIONS[lacking[0]]}, the other has; tie it to '
            "more than a node, or join it by an elastic joint without that direction"
        )
    return points[ends[0]] - points[ends[1]]


def _solved_for(rows: NDArray[np.float64]) -> tuple[scipy.sparse.csr_array, scipy.sparse.csr_array]:
    """Motions with `rows @ x = u`: x = given @ u + free @ (freedoms that stay coordinates).

    Freedoms to solve for are picked by pivoting; rows that follow from others are left out.

    Rows are (b, n), given (n, b), free (n, n - rank), both sparse.
    """
    size = rows.shape[1]
    scale = np.linalg.norm(rows, axis=1)
    scale[scale == 0.0] = 1.0
    touched = np.flatnonzero(np.any(rows != 0.0, axis=0))
    turn, triangle, order = scipy.linalg.qr(
        rows[:, touched] / scale[:, None], mode="economic", pivoting=True
    )
    rank = int(np.sum(np.abs(np.diag(triangle)) > DEPENDENT))
    solved, others = touched[order[:rank]], touched[order[rank:]]
    right = np.hstack([turn[:, :rank].T / scale, -triangle[:rank, rank:]])
    answer = scipy.linalg.solve_triangular(triangle[:rank, :rank], right)
    stay = np.setdiff1d(np.arange(size), solved)
    given = scipy.sparse.lil_array((size, len(rows)))
    given[solved] = answer[:, : len(rows)]
    free = scipy.sparse.lil_array((size, len(stay)))
    free[stay, np.arange(len(stay))] = 1.0
    if rank and len(others):
        free[np.ix_(solved, np.searchsorted(stay, others))] = answer[:, len(rows) :]
    return given.tocsr(), free.tocsr()


def _static_shapes(stiffness: Matrix, coupling: Matrix) -> NDArray[np.float64]:
    """Constraint modes -K_ii^-1 K_ib (inner, boundary)."""
    if not stiffness.shape[0]:
        return np.zeros(coupling.shape)
    if scipy.sparse.issparse(stiffness):
        try:
            factors = symmetric_factors(stiffness)
        except RuntimeError as error:
            # exactly singular
            raise StructureError(MOVES_FREELY) from error
        pivots = factors.U.diagonal() / stiffness.diagonal()[np.argsort(factors.perm_c)]
        shapes = -factors.solve(dense(coupling))
    else:
        try:
            factor = scipy.linalg.cho_factor(stiffness, lower=True)
        except scipy.linalg.LinAlgError as error:
            raise StructureError(MOVES_FREELY) from error
        pivots = np.diag(factor[0]) ** 2 / np.diag(stiffness)
        shapes = -scipy.linalg.cho_solve(factor, coupling)
    if np.min(pivots) <= ROUNDING:
        raise StructureError(MOVES_FREELY)
    return shapes


def _congruent(matrix: Matrix, basis: Matrix) -> Matrix:
    """Matrix of the motions of a basis, B' A B, kept symmetric."""
    product = basis.T @ (matrix @ basis)
    product = 0.5 * (product + product.T)
    return scipy.sparse.csr_array(product) if scipy.sparse.issparse(product) else product


def _block_diagonal(blocks: Sequence[Matrix]) -> Matrix:
    if all(scipy.sparse.issparse(block) for block in blocks):
        return scipy.sparse.block_diag(blocks, format="csr")
    return scipy.linalg.block_diag(*(dense(block) for block in blocks))
