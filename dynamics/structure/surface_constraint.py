"""Points tied to surfaces of a finite element model.

A rigid surface follows its point (in FE programs RBE2): its freedoms are replaced by the point's.
An interpolated point follows its surface (RBE3) and stiffens nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.structure.bodies import finite, rigid_motion
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.rigid_body_motion import DIRECTIONS

# Smallest over largest extent of a surface, seen from its point, that still tells rotations.
NARROWEST = 1e-6


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes of a finite element model and the matrix rows of their freedoms.

    StructureError if numbers repeat, sizes disagree or two freedoms share a row.
    """

    names: NDArray[np.int64]  # (m,), numbers of the nodes
    coordinates: NDArray[np.float64]  # (m, 3), m
    #: (m, 6), row of the matrices, from 0, of each node's displacements and rotations; -1 where the
    #: node has none or it is held
    rows: NDArray[np.int64]

    def __post_init__(self) -> None:
        count = len(self.names)
        finite("nodes", "coordinates", self.coordinates, (count, 3))
        values, counts = np.unique(self.names, return_counts=True)
        if np.any(counts > 1):
            raise StructureError(f"nodes: node {values[counts > 1][0]} is there twice")
        if self.rows.shape != (count, 6):
            raise StructureError(f"nodes: rows must be {count} x 6, not {self.rows.shape}")
        values, counts = np.unique(self.rows[self.rows >= 0], return_counts=True)
        if np.any(counts > 1):
            raise StructureError(f"nodes: row {values[counts > 1][0] + 1} has two freedoms")

    @classmethod
    def in_order(cls, names: ArrayLike, coordinates: ArrayLike, size: int) -> Nodes:
        """Nodes whose freedoms follow one another, three or six each.

        Names (m,), coordinates (m, 3), m. The size counts the rows of the matrices. StructureError
        if it is neither 3 m nor 6 m.
        """
        names = np.asarray(names, dtype=np.int64)
        count = len(names)
        if count == 0 or size not in (3 * count, 6 * count):
            raise StructureError(
                f"nodes: {count} nodes have {3 * count} or {6 * count} freedoms, the matrices have "
                f"{size} rows; say which freedom has which row"
            )
        rows = np.full((count, 6), -1, dtype=np.int64)
        rows[:, : size // count] = np.arange(size).reshape(count, -1)
        return cls(names, np.asarray(coordinates, dtype=np.float64), rows)

    def indices(self, names: Sequence[int], where: str) -> NDArray[np.int64]:
        """Where nodes stand in the table.

        Raises StructureError, beginning with `where`, if one is unknown or named twice.
        """
        known = {int(name): index for index, name in enumerate(self.names)}
        if not len(names):
            raise StructureError(f"{where}: no nodes given")
        for name in names:
            if int(name) not in known:
                raise StructureError(f"{where}: there is no node {name}")
        if len(set(names)) < len(names):
            raise StructureError(f"{where}: a node is named twice")
        return np.array([known[int(name)] for name in names])


@dataclass(frozen=True, eq=False)
class RigidSurface:
    """Point that nodes follow as one rigid body; it has six freedoms of its own."""

    name: str  # of the point
    at: ArrayLike  # (3,), m
    nodes: Sequence[int]  # their displacements follow, and their rotations if they have them


@dataclass(frozen=True, eq=False)
class InterpolatedPoint:
    """Point that follows nodes: the weighted least-squares rigid motion of their displacements.

    A force and moment on the point spread over the nodes with the same resultants.
    """

    name: str
    at: ArrayLike  # (3,), m
    nodes: Sequence[int]
    weights: Sequence[float] | None = None  # one a node, above 0; equal by default


def interpolation(point: InterpolatedPoint, nodes: Nodes, size: int) -> NDArray[np.float64]:
    """Motion of an interpolated point per freedom of the model.

    With the nodes' rigid motion R (3k, 6) about the point and weights W, it is
    (R' W R)^-1 R' W; its transpose spreads forces, and R' times that is the identity.

    (6, size), size the rows of the matrices; held freedoms count as at rest. StructureError if the
    nodes do not tell a rotation, being on one line, or a weight is not positive.
    """
    where = f'point "{point.name}"'
    indices = nodes.indices(point.nodes, where)
    weights = np.ones(len(indices)) if point.weights is None else point.weights
    weights = finite(where, "weights", weights, (len(indices),))
    if np.any(weights <= 0.0):
        raise StructureError(f"{where}: weights must be above 0")
    at = finite(where, "at", point.at, (3,))
    rigid = np.vstack([rigid_motion(one - at)[:3] for one in nodes.coordinates[indices]])
    _refuse_narrow(nodes.coordinates[indices], where)
    root = np.sqrt(np.repeat(weights / weights.max(), 3))
    share = np.linalg.pinv(root[:, None] * rigid, rcond=1e-14) * root
    rows = nodes.rows[indices, :3].ravel()
    motion = np.zeros((6, size))
    motion[:, rows[rows >= 0]] = share[:, rows >= 0]
    return motion


def rigid_transformation(
    surfaces: Sequence[RigidSurface], nodes: Nodes, size: int
) -> tuple[scipy.sparse.csr_array, dict[str, int]]:
    """Freedoms of the model from those that rigid surfaces leave.

    The transformation (size, left), sparse, has the kept freedoms in their order, then six for each
    surface; returned with the first of the six columns of each surface's point. StructureError if
    surfaces share a node, a node is held in a direction, or nodes lie on one line and have no
    rotations.
    """
    owner: dict[int, str] = {}
    rows, columns, values = [], [], []
    for surface, rigid in enumerate(surfaces):
        for row, motion in _followers(rigid, nodes):
            if row in owner:
                raise StructureError(
                    f'rigid surfaces "{owner[row]}" and "{rigid.name}" share a node'
                )
            owner[row] = rigid.name
            rows += [row] * 6
            columns += range(6 * surface, 6 * surface + 6)
            values += list(motion)
    kept = np.setdiff1d(np.arange(size), np.fromiter(owner, dtype=np.int64, count=len(owner)))
    rows = np.concatenate([kept, np.array(rows, dtype=np.int64)])
    columns = np.concatenate([np.arange(len(kept)), len(kept) + np.array(columns, dtype=np.int64)])
    values = np.concatenate([np.ones(len(kept)), np.array(values)])
    left = len(kept) + 6 * len(surfaces)
    transformation = scipy.sparse.csr_array((values, (rows, columns)), shape=(size, left))
    first = {rigid.name: len(kept) + 6 * index for index, rigid in enumerate(surfaces)}
    return transformation, first


def _followers(surface: RigidSurface, nodes: Nodes) -> list[tuple[int, NDArray[np.float64]]]:
    """Row of each freedom of a surface's nodes, and its motion (6,) per freedom of the point."""
    where = f'rigid surface "{surface.name}"'
    indices = nodes.indices(surface.nodes, where)
    at = finite(where, "at", surface.at, (3,))
    found = []
    for index in indices:
        rows = nodes.rows[index]
        turns = np.any(rows[3:] >= 0)
        for direction, row in enumerate(rows):
            if row < 0 and (direction < 3 or turns):
                raise StructureError(
                    f"{where}: node {nodes.names[index]} is held in {DIRECTIONS[direction]} and "
                    "cannot follow the point"
                )
        motion = rigid_motion(nodes.coordinates[index] - at)
        found += [(int(row), line) for row, line in zip(rows, motion, strict=True) if row >= 0]
    if not np.any(nodes.rows[indices, 3:] >= 0):
        _refuse_narrow(nodes.coordinates[indices], where)
    return found


def _refuse_narrow(coordinates: NDArray[np.float64], where: str) -> None:
    """Refuse nodes on one line: they do not tell the rotation about it."""
    extent = np.linalg.svd(coordinates - coordinates.mean(axis=0), compute_uv=False)
    if len(coordinates) < 3 or extent[1] <= NARROWEST * extent[0]:
        raise StructureError(
            f"{where}: its {len(coordinates)} nodes lie on one line and do not tell the rotation "
            "about it; take at least three that do not"
        )
